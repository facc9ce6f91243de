#!/usr/bin/env bash
# Packs the program for one platform: with manual pages, shell completions, and the licences of all that it is built of.
#
# usage: release/archive.sh TARGET [PROGRAM]
#
# TARGET is Rust's name of the platform, such as x86_64-unknown-linux-gnu. Without PROGRAM it is built. What is packed
# goes to target/release-archives: .tar.gz, for Windows .zip, each with its SHA-256 beside it. A program that this
# machine cannot run brings no completions and no pages of its own: $SECATEUR then names one that can.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
platform=${1:?usage: release/archive.sh TARGET [PROGRAM]}
target=${CARGO_TARGET_DIR:-target}
case "$platform" in *windows*) ending=.exe ;; *) ending= ;; esac
program=${2:-$target/$platform/release/secateur$ending}
if [ $# -lt 2 ]; then cargo build --release --locked --bin secateur --target "$platform"; fi

version=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)
name=secateur-$version-$platform
out=$target/release-archives
folder=$out/$name
rm -rf "$folder"
mkdir -p "$folder/completions" "$folder/man"
cp "$program" "$folder/secateur$ending"
cp LICENSE README.md CHANGELOG.md "$folder/"
python3 release/licences.py --platform "$platform" ${CARGO_NET_OFFLINE:+--offline} > "$folder/LICENCES.md"
here=${SECATEUR:-$program}
for shell in bash zsh fish powershell elvish; do "$here" completions "$shell" > "$folder/completions/secateur.$shell"; done
"$here" completions man --output "$folder/man" -q

case "$platform" in
  *windows*) archive=$name.zip; (cd "$out" && python3 -m zipfile -c "$archive" "$name") ;;
  # The same files give the same bytes.
  *) archive=$name.tar.gz
     tar --sort=name --owner=0 --group=0 --numeric-owner --mtime=@0 -C "$out" -cf - "$name" | gzip -n > "$out/$archive" ;;
esac
(cd "$out" && python3 -c 'import hashlib, sys; print(hashlib.sha256(open(sys.argv[1], "rb").read()).hexdigest(), "", sys.argv[1])' "$archive" > "$archive.sha256")
echo "$out/$archive"
