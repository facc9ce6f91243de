#!/usr/bin/env bash
# Passes the tests, all of them. Where the machine has no Vulkan driver that
# computes correctly, installs lavapipe, a software one, through the system's
# package manager, and Chromium likewise where there is no browser to open
# pages with; where npm is there, fetches the Khronos glTF validator, three.js, which the
# preview's pictures are compared with, Babylon.js, which chains of levels are shown to, and
# gltfpack, which whole plants are held against; where Python is there, numpy, and usd-core,
# which opens levels as USD.
# Further arguments go to `cargo test --workspace`.
#
# All packages are always built together: each alone would have its dependencies built with
# other features, the graphics library among them, and so once more.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

say() { printf 'tests/run.sh: %s\n' "$*"; }
root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }
# Vulkan loaders ask for it, and complain where there is none.
export XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-/tmp}"

# With all libraries: Python's wheel is made of one that no test builds by itself.
cargo build --quiet --workspace --lib --example find_adapter
find_adapter() { "${CARGO_TARGET_DIR:-target}/debug/examples/find_adapter"; }

# Debian 12's own Mesa 22 ends long loops early and so computes wrong results;
# its backports have a sound one.
needs_backports() {
  . /etc/os-release
  local policy
  # Not into `grep -q`, which stops reading: apt-cache then dies of a broken
  # pipe, and pipefail makes that an answer of no.
  policy=$(apt-cache policy mesa-vulkan-drivers)
  [ "${VERSION_CODENAME:-}" = bookworm ] && [[ $policy == *'Candidate: 22.'* ]]
}

install_with_apt() {
  local suite=()
  root apt-get update -qq
  if needs_backports; then
    # The system's own first source entry, for the suite of backports.
    local entry=/etc/apt/sources.list.d/secateur-backports.sources
    awk 'BEGIN { RS = ""; } { print; exit }' /etc/apt/sources.list.d/debian.sources |
      sed 's/^Suites:.*/Suites: bookworm-backports/' | root tee "$entry" > /dev/null
    root apt-get update -qq
    suite=(-t bookworm-backports)
  fi
  root env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends "${suite[@]}" mesa-vulkan-drivers libvulkan1
}

install_lavapipe() {
  if command -v apt-get > /dev/null; then install_with_apt
  elif command -v dnf > /dev/null; then root dnf install -y mesa-vulkan-drivers vulkan-loader
  elif command -v pacman > /dev/null; then root pacman -S --noconfirm vulkan-swrast vulkan-icd-loader
  elif command -v zypper > /dev/null; then root zypper install -y libvulkan_lvp libvulkan1
  elif command -v apk > /dev/null; then root apk add mesa-vulkan-swrast vulkan-loader
  else
    say "no package manager known here: install lavapipe, Mesa's software Vulkan driver (version 23 or later), and run this again"
    return 1
  fi
}

if ! adapter=$(find_adapter); then
  say "no sound Vulkan, Metal or DirectX 12 driver: installing lavapipe"
  install_lavapipe > /tmp/secateur-lavapipe.log 2>&1 || { cat /tmp/secateur-lavapipe.log; exit 1; }
  adapter=$(find_adapter)
fi
say "GPU tests run on $adapter"
export SECATEUR_REQUIRE_GPU=1

find_browser() {
  local name
  for name in "${SECATEUR_BROWSER:-}" chromium chromium-browser google-chrome google-chrome-stable; do
    if [ -n "$name" ] && "$name" --version > /dev/null 2>&1; then return; fi
  done
  return 1
}

install_chromium() {
  if command -v apt-get > /dev/null; then
    root apt-get update -qq
    root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends chromium
  elif command -v dnf > /dev/null; then root dnf install -y chromium
  elif command -v pacman > /dev/null; then root pacman -S --noconfirm chromium
  elif command -v zypper > /dev/null; then root zypper install -y chromium
  elif command -v apk > /dev/null; then root apk add chromium
  else
    say "no package manager known here: install Chromium, and run this again"
    return 1
  fi
}

if ! find_browser; then
  say "no browser: installing Chromium"
  install_chromium > /tmp/secateur-chromium.log 2>&1 || { cat /tmp/secateur-chromium.log; exit 1; }
  find_browser || { say "Chromium was installed and does not run"; exit 1; }
fi
export SECATEUR_REQUIRE_BROWSER=1

# The page that makes levels, which tests open.
say "building the page of web/"
bash web/build.sh quick
export SECATEUR_REQUIRE_WEB=1

fetch_packages() { npm ci --silent --no-audit --no-fund --prefix "$1"; }

if [ ! -d tests/validator/node_modules ] || [ ! -d tests/browser/node_modules ]; then
  if command -v npm > /dev/null; then
    say "fetching the Khronos glTF validator and three.js"
    fetch_packages tests/validator
    fetch_packages tests/browser
  else
    say "no npm: the tests that ask the Khronos glTF validator or three.js will say that they skip"
  fi
fi
if [ -d tests/validator/node_modules ]; then export SECATEUR_REQUIRE_VALIDATOR=1; fi
if [ -d tests/browser/node_modules ]; then export SECATEUR_REQUIRE_THREE=1; fi

if [ ! -d tests/clients/node_modules ]; then
  if command -v npm > /dev/null; then
    say "fetching three.js and Babylon.js"
    npm ci --silent --no-audit --no-fund --ignore-scripts --prefix tests/clients
  else
    say "no npm: the tests that show chains to three.js and Babylon.js will say that they skip"
  fi
fi
if [ -d tests/clients/node_modules ]; then export SECATEUR_REQUIRE_CLIENTS=1; fi

if [ ! -d tests/gltfpack/node_modules ]; then
  if command -v npm > /dev/null; then
    say "fetching gltfpack"
    npm ci --silent --no-audit --no-fund --ignore-scripts --prefix tests/gltfpack
  else
    say "no npm: the test that holds whole plants against gltfpack will say that it skips"
  fi
fi
if [ -d tests/gltfpack/node_modules ]; then export SECATEUR_REQUIRE_GLTFPACK=1; fi

if python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2> /dev/null; then
  if ! python3 -c 'import numpy' 2> /dev/null; then
    export SECATEUR_PYTHON_PACKAGES="$PWD/target/tools/numpy"
    [ -d "$SECATEUR_PYTHON_PACKAGES" ] || {
      say "fetching numpy"
      python3 -m pip install --quiet --root-user-action ignore --target "$SECATEUR_PYTHON_PACKAGES" numpy
    }
  fi
  target=$(cd "${CARGO_TARGET_DIR:-target}" && pwd)
  if [ ! -d "$target/tools/usd" ]; then
    say "fetching usd-core"
    python3 -m pip install --quiet --root-user-action ignore --target "$target/tools/usd" 'usd-core>=26.11' || {
      rm -rf "$target/tools/usd"
      say "no usd-core for this Python: the test of levels as USD will say that it skips"
    }
  fi
  if [ -d "$target/tools/usd" ]; then export SECATEUR_USD_PACKAGES="$target/tools/usd"; fi
  [ -d "$target/tools/maturin" ] || {
    say "fetching maturin"
    python3 -m pip install --quiet --root-user-action ignore --target "$target/tools/maturin" 'maturin>=1.9,<2'
  }
  rm -rf "$target/wheels"
  REAL_CARGO=$(command -v cargo) CARGO="$PWD/tests/wheel/cargo" PATH="$PWD/tests/wheel:$PATH" \
    "$target/tools/maturin/bin/maturin" build --quiet --manifest-path crates/python/Cargo.toml \
    --profile dev --out "$target/wheels"
  export SECATEUR_WHEELS="$target/wheels"
else
  say "no Python 3.11 or later: the tests of Python's package will say that they skip"
fi

if [ $# -gt 0 ]; then exec cargo test --workspace "$@"; fi
# Examples are compiled, and linked, only where targets are not named; clippy checks them.
cargo test --workspace --tests
cargo test --workspace --doc
