#!/bin/sh
# node.sh BINARY_DIR SCRIPT [ARGUMENT]...: runs SCRIPT of this folder with the program and the viewer's client of that build.
here=$(dirname "$0")
command -v node >/dev/null || { echo "node is missing: skipped"; exit 77; }
[ -d "$here/../../web/node_modules/ws" ] || { echo "web/node_modules is missing: skipped"; exit 77; }
binaries=$1 script=$2
shift 2
GNOMON=${GNOMON:-$binaries/gnomon} BINARY_DIR=$binaries exec node "$here/$script" "$@"
