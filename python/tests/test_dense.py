"""The dense map: of a wall that is known, of a run while it lasts, as files."""

import json

import numpy as np
import pytest

import dkp_slam

WALL = 2.0  # metres


def ply(file):
    """Vertices and faces that a file's header tells."""
    lines = file.read_bytes().split(b"end_header")[0].decode().splitlines()
    return {w[1]: int(w[2]) for w in (line.split() for line in lines) if w[0] == "element"}


@pytest.fixture
def wall(small_camera):
    """A wall of the colour (200, 100, 50) ahead of a camera, with somebody at 1 m in its middle
    who is masked: of eight images."""
    dense = dkp_slam.DenseMap(small_camera, voxel=0.02, cell=0.05)
    rgb = np.full((120, 160, 3), (200, 100, 50), np.uint8)
    depth = np.full((120, 160), WALL, np.float32)
    depth[40:80, 60:100] = 1.0
    mask = depth < WALL
    for i in range(8):
        pose = np.eye(4)
        pose[0, 3] = 0.02 * i
        dense.fuse(rgb, depth, pose, mask)
    return dense


def test_wall_is_there_and_who_stands_before_it_is_not(wall):
    surface = wall.surface()
    assert len(wall) == 8 and len(surface) == len(surface.points) > 1000
    assert np.allclose(surface.points[:, 2], WALL, atol=0.005)
    assert np.allclose(surface.normals, (0.0, 0.0, -1.0), atol=0.05)
    assert np.all(abs(surface.colours.astype(int) - (200, 100, 50)) <= 1)
    assert surface.triangles.min() == 0 and surface.triangles.max() == len(surface) - 1
    # As wide as the view, but for what the person hides.
    assert surface.points[:, 0].min() < -1.1 and surface.points[:, 0].max() > 1.1
    assert not np.any(np.linalg.norm(surface.points[:, :2] - (0.07, 0.0), axis=1) < 0.1)


def test_arrays_are_views_that_outlive_the_surface(wall):
    surface = wall.surface()
    points = surface.points
    assert not points.flags.writeable and not points.flags.owndata
    before = points.copy()
    assert np.shares_memory(points, surface.points)
    del surface, wall
    assert np.array_equal(points, before)


def test_files(wall, tmp_path):
    surface = wall.surface()
    surface.save_cloud(tmp_path / "wall.ply")
    assert ply(tmp_path / "wall.ply") == {"vertex": len(surface)}
    surface.save_mesh(tmp_path / "mesh.ply")
    assert ply(tmp_path / "mesh.ply") == {"vertex": len(surface), "face": len(surface.triangles)}
    surface.save_mesh(tmp_path / "mesh.glb")
    assert (tmp_path / "mesh.glb").read_bytes()[:4] == b"glTF"
    wall.save_octomap(tmp_path / "wall.bt")
    assert (tmp_path / "wall.bt").read_bytes().startswith(b"# Octomap")
    grid = wall.grid(low=-5.0, high=5.0)
    assert set(np.unique(grid.cells)) <= {0, 205, 254} and (grid.cells == 0).sum() > 20
    assert grid.resolution == 0.05 and grid.level_from_world.shape == (4, 4)
    grid.save(tmp_path / "wall.pgm")
    rows, columns = grid.cells.shape
    assert (tmp_path / "wall.pgm").read_bytes().endswith(grid.cells.tobytes())
    assert f"{columns} {rows}".encode() in (tmp_path / "wall.pgm").read_bytes()[:200]
    assert "resolution: 0.05" in (tmp_path / "wall.yaml").read_text()


def test_what_is_wrong_is_said(wall, small_camera, noise, tmp_path):
    rgb, depth = noise()
    for arguments, told in [({"voxel": 0.001}, "voxel is 0.001; it must be from 0.005 to 0.2"),
                            ({"range": 0.1}, "range is 0.1"), ({"cell": 5.0}, "cell is 5"),
                            ({"memory": 0.0}, "memory is 0")]:
        with pytest.raises(ValueError, match=told):
            dkp_slam.DenseMap(small_camera, **arguments)
    with pytest.raises(ValueError, match="pose is no rigid motion"):
        wall.fuse(rgb, depth, 2 * np.eye(4))
    with pytest.raises(ValueError, match="mask is 10 x 10 pixels"):
        wall.fuse(rgb, depth, np.eye(4), np.zeros((10, 10), bool))
    with pytest.raises(ValueError, match="depth is float64"):
        wall.reserve(rgb, depth.astype(float), np.eye(4))
    with pytest.raises(ValueError, match="low is 2, high 1"):
        wall.grid(2.0, 1.0)
    with pytest.raises(ValueError, match="must end in .ply or .glb"):
        wall.surface().save_mesh(tmp_path / "mesh.obj")
    with pytest.raises(dkp_slam.Error, match="nowhere"):
        wall.surface().save_cloud(tmp_path / "nowhere" / "wall.ply")
    empty = dkp_slam.DenseMap(small_camera)
    assert len(empty.surface()) == 0 and empty.surface().points.shape == (0, 3)
    with pytest.raises(dkp_slam.Error, match="empty.ply"):
        empty.surface().save_cloud(tmp_path / "empty.ply")
    with pytest.raises(dkp_slam.Error, match="nothing is fused yet"):
        empty.grid()
    assert not list(tmp_path.iterdir())


def test_is_the_map_that_the_program_exports(program, sequence, camera, frames, tmp_path):
    """The same poses and masks, in two passes: the same surface."""
    out = tmp_path / "run"
    program("run", sequence, "--detections", sequence / "detections.txt", "--save-masks",
            "--out", out)
    told = program("export", out, "--dense", tmp_path / "by_program.ply")
    masked = {f.index: f.mask for f in dkp_slam.read_tum_folder(sequence, masks=out / "masks")}
    path = dkp_slam.read_trajectory(out / "trajectory.txt")
    poses = dict(zip(np.round(path.timestamps, 5), path.poses))
    dense = dkp_slam.DenseMap(camera)
    for work in (dense.reserve_frame, dense.fuse_frame):
        for frame in frames:
            work(frame, poses[round(frame.timestamp, 5)], masked[frame.index])
    surface = dense.surface()
    assert len(dense) == len(frames)
    there = ply(tmp_path / "by_program.ply")["vertex"]
    assert abs(len(surface) - there) <= 0.001 * there, told


def test_run_fuses_its_keyframes(camera, frames, true_boxes, program, sequence, tmp_path):
    boxes = iter(true_boxes)
    slam = dkp_slam.Slam(dkp_slam.Config(camera), lambda image: next(boxes))
    with pytest.raises(ValueError, match="keyframes is 1"):
        slam.fuse_dense(keyframes=1)
    live = slam.fuse_dense(voxel=0.04, range=4.0)
    assert len(live.surface()) == 0 and live.version == 0
    list(dkp_slam.play(slam, frames))
    live.finish()
    surface = live.surface()
    assert live.version > 0 and len(surface) > 500
    surface.save_mesh(tmp_path / "live.ply")
    # What the program fuses while its run lasts.
    program("run", sequence, "--detections", sequence / "detections.txt", "--out", tmp_path / "run",
            "--voxel", 0.04, "--range", 4.0, "--mesh", tmp_path / "by_program.ply")
    assert ply(tmp_path / "live.ply") == ply(tmp_path / "by_program.ply")
    with pytest.raises(ValueError, match="before its first frame"):
        slam.fuse_dense()
    slam.close()
    assert len(live.surface()) == len(surface), "it outlives the run"
