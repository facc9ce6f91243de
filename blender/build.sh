#!/usr/bin/env bash
# Makes target/blender/secateur-VERSION-PLATFORM.zip, an extension for Blender 4.4 and later, of a wheel: install it
# by dragging it into Blender's window.
#
# usage: blender/build.sh WHEEL.whl
set -euo pipefail
wheel=$(realpath "${1:?usage: blender/build.sh WHEEL.whl}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."
target=${CARGO_TARGET_DIR:-target}
platform=$(basename "$wheel" .whl)
platform=${platform##*-}
version=$(sed -n 's/^version = "\(.*\)"/\1/p' blender/extension/blender_manifest.toml)
case $(basename "$wheel") in
  secateur-"$version"-cp311-abi3-*) ;;
  *) echo "$wheel: is no wheel of secateur $version for abi3" >&2; exit 1 ;;
esac
folder=$target/blender/extension
rm -rf "$folder"
mkdir -p "$folder/wheels"
cp "$wheel" "$folder/wheels/"
cp blender/extension/__init__.py LICENSE crates/secateur/src/engines/blender_import.py "$folder/"
sed "s/@PLATFORM@/$platform/" blender/extension/blender_manifest.toml > "$folder/blender_manifest.toml"
archive=$target/blender/secateur-$version-$platform.zip
rm -f "$archive"
python3 -m zipfile -c "$archive" "$folder"/*
echo "$archive"
