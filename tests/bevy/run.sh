#!/usr/bin/env bash
# Loads levels in Bevy without a window, by the plugin that `lods --for bevy` writes, and asks Bevy from many distances
# which level it would draw. Compiles Bevy: some minutes.
#
# usage: run.sh PROGRAM
set -euo pipefail
program=$(realpath "${1:?usage: run.sh PROGRAM}")
cd "$(dirname "${BASH_SOURCE[0]}")"
levels=$PWD/target/levels
mkdir -p target
"$program" grow oak --leaves 300 -o target/oak.glb -q
"$program" lods target/oak.glb -o "$levels" --for bevy --levels 0.5,0.2 --max-difference 2 --overwrite -q > /dev/null
cp "$levels/oak_lods.rs" src/oak_lods.rs
exec cargo run --quiet -- "$levels"
