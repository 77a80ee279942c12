#!/bin/sh
# gnomon bench --suite smoke: every system runs, and what is written holds every cell.
set -eu
. "$(dirname "$0")/../cli/expect.sh"

good bench --help
says '^Usage: gnomon bench '
bad 64 'smoke, paper, hard or full\|are accepted' bench --suite no_such_suite
bad 64 '1 to 1000' bench --frames 0
bad 64 'without --filter' bench --filter no_such_word
bad 64 'readable folder' bench --models /no/such/folder
bad 64 'takes no argument' bench smoke
bad 74 'folder' bench --json /no/such/folder/a.json

run list devices
[ "$code" != 69 ] || { echo 'no usable device'; exit 77; }

good bench --suite smoke --json "$work/a.json" --threads 2
says '^== '
cp "$work/out" "$work/text"
good list algorithms --json "$work/algorithms.json"
json "$work/a.json" '.suite == "smoke" and (.device | length > 0) and .interrupted == false and (.command | startswith("gnomon bench"))' 'head'
json "$work/a.json" 'all(.cells[]; .done)' 'every cell was run'
json "$work/a.json" 'all(.cells[]; .failed != null or (.still.frame_ms | .q1 <= .median and .median <= .q3 and .min > 0))' 'quartiles'
json "$work/a.json" 'all(.cells[]; .failed != null or (.point.receivers > 0 and .samples32.rmse >= 0))' 'errors'
json "$work/a.json" "[.cells[].system] | unique | length == $(jq '.algorithms | length' "$work/algorithms.json")" 'every system'
json "$work/a.json" 'all(.cells[] | select(.system == "reference"); .point.misclassified == 0)' 'the reference has no error'
json "$work/a.json" 'any(.cells[]; .still.ratio.median > 0)' 'ratios to the baseline'
for name in $(jq -r '.cells[].name' "$work/a.json" | sort -u); do
    grep -q "^  $name " "$work/text" || complain "no row for $name"
done

good bench --filter box,sm --frames 1 --json -
json "$work/out" '(.cells | length > 0) and all(.cells[]; (.scene | test("box")) and (.name | test("sm")))' 'the filter'

finish
