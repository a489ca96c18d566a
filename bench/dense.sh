#!/usr/bin/env bash
# Measures dense maps (docs/export.md): plays each sequence, fuses it with the run's masks, with the
# true ones and without any, and compares the clouds with the truth.
#   bench/dense.sh OUT SEQUENCE...     SEQUENCE: of `dkp-slam synth`, or a composite with mask/
# Options of `run` and `export` come from RUN_OPTIONS and EXPORT_OPTIONS in the environment, the
# camera of sequences without a camera.yaml from CAMERA; BACKGROUND: what a composite was made of.
set -euo pipefail
if [ $# -lt 2 ]; then
  echo "usage: bench/dense.sh OUT SEQUENCE..." >&2
  exit 2
fi
build=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/build/release
out=$1
shift
read -ra run_options <<<"${RUN_OPTIONS:-}"
read -ra export_options <<<"${EXPORT_OPTIONS:-}"
camera=()
if [ -n "${CAMERA:-}" ]; then camera=(--camera "$CAMERA"); fi
background=()
if [ -n "${BACKGROUND:-}" ]; then background=(--background "$BACKGROUND"); fi
for sequence in "$@"; do
  run=$out/$(basename "$sequence")
  if [ ! -f "$run/summary.json" ]; then
    "$build/dkp-slam" run "$sequence" "${camera[@]}" --save-masks --out "$run" "${run_options[@]}"
  fi
  export_cloud() {
    "$build/dkp-slam" export "$run" --dense "$run/$1.ply" "${export_options[@]}" "${@:2}"
  }
  export_cloud masks
  export_cloud true_masks --masks "$sequence/mask"
  export_cloud no_masks --no-masks
  "$build/dkp-slam-bench" dense "$sequence" "$run/trajectory.txt" "$run"/{masks,true_masks,no_masks}.ply \
    "${camera[@]}" "${background[@]}"
done
