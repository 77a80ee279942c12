# What the scripts of this folder share; sourced. $GNOMON: the program.
GNOMON=${GNOMON:?the program to test}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

complain() {
    failures=$((failures + 1))
    printf 'FAILED: %s\n' "$*"
    sed 's/^/    stderr: /' "$work/err"
}

# run ARGS...: stdout to $work/out, stderr to $work/err, exit code in $code.
run() {
    code=0
    timeout 120 "$GNOMON" "$@" >"$work/out" 2>"$work/err" || code=$?
}

# good ARGS...: exit 0 and nothing said on standard error.
good() {
    run "$@"
    [ "$code" = 0 ] || { complain "exit $code, not 0: gnomon $*"; return 0; }
    [ ! -s "$work/err" ] || complain "chatter on standard error: gnomon $*"
}

# bad CODE PATTERN ARGS...: that exit code, nothing on standard output, one line of error that matches PATTERN.
bad() {
    wanted=$1 pattern=$2
    shift 2
    run "$@"
    [ "$code" = "$wanted" ] || complain "exit $code, not $wanted: gnomon $*"
    [ ! -s "$work/out" ] || complain "output on failure: gnomon $*"
    one_error "gnomon $*"
    grep -q -e "$pattern" "$work/err" || complain "the error does not match '$pattern': gnomon $*"
}

one_error() {
    [ "$(wc -l <"$work/err")" = 1 ] && grep -q '^gnomon: error: ..*' "$work/err" || complain "not one line 'gnomon: error: ...': $1"
}

# says PATTERN: in the last standard output.
says() {
    grep -q -e "$1" "$work/out" || complain "no '$1' in the output"
}

# json FILE FILTER WHAT: the filter's result is true.
json() {
    jq -e "$2" "$1" >"$work/jq" 2>&1 || { complain "$3"; sed 's/^/    jq: /' "$work/jq"; }
}

finish() {
    [ "$failures" = 0 ] || { echo "$failures failed"; exit 1; }
    echo "all good"
}
