"""Trajectory: a path as two arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt


class Trajectory(NamedTuple):
    """Where the camera was: `timestamps, poses = trajectory`.

    timestamps: seconds, (n,), rising. poses: world from camera, (n, 4, 4), metres.
    """

    timestamps: npt.NDArray[np.float64]
    poses: npt.NDArray[np.float64]

    @property
    def positions(self) -> npt.NDArray[np.float64]:
        """Of the camera, metres, (n, 3)."""
        return self.poses[:, :3, 3]

    def __repr__(self) -> str:
        return f"<dkp_slam.Trajectory of {len(self.timestamps)} poses>"
