#!/bin/sh
# headers.sh TREE COMPILER [OPTION...]: every header of TREE's renderer/, server/ and proto/ must compile with nothing before it, and twice.
set -eu
tree=$1
shift
bad=0
for header in $(cd "$tree" && find renderer server proto -name '*.h' 2>/dev/null | LC_ALL=C sort); do
    printf '#include "%s"\n#include "%s"\n' "$header" "$header" |
        "$@" -std=gnu17 -D_GNU_SOURCE -Wall -Wextra -Werror -fsyntax-only -I "$tree" -I "$tree/renderer" -I "$tree/server" -I "$tree/shaders" \
            -x c - ||
        { echo "$header does not stand alone"; bad=1; }
done
exit $bad
