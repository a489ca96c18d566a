"""Bad inputs: each is named, with what to do, and changes nothing."""

import numpy as np
import pytest

import dkp_slam

COLOUR = np.zeros((120, 160, 3), np.uint8)
DEPTH = np.ones((120, 160), np.float32)


@pytest.fixture
def slam(small_camera):
    slam = dkp_slam.Slam(dkp_slam.Config(small_camera), detector=None)
    slam.feed(COLOUR, DEPTH, 1.0)
    yield slam
    slam.feed(COLOUR, DEPTH, 2.0)  # it goes on
    slam.finish()
    assert slam.counters.answered == 2


@pytest.mark.parametrize("change, told", [
    ({"rgb": COLOUR.astype(np.float32)}, "rgb is float32 of shape .* must be uint8 of shape"),
    ({"rgb": COLOUR[..., 0]}, r"rgb is uint8 of shape \(120, 160\)"),
    ({"rgb": np.zeros((120, 160, 4), np.uint8)}, r"rgb is uint8 of shape \(120, 160, 4\)"),
    ({"rgb": COLOUR[..., ::-1]}, r"do not lie side by side .* pass numpy.ascontiguousarray\(rgb\)"),
    ({"rgb": COLOUR[::-1]}, r"pass numpy.ascontiguousarray\(rgb\)"),
    ({"rgb": np.zeros((240, 320, 3), np.uint8)}, "rgb is 320 x 240 pixels, the camera 160 x 120"),
    ({"depth": DEPTH.astype(np.float64)}, r"depth.astype\(numpy.float32\)"),
    ({"depth": DEPTH.T}, "depth"),
    ({"depth": DEPTH[:, ::2]}, r"pass numpy.ascontiguousarray\(depth\)"),
    ({"depth": DEPTH[:60]}, "depth is 160 x 60 pixels"),
    ({"depth": DEPTH.astype(np.uint16), "depth_scale": 0.0}, "depth_scale is 0"),
    ({"t": float("nan")}, "t is nan; give the image's time in seconds"),
    ({"t": 1.0}, "t is 1.000000, not after the last frame's 1.000000"),
    ({"mask": COLOUR[..., 0]}, 'mode dkp. does not use masks; make the Config with mode="masks"'),
    ({"order": "grb"}, "order is 'grb'; it must be rgb or bgr"),
    ({"depth_delay": float("inf")}, "depth_delay"),
])
def test_feed_refuses(slam, change, told):
    with pytest.raises(ValueError, match=told):
        slam.feed(**{"rgb": COLOUR, "depth": DEPTH, "t": 1.5, **change})


def test_what_is_no_array_is_refused(slam):
    with pytest.raises(TypeError, match="rgb is a list; give a numpy array"):
        slam.feed([1, 2, 3], DEPTH, 1.5)


def test_cropped_and_read_only_images_are_taken(small_camera):
    wide = np.zeros((140, 200, 3), np.uint8)[10:130, 20:180]
    depth = np.ones((120, 160), np.float32)
    depth[0] = np.nan  # unknown
    depth.flags.writeable = False
    with dkp_slam.Slam(dkp_slam.Config(small_camera), detector=None) as slam:
        slam.feed(wide, depth, 0.0)
        slam.feed(wide, depth, 1.0, order="bgr")
    assert len(slam.results()) == 2


def test_order_of_calls(small_camera):
    slam = dkp_slam.Slam(dkp_slam.Config(small_camera), detector=None)
    with pytest.raises(ValueError, match="there after finish"):
        slam.trajectory
    slam.finish()
    with pytest.raises(dkp_slam.Error, match="after finish"):
        slam.feed(COLOUR, DEPTH, 0.0)
    assert len(slam.trajectory.timestamps) == 0 and slam.wait() is None
    slam.close()
    with pytest.raises(ValueError, match="closed"):
        slam.poll()


@pytest.mark.parametrize("detector, error, told", [
    ("yolo", ValueError, "detector is 'yolo'; it must be one of"),
    (3, TypeError, "detector is a int"),
])
def test_detectors_that_are_none(small_camera, detector, error, told):
    with pytest.raises(error, match=told):
        dkp_slam.Slam(dkp_slam.Config(small_camera), detector)


@pytest.mark.parametrize("arguments, told", [
    (((0, 0, 0, 5), "person", 0.5), "the last two above 0"),
    (((0, 0, float("nan"), 5), "person", 0.5), "not finite"),
    (((0, 0, 5, 5), "persona", 0.5), "label is 'persona'"),
    (((0, 0, 5, 5), 80, 0.5), "label is 80"),
    (((0, 0, 5, 5), "person", 1.5), "score is 1.5"),
    (((0, 0, 5, 5), "person", 0.5, np.zeros((9, 9, 3))), "mask is float64 of shape"),
    (((0, 0, 5, 5), "person", 0.5, None, 11), "weight is 11"),
])
def test_detections_that_are_none(arguments, told):
    with pytest.raises(ValueError, match=told):
        dkp_slam.Detection(*arguments)


def test_detection():
    mask = np.zeros((120, 160), bool)
    d = dkp_slam.Detection(box=(1, 2, 3, 4), label="person", score=0.5, mask=mask)
    assert d.box == (1, 2, 3, 4) and d.label == "person" and d.class_id == 0 and d.weight == 10
    assert d.mask is mask
    assert dkp_slam.Detection((0, 0, 1, 1), "moving", 1).class_id == -2


def test_detection_clipped_and_with_a_silhouette(small_camera, noise):
    mask = np.zeros((120, 160), bool)
    mask[40:80, 50:70] = True
    wanted = [dkp_slam.Detection((-20, 10, 100, 100), "person", 0.9),
              dkp_slam.Detection((45.5, 30.2, 40, 60), "dog", 0.8, mask),
              dkp_slam.Detection((500, 500, 10, 10), "person", 0.9)]
    with dkp_slam.Slam(dkp_slam.Config(small_camera), lambda image: wanted) as slam:
        slam.feed(*noise(), 0.0)
    first, second = slam.results()[0].detections
    assert first.box == (0, 10, 80, 100) and first.mask is None
    assert second.label == "dog" and np.array_equal(second.mask > 0, mask)


def test_cameras_that_are_none():
    with pytest.raises(ValueError, match="Camera: "):
        dkp_slam.Camera(160, 120, -1.0, 130.0, 79.5, 59.5)
    with pytest.raises(dkp_slam.Error, match="nowhere.yaml: no such camera file"):
        dkp_slam.Camera.load("nowhere.yaml")


def test_shipped_cameras():
    camera = dkp_slam.Camera.load("fr1")
    assert camera.depth_delay == -0.02 and camera.depth_bias == 0.0
    assert len(camera.depth_distortion) == 9 and camera.depth_distortion[0] == -0.00823
    assert (camera.width, camera.height) == (640, 480) and camera.readout > 0
    assert camera.matrix[0, 0] == camera.fx and len(camera.distortion) == 5
    for name in "fr2", "fr3", "bonn":
        dkp_slam.Camera.load(name)


def test_folders_that_are_none(tmp_path):
    with pytest.raises(dkp_slam.Error, match="no such folder"):
        dkp_slam.read_tum_folder(tmp_path / "nowhere")
    with pytest.raises(dkp_slam.Error, match="pass camera="):
        dkp_slam.read_tum_folder(tmp_path)
