#!/usr/bin/env bash
# The whole suite under a sanitizer, with the assertions that a release build leaves out; every
# report fails its test.
#   scripts/sanitize.sh [address|thread] [ARGUMENT...]
# address (the default): AddressSanitizer and UndefinedBehaviorSanitizer; thread: ThreadSanitizer.
# The arguments go to ctest (-R NAME, say). DKP_SLAM_DATA and DKP_SLAM_MODEL as for scripts/test.sh.
# Takes about ten times as long as that.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=asan
case "${1:-}" in
  address) shift ;;
  thread) preset=tsan; shift ;;
esac
cmake --preset "$preset"
cmake --build --preset "$preset"
ctest --preset "$preset" --parallel "$(nproc)" "$@"
