"""Evaluation, map files, the generated world: as the program has them."""

import json
import re

import numpy as np
import pytest

import dkp_slam


def straight_path(n=40):
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, 0, 3] = 0.1 * np.arange(n)
    return np.arange(n) / 10.0, poses


def test_ate_of_a_known_path():
    t, poses = straight_path()
    moved = poses.copy()
    moved[:, 1, 3] = 5.0  # another world frame
    error = dkp_slam.ate((t, poses), dkp_slam.Trajectory(t, moved))
    assert error.rmse < 1e-12 and len(error.errors) == 40
    assert np.allclose(error.truth_from_estimate @ moved[7], poses[7])
    shaken = poses.copy()
    shaken[::2, 2, 3] += 0.02
    assert np.isclose(dkp_slam.ate((t, poses), (t, shaken)).rmse, 0.01, rtol=0.02)
    late = dkp_slam.ate((t, poses), (t + 3.0, poses), offset=-3.0)
    assert late.rmse < 1e-12 and np.array_equal(late.matches[:, 0], late.matches[:, 1])


def test_rpe_of_a_known_path():
    t, poses = straight_path()
    fast = poses.copy()
    fast[:, 0, 3] *= 1.1
    error = dkp_slam.rpe((t, poses), (t, fast), delta=5, unit="f")
    assert np.isclose(error.translation.rmse, 0.05) and error.rotation.max < 1e-6
    assert error.samples.shape == (error.translation.count, 4)


def test_errors_are_the_programs(program, sequence, by_program):
    files = sequence / "groundtruth.txt", by_program / "trajectory.txt"
    told = json.loads(program("eval", *files, "--json", "-"))
    ours = dkp_slam.ate(*files).statistics
    figures = next(v for v in told.values() if isinstance(v, dict) and "translation_m" in v)
    assert np.isclose(ours.rmse, figures["translation_m"]["rmse"], rtol=1e-6)


@pytest.mark.parametrize("t, poses, told", [
    ([0.0, 0.0], np.tile(np.eye(4), (2, 1, 1)), r"timestamps\[1\] is 0"),
    ([0.0], np.eye(4), r"must be of shapes \(n,\) and \(n, 4, 4\)"),
    ([0.0], 2 * np.eye(4)[None], r"poses\[0\] is no rigid motion"),
    ([0.0], np.full((1, 4, 4), np.nan), r"poses\[0\] is no rigid motion"),
    (["a"], np.eye(4)[None], "holds no numbers"),
])
def test_paths_that_are_none(t, poses, told):
    with pytest.raises(ValueError, match=told):
        dkp_slam.ate((t, poses), (t, poses))


def test_trajectory_files(tmp_path):
    t, poses = straight_path()
    dkp_slam.write_trajectory(tmp_path / "path.txt", (t, poses))
    read = dkp_slam.read_trajectory(tmp_path / "path.txt")
    assert np.allclose(read.timestamps, t) and np.allclose(read.poses, poses)
    with pytest.raises(dkp_slam.Error, match="nowhere.txt"):
        dkp_slam.read_trajectory(tmp_path / "nowhere.txt")


def test_map_file(program, by_program, tmp_path):
    map = dkp_slam.Map.load(by_program / "room.map")
    told = json.loads(program("map", "info", by_program / "room.map", "--json"))
    assert (len(map.keyframe_ids), len(map.landmarks)) == (told["keyframes"], told["landmarks"])
    assert map.maps == [m["id"] for m in told["maps"]] and map.camera.width == 320
    program("map", "export", by_program / "room.map", "--out", tmp_path)
    exported = dkp_slam.read_trajectory(tmp_path / "keyframes_0.txt")
    assert np.allclose(exported.poses, map.keyframes(0).poses, atol=1e-6)
    map.save(tmp_path / "again.map")
    again = dkp_slam.Map.load(tmp_path / "again.map")
    assert np.array_equal(again.landmarks, map.landmarks)
    with pytest.raises(dkp_slam.Error, match="again.map"):
        map.save(tmp_path / "again.map")
    with pytest.raises(ValueError, match="there is no map 3; its maps are 0"):
        map.keyframes(3)


def test_trajectory_formats_are_the_programs(program, by_program, tmp_path):
    path = dkp_slam.read_trajectory(by_program / "trajectory.txt")
    for name, file in [("tum", "path.txt"), ("euroc", "path.csv"), ("ply", "path.ply"),
                       ("gltf", "path.gltf"), ("kitti", "path.kitti")]:
        dkp_slam.write_trajectory(tmp_path / file, path, name if name == "kitti" else None)
        program("export", by_program, "--format", name, "--out", tmp_path / f"program_{file}")
        ours, theirs = ((tmp_path / f).read_bytes() for f in (file, f"program_{file}"))
        if name == "gltf":
            assert json.loads(ours)["accessors"][0]["count"] == len(path.timestamps)
            continue
        # Rotations come by way of matrices, and a 0 may have another sign.
        ours, theirs = ([float(n) for n in re.findall(rb"-?\d+\.?\d*", b)] for b in (ours, theirs))
        assert len(ours) >= 3 * len(path.timestamps), name
        assert np.allclose(ours, theirs, atol=1e-6), name
    with pytest.raises(ValueError, match="format is 'bvh'; it must be one of tum, kitti"):
        dkp_slam.write_trajectory(tmp_path / "path.bvh", path, "bvh")
    with pytest.raises(dkp_slam.Error):
        dkp_slam.write_trajectory(tmp_path / "empty.ply", (np.zeros(0), np.zeros((0, 4, 4))))
    assert not (tmp_path / "empty.ply").exists()


def test_landmarks_and_merged_maps(program, by_program, small_camera, tmp_path):
    file = by_program / "room.map"
    map = dkp_slam.Map.load(file)
    map.save_landmarks(tmp_path / "landmarks.ply")
    program("export", file, "--landmarks", tmp_path / "by_program.ply")
    assert (tmp_path / "landmarks.ply").read_bytes() == (tmp_path / "by_program.ply").read_bytes()
    both, joined = dkp_slam.merge_maps(map, map)
    assert len(both.keyframe_ids) == 2 * len(map.keyframe_ids)
    program("map", "merge", file, file, "--out", tmp_path / "both.map")
    by_program = dkp_slam.Map.load(tmp_path / "both.map")
    assert np.array_equal(both.landmarks, by_program.landmarks)
    assert both.maps == by_program.maps and len(joined) == 2 - len(both.maps)
    with dkp_slam.Slam(dkp_slam.Config(small_camera), detector=None) as slam:
        pass
    assert len(slam.map.landmarks) == 0
    with pytest.raises(ValueError, match="made with different cameras"):
        dkp_slam.merge_maps(map, slam.map)
    with pytest.raises(dkp_slam.Error, match="holds no landmark"):
        slam.map.save_landmarks(tmp_path / "none.ply")


def test_camera_is_found_in_a_map(by_program, camera, frames, small_camera):
    map = dkp_slam.Map.load(by_program / "room.map")
    config = dkp_slam.Config(camera, mode="off", options={"localize_only": True})
    with dkp_slam.Slam(config, map=map) as slam:
        results = list(dkp_slam.play(slam, frames[20:30]))
    assert all(r.localised for r in results)
    assert np.array_equal(slam.map.keyframe_ids, map.keyframe_ids)
    path = dkp_slam.read_trajectory(by_program / "trajectory.txt")
    assert np.allclose(results[-1].pose[:3, 3], path.positions[29], atol=0.02)
    with pytest.raises(ValueError, match="localize_only needs a map"):
        dkp_slam.Slam(config)
    with pytest.raises(ValueError, match="map was made with another camera"):
        dkp_slam.Slam(dkp_slam.Config(small_camera), map=map)


def test_generated_frames_are_the_programs(sequence, frames, true_boxes):
    generated = dkp_slam.synth("walking_xyz", 3, width=320, height=240)
    truth = dkp_slam.read_trajectory(sequence / "groundtruth.txt")
    assert len(generated) == 3 and generated.camera.width == 320
    assert np.array_equal(generated.true_trajectory.timestamps, [f.timestamp for f in frames[:3]])
    for frame, written, boxes in zip(generated, frames, true_boxes):
        assert isinstance(frame, dkp_slam.Frame) and frame.timestamp == written.timestamp
        assert np.array_equal(frame.rgb, written.rgb)
        assert np.allclose(frame.depth, written.depth, atol=2e-4)
        assert [d.box for d in frame.true_detections] == [d.box for d in boxes]
        nearest = np.argmin(abs(truth.timestamps - frame.timestamp))
        assert np.allclose(frame.true_pose, truth.poses[nearest], atol=1e-5)
        assert frame.true_mask.shape == frame.true_instances.shape == (240, 320)


def test_written_folder_is_the_programs(program, tmp_path):
    assert dkp_slam.write_synth(tmp_path / "ours", "static_room", 2, width=320, height=240) == 2
    program("synth", "static_room", "--frames", 2, "--width", 320, "--height", 240, "--out",
            tmp_path / "theirs")
    files = sorted(f.relative_to(tmp_path / "ours") for f in (tmp_path / "ours").rglob("*.*"))
    assert len(files) == 2 * 4 + 7
    for file in files:
        ours, theirs = ((tmp_path / f / file).read_bytes() for f in ("ours", "theirs"))
        assert ours == theirs, file
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "letter.txt").write_text("mine")
    with pytest.raises(dkp_slam.Error, match="full: is not empty"):
        dkp_slam.write_synth(tmp_path / "full", "static_room", 1)
    with pytest.raises(ValueError, match="frames is 0"):
        dkp_slam.write_synth(tmp_path / "none", "static_room", 0)
    assert not (tmp_path / "none").exists()


def test_scenarios():
    assert "walking_xyz" in dkp_slam.scenarios()
    with pytest.raises(dkp_slam.Error, match="no_such"):
        dkp_slam.synth("no_such")
    with pytest.raises(ValueError, match="10 x 240 pixels"):
        dkp_slam.synth(width=10, height=240)


def test_frames_of_a_folder(sequence, frames):
    some = dkp_slam.read_tum_folder(sequence, first_frame=5, count=3)
    assert len(some) == 3
    for frame, expected in zip(some, frames[5:]):
        assert frame.timestamp == expected.timestamp
        assert np.array_equal(frame.rgb, expected.rgb) and frame.mask is None
        assert np.array_equal(frame.rgb[..., ::-1], frame.bgr)
        assert frame.depth.dtype == np.float32 and not frame.depth.flags.writeable
    assert some.skipped == 0
