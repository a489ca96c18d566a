#!/usr/bin/env bash
# A long soak of the built program (docs/reliability.md): one run in real time from beginning to end,
# and beside it run after run with faults that a seed chooses. Ends with exit code 1 when anything
# crashes, hangs, leaves a map that cannot be read, loses its way or grows.
#   scripts/soak.sh TIME [SEED]    TIME: 3m (the short form), 4h; SEED: 1
# Ctrl-C, or SIGTERM, ends it early with what is known by then.
# DKP_SLAM_DATA: a folder with real sequences (fr1_xyz, ...), which are played, too, in half an hour and more.
# Results are in build/soak; the sequences that it generates stay there for the next time.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() { sed -n '2,9s/^# \?//p' "scripts/soak.sh" >&2; exit 2; }
[[ ${1:-} =~ ^([0-9]+)([smh])$ ]] || usage
seconds=${BASH_REMATCH[1]}
case "${BASH_REMATCH[2]}" in m) seconds=$((seconds * 60)) ;; h) seconds=$((seconds * 3600)) ;; esac
[[ ${2:-1} =~ ^[0-9]+$ ]] || usage
seed=${2:-1}
RANDOM=$((seed % 32768))

program=$PWD/build/release/dkp-slam
shim=$PWD/build/release/tests/libdkp_slam_fault_shim.so
for file in "$program" "$shim"; do
  if [ ! -e "$file" ]; then echo "soak.sh: $file is missing; run scripts/build.sh first" >&2; exit 1; fi
done
folder=$PWD/build/soak
mkdir -p "$folder"
cd "$folder"
rm -rf runs && mkdir runs
end=$((SECONDS + seconds))
stopped=
stopping=
trap 'stopped=" (stopped early)"; stopping=1; end=0' INT TERM

# Seconds: whatever takes longer hangs. Longer by as much as others crowd the cores.
readonly patience=120
patience_now() {
  python3 -c "import os; print(round($patience * max(1, os.getloadavg()[0] / os.cpu_count())))"
}
declare -A done_of=()
problems=0
problem() {
  # Ctrl-C reaches the step that goes on, too: what becomes of it says nothing.
  if [ -n "$stopping" ]; then return; fi
  problems=$((problems + 1))
  echo "soak.sh: PROBLEM: $1" >&2
}

sequences=()
for scenario in walking_xyz crowd lights dropped_frames; do
  # Complete only with its true path, which is written last.
  if [ ! -s "$scenario/groundtruth.txt" ]; then
    rm -rf "$scenario"
    "$program" synth "$scenario" --frames 90 --width 320 --height 240 --out "$scenario" >/dev/null 2>&1
  fi
  sequences+=("$folder/$scenario")
done
# They take so long that the short form would come to little else.
if [ -n "${DKP_SLAM_DATA:-}" ] && [ "$seconds" -ge 1800 ]; then
  for real in fr1_xyz composite_xyz_walking; do
    if [ -d "$DKP_SLAM_DATA/$real" ]; then sequences+=("$DKP_SLAM_DATA/$real"); fi
  done
fi
camera_of() { if [ -f "$1/camera.yaml" ]; then echo "$1/camera.yaml"; else echo fr1; fi; }

# The one that lasts: the first sequence forward and backward in turn, by the clock.
python3 ../../bench/there_and_back.py make "${sequences[0]}" long --rounds $(((seconds + 2 * patience) / 3))
"$program" run long --camera "${sequences[0]}/camera.yaml" --realtime --detector motion \
  --map runs/long.map --out runs/long >runs/long.log 2>&1 &
long=$!

# What is left after a run, however it ended: a map that can be read, no temporary files of a run
# that ended by itself.
check_left() {  # WHAT CODE
  if [ -f runs/room.map ] && ! "$program" map info runs/room.map >runs/info.log 2>&1; then
    problem "$1: $(tail -n 1 runs/info.log)"
    rm -f runs/room.map runs/room.map-wal
  fi
  if [ "$2" -lt 128 ] && compgen -G 'runs/*/*.tmp' >/dev/null; then problem "$1: a temporary file is left"; fi
  rm -f runs/*/*.tmp
}

play() {  # WHAT CODES... -- COMMAND...: runs it; its exit code must be one of these
  local what=$1 codes=() code=0 most
  most=$(patience_now)
  shift
  while [ "$1" != -- ]; do codes+=("$1"); shift; done
  shift
  (
    if [ "$1" = limited ]; then  # KILOBYTES COMMAND...
      ulimit -v "$2"
      shift 2
    fi
    exec timeout --signal=KILL "$most" "$@"
  ) >runs/last.log 2>&1 || code=$?
  done_of[$what]=$((${done_of[$what]:-0} + 1))
  if [[ " ${codes[*]} " != *" $code "* ]]; then
    problem "$what: exit code $code: $(tail -n 1 runs/last.log)"
    cp runs/last.log "runs/problem$problems.log"
  fi
  check_left "$what" "$code"
}

stop_after() {  # SIGNAL: of a run that goes on with the map, at a moment within two seconds
  local code=0 id
  "$program" "${run[@]}" --map runs/room.map >runs/last.log 2>&1 &
  id=$!
  sleep "$((RANDOM % 2)).$((RANDOM % 10))" || true
  kill -s "$1" "$id" 2>/dev/null || true
  { wait "$id"; } 2>/dev/null || code=$?
  done_of[$1]=$((${done_of[$1]:-0} + 1))
  case "$1 $code" in
    "KILL 137" | "INT 130" | *" 0") ;;
    *) problem "$1: exit code $code: $(tail -n 1 runs/last.log)" ;;
  esac
  check_left "$1" "$code"
}

check_error() {  # SEQUENCE: that the last run found its way
  if [ ! -f "$1/groundtruth.txt" ] || [ ! -f runs/out/trajectory.txt ]; then return; fi
  if ! "$program" eval "$1/groundtruth.txt" runs/out/trajectory.txt --json runs/error.json >/dev/null 2>&1 ||
     ! python3 -c 'import json,sys; sys.exit(json.load(open("runs/error.json"))["ate"]["translation_m"]["rmse"] > 0.1)'
  then
    problem "$1: the path is wrong by more than 0.1 m"
  fi
}

while [ "$SECONDS" -lt "$end" ]; do
  sequence=${sequences[RANDOM % ${#sequences[@]}]}
  run=(run "$sequence" --camera "$(camera_of "$sequence")" --detector motion --out runs/out)
  # Another camera's sequence makes a map of its own.
  if [ "$sequence" != "${last_sequence:-$sequence}" ]; then rm -f runs/room.map runs/room.map-wal; fi
  last_sequence=$sequence
  rm -rf runs/out
  case $((RANDOM % 8)) in
    0) play "run" 0 -- "$program" "${run[@]}" && check_error "$sequence" ;;
    1) play "run with map" 0 -- "$program" "${run[@]}" --map runs/room.map ;;
    2) if [ -f runs/room.map ]; then
         play "localize" 0 1 -- "$program" "${run[@]}" --localize runs/room.map --realtime --rate 3
       fi ;;
    3) if [ -f runs/room.map ]; then
         rm -f runs/merged.map
         play "merge" 0 -- "$program" map merge runs/room.map runs/room.map --out runs/merged.map
       fi ;;
    4) stop_after KILL ;;
    5) stop_after INT ;;
    6) calls=(write sync open read)
       errors=(enospc eio short)
       play "disk" 0 1 -- env LD_PRELOAD="$shim" FAULT_CALL="${calls[RANDOM % 4]}" \
         FAULT_ERROR="${errors[RANDOM % 3]}" FAULT_NTH=$((RANDOM % 300 + 1)) FAULT_LASTS=$((RANDOM % 2)) \
         "$program" "${run[@]}" --map runs/room.map ;;
    7) play "memory" 0 1 127 -- limited $((300000 + RANDOM * 20)) "$program" "${run[@]}" \
         --map runs/room.map ;;
  esac
done
stopping=

if [ -z "$stopped" ] && ! kill -0 "$long" 2>/dev/null; then problem "the long run ended early: $(tail -n 1 runs/long.log)"; fi
kill -s INT "$long" 2>/dev/null || true
for ((i = 0; i < patience && i >= 0; ++i)); do
  if ! kill -0 "$long" 2>/dev/null; then break; fi
  sleep 1
done
if kill -0 "$long" 2>/dev/null; then
  problem "the long run does not end"
  kill -s KILL "$long"
fi
code=0
wait "$long" || code=$?
if [ "$code" -ne 130 ]; then problem "the long run: exit code $code: $(tail -n 1 runs/long.log)"; fi
"$program" map info runs/long.map >/dev/null || problem "the long run's map cannot be read"

# The last quarter against the one before: by then the room is known, and nothing may grow.
read -r frames lost before last < <(python3 - runs/long/timings.csv <<'TEXT'
import csv, statistics, sys
rows = [(float(r["memory_mb"]), r["localised"] == "1") for r in csv.DictReader(open(sys.argv[1]))]
quarter = max(1, len(rows) // 4)
half = [statistics.median(m for m, _ in rows[-k * quarter:len(rows) - (k - 1) * quarter]) for k in (2, 1)]
print(len(rows), sum(not localised for _, localised in rows), *half)
TEXT
)
for what in "${!done_of[@]}"; do printf '%-14s %6d\n' "$what" "${done_of[$what]}"; done | sort
echo "long run: $frames frames, $lost lost, memory $before MB in the last quarter but one, $last MB in the last"
if python3 -c "import sys; sys.exit(not $last > 1.05 * $before + 5)"; then problem "memory grows"; fi
echo "soak.sh: $problems problems in $((SECONDS / 60)) minutes$stopped, seed $seed"
[ "$problems" -eq 0 ]
