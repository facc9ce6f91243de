#!/usr/bin/env bash
# Whether each crate is whole without the rest of the repository: packages all of
# them as for a registry, unpacks the packages elsewhere, and checks that they
# compile there. Needs no network once the dependencies are fetched.
#
# `cargo package` would verify them too, but compiles every dependency again.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

mkdir -p "${CARGO_TARGET_DIR:-target}"
target=$(cd "${CARGO_TARGET_DIR:-target}" && pwd)
rm -rf "$target"/package/*.crate
cargo package --workspace --no-verify --no-metadata --allow-dirty --offline --quiet

folder=$target/unpacked
rm -rf "$folder"
mkdir -p "$folder"
for package in "$target"/package/*.crate; do
  # Touched: packages have times long past, which cargo takes for unchanged.
  tar -xzmf "$package" -C "$folder"
done
for package in "$folder"/*/; do
  for file in README.md LICENSE; do
    [ -s "$package$file" ] || { echo "tests/packages.sh: $package has no $file"; exit 1; }
  done
  # A package in a workspace takes the workspace's lock file.
  rm -f "${package}Cargo.lock"
done

# The packages name each other by version: here they are found in this folder. The
# repository's profiles and lock file make its compiled dependencies serve again.
{
  printf '[workspace]\nresolver = "3"\nmembers = ["*"]\n\n[patch.crates-io]\n'
  for package in "$folder"/*/; do
    package=$(basename "$package")
    printf '%s = { path = "%s" }\n' "${package%-[0-9]*}" "$package"
  done
  awk '/^\[/ { keep = /^\[profile/ } keep' Cargo.toml
} > "$folder/Cargo.toml"
cp Cargo.lock "$folder/Cargo.lock"
cargo check --manifest-path "$folder/Cargo.toml" --workspace --offline --target-dir "$target"
