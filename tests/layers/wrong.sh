#!/bin/sh
# Proves that layers.sh can fail: in the tree wrong/ it must find what wrong/expected.txt lists, and nothing else.
here=$(cd "$(dirname "$0")" && pwd)
found=$("$here/layers.sh" "$here/wrong") && { echo "layers.sh found nothing wrong in wrong/"; exit 1; }
printf '%s\n' "$found" | diff -u "$here/wrong/expected.txt" -
