"""Memory that is shared, detectors that fail, Ctrl-C."""

import gc
import logging
import os
import signal
import subprocess
import sys
import threading
import time
import weakref

import numpy as np
import pytest

import dkp_slam


def gone(reference, seconds=5.0):
    """Whether it goes within the time: the system's threads give back what they are done with."""
    end = time.monotonic() + seconds
    while reference() is not None and time.monotonic() < end:
        gc.collect()
        time.sleep(0.01)
    return reference() is None


class Gate:
    """A detector that waits until it is let through, and keeps what it saw."""

    def __init__(self):
        self.open, self.entered, self.seen = threading.Event(), threading.Event(), []

    def __call__(self, image):
        self.seen.append(image.copy())
        self.entered.set()
        assert self.open.wait(20.0)
        return []


@pytest.mark.parametrize("order, copy, shared",
                         [("bgr", False, True), ("bgr", True, False), ("rgb", False, False)])
def test_images_are_shared_not_copied(small_camera, noise, order, copy, shared):
    gate = Gate()
    slam = dkp_slam.Slam(dkp_slam.Config(small_camera), gate)
    rgb, depth = noise()
    slam.feed(rgb, depth, 0.0)
    assert gate.entered.wait(20.0)
    # The detector is at the first frame; what is written to the second before it comes to it is
    # seen there if, and only if, it is the same memory.
    image, depth = noise()
    image[0, 0] = 0
    slam.feed(image, depth, 1.0, order=order, copy=copy)
    image[0, 0] = (11, 22, 33)
    gate.open.set()
    slam.finish()
    assert tuple(gate.seen[1][0, 0]) == ((33, 22, 11) if shared else (0, 0, 0))


def test_arrays_live_as_long_as_they_are_used_and_no_longer(small_camera, noise):
    gate = Gate()
    slam = dkp_slam.Slam(dkp_slam.Config(small_camera), gate)
    arrays = []
    for i in range(2):
        image, depth = noise()
        arrays += [weakref.ref(image), weakref.ref(depth)]
        slam.feed(image, depth, float(i), order="bgr")
    image, copied = noise()
    arrays.append(weakref.ref(image))
    slam.feed(image, copied, 2.0, order="bgr", copy=True)
    del image, depth
    gc.collect()
    assert all(a() is not None for a in arrays[:4]), "borrowed, and the detector waits"
    assert gone(arrays[4]), "was copied"
    gate.open.set()
    slam.finish()
    slam.close()
    assert all(gone(a) for a in arrays)


def test_arrays_are_given_back_while_it_runs(camera, frames):
    """However long it runs: when a frame's result is there, those before it are let go."""
    alive = []
    most = 0
    with dkp_slam.Slam(dkp_slam.Config(camera), detector=None) as slam:
        for frame in frames:
            image, depth = frame.bgr.copy(), frame.depth.copy()
            alive += [weakref.ref(image), weakref.ref(depth)]
            slam.feed(image, depth, frame.timestamp, order="bgr")
            while slam.wait() is not None:
                pass
            del image, depth
            most = max(most, sum(a() is not None for a in alive))
    assert most <= 2 * 2


def failing(image):
    raise ZeroDivisionError("nothing to divide by")


@pytest.mark.parametrize("detector, told", [
    (failing, "ZeroDivisionError: nothing to divide by (test_threads.py:"),
    (lambda image: None, "the detector returned None; return a list of Detection"),
    (lambda image: [1.0], "the detector returned a float among its detections"),
])
def test_detector_that_fails_is_told_and_the_run_goes_on(small_camera, noise, caplog, detector,
                                                         told):
    caplog.set_level(logging.INFO, "dkp_slam")
    with dkp_slam.Slam(dkp_slam.Config(small_camera), detector) as slam:
        for i in range(4):
            slam.feed(*noise(), float(i))
    assert [r.index for r in slam.results()] == [0, 1, 2, 3]
    assert slam.counters.detector_failures == 1
    assert isinstance(slam.detector_error, Exception)
    lines = [r.getMessage() for r in caplog.records if r.levelno == logging.ERROR]
    assert len(lines) == 1 and told in lines[0] and "going on without it" in lines[0]


@pytest.mark.parametrize("call", ["wait", "finish", "feed"])
def test_ctrl_c_ends_waiting(small_camera, noise, call):
    gate = Gate()
    slam = dkp_slam.Slam(dkp_slam.Config(small_camera), gate)
    slam.feed(*noise(), 0.0)
    assert gate.entered.wait(20.0)
    timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        if call == "feed":
            for i in range(1, 30):
                slam.feed(*noise(), float(i))
        getattr(slam, call)()
    timer.join()
    gate.open.set()
    slam.finish()
    assert slam.counters.answered == slam.counters.fed
    slam.close()


class Stop(BaseException):
    """What a program's own handler of a signal raises."""


@pytest.mark.parametrize("number, raised",
                         [(signal.SIGINT, KeyboardInterrupt), (signal.SIGUSR1, Stop)])
def test_what_comes_while_the_log_is_written_ends_the_program(small_camera, noise, number, raised):
    """As Ctrl-C in a handler of `logging`: the call that hands over the log lines passes it on."""
    class Interrupted(logging.Handler):
        def emit(self, record):
            logger.removeHandler(self)
            signal.raise_signal(number)

    def stop(*_):
        raise Stop

    def fails(image):
        raise RuntimeError("told in the log")

    logger = logging.getLogger("dkp_slam")
    handler = Interrupted()
    logger.addHandler(handler)
    before = signal.signal(signal.SIGUSR1, stop)
    try:
        with dkp_slam.Slam(dkp_slam.Config(small_camera), fails) as slam:
            with pytest.raises(raised):
                slam.feed(*noise(), 0.0)
                slam.wait()
                slam.finish()
            slam.finish()
            assert slam.counters.answered == 1
    finally:
        signal.signal(signal.SIGUSR1, before)
        logger.removeHandler(handler)


def test_wait_gives_up_in_time(small_camera, noise):
    gate = Gate()
    slam = dkp_slam.Slam(dkp_slam.Config(small_camera), gate)
    slam.feed(*noise(), 0.0)
    assert slam.wait(timeout=0.05) is None
    gate.open.set()
    assert slam.wait().index == 0
    assert slam.wait() is None


def test_python_ends_while_a_system_runs():
    """Nothing is finished or closed: the interpreter ends all the same, and says nothing."""
    program = """
import numpy, dkp_slam
slam = dkp_slam.Slam(dkp_slam.Config(dkp_slam.Camera(160, 120, 130, 130, 79.5, 59.5)), lambda i: [])
for t in range(5):
    image, depth = numpy.zeros((120, 160, 3), "uint8"), numpy.ones((120, 160), "float32")
    slam.feed(image, depth, t, order="bgr")
print("fed")
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True,
                          timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "fed\n", "")


def test_masks_of_results_outlive_the_system(small_camera, noise):
    with dkp_slam.Slam(dkp_slam.Config(small_camera), detector=None) as slam:
        slam.feed(*noise(), 0.0)
    mask = slam.results()[0].mask
    slam.close()
    del slam
    gc.collect()
    assert not mask.any() and not mask.flags.writeable


def test_results_taken_too_late_have_lost_their_masks(small_camera, noise):
    image, depth = noise()
    with dkp_slam.Slam(dkp_slam.Config(small_camera), detector=None) as slam:
        for i in range(70):
            slam.feed(image, depth, float(i))
    results = slam.results()
    assert len(results) == 70 and results[69].mask.shape == (120, 160)
    with pytest.raises(dkp_slam.Error, match="take results after every feed"):
        results[0].mask
