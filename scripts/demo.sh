#!/usr/bin/env bash
# Builds dkp-slam and shows its main job on a generated sequence: a furnished room with people walking
# about. No download, no model: the motion detector finds them; YOLOX does where there are weights.
# Options go to dkp-slam demo, e.g. scripts/demo.sh --frames 600 --seed 2
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/build.sh --target dkp-slam
exec build/release/dkp-slam demo "$@"
