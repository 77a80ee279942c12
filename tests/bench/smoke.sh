#!/bin/sh
# gnomon bench --suite smoke: every system runs, and what is written holds every cell.
set -eu
. "$(dirname "$0")/../cli/expect.sh"

good bench --help
says '^Usage: gnomon bench '
bad 64 'smoke, paper, hard or full\|are accepted' bench --suite no_such_suite
bad 64 '1 to 1000' bench --frames 0
bad 64 'without --filter' bench --filter no_such_word
bad 64 'no such table' bench --tables no_such_table
bad 64 'readable folder' bench --models /no/such/folder
bad 64 'one FILE may be -' bench --json - --csv -
bad 64 'models, builtin or none' bench --pictures all
bad 64 'takes no argument' bench smoke
bad 74 'folder' bench --json /no/such/folder/a.json

run list devices
[ "$code" != 69 ] || { echo 'no usable device'; exit 77; }

good bench --suite smoke --json "$work/a.json" --csv "$work/a.csv" --html "$work/a.html" --threads 2
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

[ "$(wc -l <"$work/a.csv")" = "$(($(jq '.cells | length' "$work/a.json") + 1))" ] || complain 'the CSV has not a line a cell'
for name in $(jq -r '.cells[].name' "$work/a.json" | sort -u); do
    grep -q "<code>$name</code>" "$work/a.html" || complain "the page has no row for $name"
done
grep -q '</html>' "$work/a.html" || complain 'the page has no end'

# Pictures of a figure, and a system that refuses: the run goes on.
good bench --suite paper --quick --size 64x36 --frames 1 --filter butterfly,sm:size=1024 --models '' --html - --json "$work/b.json"
grep -q 'data:image/png;base64,' "$work/out" || complain 'no picture in the page'
json "$work/b.json" '(.cells | length > 0) and all(.cells[]; .scene == "builtin:butterfly")' 'the built-in butterfly'

# Ctrl-C: what there is is written, and the end is clean.
code=0
timeout -s INT 2 "$GNOMON" bench --suite full --models '' --pictures none --frames 1000 --filter butterfly --json "$work/c.json" >"$work/out" 2>"$work/err" ||
    code=$?
[ "$code" = 124 ] || [ "$code" = 0 ] || complain "exit $code after an interruption"
grep -q '^interrupted: ' "$work/err" || complain 'nothing said about the interruption'
json "$work/c.json" '.interrupted and (.cells | length > 1) and any(.cells[]; .done | not)' 'an interrupted run'

good bench --filter box,sm --frames 1 --json -
json "$work/out" '(.cells | length > 0) and all(.cells[]; (.scene | test("box")) and (.name | test("sm")))' 'the filter'

finish
