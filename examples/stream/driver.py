#!/usr/bin/env python3
"""A camera's driver: writes a frame stream (docs/frame-stream.md) for dkp-slam.

    examples/stream/driver.py | dkp-slam run - --out OUT
    examples/stream/driver.py /run/user/1000/camera    # dkp-slam run --source unix:/run/user/1000/camera

The camera is made up: it glides along a patterned wall two metres away. Yours gives `images`.
"""
import socket, struct, sys
import numpy as np

width, height, focal = 640, 480, 500.0
wall = np.random.default_rng(7).integers(0, 256, (40, 80, 3), np.uint8).repeat(12, 0).repeat(12, 1)

def images():
    """Seconds, colour (height, width, 3) uint8 BGR, depth (height, width) uint16 millimetres."""
    for i in range(30):
        yield i / 30, wall[:, 3 * i : 3 * i + width], np.full((height, width), 2000, np.uint16)

camera = (f"width: {width}\nheight: {height}\nfx: {focal}\nfy: {focal}\n"
          f"cx: {(width - 1) / 2}\ncy: {(height - 1) / 2}\ndepth_scale: 1000\n").encode()

out = sys.stdout.buffer
if len(sys.argv) > 1:
    connection = socket.socket(socket.AF_UNIX)
    connection.connect(sys.argv[1])
    out = connection.makefile("wb")
BGR8, U16 = 1, 1
out.write(struct.pack("<8s6Id", b"DKPSLAM", 1, width, height, BGR8, U16, len(camera), 1000.0) + camera)
for stamp, colour, depth in images():
    pixels = colour.tobytes() + depth.tobytes()
    out.write(struct.pack("<4sI2d", b"FRME", 16 + len(pixels), stamp, 0.0) + pixels)
    out.flush()
out.write(struct.pack("<4sI", b"DONE", 0))
out.flush()
