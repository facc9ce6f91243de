#!/usr/bin/env bash
# Whether another kind of processor writes the same files: builds the program for
# this machine, an x86-64, and for 64-bit ARM, runs both, the latter in an
# emulator (QEMU), and compares what they write byte by byte, and what they
# measure digit by digit. Grows its own trees; more can be named. Some ten
# minutes, nearly all of them building; installs with apt what is missing.
#
# usage: tests/architectures.sh [TREE.glb ...]
set -Eeuo pipefail
trap 'echo "tests/architectures.sh: line $LINENO failed: $BASH_COMMAND" >&2' ERR
# What is set outside would take the place of what .cargo/config.toml says.
unset CFLAGS CXXFLAGS

trees=()
for tree in "$@"; do trees+=("$(realpath "$tree")"); done
cd "$(dirname "${BASH_SOURCE[0]}")/.."

root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }

[ "$(uname -m)" = x86_64 ] || { echo "tests/architectures.sh: this machine is no x86-64"; exit 1; }
if ! command -v qemu-aarch64 > /dev/null || ! command -v aarch64-linux-gnu-g++ > /dev/null; then
  root apt-get update -qq
  root env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends qemu-user g++-aarch64-linux-gnu libc6-dev-arm64-cross
fi

arm=aarch64-unknown-linux-gnu
rustup target add "$arm"
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
# The GPU's part stays out: an emulator has none.
build() {
  cargo build --release --package secateur-cli --no-default-features \
    --config profile.release.lto=false --config profile.release.codegen-units=16 \
    --target-dir target/architectures --target "$1"
}
build x86_64-unknown-linux-gnu
build "$arm"
here() { target/architectures/x86_64-unknown-linux-gnu/release/secateur "$@"; }
there() { qemu-aarch64 -L /usr/aarch64-linux-gnu "target/architectures/$arm/release/secateur" "$@"; }

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
same=0 different=0
compare() {
  local what=$1
  if cmp --silent "$folder/here" "$folder/there"; then
    same=$((same + 1))
  else
    different=$((different + 1))
    echo "different: $what"
  fi
}

for species in oak carya birch alder maple rowan pine palmetto willow bush; do
  for on in here there; do
    "$on" grow "$species" --leaves 400 --seed 3 -o "$folder/$species-$on.glb" > /dev/null 2> "$folder/log" ||
      { cat "$folder/log"; exit 1; }
    mv "$folder/$species-$on.glb" "$folder/$on"
  done
  compare "grow $species"
  mv "$folder/here" "$folder/$species.glb"
  trees+=("$folder/$species.glb")
done

settings=(
  "--ratio 0.25"
  "--ratio 0.25 --reference previous --resize deficit --neighbours 4 --max-coverage 1"
  "--ratio 0.25 --views vnc --ties spread"
  "--triangles 0.5 --wood ignore"
  "--preset information --triangles 0.5 --wood ignore"
  "--preset information --ratio 0.1"
  "--triangles 0.1 --wood ignore"
  "--ratio 0.25 --fit"
  "--triangles 0.1 --wood ignore --fit=4"
  "--method fsa --ratio 0.25"
  "--method stochastic --ratio 0.25"
  "--method meshopt --triangles 0.25 --wood ignore"
  "--method meshopt --preserve-area --triangles 0.25 --wood ignore"
  "--method meshopt --meshopt-mode sloppy --triangles 0.25 --wood ignore"
)
for tree in "${trees[@]}"; do
  for setting in "${settings[@]}"; do
    for on in here there; do
      # Word by word.
      # shellcheck disable=SC2086
      "$on" simplify "$tree" -o "$folder/$on.glb" --resolution 128 $setting > /dev/null 2> "$folder/log" ||
        { cat "$folder/log"; exit 1; }
      mv "$folder/$on.glb" "$folder/$on"
    done
    compare "$(basename "$tree") $setting"
  done
  # The last of them, but for how long it took, and where.
  for on in here there; do
    "$on" measure "$tree" "$folder/here" --format json |
      grep -vE '"(total|cpu|arch|peak_rss_bytes)"' > "$folder/$on.json"
  done
  mv "$folder/here.json" "$folder/here"
  mv "$folder/there.json" "$folder/there"
  compare "$(basename "$tree") measured"
done
echo "$same results are the same on x86-64 and 64-bit ARM, $different are not"
[ "$different" = 0 ]
