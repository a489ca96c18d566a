#!/usr/bin/env bash
# Builds everything and runs all tests; arguments go to ctest (-R NAME, say).
#   DKP_SLAM_DATA    folder that holds real sequences by name (fr1_xyz, ...)
#   DKP_SLAM_MODEL   YOLOX weights, an .onnx file
# Tests that need what is not set are skipped.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/build.sh
# One more than there are cores: some tests wait for a clock.
ctest --preset release --parallel "$(($(nproc) + 1))" "$@"
