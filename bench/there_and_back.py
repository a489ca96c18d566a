#!/usr/bin/env python3
"""A long run from a short recording: plays a sequence in TUM format forward and backward in turn.

  there_and_back.py make SEQUENCE OUT --rounds 20     a folder that lists the frames that often
  there_and_back.py measure OUT RUN                   first and last round of its run side by side

`make` copies no image: OUT's lists name those of SEQUENCE. Its detections.txt, where there is one, is
repeated like the lists. Run it with a camera file whose readout is 0: played backward, a rolling shutter
reads the rows the wrong way round. `measure` compares the last ten minutes with the ten before, too, where
the recording is longer than twenty.
"""

import argparse
import csv
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile


def entries(path):
    lines = (l.split() for l in path.read_text().splitlines() if l and not l.startswith("#"))
    return [(float(l[0]), l[1:]) for l in lines if l]


def make(sequence, out, rounds):
    for name in ("rgb", "depth"):
        if not (sequence / f"{name}.txt").is_file():
            sys.exit(f"there_and_back.py: {sequence} has no {name}.txt; name a folder in TUM format")
    out.mkdir(parents=True, exist_ok=True)
    names = ["rgb", "depth", "groundtruth"]
    if (sequence / "detections.txt").is_file():
        names.append("detections")
    lists = {name: entries(sequence / f"{name}.txt") for name in names}
    first = min(t for t, _ in lists["rgb"])
    last = max(t for t, _ in lists["rgb"])
    frame_time = (last - first) / (len(lists["rgb"]) - 1)
    length = last - first + frame_time
    for name in ("rgb", "depth"):
        link = out / name
        if not link.exists():
            link.symlink_to((sequence / name).resolve())
    for name, rows in lists.items():
        with open(out / f"{name}.txt", "w") as file:
            for r in range(rounds):
                begin = first + r * length
                inside = [(t, rest) for t, rest in rows if first - 0.05 <= t <= last + 0.05]
                moments = [(begin + (last - t if r % 2 else t - first), rest) for t, rest in inside]
                for t, rest in sorted(moments, key=lambda m: m[0]):  # stable: boxes keep their order
                    file.write(f"{t:.6f} {' '.join(rest)}\n")
    (out / "rounds.txt").write_text(f"{first:.6f} {length:.6f} {rounds}\n")


def within(rows, begin, end):
    return [(t, rest) for t, rest in rows if begin <= t < end]


def error(program, truth, path):
    with tempfile.TemporaryDirectory() as folder:
        names = []
        for name, rows in (("truth", truth), ("path", path)):
            names.append(pathlib.Path(folder) / f"{name}.txt")
            names[-1].write_text("".join(f"{t:.6f} {' '.join(rest)}\n" for t, rest in rows))
        done = subprocess.run([program, "eval", *map(str, names), "--json", "-"], capture_output=True,
                              text=True, check=True)
    return json.loads(done.stdout)["ate"]["translation_m"]["rmse"]


def slope(values):
    middle, mean = (len(values) - 1) / 2, statistics.mean(values)
    return (sum((i - middle) * (v - mean) for i, v in enumerate(values))
            / sum((i - middle) ** 2 for i in range(len(values))))


def rounds(out, run, program):
    """Figures of each round, one after the other."""
    first, length, count = (float(x) for x in (out / "rounds.txt").read_text().split())
    truth, path = entries(out / "groundtruth.txt"), entries(run / "trajectory.txt")
    with open(run / "timings.csv") as file:
        frames = list(csv.DictReader(file))
    for r in range(int(count)):
        begin, end = first + r * length, first + (r + 1) * length
        mine = [f for f in frames if begin <= float(f["timestamp"]) < end]
        if not mine:
            break
        memory = [float(f["memory_mb"]) for f in mine]
        yield {"round": r + 1, "frames": len(mine),
               "localised": sum(int(f["localised"]) for f in mine),
               "frame_ms": statistics.median(float(f["frame_ms"]) for f in mine),
               "tracking_ms": statistics.median(float(f["tracking_ms"]) for f in mine),
               "decode_ms": statistics.median(float(f["decode_ms"]) for f in mine),
               "keyframes": sum(int(f["keyframe"]) for f in mine),
               "most_mb": max(memory), "median_mb": statistics.median(memory),
               "ate": error(program, within(truth, begin, end), within(path, begin, end))}


def growth(figures):
    """MB a round over the second half: the slope of a line through the medians, for images on their
    way through the threads make the memory of one frame vary by megabytes."""
    return slope([f["median_mb"] for f in figures[len(figures) // 2 - 1:]])


def windows(run, minutes=10):
    """The frames of the last minutes and those of as many before; none where the run is shorter."""
    with open(run / "timings.csv") as file:
        frames = [(float(f["timestamp"]), float(f["memory_mb"]), float(f["frame_ms"]), float(f["tracking_ms"]))
                  for f in csv.DictReader(file)]
    end, span = frames[-1][0], 60 * minutes
    if end - frames[0][0] < 2 * span:
        return None
    return [[f for f in frames if end - (k + 1) * span < f[0] <= end - k * span] for k in (1, 0)]


def compare_windows(run):
    both = windows(run)
    if both is None:
        return
    for column, name, unit in ((1, "memory", "MB"), (2, "frame time", "ms"), (3, "tracking", "ms")):
        before, last = (statistics.median(f[column] for f in frames) for frames in both)
        print(f"{name}, median: {before:.2f} {unit} in the last ten minutes but ten, {last:.2f} in the last ten"
              f" ({100 * (last / before - 1):+.1f} %)")


def measure(out, run, program):
    print("round  frames  localised  frame ms  tracking ms  decoding ms  keyframes made  memory MB"
          "  median MB  ATE m")
    figures = []
    for f in rounds(out, run, program):
        figures.append(f)
        print(f"{f['round']:5}  {f['frames']:6}  {f['localised']:9}  {f['frame_ms']:8.1f}"
              f"  {f['tracking_ms']:11.2f}  {f['decode_ms']:11.2f}  {f['keyframes']:14}  {f['most_mb']:9.1f}"
              f"  {f['median_mb']:9.1f}  {f['ate']:.4f}")
    if len(figures) > 4:
        print(f"memory grows by {growth(figures):.3f} MB a round over the second half")
    compare_windows(run)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    maker = commands.add_parser("make")
    maker.add_argument("sequence", type=pathlib.Path)
    maker.add_argument("out", type=pathlib.Path)
    maker.add_argument("--rounds", type=int, default=20)
    measurer = commands.add_parser("measure")
    measurer.add_argument("out", type=pathlib.Path)
    measurer.add_argument("run", type=pathlib.Path)
    measurer.add_argument("--program", type=pathlib.Path,
                          default=pathlib.Path(__file__).parents[1] / "build/release/dkp-slam")
    arguments = parser.parse_args()
    if arguments.command == "make":
        make(arguments.sequence, arguments.out, arguments.rounds)
    else:
        measure(arguments.out, arguments.run, arguments.program)


if __name__ == "__main__":
    main()
