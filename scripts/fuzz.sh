#!/usr/bin/env bash
# Builds libFuzzer's targets (fuzz/, clang, AddressSanitizer, UndefinedBehaviorSanitizer) and runs
# them, on as many cores as there are.
#   scripts/fuzz.sh TIME [TARGET...]   TIME for each: 20 or 20s, 5m, 4h; all targets or those named
# What they learn stays in build/fuzz/corpus; an input that breaks something goes to
# build/fuzz/found/TARGET, its report beside it, and ends with exit code 1. Copied into
# fuzz/found/TARGET it is a regression test (fuzz_test).
#   FUZZ_JOBS   how many at once; FUZZ_SEED: the same mutations every time (a new corpus given)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() { sed -n '2,9s/^# \?//p' "scripts/fuzz.sh" >&2; exit 2; }
[ $# -ge 1 ] || usage
[[ $1 =~ ^([0-9]+)([smh]?)$ ]] || usage
seconds=${BASH_REMATCH[1]}
case "${BASH_REMATCH[2]}" in m) seconds=$((seconds * 60)) ;; h) seconds=$((seconds * 3600)) ;; esac
shift

if ! command -v clang++-14 >/dev/null; then
  echo "fuzz.sh: clang 14 is missing; scripts/setup.sh --with fuzz installs it" >&2
  exit 1
fi
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz >build/fuzz/build.log || { cat build/fuzz/build.log >&2; exit 1; }

programs=build/fuzz/fuzz
if [ $# -gt 0 ]; then
  targets=("$@")
  for target in "${targets[@]}"; do
    if [ ! -x "$programs/fuzz_$target" ]; then
      echo "fuzz.sh: no target '$target'; there are:" "$(cd "$programs" && echo fuzz_* | sed 's/fuzz_//g')" >&2
      exit 2
    fi
  done
else
  mapfile -t targets < <(cd "$programs" && printf '%s\n' fuzz_* | sed 's/^fuzz_//')
fi

run_target() {
  local target=$1 corpus=build/fuzz/corpus/$1 found=build/fuzz/found/$1
  mkdir -p "$corpus" "$found"
  "build/fuzz/fuzz/fuzz_$target" --seeds "$corpus"
  local known=()
  if [ -d "fuzz/found/$target" ]; then known=("fuzz/found/$target"); fi
  # rosbag keeps memory between bags, for which libFuzzer seeks leaks after every input: two thirds of
  # the time. They are sought when it ends in any case.
  local code=0 leaks=1
  if [ "$target" = bag ]; then leaks=0; fi
  # Mutations follow the order in which a corpus is read again, and values that are addresses.
  local reload=1 fixed=()
  if [ -n "${FUZZ_SEED:-}" ]; then
    reload=0
    if setarch -R true 2>/dev/null; then fixed=(setarch -R); fi
  fi
  # What other libraries say of broken files is of no interest; the report goes elsewhere.
  UBSAN_OPTIONS=print_stacktrace=1 LSAN_OPTIONS=suppressions=cmake/lsan.supp:print_suppressions=0 \
    "${fixed[@]}" "build/fuzz/fuzz/fuzz_$target" -max_total_time="$seconds" -seed="${FUZZ_SEED:-0}" -timeout=20 -rss_limit_mb=3000 \
    -detect_leaks=$leaks -reload=$reload -close_fd_mask=3 -print_final_stats=1 -artifact_prefix="$found/" \
    "$corpus" "${known[@]}" >"$found/report.log" 2>&1 || code=$?
  printf '%-14s %12s executions%s\n' "$target" \
    "$(sed -n 's/^stat::number_of_executed_units: *//p' "$found/report.log")" \
    "$([ "$code" -eq 0 ] || echo "   FOUND SOMETHING: $found")"
  if [ "$code" -ne 0 ]; then tail -n 40 "$found/report.log" | cut -c -200 | sed "s/^/$target: /"; fi
  return "$code"
}
export -f run_target
export seconds
# xargs ends with 123 when any of them found something.
printf '%s\n' "${targets[@]}" | xargs -P "${FUZZ_JOBS:-$(nproc)}" -I{} bash -c 'run_target {}' || exit 1
