#!/bin/sh
# Proves that headers.sh can fail: wrong/ has a header that needs another and one that cannot be included twice.
here=$(cd "$(dirname "$0")" && pwd)
found=$(sh "$here/headers.sh" "$here/wrong" "$@" 2>/dev/null) && { echo "headers.sh found nothing wrong in wrong/"; exit 1; }
[ "$found" = "renderer/needs_size.h does not stand alone
renderer/once_only.h does not stand alone" ] || { echo "headers.sh found something else: $found"; exit 1; }
