"""Finds the path of an RGB-D camera in a room where people move about.

    import dkp_slam

    frames = dkp_slam.read_tum_folder("rgbd_dataset_freiburg3_walking_xyz")
    with dkp_slam.Slam(dkp_slam.Config(frames.camera)) as slam:
        for result in play(slam, frames):
            print(result.timestamp, result.pose)
    timestamps, poses = slam.trajectory

Frames: `world_from_camera` takes a point of the camera's frame to the world's. Metres, seconds,
pixels (u, v) with the top left pixel's centre at (0, 0). Messages go to the logger "dkp_slam".
"""

from __future__ import annotations

import atexit
from typing import TYPE_CHECKING, Iterable, Iterator

from . import _core
from ._core import (
    AbsoluteError,
    Camera,
    Config,
    Counters,
    DenseMap,
    Detection,
    Detector,
    DynamicObject,
    Error,
    ErrorStatistics,
    Frame,
    LiveDenseMap,
    Map,
    OccupancyGrid,
    RecordedDetections,
    RelativeError,
    Result,
    Slam,
    Surface,
    TumFolder,
    Yolox,
    ate,
    merge_maps,
    read_trajectory,
    read_tum_folder,
    rpe,
    write_trajectory,
)
from ._trajectory import Trajectory

if TYPE_CHECKING:
    from ._synth import SyntheticFrame, SyntheticSequence, scenarios, synth, write_synth

__version__: str = _core.__version__

# The generated world brings its own libraries, which are loaded when it is asked for.
_of_synth = ("SyntheticFrame", "SyntheticSequence", "scenarios", "synth", "write_synth")

__all__ = [
    "AbsoluteError",
    "Camera",
    "Config",
    "Counters",
    "DenseMap",
    "Detection",
    "Detector",
    "DynamicObject",
    "Error",
    "ErrorStatistics",
    "Frame",
    "LiveDenseMap",
    "Map",
    "OccupancyGrid",
    "RecordedDetections",
    "RelativeError",
    "Result",
    "Slam",
    "Surface",
    "Trajectory",
    "TumFolder",
    "Yolox",
    "ate",
    "merge_maps",
    "play",
    "read_trajectory",
    "read_tum_folder",
    "rpe",
    "write_trajectory",
    *_of_synth,
]

# Threads of the system must not come to an interpreter that has ended.
atexit.register(_core._end)


def __getattr__(name: str) -> object:
    if name not in _of_synth:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import _synth

    return getattr(_synth, name)


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))


def play(slam: Slam, frames: Iterable[Frame]) -> Iterator[Result]:
    """Feeds all frames, yields the results as they come, and finishes."""
    for frame in frames:
        slam.feed_frame(frame)
        yield from slam.results()
    slam.finish()
    yield from slam.results()
