#!/usr/bin/env bash
# Makes levels of all plants below a folder into the same folders below another one, or checks those that are there.
#
# usage: action/run.sh make|check PLANTS LEVELS [options of `secateur lods`]
#
# Checked levels are as `make` with the same options and the same build of secateur would write them: their files are
# whole, and neither plant nor options have changed since. The program is $SECATEUR, or secateur.
set -euo pipefail

usage() { sed -n '4s/^# //p' "${BASH_SOURCE[0]}" >&2; exit 2; }
[ $# -ge 3 ] || usage
mode=$1 plants=${2%/} levels=${3%/}
shift 3
[ "$mode" = make ] || [ "$mode" = check ] || usage
program=${SECATEUR:-secateur}
[ -d "$plants" ] || { echo "$plants: is no folder of plants" >&2; exit 1; }

told=$(mktemp)
trap 'rm -f "$told"' EXIT
failed=0 count=0
while IFS= read -r -d '' folder; do
  # Levels may lie among the plants.
  case "$folder/" in "$levels"/*) continue ;; esac
  files=()
  for file in "$folder"/*.glb "$folder"/*.gltf; do if [ -f "$file" ]; then files+=("$file"); fi; done
  if [ ${#files[@]} -eq 0 ]; then continue; fi
  count=$((count + ${#files[@]}))
  place=$levels${folder#"$plants"}
  if [ "$mode" = make ]; then
    mkdir -p "$place"
    "$program" lods "${files[@]}" -o "$place" --keep-going --format md "$@" >> "$told" || failed=1
    continue
  fi
  for file in "${files[@]}"; do
    if [ -d "$place" ] && "$program" lods "$file" -o "$place" --dry-run --format json "$@" | grep -q '"kept": *true'; then
      continue
    fi
    echo "$file: its levels in $place are not as they would be made"
    failed=1
  done
done < <(find "$plants" -type d -print0 | sort -z)

[ "$count" -gt 0 ] || { echo "$plants: has no .glb and no .gltf" >&2; exit 1; }
if [ "$mode" = make ]; then cat "$told"; fi
if [ -n "${GITHUB_STEP_SUMMARY:-}" ]; then cat "$told" >> "$GITHUB_STEP_SUMMARY"; fi
echo "$count plants, mode $mode: $([ "$failed" = 0 ] && echo done || echo failed)"
exit "$failed"
