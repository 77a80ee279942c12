#!/bin/sh
# Command line without a device: help, exit codes, one line for every failure.
set -eu
. "$(dirname "$0")/expect.sh"

good --version
says '^gnomon [0-9]*\.[0-9]*\.[0-9]*$'
good --help
for command in serve render compare bench batch check list; do
    says "^  $command  *[a-z]"
done
says 'Exit codes: 0 .*64 .*65 .*66 .*69'
bad 64 'serve, render, compare, bench, batch, check, list' unknown
bad 64 'serve, render, compare, bench, batch, check, list'

for command in serve render compare check list; do
    good $command --help
    says "^Usage: gnomon $command "
    says '^Examples:$'
    bad 64 "$command has no option --nonsense; accepted: " $command --nonsense
done
for command in serve render compare; do
    good $command --help
    for option in size camera eye target up fov light algorithm show exposure ambient tonemap aa time camera-pass frames-timed moving \
        threads device memory quiet log-level; do
        says "^  --$option"
    done
done

# What the contract has and this version does not.
bad 64 'not built yet' batch job.json
bad 74 'no answer from http://127.0.0.1:1' render builtin:box -o "$work/a.png" --server http://127.0.0.1:1
bad 64 '--time is not built yet' render builtin:box -o "$work/a.png" --time 1
bad 74 'no answer from http://127.0.0.1:1' list scenes --server http://127.0.0.1:1

# Usage.
bad 64 'needs an argument' render
bad 64 'needs -o FILE; .png, .jpg, .webp and .exr' render builtin:box
bad 64 '.png, .jpg, .webp and .exr' render builtin:box -o picture.bmp
bad 64 '.png, .jpg, .webp and .exr' render builtin:box -o picture
bad 64 'standard output carries one thing' render builtin:box -o - --stats -
bad 64 'standard output carries one thing' compare builtin:box --algorithm none -o - --json -
bad 64 '1 to 16384' render builtin:box -o "$work/a.png" --size 16385x1
bad 64 'needs --algorithm' compare builtin:box
bad 64 'exclude each other' render builtin:box -o "$work/a.png" --show difference --progressive 3
bad 64 'difference' serve --listen 127.0.0.1:0 --show difference
bad 64 '1 to 100000 frames' render builtin:box -o "$work/a.png" --progressive 0
bad 64 'lists of 1 to 64' compare builtin:box --algorithm none --oracle 0
bad 64 'light or camera' compare builtin:box --algorithm none --flicker sun
bad 64 '3 to 10000 frames' compare builtin:box --algorithm none --flicker light --frames 2
bad 64 'frames of --flicker, which is missing' compare builtin:box --algorithm none --frames 8
bad 64 'against point and samples32 only' compare builtin:box --algorithm none --against sm --flicker light
bad 64 '1 to 1048576 MiB' render builtin:box -o "$work/a.png" --memory 0
bad 64 'algorithm' compare builtin:box --algorithm no_such_system
bad 64 'against' compare builtin:box --algorithm none --against no_such_system
bad 64 'rays of arealight' compare builtin:box --algorithm none --against arealight:rays=0
bad 64 'radius=R and rays=N' compare builtin:box --algorithm none --against arealight:size=3
bad 64 "there is no camera 'nobody'" render builtin:box -o "$work/a.png" --camera nobody
bad 64 'scenes, algorithms or devices' list cameras
bad 66 'no_such_scene' check builtin:no_such_scene
bad 66 'no_such_scene' render builtin:no_such_scene -o "$work/a.png"
bad 64 'point, spot or directional' render builtin:box -o "$work/a.png" --light lamp
bad 64 'token' serve --listen 0.0.0.0:0

# Scenes.
printf 'not a scene' >"$work/broken.glb"
printf '{"asset":{"version":"2.0"},"buffers":[{"uri":"missing.bin","byteLength":4}]}' >"$work/missing.gltf"
bad 66 'no-such-file.glb' check "$work/no-such-file.glb"
bad 66 'no-such-file.glb' render "$work/no-such-file.glb" -o "$work/a.png"
bad 66 'no-such-file.glb' compare "$work/no-such-file.glb" --algorithm none
bad 65 'broken.glb' check "$work/broken.glb"
bad 65 'missing.bin' check "$work/missing.gltf"
[ ! -e "$work/a.png" ] || complain "a failed render left a picture behind"

# Output.
bad 74 '/no/such/folder' render builtin:box -o /no/such/folder/a.png
bad 74 '/no/such/folder' check builtin:box --json /no/such/folder/a.json
bad 74 'folder' check builtin:box --json "$work"
if [ -e /dev/full ]; then
    bad 74 '/dev/full' check builtin:box --json /dev/full
    for arguments in '--help' 'render --help' 'list algorithms' 'list scenes --json -' 'check builtin:box' 'check builtin:box --json -'; do
        code=0
        # shellcheck disable=SC2086
        "$GNOMON" $arguments >/dev/full 2>"$work/err" || code=$?
        [ "$code" = 74 ] || complain "exit $code, not 74, on a full disk: gnomon $arguments"
        one_error "gnomon $arguments >/dev/full"
    done
fi
code=0
"$GNOMON" list algorithms >&- 2>"$work/err" || code=$?
[ "$code" = 74 ] || complain "exit $code, not 74, with standard output closed"
one_error "gnomon list algorithms >&-"
{ sleep 0.3; code=0; "$GNOMON" list algorithms 2>"$work/err" || code=$?; echo "$code" >"$work/code"; } | true
[ "$(cat "$work/code")" = 74 ] || complain "exit $(cat "$work/code"), not 74, into a closed pipe"
one_error "gnomon list algorithms | true"

# Listings and summaries.
good list scenes
says '^builtin:box$'
good list scenes --json -
json "$work/out" '[.scenes[].name] | index("builtin:box") != null' 'list scenes names builtin:box'
json "$work/out" 'all(.scenes[]; (.name | startswith("builtin:")) and (.help | length > 0) and (.params | type == "array"))' \
    'list scenes describes each'
good list algorithms --json "$work/algorithms.json"
[ ! -s "$work/out" ] || complain 'standard output besides --json FILE'
json "$work/algorithms.json" '[.algorithms[].name] | index("sm") != null and index("reference") != null' 'list algorithms names sm'
json "$work/algorithms.json" '.algorithms[] | select(.name == "sm") | .params[] | select(.name == "size") | .default == 1024' \
    'the default size is 1024'
good check builtin:box
says '^triangles  *[0-9]'
good check builtin:box --json -
json "$work/out" '.counts.triangles > 0 and (.bounds.min | length == 3) and (.warnings | type == "array")' 'check --json counts'

finish
