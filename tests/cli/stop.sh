#!/bin/sh
# SIGTERM ends `gnomon serve` with exit code 0 within 5 s, whatever it is at: nothing, a long load, a picture that takes a minute.
set -eu
. "$(dirname "$0")/expect.sh"
command -v curl >/dev/null || { echo 'curl is missing: skipped'; exit 77; }
run list devices
[ "$code" != 69 ] || { echo 'no usable device'; exit 77; }

# stop WHAT BODY: with a request under way, or none.
stop() {
    rm -f "$work/out" # the ready line of the one before
    "$GNOMON" serve --listen 127.0.0.1:0 >"$work/out" 2>"$work/err" &
    server=$!
    tries=0
    until grep -qs '^gnomon: ready ' "$work/out"; do
        tries=$((tries + 1))
        [ "$tries" -lt 300 ] || { complain "no ready line: $1"; kill -9 "$server"; return 0; }
        sleep 0.1
    done
    url=$(sed -n 's/^gnomon: ready //p' "$work/out")
    [ -z "$2" ] || { curl -s -m 20 -o "$work/answer" -d "$2" "${url}v1/render" & sleep 0.5; }
    start=$(date +%s%N)
    kill -TERM "$server"
    code=0
    wait "$server" || code=$?
    took=$((($(date +%s%N) - start) / 1000000))
    wait
    [ "$code" = 0 ] || complain "exit $code, not 0: $1"
    [ "$took" -lt 5000 ] || complain "$took ms: $1"
    [ "$(wc -l <"$work/out")" = 1 ] || complain "more than the ready line on standard output: $1"
    echo "$1: $took ms"
}

stop 'at rest' ''
stop 'loading' '{"scene":"builtin:dragon:triangles=2500000","size":[64,36]}'
stop 'rendering' '{"scene":"builtin:tree","algorithm":"reference:samples=32","size":[3840,2160]}'
finish
