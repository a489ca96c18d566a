#!/usr/bin/env bash
# The whole suite under AddressSanitizer and UndefinedBehaviorSanitizer, with the assertions that a
# release build leaves out; every report fails its test. Arguments go to ctest (-R NAME, say).
# DKP_SLAM_DATA and DKP_SLAM_MODEL as for scripts/test.sh. Takes about eight times as long as that.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
cmake --preset asan
cmake --build --preset asan
ctest --preset asan --parallel "$(nproc)" "$@"
