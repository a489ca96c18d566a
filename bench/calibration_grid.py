#!/usr/bin/env python3
"""How well `dkp-slam calibrate` finds what is known: generated sequences with a readout, a delay
and a scale of depth, each from a camera file that knows none of them. Prints Markdown tables.

    bench/calibration_grid.py FOLDER [--cells 16] [--frames 300] [--width 640] [--program build/release/dkp-slam]

Needs Debian's python3-numpy and python3-pil. Sequences that are in FOLDER already are not made again.
"""
import argparse
import pathlib
import re
import subprocess

import numpy as np
from PIL import Image

READOUTS = (0, 10, 20, 30)   # ms
DELAYS = (-15, -5, 5, 15)    # ms
SCALES = (4900, 4950, 5050, 5100)  # units per metre
# A Graeco-Latin square (by sums and products in the field of four): each readout meets each delay,
# each scale, and each delay each scale once. Any four cells in a row have all of each.
GRID = [(READOUTS[i], DELAYS[i ^ k], SCALES[i ^ (0, 2, 3, 1)[k]], 4 * k + i + 1)
        for k in range(4) for i in range(4)]
# Found in the file that it begins with instead of what is true.
UNKNOWN = {"readout": 0, "depth_delay": 0, "depth_scale": 5000}


def synth(program, out, options):
    if not (out / "associations.txt").exists():
        subprocess.run([program, "synth", "static_room", "--out", out, *map(str, options)], check=True)


def start_file(truth, out):
    text = truth.read_text()
    for key, value in UNKNOWN.items():
        text = re.sub(rf"(?m)^{key}: \S+", f"{key}: {value}", text)
    out.write_text(text)


def flat(inverse, u, v, half):
    """Whether the inverse depth around a pixel is a plane."""
    part = inverse[v - half:v + half + 1, u - half:u + half + 1]
    if not np.isfinite(part).all():
        return False
    y, x = np.mgrid[-half:half + 1, -half:half + 1]
    a = np.stack([np.ones(part.size), x.ravel(), y.ravel()], 1)
    rest = part.ravel() - a @ np.linalg.lstsq(a, part.ravel(), rcond=None)[0]
    return np.abs(rest).max() < 0.002


def known_length(exact, lens):
    """Two pixels of one row far apart on flat surfaces, and their true distance: an exact image."""
    depth = np.asarray(Image.open(exact)).astype(float) / 5000.0
    with np.errstate(divide="ignore"):
        inverse = np.where(depth > 0, 1.0 / depth, np.inf)
    height, width = depth.shape
    half = width // 40
    best = (0.0, None)
    for v in range(2 * half, height - 2 * half, half):
        ends = [u for u in range(width // 8, width * 7 // 8, 4)
                if flat(inverse, u, v, half) and depth[v, u] < 3.0]
        if len(ends) < 2 or ends[-1] - ends[0] <= best[0]:
            continue
        best = (ends[-1] - ends[0], (ends[0], ends[-1], v))
    u1, u2, v = best[1]
    points = [np.array([(u - lens["cx"]) / lens["fx"], (v - lens["cy"]) / lens["fy"], 1.0]) *
              depth[v, u] for u in (u1, u2)]
    return f"{exact.stem},{u1},{v},{u2},{v},{np.linalg.norm(points[0] - points[1]):.4f}"


def measure(arguments, row):
    """(true, found, standard deviation) of each key in the unit of its column, or why not."""
    readout, delay, scale, seed = row
    folder = arguments.folder / f"{readout}_{delay}_{scale}_{seed}_{arguments.width}"
    size = ["--width", arguments.width, "--height", arguments.width * 3 // 4, "--seed", seed,
            "--readout", readout / 1000]
    synth(arguments.program, folder / "seen",
          [*size, "--frames", arguments.frames, "--depth-scale", scale, "--depth-delay",
           delay / 1000])
    synth(arguments.program, folder / "exact", [*size, "--frames", 16, "--noise", "none"])
    start_file(folder / "seen/camera.yaml", folder / "start.yaml")
    lens = dict(re.findall(r"(?m)^(fx|fy|cx|cy): (\S+)", (folder / "start.yaml").read_text()))
    length = known_length(sorted((folder / "exact/depth").iterdir())[-1],
                          {k: float(v) for k, v in lens.items()})
    done = subprocess.run(
        [arguments.program, "calibrate", folder / "seen", "--camera", folder / "start.yaml",
         "--out", folder / "found.yaml", "--plot", folder / "found.svg", "--length", length],
        capture_output=True, text=True)
    if done.returncode != 0:
        return done.stderr.strip().splitlines()[-1]
    found = {k: (float(v), float(s)) for k, v, s in
             re.findall(r"(?m)^(\w+) +(\S+) \+- (\S+)", done.stdout)}
    return [(true, found[key][0] * unit, found[key][1] * unit) for key, true, unit in
            (("readout", readout, 1000), ("depth_delay", delay, 1000),
             ("depth_scale", scale / 5000, 1 / 5000))]


def print_errors(cells):
    """What all cells together say: errors, and errors over their standard deviations."""
    rows = np.array(cells)
    errors = rows[:, :, 1] - rows[:, :, 0]
    ratios = errors / rows[:, :, 2]
    print(f"\n| {len(cells)} cells | readout [ms] | delay [ms] | scale |\n|---|---|---|---|")
    for name, values, digits in (
            ("largest error", np.abs(errors).max(0), (2, 2, 4)),
            ("error, root mean square", np.sqrt((errors**2).mean(0)), (2, 2, 4)),
            ("error, mean", errors.mean(0), (2, 2, 4)),
            ("error / standard deviation, root mean square", np.sqrt((ratios**2).mean(0)), (2, 2, 2)),
            ("the same, largest", np.abs(ratios).max(0), (2, 2, 2))):
        print(f"| {name} | " + " | ".join(f"{v:.{d}f}" for v, d in zip(values, digits)) + " |")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--cells", type=int, default=len(GRID), help="the first so many")
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--program", default="build/release/dkp-slam")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    print("| readout [ms] | found | delay [ms] | found | scale | found |")
    print("|" + "---|" * 6)
    found = []
    for row in GRID[:arguments.cells]:
        cells = measure(arguments, row)
        if isinstance(cells, str):
            print(f"| {row[0]} | refused | {row[1]} | {cells} | {row[2] / 5000:g} | |", flush=True)
            continue
        found.append(cells)
        print("| " + " | ".join(
            f"{true:g} | {value:.{digits}f} ± {sigma:.{digits}f}"
            for (true, value, sigma), digits in zip(cells, (2, 2, 4))) + " |", flush=True)
    if found:
        print_errors(found)


if __name__ == "__main__":
    main()
