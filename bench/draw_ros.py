#!/usr/bin/env python3
"""Draws what the ROS node publishes, for docs/ros.md: path, landmarks and floor plan from above, and the dense cloud.

  bench/draw_ros.py OUT.png [--node /dkp_slam] [--quiet 8]

Listens until nothing has come for `--quiet` seconds. Needs matplotlib and Debian's python3-rospy, python3-sensor-msgs and
python3-nav-msgs.
"""
import argparse
import sys
import time

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid, Path
from sensor_msgs.msg import PointCloud2

TYPES = {"pose": PoseWithCovarianceStamped, "path": Path, "landmarks": PointCloud2, "cloud": PointCloud2, "grid": OccupancyGrid}


def floats(cloud):
    """A row of 32-bit fields per point."""
    return np.frombuffer(cloud.data, "<f4").reshape(cloud.width, cloud.point_step // 4)


def listen(node, quiet):
    """The newest message of each topic, and all poses."""
    rospy.init_node("draw_ros", anonymous=True, disable_signals=True)
    newest, poses, last = {}, [], [time.monotonic()]

    def take(message, name):
        newest[name], last[0] = message, time.monotonic()
        if name == "pose":
            poses.append([message.pose.pose.position.x, message.pose.pose.position.y])

    for name, kind in TYPES.items():
        rospy.Subscriber(f"{node}/{name}", kind, take, name)
    while not poses or time.monotonic() - last[0] < quiet:
        time.sleep(0.2)
    missing = sorted(set(TYPES) - set(newest))
    if missing:
        sys.exit(f"draw_ros.py: nothing came of {', '.join(missing)}")
    return newest, np.array(poses)


def draw_plan(axes, newest, poses):
    grid = newest["grid"]
    cells = np.array(grid.data, int).reshape(grid.info.height, grid.info.width)
    grey = np.select([cells == 100, cells == 0], [0.0, 1.0], 0.8)
    at, size = grid.info.origin.position, grid.info.resolution
    axes.imshow(grey, cmap="gray", vmin=0, vmax=1, origin="lower", extent=(
        at.x, at.x + size * grid.info.width, at.y, at.y + size * grid.info.height))
    points = floats(newest["landmarks"])
    axes.plot(points[:, 0], points[:, 1], ".", markersize=1, color="tab:blue", label="~landmarks")
    axes.plot(*poses.T, color="tab:red", label="~pose")
    keyframes = [(p.pose.position.x, p.pose.position.y) for p in newest["path"].poses]
    axes.plot(*np.array(keyframes).T, "o", markersize=3, color="tab:orange", label="~path")
    axes.set(title="~grid, from above", xlabel="x, metres", ylabel="y", aspect="equal")
    axes.set_xlim(at.x, at.x + size * grid.info.width)
    axes.set_ylim(at.y, at.y + size * grid.info.height)
    axes.legend(loc="upper left", fontsize=8)


def draw_cloud(axes, newest):
    points = floats(newest["cloud"])
    rgb = points[:, 3].copy().view("<u4")
    colours = np.stack([rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255], axis=1) / 255.0
    # Seen along x, as the camera looks.
    order = np.argsort(-points[:, 0])
    axes.scatter(points[order, 1], points[order, 2], s=2, c=colours[order], linewidths=0)
    axes.invert_xaxis()
    axes.set(title="~cloud, seen along x", xlabel="y, metres", ylabel="z", aspect="equal")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("--node", default="/dkp_slam")
    parser.add_argument("--quiet", type=float, default=8.0, help="seconds")
    arguments = parser.parse_args()
    newest, poses = listen(arguments.node, arguments.quiet)
    figure, (plan, cloud) = plt.subplots(1, 2, figsize=(12, 5.5))
    draw_plan(plan, newest, poses)
    draw_cloud(cloud, newest)
    figure.tight_layout()
    figure.savefig(arguments.out, dpi=80)


if __name__ == "__main__":
    main()
