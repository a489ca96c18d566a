#!/usr/bin/env bash
# Builds dkp-slam into build/release; arguments go to the build tool (a target, say).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
cmake --preset release
cmake --build --preset release "$@"
