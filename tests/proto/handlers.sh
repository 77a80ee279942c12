#!/bin/sh
# handlers.sh CC: a method in the document without a handler does not link, and a handler without a method does not compile. Proved with documents
# that have one method more and one less; the document as it is does both.
set -eu
cc=${1:-cc}
command -v node >/dev/null || { echo 'node is missing: skipped'; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$1"; sed 's/^/    /' "$work/log"; exit 1; }

# tables NAME FILTER: tables of the document after FILTER, a statement on `d`.
tables() {
    mkdir "$work/$1"
    node -e 'const d = JSON.parse(require("fs").readFileSync("proto/gnomon.openrpc.json")); '"$2"'; console.log(JSON.stringify(d))' >"$work/$1/document.json"
    node proto/generate.mjs c "$work/$1/protocol.h" "$work/$1/protocol.c" "$work/$1/document.json"
}

# compile NAME SOURCE...: as CMakeLists.txt does; objects beside the tables.
compile() {
    folder=$work/$1
    shift
    for source in "$@"; do
        # shellcheck disable=SC2046
        "$cc" -std=gnu17 -D_GNU_SOURCE -DGNOMON_VERSION='"test"' -O0 -Werror=missing-prototypes -Werror=unused-function -I server -I renderer -I shaders -I . \
            -I "$folder" $(pkg-config --cflags jansson cglm) -c "$source" -o "$folder/$(basename "$source" .c).o" 2>"$work/log" || return 1
    done
}

unhandled() { "$cc" "$work/$1"/*.o -o "$work/program" 2>&1 | grep -o 'undefined reference to .method_[a-z_]*' | sort -u >"$work/log"; [ -s "$work/log" ]; }

tables good ''
compile good "$work/good/protocol.c" server/methods/*.c || fail 'the document as it is does not compile'
! unhandled good || fail 'methods without a handler'

tables more 'd.methods.push({...d.methods.find((m) => m.name === "view.close"), name: "view.nonesuch"})'
compile more "$work/more/protocol.c" server/methods/*.c || fail 'one method more does not compile'
unhandled more || fail 'a method without a handler links'
grep -q 'method_view_nonesuch$' "$work/log" && [ "$(wc -l <"$work/log")" = 1 ] || fail 'not that method alone is missed'

tables less 'd.methods = d.methods.filter((m) => m.name !== "view.close")'
compile less server/methods/hello.c || fail 'one method less: hello.c does not compile'
! compile less server/methods/views.c || fail 'a handler without a method compiles'
grep -q 'method_view_close' "$work/log" || fail 'another error than the missing prototype'
echo 'all good'
