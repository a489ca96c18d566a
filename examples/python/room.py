"""A room with people, from frames to a plot: cells for a notebook, or a script as it stands.

room.py [--sequence FOLDER] [--out FILE]    # a TUM RGB-D folder; without: a generated sequence
"""

# %% What to play
import argparse
import os
import sys

import matplotlib

if sys.platform == "linux" and not os.environ.get("DISPLAY"):
    matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import dkp_slam

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--sequence", help="folder in TUM RGB-D format")
parser.add_argument("--out", default="room.png", help="the picture")
arguments = parser.parse_args()

if arguments.sequence:
    frames = dkp_slam.read_tum_folder(arguments.sequence)
    truth = os.path.join(arguments.sequence, "groundtruth.txt")
    truth = dkp_slam.read_trajectory(truth) if os.path.exists(truth) else None
else:
    frames = dkp_slam.synth("walking_xyz", frames=150, width=320, height=240)
    truth = frames.true_trajectory

# %% Play it, and keep the frame in which most is masked
shown, shown_image, removed, images = None, None, [], {}


def remembered(frames):
    for frame in frames:
        images[frame.timestamp] = frame.rgb
        yield frame


with dkp_slam.Slam(dkp_slam.Config(frames.camera, mode="dkp+"), detector="motion") as slam:
    for result in dkp_slam.play(slam, remembered(frames)):
        image = images.pop(result.timestamp)
        removed.append(result.removed_features / max(1, result.features))
        if shown is None or np.count_nonzero(result.mask) > np.count_nonzero(shown.mask):
            shown, shown_image = result, image
timestamps, poses = slam.trajectory
print(f"{len(timestamps)} poses, {slam.map}")

# %% How far from the truth
aligned = poses
if truth is not None:
    error = dkp_slam.ate(truth, slam.trajectory)
    aligned = error.truth_from_estimate @ poses
    print(f"ATE {1000 * error.rmse:.1f} mm")

# %% Plot path, mask and features
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
if truth is not None:
    left.plot(*truth.positions[:, :2].T, color="0.6", linewidth=3, label="truth")
left.plot(*aligned[:, :2, 3].T, color="tab:blue", label="dkp-slam")
left.set(xlabel="x [m]", ylabel="y [m]", title="Path of the camera", aspect="equal")
left.legend()
right.imshow(shown_image)
overlay = np.zeros((*shown.mask.shape, 4))
overlay[shown.mask > 0] = (1.0, 0.1, 0.1, 0.45)
right.imshow(overlay)
for static, colour in (True, "lime"), (False, "red"):
    right.scatter(*shown.keypoints[shown.is_static == static].T, s=3, color=colour)
right.set_axis_off()
right.set_title(f"{shown.timestamp:.2f} s: {100 * removed[shown.index]:.0f}% of features removed")
figure.savefig(arguments.out, dpi=80)
print(f"in {arguments.out}")
if matplotlib.get_backend().lower() != "agg":
    plt.show()
