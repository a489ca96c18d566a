#!/usr/bin/env python3
"""Draws point clouds and grids of `dkp-slam export` side by side, for docs/export.md.

  bench/draw_dense.py OUT.png FILE... [--from X,Y,Z] [--to X,Y,Z] [--labels A,B,...]

FILE: a cloud (.ply), seen from one point towards another in the trajectory's world (x right, y down,
z ahead, metres), or a grid (.pgm). Needs numpy and OpenCV (Debian: python3-opencv).
"""
import argparse
import sys

import cv2
import numpy as np

WIDTH, HEIGHT = 640, 600


def read_cloud(name):
    """Positions (n x 3, metres) and colours (n x 3, BGR)."""
    with open(name, "rb") as file:
        count = 0
        for line in iter(file.readline, b""):
            if line.startswith(b"element vertex"):
                count = int(line.split()[2])
            if line == b"end_header\n":
                break
        record = np.dtype([("at", "<f4", 3), ("normal", "<f4", 3), ("rgb", "u1", 3)])
        points = np.frombuffer(file.read(count * record.itemsize), record)
    if len(points) != count or count == 0:
        sys.exit(f"{name}: no point cloud of `dkp-slam export`")
    return points["at"].astype(float), points["rgb"][:, ::-1].astype(np.uint8)


def draw_cloud(name, eye, target):
    """Points as small squares, the nearest on top."""
    points, colours = read_cloud(name)
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross([0.0, 1.0, 0.0], ahead)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(ahead, right), ahead])
    seen = (points - eye) @ axes.T
    focal = 0.8 * WIDTH
    kept = seen[:, 2] > 0.3
    seen, colours = seen[kept], colours[kept]
    pixels = seen[:, :2] / seen[:, 2:] * focal + [WIDTH / 2, HEIGHT / 2]
    sizes = np.maximum(1, np.ceil(0.021 * focal / seen[:, 2])).astype(int)
    image = np.full((HEIGHT, WIDTH, 3), 255, np.uint8)
    for i in np.argsort(-seen[:, 2]):
        x, y = np.round(pixels[i] - sizes[i] / 2).astype(int)
        if -20 < x < WIDTH and -20 < y < HEIGHT:
            image[max(y, 0) : max(y + sizes[i], 0), max(x, 0) : max(x + sizes[i], 0)] = colours[i]
    return image


def draw_grid(name):
    grid = cv2.imread(name, cv2.IMREAD_GRAYSCALE)
    if grid is None:
        sys.exit(f"{name}: no grid of `dkp-slam export`")
    scale = max(1, min(WIDTH // grid.shape[1], HEIGHT // grid.shape[0]))
    grid = cv2.resize(grid, None, fx=scale, fy=scale, interpolation=cv2.INTER_NEAREST)[:HEIGHT, :WIDTH]
    image = np.full((HEIGHT, grid.shape[1] + 20, 3), 255, np.uint8)
    top = (HEIGHT - grid.shape[0]) // 2
    image[top : top + grid.shape[0], 10 : 10 + grid.shape[1]] = grid[:, :, None]
    return image


def point(text):
    return np.array([float(v) for v in text.split(",")])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out")
    parser.add_argument("files", nargs="+")
    parser.add_argument("--from", dest="eye", type=point, default=point("0,-0.6,-1.2"))
    parser.add_argument("--to", dest="target", type=point, default=point("0,0.3,2"))
    parser.add_argument("--labels", default="")
    options = parser.parse_args()
    labels = options.labels.split(",") if options.labels else []
    pictures = []
    for i, name in enumerate(options.files):
        grid = name.endswith(".pgm")
        picture = draw_grid(name) if grid else draw_cloud(name, options.eye, options.target)
        if i < len(labels):
            cv2.putText(picture, labels[i], (12, 28), cv2.FONT_HERSHEY_SIMPLEX, 0.7, (0, 0, 0), 1, cv2.LINE_AA)
        pictures.append(picture)
    if not cv2.imwrite(options.out, np.hstack(pictures)):
        sys.exit(f"{options.out}: cannot be written")


if __name__ == "__main__":
    main()
