"""Slam: the same path as the program's, however the frames come in."""

import threading

import numpy as np
import pytest

import dkp_slam


def run(camera, frames, detector, feed):
    results = []
    with dkp_slam.Slam(dkp_slam.Config(camera), detector) as slam:
        for frame in frames:
            feed(slam, frame)
            results += slam.results()
    results += slam.results()
    assert [r.index for r in results] == list(range(len(frames)))
    return slam, results


def feed_rgb(slam, frame):
    slam.feed(frame.rgb, frame.depth, frame.timestamp, depth_delay=frame.depth_delay)


@pytest.fixture(scope="module")
def played(camera, frames, sequence):
    return run(camera, frames, dkp_slam.RecordedDetections(sequence / "detections.txt"), feed_rgb)


def test_path_is_the_programs(played, by_program, tmp_path):
    """To the last digit of the file: 0.1 micrometres."""
    slam, _ = played
    for name, path in (("trajectory.txt", slam.trajectory),
                       ("keyframes.txt", slam.keyframe_trajectory)):
        dkp_slam.write_trajectory(tmp_path / name, path)
        assert np.array_equal(np.loadtxt(tmp_path / name), np.loadtxt(by_program / name))


def test_path_does_not_depend_on_the_way_in(played, camera, frames, sequence):
    def feed_bgr(slam, frame):
        slam.feed(frame.bgr, frame.depth, frame.timestamp, order="bgr")

    def feed_units(slam, frame):
        units = np.rint(frame.depth * camera.depth_scale).astype(np.uint16)
        slam.feed(frame.rgb, units, frame.timestamp, copy=True)

    def feed_frame(slam, frame):
        slam.feed_frame(frame)

    expected = played[0].trajectory
    for feed in feed_bgr, feed_units, feed_frame:
        detector = dkp_slam.RecordedDetections(sequence / "detections.txt")
        path = run(camera, frames, detector, feed)[0].trajectory
        assert np.array_equal(path.timestamps, expected.timestamps), feed.__name__
        assert np.array_equal(path.poses, expected.poses), feed.__name__


def test_path_is_near_the_truth(played, sequence):
    trajectory = played[0].trajectory
    assert dkp_slam.ate(sequence / "groundtruth.txt", trajectory).rmse < 0.02
    timestamps, poses = trajectory
    assert timestamps.shape == (36,) and poses.shape == (36, 4, 4)
    assert np.allclose(poses[:, 3], [0, 0, 0, 1])
    assert np.allclose(poses[:, :3, :3] @ poses[:, :3, :3].transpose(0, 2, 1), np.eye(3))
    assert np.array_equal(trajectory.positions, poses[:, :3, 3])


def test_result_tells_what_became_of_a_frame(played, frames, true_boxes):
    slam, results = played
    known = set(slam.map.landmark_ids)
    for result, frame, boxes in zip(results, frames, true_boxes):
        assert result.state == "tracking" and result.localised
        assert result.timestamp == frame.timestamp
        assert result.pose.shape == (4, 4) and result.pose.dtype == np.float64
        assert result.mask.shape == (240, 320) and result.mask.dtype == np.uint8
        n = result.features
        assert result.keypoints.shape == (n, 2) and result.keypoints.dtype == np.float32
        assert result.is_static.shape == result.landmarks.shape == (n,)
        assert np.count_nonzero(~result.is_static) == result.removed_features
        assert [d.box for d in result.detections] == [b.box for b in boxes]
        assert result.times["frame"] > 0
    assert results[0].keyframe
    # What only the last frames saw is culled when the path ends.
    seen = np.intersect1d(results[-1].landmarks, results[len(results) // 2].landmarks)
    seen = seen[seen >= 0]
    assert len(seen) >= 20 and np.mean([landmark in known for landmark in seen]) > 0.9


def test_mask_lies_on_people(played, sequence):
    common = people = masked = 0
    true_masks = dkp_slam.read_tum_folder(sequence, masks=sequence / "mask")
    for result, frame in zip(played[1], true_masks):
        common += np.count_nonzero((result.mask > 0) & (frame.mask > 0))
        people += np.count_nonzero(frame.mask)
        masked += np.count_nonzero(result.mask)
    assert people > 0 and common > 0.4 * people and common > 0.5 * masked


def test_detector_in_python_gives_the_same_path(played, camera, frames, true_boxes):
    calls = []

    def detect(image):
        assert image.shape == (240, 320, 3) and image.dtype == np.uint8
        assert np.array_equal(image, frames[len(calls)].rgb)
        calls.append(threading.get_ident())
        return true_boxes[len(calls) - 1]

    slam, results = run(camera, frames, detect, feed_rgb)
    assert len(calls) == len(frames) and threading.get_ident() not in calls
    assert slam.detector_error is None and slam.detector_name == "python (detect)"
    assert np.array_equal(slam.trajectory.poses, played[0].trajectory.poses)


def test_map_and_loops_are_there_after_the_end(played):
    slam, results = played
    map = slam.map
    assert map.landmarks.shape == (len(map.landmark_ids), 3)
    assert len(map.landmarks) == results[-1].map_landmarks or len(map.landmarks) > 100
    assert set(map.landmark_maps) == {0} and map.maps == [0]
    assert map.landmark_sightings.min() >= 1
    assert np.array_equal(map.keyframes().poses, slam.keyframe_trajectory.poses)
    assert slam.loops == [] and len(slam.trajectories) == 1
    counters = slam.counters
    assert (counters.fed, counters.answered, counters.dropped) == (36, 36, 0)


def test_given_masks_need_no_detector(camera, frames, sequence):
    config = dkp_slam.Config(camera, mode="masks")
    folder = dkp_slam.read_tum_folder(sequence, camera, masks=sequence / "mask", count=10)
    paths = []
    for as_arrays in False, True:
        with dkp_slam.Slam(config) as slam:
            for frame in dkp_slam.read_tum_folder(sequence, masks=sequence / "mask", count=10):
                if as_arrays:
                    slam.feed(frame.rgb, frame.depth, frame.timestamp, mask=frame.mask > 0)
                else:
                    slam.feed_frame(frame)
        paths.append(slam.trajectory.poses)
        assert slam.detector_name == "none"
    assert len(folder) == 10 and np.array_equal(*paths)


def test_live_returns_at_once_and_drops(camera, frames):
    config = dkp_slam.Config(camera, realtime=True)
    with dkp_slam.Slam(config, detector=None) as slam:
        for frame in frames:
            slam.feed_frame(frame)
        assert slam.wait(timeout=10.0) is not None
    counters = slam.counters
    assert counters.fed == 36 and counters.answered + counters.dropped == 36
