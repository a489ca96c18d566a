"""What the tests share: a generated sequence, played by the program and by the module."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

import dkp_slam

SCENARIO = "walking_xyz"
FRAMES = 36


@pytest.fixture(scope="session")
def program():
    """Runs the program; its standard output."""

    def run(*arguments):
        command = [os.environ["DKP_SLAM_PROGRAM"], *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{command}: {done.stderr}"
        return done.stdout

    return run


@pytest.fixture(scope="session")
def sequence(program, tmp_path_factory):
    """A folder of 36 frames, 320 x 240, two people in them."""
    folder = tmp_path_factory.mktemp("sequence")
    program("synth", SCENARIO, "--frames", FRAMES, "--width", 320, "--height", 240, "--out", folder)
    return folder


@pytest.fixture(scope="session")
def by_program(program, sequence, tmp_path_factory):
    """What the program makes of it, given the true boxes: a folder, with a map file."""
    out = tmp_path_factory.mktemp("run")
    program("run", sequence, "--detections", sequence / "detections.txt", "--out", out, "--map",
            out / "room.map")
    return out


@pytest.fixture(scope="session")
def frames(sequence):
    return list(dkp_slam.read_tum_folder(sequence))


@pytest.fixture(scope="session")
def camera(sequence):
    return dkp_slam.Camera.load(sequence / "camera.yaml")


@pytest.fixture(scope="session")
def true_boxes(sequence, frames):
    """Per frame: its detections, as the sequence's file has them."""
    stamps = [round(f.timestamp, 6) for f in frames]
    boxes = [[] for _ in frames]
    for line in pathlib.Path(sequence / "detections.txt").read_text().splitlines():
        if line.startswith("#"):
            continue
        t, label, score, *box = map(float, line.split())
        boxes[stamps.index(t)].append(dkp_slam.Detection(tuple(box), int(label), score))
    return boxes


@pytest.fixture
def small_camera():
    return dkp_slam.Camera(160, 120, 130.0, 130.0, 79.5, 59.5)


@pytest.fixture
def noise():
    """Makes a frame that nothing can be made of: colour, depth."""
    random = np.random.default_rng(1)

    def make(height=120, width=160):
        return (random.integers(0, 255, (height, width, 3), np.uint8),
                np.full((height, width), 2.0, np.float32))

    return make
