#!/usr/bin/env python3
"""Speed of the program on recorded sequences, as one table (docs/performance.md).

    bench/speed.py SEQUENCE... [--program build/release/dkp-slam] [--against OTHER] [--rounds 3]
                   [--modes offline,preloaded,1x,2x] [--out FILE.md]

Every figure is the median of the rounds. Programs run in turn, one run at a time. The speed of a machine
changes by tens of percent from hour to hour: before every run a fixed reference load is timed, and times
are given in milliseconds and as multiples of it (x ref), which can be compared between hours and machines.
Needs nothing but Python; the machine should be quiet.
"""
import argparse
import csv
import hashlib
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CAMERAS = {"fr1": "fr1", "fr2": "fr2", "fr3": "fr3", "composite": "fr1", "bonn": "bonn"}


def reference_ms():
    """Processor time of a load that never changes: 64 MB through SHA-256 and 300,000 steps of Python."""
    block = bytes(1 << 20)
    begin = time.process_time()
    digest = hashlib.sha256()
    for _ in range(64):
        digest.update(block)
    total = 0
    for i in range(300_000):
        total += i * i % 7
    return 1000.0 * (time.process_time() - begin)


def quantile(values, share):
    ordered = sorted(values)
    return ordered[int(share * (len(ordered) - 1))]


def camera_of(sequence):
    if (sequence / "camera.yaml").exists():
        return []
    for prefix, camera in CAMERAS.items():
        if sequence.name.startswith(prefix):
            return ["--camera", camera]
    return []


def run(program, sequence, extra, scratch):
    """One run; figures of it by name."""
    out = scratch / "run"
    reference = reference_ms()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [program, "run", str(sequence), *camera_of(sequence), "--seed", "1", "--out", str(out), *extra],
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"speed.py: {sequence}: the run ended with {done.returncode}: {done.stderr.strip()[-300:]}")
    with open(out / "timings.csv") as file:
        frames = list(csv.DictReader(file))
    summary = json.loads((out / "summary.json").read_text())
    frame = [float(f["frame_ms"]) for f in frames[1:]]
    figures = {"median": statistics.median(frame), "99 %": quantile(frame, 0.99), "worst": max(frame),
               "dropped %": 100.0 * summary["dropped_frames"] / max(1, len(frames) + summary["dropped_frames"]),
               "lost": summary["lost_frames"],
               "ate m": summary.get("ate", {}).get("rmse_m"), "memory MB": summary["peak_memory_mb"],
               "reference": reference}
    if "latency_ms" in frames[0]:
        latency = [float(f["latency_ms"]) for f in frames]
        figures["latency"] = statistics.median(latency)
        figures["latency 99 %"] = quantile(latency, 0.99)
    whole = (after.ru_utime + after.ru_stime) - (before.ru_utime + before.ru_stime)
    figures["processor"] = summary.get("processor_ms_per_frame", 1000.0 * whole / len(frames))
    return figures


def start_ms(program, arguments):
    begin = time.perf_counter()
    subprocess.run([program, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
    return 1000.0 * (time.perf_counter() - begin)


def one_frame(program, sequence, scratch):
    """Arguments that run one frame alone: of the first colour image that has depth, which the camera's delay decides."""
    folder = scratch / "one"
    folder.mkdir()
    for name in ("rgb", "depth"):
        (folder / name).symlink_to((sequence / name).resolve())
    colour, depth = (
        [line for line in (sequence / name).read_text().splitlines() if line and line[0] != "#"]
        for name in ("rgb.txt", "depth.txt"))
    (folder / "depth.txt").write_text("\n".join(depth[:30]) + "\n")
    arguments = ["run", str(folder), *camera_of(sequence), "--out", str(scratch / "run")]
    for line in colour[:20]:
        (folder / "rgb.txt").write_text(line + "\n")
        if subprocess.run([program, *arguments], capture_output=True).returncode == 0:
            return arguments
    sys.exit(f"speed.py: {sequence}: none of the first colour images can be run alone; see `{program} {' '.join(arguments)}`")


MODES = {"offline": [], "preloaded": ["--preload"], "1x": ["--realtime"], "2x": ["--realtime", "--rate", "2"]}
COLUMNS = ["median", "99 %", "worst", "processor", "latency", "latency 99 %", "dropped %", "lost", "ate m",
           "memory MB"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequences", nargs="+", type=Path)
    parser.add_argument("--program", default="build/release/dkp-slam")
    parser.add_argument("--against", help="another build, run in turn")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--modes", default=",".join(MODES))
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    modes = options.modes.split(",")
    if unknown := [m for m in modes if m not in MODES]:
        parser.error(f"--modes: {unknown[0]} is none of {', '.join(MODES)}")
    programs = [options.program] + ([options.against] if options.against else [])
    for program in programs:
        if not os.access(program, os.X_OK):
            parser.error(f"{program} cannot be run; build it first")
    lines = ["| sequence | played | build | " + " | ".join(COLUMNS) + " | processor, x ref |",
             "|---|---|---|" + "---:|" * (len(COLUMNS) + 1)]
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        for sequence in options.sequences:
            for mode in modes:
                rounds = {program: [] for program in programs}
                for _ in range(options.rounds):
                    for program in programs:
                        rounds[program].append(run(program, sequence, MODES[mode], scratch))
                for number, program in enumerate(programs):
                    middle = {}
                    for name in COLUMNS:
                        values = [r[name] for r in rounds[program] if r.get(name) is not None]
                        middle[name] = statistics.median(values) if values else None
                    times = statistics.median(r["processor"] / r["reference"] for r in rounds[program])
                    cells = ["-" if middle[c] is None else f"{middle[c]:.4f}" if c == "ate m" else f"{middle[c]:.1f}"
                             for c in COLUMNS]
                    lines.append(f"| {sequence.name} | {mode} | {'AB'[number]} | " + " | ".join(cells)
                                 + f" | {times:.3f} |")
                    print(lines[-1], flush=True)
        alone = one_frame(programs[0], options.sequences[0], scratch)
        lines += ["", "| build | `--version`, ms | whole process for one frame, ms |", "|---|---:|---:|"]
        for number, program in enumerate(programs):
            version = statistics.median(start_ms(program, ["--version"]) for _ in range(5 * options.rounds))
            one = statistics.median(start_ms(program, alone) for _ in range(2 * options.rounds))
            lines.append(f"| {'AB'[number]} | {version:.0f} | {one:.0f} |")
    text = "\n".join(lines) + "\n"
    print(text)
    if options.out:
        options.out.write_text(text)


if __name__ == "__main__":
    main()
