from __future__ import annotations

from os import PathLike

import numpy as np
import numpy.typing as npt

from ._core import Camera, Detection, Frame
from ._trajectory import Trajectory

class SyntheticFrame(Frame):
    @property
    def true_pose(self) -> npt.NDArray[np.float64]: ...
    @property
    def true_depth(self) -> npt.NDArray[np.float32]: ...
    @property
    def true_mask(self) -> npt.NDArray[np.uint8]: ...
    @property
    def true_instances(self) -> npt.NDArray[np.uint8]: ...
    @property
    def true_detections(self) -> list[Detection]: ...

class SyntheticSequence:
    @property
    def camera(self) -> Camera: ...
    @property
    def true_trajectory(self) -> Trajectory: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> SyntheticSequence: ...
    def __next__(self) -> SyntheticFrame: ...

def synth(
    scenario: str = "walking_xyz",
    frames: int | None = None,
    *,
    seed: int = 1,
    width: int = 640,
    height: int = 480,
    rate: float = 30.0,
    noise: bool = True,
    rolling_shutter: bool = False,
) -> SyntheticSequence: ...
def write_synth(
    folder: str | PathLike[str],
    scenario: str = "walking_xyz",
    frames: int | None = None,
    *,
    seed: int = 1,
    width: int = 640,
    height: int = 480,
    rate: float = 30.0,
    noise: bool = True,
    rolling_shutter: bool = False,
    force: bool = False,
) -> int: ...
def scenarios() -> dict[str, str]: ...
