"""Config: the options of `dkp-slam config`, by their names."""

import pytest

import dkp_slam


@pytest.fixture
def config(small_camera):
    return dkp_slam.Config(small_camera)


def test_options_have_their_types(config):
    assert config["mode"] == "dkp+" and config["realtime"] is False
    assert config["tracking.local_keyframes"] == 40
    assert isinstance(config["tracking.keyframe_share"], float)
    config["tracking.local_keyframes"] = 60
    config["tracking.keyframe_share"] = 0.5
    config["close_loops"] = False
    config["mode"] = "dk"
    assert (config["tracking.local_keyframes"], config["tracking.keyframe_share"]) == (60, 0.5)
    assert (config["close_loops"], config["mode"]) == (False, "dk")
    assert config.copy()["mode"] == "dk" and config.camera.width == 160


def test_options_are_a_mapping(config):
    names = list(config)
    assert len(config) == len(names) > 200 and "seed" in config and "seeds" not in config
    assert dict(config)["seed"] == 1
    assert "[pixels]" in config.describe("tracking.motion_radius")


def test_constructor_takes_options(small_camera):
    options = {"tracking.local_keyframes": 50, "seed": 7}
    config = dkp_slam.Config(small_camera, mode="off", realtime=True, options=options)
    assert (config["mode"], config["realtime"], config["seed"]) == ("off", True, 7)


def test_wrong_names_and_values_are_told(config):
    with pytest.raises(KeyError, match="there is no option local_keyframes; did you mean "
                                       "tracking.local_keyframes?"):
        config["local_keyframes"] = 3
    with pytest.raises(KeyError):
        config["nothing"]
    with pytest.raises(ValueError, match="tracking.local_keyframes is '0'; it must be a whole"):
        config["tracking.local_keyframes"] = 0
    with pytest.raises(ValueError, match="mode is 'all'; it must be one of off, "):
        dkp_slam.Config(config.camera, mode="all")
    with pytest.raises(TypeError, match="seed must be a number, a bool or a text, not list"):
        config["seed"] = []
    assert config["tracking.local_keyframes"] == 40


def test_options_that_do_not_go_together_are_told(config, small_camera):
    config["dynamics.compensation.continue_score"] = 0.9
    with pytest.raises(ValueError, match="continue_score is 0.9; it must be at most"):
        config.check()
    with pytest.raises(ValueError, match="continue_score"):
        dkp_slam.Slam(config)


def test_files(config, program, tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("mode: d\norb:\n  features: 1500\n")
    config.read(file)
    assert (config["mode"], config["orb.features"]) == ("d", 1500)
    printed = program("config", "--config", file)
    assert printed.endswith(config.to_yaml())
    file.write_text("seed: 3\nmode: nothing\n")
    with pytest.raises(dkp_slam.Error, match="mine.yaml:2: mode is 'nothing'"):
        config.read(file)
    assert config["seed"] == 1
