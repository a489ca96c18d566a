#!/usr/bin/env bash
# Builds dkp-slam and shows its main job on a generated sequence: a furnished room with two people
# walking about. No download, no model: the motion detector finds them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/build.sh --target dkp-slam

program=build/release/dkp-slam
out=out/demo
echo "== a sequence with a true path, in $out/sequence"
"$program" synth walking_xyz --frames 90 --out "$out/sequence"
echo "== the camera's path, people left out, in $out/run"
"$program" run "$out/sequence" --camera "$out/sequence/camera.yaml" --detector motion \
  --overlay --out "$out/run"
echo "== compared with the true path"
"$program" eval "$out/sequence/groundtruth.txt" "$out/run/trajectory.txt" --plot "$out/run/paths.svg"
echo "Pictures: $out/run/overlay/*.png (what was removed), $out/run/paths.svg (both paths)"
