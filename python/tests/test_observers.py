"""Callables that are told what happens."""

import gc
import logging
import weakref

import numpy as np
import pytest

import dkp_slam


def play(slam, frames):
    with slam:
        for frame in frames:
            slam.feed_frame(frame)


def test_keyframes_and_changes_of_the_map_are_told(camera, frames, true_boxes):
    boxes = iter(true_boxes)
    slam = dkp_slam.Slam(dkp_slam.Config(camera), lambda image: next(boxes))
    keyframes, poses, landmarks = [], {}, set()

    def changed(change):
        assert len(change["keyframe_ids"]) == len(change["keyframe_poses"])
        poses.update(zip(change["keyframe_ids"], change["keyframe_poses"]))
        landmarks.update(change["landmark_ids"])
        landmarks.difference_update(change["removed_landmarks"])
        assert change["landmarks"].shape == (len(change["landmark_ids"]), 3)
        for k in change["removed_keyframes"]:
            poses.pop(k)

    slam.observe(keyframe=keyframes.append, map=changed, map_interval=0.2)
    play(slam, frames)
    told = [k["frame_index"] for k in keyframes]
    assert told == [r.index for r in slam.results() if r.keyframe] and told[0] == 0
    assert keyframes[0]["pose"].shape == (4, 4) and keyframes[0]["landmarks"] > 50
    # Together they are the map as it is in the end.
    map = slam.map
    assert sorted(poses) == list(map.keyframe_ids)
    by_time = [poses[k["id"]] for k in keyframes if k["id"] in poses]
    assert np.allclose(by_time, map.keyframes().poses)
    assert landmarks == set(map.landmark_ids)
    assert slam.counters.observer_exceptions == 0


def test_lost_and_found_are_told(camera, frames):
    told = []
    slam = dkp_slam.Slam(dkp_slam.Config(camera, mode="off"))
    slam.observe(lost=lambda c: told.append(("lost", c)), found=lambda c: told.append(("found", c)))
    with slam:
        for frame in frames[:24]:
            dark = 8 <= frame.index < 16
            slam.feed(0 * frame.rgb if dark else frame.rgb,
                      0 * frame.depth if dark else frame.depth, frame.timestamp)
    states = [r.state for r in slam.results()]
    assert "lost" in states and [name for name, _ in told[:2]] == ["lost", "found"]
    lost, found = told[0][1], told[1][1]
    assert lost["frame_index"] == states.index("lost") < found["frame_index"]
    assert np.isclose(found["lost_for"], found["timestamp"] - lost["timestamp"])


def test_what_they_raise_is_logged_and_the_run_goes_on(camera, frames, caplog):
    caplog.set_level(logging.INFO, "dkp_slam")

    def failing(keyframe):
        raise ZeroDivisionError("nothing to divide by")

    slam = dkp_slam.Slam(dkp_slam.Config(camera, mode="off"))
    slam.observe(keyframe=failing)
    play(slam, frames)
    results = slam.results()
    assert len(results) == len(frames) and all(r.localised for r in results)
    assert slam.counters.observer_exceptions == sum(r.keyframe for r in results)
    lines = [r.getMessage() for r in caplog.records if r.levelno == logging.ERROR]
    assert len(lines) == 1 and "ZeroDivisionError: nothing to divide by (test_obs" in lines[0]


@pytest.mark.parametrize("call", ["wait", "finish", "close", "feed"])
def test_what_waits_for_the_run_cannot_be_called_there(small_camera, noise, caplog, call):
    slam = dkp_slam.Slam(dkp_slam.Config(small_camera, mode="off"))
    rgb, depth = noise()
    arguments = (rgb, depth, 9.0) if call == "feed" else ()
    slam.observe(lost=lambda c: getattr(slam, call)(*arguments),
                 keyframe=lambda k: getattr(slam, call)(*arguments))
    with slam:
        for i in range(3):
            slam.feed(rgb if i < 1 else 0 * rgb, depth if i < 1 else 0 * depth, float(i))
    assert slam.counters.answered == 3 and slam.counters.observer_exceptions >= 1
    assert any(f"{call}() waits for the system" in r.getMessage() for r in caplog.records)


def test_they_are_let_go_when_the_run_is_over(small_camera, noise):
    class Listener:
        def __init__(self, slam):
            self.slam = slam

        def __call__(self, keyframe):
            pass

    slam = dkp_slam.Slam(dkp_slam.Config(small_camera))
    listener = Listener(slam)
    gone = weakref.ref(listener)
    slam.observe(keyframe=listener)
    del listener
    gc.collect()
    assert gone() is not None
    slam.feed(*noise(), 0.0)
    slam.finish()
    gc.collect()
    assert gone() is None


def test_what_cannot_be_told(small_camera, noise):
    slam = dkp_slam.Slam(dkp_slam.Config(small_camera))
    with pytest.raises(TypeError, match="loop is a int; it must be a callable or None"):
        slam.observe(loop=3)
    with pytest.raises(ValueError, match="map_interval is nan"):
        slam.observe(map=print, map_interval=float("nan"))
    slam.feed(*noise(), 0.0)
    with pytest.raises(ValueError, match="before its first frame"):
        slam.observe(keyframe=print)
    slam.close()
