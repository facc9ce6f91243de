#!/usr/bin/env bash
# Makes target/web/secateur.html: engine, page and styles in one file, which works from a disk or any static host,
# without a network. Beside it lies target/web/package, which `npm pack` takes.
#
# Needs Rust. Cargo fetches the crates that Cargo.lock and web/builder/Cargo.lock name; rustup fetches the
# standard library for wasm32-unknown-unknown where it is not installed.
#
# `web/build.sh quick` compiles in a fraction of the time to a larger and slower engine, for tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

profile=web
if [ "${1:-}" = quick ]; then profile=web-quick; fi
target=${CARGO_TARGET_DIR:-target}
case "$target" in /*) ;; *) target=$PWD/$target ;; esac
out=$target/web
if [ "$profile" = web-quick ]; then out=$target/web-quick; fi

if command -v rustup > /dev/null; then
  rustup target list --installed | grep --quiet wasm32-unknown-unknown ||
    rustup target add wasm32-unknown-unknown
fi
CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS="-C target-feature=+simd128" \
  cargo build --quiet --locked --package secateur-web --lib --target wasm32-unknown-unknown --profile "$profile"
cargo build --quiet --locked --manifest-path web/builder/Cargo.toml --target-dir "$target/tools/web-builder"

builder=$target/tools/web-builder/debug/secateur-web-builder
engine=$target/wasm32-unknown-unknown/$profile/secateur_web.wasm
rm -rf "$out"
mkdir -p "$out"
"$builder" wrap "$engine" no-modules "$out/no-modules"
"$builder" page "$out/no-modules" . "$out/secateur.html"
for kind in nodejs bundler; do "$builder" wrap "$engine" "$kind" "$out/package/$kind"; done
cp -r web/package/* LICENSE "$out/package/"
printf '%s: %s bytes, %s compressed\n' "$out/secateur.html" \
  "$(wc -c < "$out/secateur.html")" "$(gzip -9 -c "$out/secateur.html" | wc -c)"
