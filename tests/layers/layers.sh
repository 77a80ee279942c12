#!/bin/sh
# layers.sh TREE: checks who includes whom in TREE/renderer, TREE/server and TREE/proto. Exit code 1 and one line for each fault.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$1"
sources=$(find renderer server proto -name '*.[ch]' -o -name '*.cc' -o -name '*.hh' -o -name '*.[ch]pp' 2>/dev/null | LC_ALL=C sort)
headers=$(find renderer server shaders proto -name '*.h' -o -name '*.hh' -o -name '*.def' 2>/dev/null | LC_ALL=C sort)
# These also mean other things: a tone map, a camera pass, a tracer, a member of the figures, an alpha mode.
names=$(sed -n 's/^ *[A-Z_]*(\([a-z0-9_]*\).*/\1/p' renderer/shadow/algorithms.def 2>/dev/null | grep -vxE 'none|auto|exact|reference|mask' || true)
words() { tr '\n' ' '; }
# shellcheck disable=SC2086
found=$(LC_ALL=C awk -v allowed="$here/allowed.txt" -v headers="$(echo "$headers" | words)" -v algorithms="$(echo "${names:-sm pcf}" | words)" \
    -f "$here/layers.awk" $sources)
[ -z "$found" ] || { printf '%s\n' "$found"; exit 1; }
