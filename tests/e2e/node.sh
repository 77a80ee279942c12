#!/bin/sh
# node.sh BINARY_DIR SCRIPT: runs SCRIPT of this folder with the program and the viewer's client of that build.
here=$(dirname "$0")
command -v node >/dev/null || { echo "node is missing: skipped"; exit 77; }
[ -d "$here/../../web/node_modules/ws" ] || { echo "web/node_modules is missing: skipped"; exit 77; }
GNOMON=${GNOMON:-$1/gnomon} BINARY_DIR=$1 exec node "$here/$2"
