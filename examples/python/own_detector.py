"""A detector of one's own, in ten lines: whatever is red moves. own_detector.py FOLDER"""

import sys

import numpy as np

import dkp_slam


def red_things(image):
    r, g, b = (image[..., i].astype(int) for i in range(3))
    rows, columns = np.nonzero((r > 150) & (g < 90) & (b < 90))
    if len(rows) < 50:
        return []
    x, y = columns.min(), rows.min()
    return [dkp_slam.Detection((x, y, np.ptp(columns) + 1, np.ptp(rows) + 1), "moving", 0.9)]


frames = dkp_slam.read_tum_folder(sys.argv[1])
with dkp_slam.Slam(dkp_slam.Config(frames.camera), red_things) as slam:
    results = list(dkp_slam.play(slam, frames))
print(f"{sum(r.localised for r in results)} of {len(results)} frames localised, "
      f"{sum(len(r.detections) for r in results)} red things")
