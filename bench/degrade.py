#!/usr/bin/env python3
"""Makes of a TUM folder what a poorer camera would have seen in a worse hour.

    bench/degrade.py SEQUENCE OUT [--every N] [--dark SHARE] [--holes]

--every N keeps every N-th frame only (30 Hz become 15, 10); --dark SHARE leaves that share of the
light (0.3, say), bright parts more of it than dark ones, and adds noise of 3 grey levels; --holes
takes depth away beyond 3 m and in patches that cover about a third of the image, others in every
frame. What is not changed is linked. Needs associations.txt, and Debian's python3-numpy and
python3-pil.
"""
import argparse
import pathlib

import numpy as np
from PIL import Image

NOISE = 3.0          # grey levels
CONTRAST = 1.3       # exponent
FARTHEST = 3.0       # metres
UNITS = 5000         # of TUM's depth images, per metre
PATCHES = (20, 15)   # random numbers over the image, smoothly joined
HOLE_ABOVE = 0.62    # of them


def darken(image, share, random):
    grey = (image / 255.0) ** CONTRAST * 255.0 * share
    return np.clip(grey + random.normal(0.0, NOISE, image.shape), 0, 255).astype(np.uint8)


def pierce(depth, random):
    numbers = Image.fromarray(random.random(PATCHES[::-1]).astype(np.float32))
    smooth = np.asarray(numbers.resize(depth.shape[::-1], Image.Resampling.BICUBIC))
    return np.where((smooth > HOLE_ABOVE) | (depth > FARTHEST * UNITS), 0, depth).astype(np.uint16)


def change(sequence, out, name, how):
    (out / name).parent.mkdir(exist_ok=True)
    changed = Image.fromarray(how(np.asarray(Image.open(sequence / name))))
    changed.save(out / name, format="PNG", compress_level=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequence", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--dark", type=float)
    parser.add_argument("--holes", action="store_true")
    args = parser.parse_args()
    if args.every < 1 or (args.dark is not None and not 0.0 < args.dark <= 1.0):
        parser.error("--every is at least 1, --dark over 0 and at most 1")
    lists = args.sequence / "associations.txt"
    if not lists.is_file():
        parser.error(f"{lists} is missing")
    if args.out.exists():
        parser.error(f"{args.out} is there already")
    lines = [l for l in lists.read_text().splitlines() if l.strip() and not l.startswith("#")]
    lines = lines[::args.every]
    names = [line.split() for line in lines]
    made = ({pathlib.Path(n[1]).parts[0] for n in names} if args.dark else set()) | \
           ({pathlib.Path(n[3]).parts[0] for n in names} if args.holes else set())
    args.out.mkdir(parents=True)
    for entry in args.sequence.iterdir():
        # The full lists would name frames that are left out here.
        if entry.name in made or entry.name in ("associations.txt", "rgb.txt", "depth.txt"):
            continue
        (args.out / entry.name).symlink_to(entry.resolve())
    random = np.random.default_rng(7)
    for _, colour, _, depth in names:
        if args.dark:
            change(args.sequence, args.out, colour, lambda image: darken(image, args.dark, random))
        if args.holes:
            change(args.sequence, args.out, depth, lambda image: pierce(image, random))
    (args.out / "associations.txt").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
