#!/usr/bin/env bash
# Difference of a tenth of each plant 540 pixels high, and user seconds of `simplify`, at each effort: the table of
# docs/simplify.md.
#
# usage: effort.sh PROGRAM TREE.glb...
set -eu
program=$1
shift
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
echo "| plant | effort | difference | user s |"
echo "|---|---|---|---|"
for tree in "$@"; do
  for effort in fast normal best; do
    level=$folder/level.glb
    TIMEFORMAT=%U
    seconds=$({ time "$program" -q simplify "$tree" -o "$level" --triangles 0.1 --no-audit --effort "$effort" >&2; } 2>&1 | tail -1)
    difference=$("$program" measure "$tree" "$level" | awk '$1 == "difference" { print $2 }')
    echo "| $(basename "$tree" .glb) | $effort | $difference | $seconds |"
  done
done
