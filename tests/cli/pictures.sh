#!/bin/sh
# Pictures and figures of the built program, on whatever device there is: names exact, figures repeat.
set -eu
. "$(dirname "$0")/expect.sh"

run list devices
[ "$code" != 69 ] || { echo 'no usable device'; exit 77; }
good list devices --json -
json "$work/out" '.devices | length > 0 and any(.usable)' 'list devices: one is usable'
bad 69 'device' render builtin:box -o "$work/a.png" --device /dev/dri/no-such-node

small='--size 96x64 --algorithm sm:size=128 --threads 2'

# Each format by its first bytes.
signature() {
    # shellcheck disable=SC2086
    good render builtin:box -o "$work/$1" $small
    [ ! -s "$work/out" ] || complain "standard output besides -o $1"
    od -An -tx1 -N12 "$work/$1" | tr -d ' \n' >"$work/magic"
    grep -q "^$2" "$work/magic" || complain "$1 begins with $(cat "$work/magic"), not $2"
}
signature a.png 89504e47
signature a.jpg ffd8ff
signature a.webp 52494646........57454250
signature a.exr 762f3101
# shellcheck disable=SC2086
good render builtin:box -o - $small
cmp -s "$work/out" "$work/a.png" || [ "$(od -An -tx1 -N4 "$work/out" | tr -d ' \n')" = 89504e47 ] || complain '-o - is not a PNG'
ls -A "$work" | grep -q '\.tmp' && complain 'a temporary file was left behind'
if [ -e /dev/full ]; then
    code=0
    # shellcheck disable=SC2086
    "$GNOMON" render builtin:box -o - $small >/dev/full 2>"$work/err" || code=$?
    [ "$code" = 74 ] || complain "exit $code, not 74: a picture to a full disk"
    one_error 'a picture to a full disk'
fi

# render --stats.
stats_keys='["algorithm","device","frame_ms","frames","maps","memory","moving","params","passes","scene","size","version","visibility_ms"]'
stats_shape() {
    json "$1" "($stats_keys - keys) == []" "stats: members of $1"
    json "$1" '.scene | keys == ["drawn_triangles","lights","triangles","vertices"]' 'stats: scene'
    json "$1" '.frame_ms | keys == ["median","min","p95"] and .min > 0 and .min <= .median and .median <= .p95' 'stats: frame_ms'
    json "$1" '.passes | (["camera_ms","lighting_ms","prepare_ms","readback_ms","receivers_ms","resolve_ms"] - keys) == []' \
        'stats: passes'
    json "$1" '.memory | keys == ["peak_bytes","shadow_bytes","shadow_bytes_max"] and .shadow_bytes_max >= .shadow_bytes
        and .peak_bytes > 1000000' 'stats: memory'
    json "$1" '(.passes.receivers_ms + .passes.prepare_ms + .passes.resolve_ms - .visibility_ms) | fabs < 0.001' 'stats: visibility_ms'
    json "$1" 'all(.maps[]; keys == ["fov_deg","size"])' 'stats: maps'
}
# shellcheck disable=SC2086
good render builtin:box -o "$work/a.png" $small --frames-timed 4 --moving --stats -
cp "$work/out" "$work/stats.json"
stats_shape "$work/stats.json"
json "$work/stats.json" "keys == $stats_keys" 'stats: nothing else'
json "$work/stats.json" '.frames == 4 and .moving and .size == [96, 64] and .algorithm == "sm" and .params.size == 128' 'stats: settings'
json "$work/stats.json" '.scene.lights >= 1 and .maps[0].size == 128 and .memory.shadow_bytes >= 128 * 128 * 2' 'stats: maps and bytes'

# arealight: with one ray it is point; more rays change the figures, and are said to.
good compare builtin:box --size 96x64 --algorithm reference --against arealight:rays=1 --json -
json "$work/out" '.misclassified == 0 and .max_abs == 0 and .receivers > 1000 and .against == "arealight:rays=1"' 'one ray of an area light is point'
good compare builtin:box --size 96x64 --algorithm reference --against arealight:rays=16,radius=0.5 --json -
json "$work/out" '.max_abs > 0 and .rmse > 0 and .against == "arealight:radius=0.5,rays=16" and .wrong_samples == null' 'an area light blurs'

# --show difference: compare's picture.
# shellcheck disable=SC2086
good render builtin:box -o "$work/shown.png" $small --show difference
# shellcheck disable=SC2086
good compare builtin:box -o "$work/compared.png" $small --against point
cmp -s "$work/shown.png" "$work/compared.png" || complain 'render --show difference is not what compare -o writes'

# Flicker: the reference has just its own, no shadow has none.
good compare builtin:box --size 96x64 --algorithm reference --flicker light --flicker camera --frames 4 --json -
json "$work/out" '.flicker | .light == 0 and .camera == 0 and .reference.light > 0 and .tested == .reference and .frames == 4' \
    'flicker: the reference adds none'
good compare builtin:box --size 96x64 --algorithm none --flicker light --frames 4 --json -
json "$work/out" '.flicker | .light < 0 and .tested.light == 0 and .camera == null' 'flicker: no shadows, no flicker'

# Masks.
good compare builtin:box --size 96x64 --algorithm reference:samples=32 --against samples32 --json -
json "$work/out" '.wrong_samples == 0 and .per_light[0].wrong_samples == 0' 'the reference has no wrong sample'

# --progressive: the last picture, or each; a row a frame.
# shellcheck disable=SC2086
good render builtin:box -o "$work/each.##.png" $small --progressive 3 --memory 64 --stats "$work/stats.json"
json "$work/stats.json" '.frames == 3 and (.progressive | length == 3 and all(.[]; .converged and .frame_ms > 0 and .shadow_bytes > 0))' \
    'stats: a row for each frame'
json "$work/stats.json" '[.progressive[].prepared] == [true, false, false]' 'stats: maps are made once'
cmp -s "$work/each.01.png" "$work/each.03.png" || [ -e "$work/each.02.png" ] || complain 'a picture for each frame'
[ ! -e "$work/each.04.png" ] || complain 'more pictures than frames'

# compare --json.
error_keys='["acne","boundary","leaks","max_abs","misclassified","misclassified_fraction","receivers","rmse","rmse_one_receiver","wrong_samples"]'
two_lights() {
    run compare builtin:box --size 96x64 --threads 2 --json - --light 'point position=2,4,3 intensity=100' \
        --light 'directional direction=-1,-2,-0.5 intensity=2' "$@"
    [ "$code" = 0 ] || complain "exit $code: compare $*"
}
two_lights --algorithm sm:size=128 --against point -o "$work/difference.png"
cp "$work/out" "$work/compare.json"
[ -s "$work/difference.png" ] || complain 'compare -o wrote no picture'
stats_shape "$work/compare.json"
json "$work/compare.json" "(($error_keys + [\"identified_fraction\",\"identified_pooled\",\"identified_oracle5\",\"identified_oracle5_pooled\",\"identified_texels\",\"texels_over_4\",\"per_light\"]) - keys) == []" \
    'compare: members'
json "$work/compare.json" "(.per_light | length) == 2 and all(.per_light[]; ($error_keys - keys) == [])" 'compare: per_light'
json "$work/compare.json" '.boundary | keys == ["edge_shift_max","edge_shift_mean","edge_shift_p95","pixels","rmse"]' 'compare: boundary'
json "$work/compare.json" '.receivers == ([.per_light[].receivers] | add) and .misclassified == ([.per_light[].misclassified] | add)' \
    'compare: lights add up'
json "$work/compare.json" '.receivers > 100 and .misclassified_fraction == .misclassified / .receivers
    or (.misclassified_fraction - .misclassified / .receivers | fabs) < 1e-9' 'compare: fraction of receivers'
json "$work/compare.json" '.identified_fraction == null and .wrong_samples == null' 'compare: null where there is none'

# The same command, the same figures; times apart.
timeless='del(.frame_ms, .passes, .visibility_ms, .memory.peak_bytes, .reference.ms)'
two_lights --algorithm sm:size=128 --against point
jq -S "$timeless" "$work/compare.json" >"$work/first"
jq -S "$timeless" "$work/out" >"$work/second"
cmp -s "$work/first" "$work/second" || complain 'the same comparison gives other figures'

zero='.receivers > 100 and .misclassified == 0 and .rmse == 0 and .max_abs == 0 and .leaks == 0 and .acne == 0 and .boundary.rmse == 0'
two_lights --algorithm sm:size=128 --against sm:size=128
json "$work/out" "$zero" 'a system against itself is right everywhere'
two_lights --algorithm reference --against point
json "$work/out" "$zero" 'the reference is right everywhere'
two_lights --algorithm reference:samples=32 --against samples32
json "$work/out" "$zero" 'the reference with 32 samples is right everywhere'
two_lights --algorithm none --against point
json "$work/out" '.misclassified > 20 and .max_abs == 1 and .acne == 0' 'no shadows at all: misclassified, never acne'
two_lights --algorithm sm:size=128 --against samples32
json "$work/out" '.rmse > 0 and .against == "samples32" and .rmse_one_receiver != null' 'against samples32'

# The table for people.
# shellcheck disable=SC2086
good compare builtin:box $small
says 'misclassified'

finish
