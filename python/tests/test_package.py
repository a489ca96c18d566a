"""Stubs, docstrings, examples, the wheel."""

import ast
import inspect
import os
import pathlib
import re
import subprocess
import sys
import types

import numpy as np
import pytest

import dkp_slam
from dkp_slam import _core, _synth

SOURCE = pathlib.Path(os.environ["DKP_SLAM_SOURCE"])
BUILD = pathlib.Path(os.environ["DKP_SLAM_BUILD"])


def stub_of(module):
    """Per name, what the stub says: the arguments of a function, or the members of a class."""
    text = (SOURCE / "python/dkp_slam" / (module.__name__.split(".")[-1] + ".pyi")).read_text()
    stub = {}
    for node in ast.parse(text).body:
        if isinstance(node, ast.FunctionDef):
            stub[node.name] = arguments_of(node)
        elif isinstance(node, ast.ClassDef) and "TypedDict" not in map(ast.unparse, node.bases):
            members = {}
            for member in node.body:
                if isinstance(member, ast.FunctionDef):
                    names = [getattr(d, "id", "") for d in member.decorator_list]
                    members[member.name] = None if "property" in names else arguments_of(member)
                    # A setter comes after its property.
                    if any(isinstance(d, ast.Attribute) for d in member.decorator_list):
                        members[member.name] = None
            stub[node.name] = members
    return stub


def arguments_of(node):
    a = node.args
    plain, named = [x.arg for x in a.args], [x.arg for x in a.kwonlyargs]
    return [n for n in plain if n != "self"], named, len(a.defaults) + sum(
        d is not None for d in a.kw_defaults)


def arguments_told(function):
    """The same, of the first line of the docstring, where pybind11 writes it."""
    line = re.sub(r"<[^>]*>", "None", function.__doc__.splitlines()[0])
    return arguments_of(ast.parse(f"def {line}: ...").body[0])


@pytest.mark.parametrize("module", [_core, _synth], ids=["_core", "_synth"])
def test_stubs_say_what_there_is(module):
    stub = stub_of(module)
    there = {n: v for n, v in vars(module).items()
             if isinstance(v, (type, types.BuiltinFunctionType))}
    assert set(stub) == set(there)
    for name, expected in stub.items():
        if not isinstance(there[name], type):
            assert arguments_told(there[name]) == expected, name
            continue
        members = vars(there[name])
        public = {n for n in members if not n.startswith("_")}
        assert {n for n in expected if not n.startswith("_")} == public, name
        for member, arguments in expected.items():
            value = inspect.getattr_static(there[name], member)
            if arguments is None:
                assert isinstance(value, property), f"{name}.{member}"
            elif not member.startswith("__") or member in ("__init__", "__getitem__"):
                assert arguments_told(getattr(there[name], member)) == arguments, f"{name}.{member}"


def test_everything_public_is_documented():
    for name in dkp_slam.__all__:
        value = getattr(dkp_slam, name)
        assert value.__doc__, name
        for member, method in inspect.getmembers(value, inspect.isroutine):
            if not member.startswith("_") and isinstance(value, type) and name not in (
                    "Error", "Trajectory"):
                assert len(method.__doc__.strip().splitlines()) > 1, f"{name}.{member}"


def test_package_names_are_there():
    assert set(dkp_slam.__all__) <= set(dir(dkp_slam))
    project = (SOURCE / "CMakeLists.txt").read_text().split("project(")[1]
    assert dkp_slam.__version__ == re.search(r"VERSION (\S+)", project)[1]
    with pytest.raises(AttributeError):
        dkp_slam.nothing


def python(*arguments, **environment):
    env = {**os.environ, **environment}
    done = subprocess.run([sys.executable, *map(str, arguments)], capture_output=True, text=True,
                          timeout=120, check=False, env=env)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_example_plots(tmp_path, sequence):
    out = tmp_path / "room.png"
    told = python(SOURCE / "examples/python/room.py", "--sequence", sequence, "--out", out,
                  MPLBACKEND="Agg")
    assert "ATE" in told
    assert out.read_bytes().startswith(b"\x89PNG") and out.stat().st_size > 20_000


def test_own_detector_example(sequence):
    told = python(SOURCE / "examples/python/own_detector.py", sequence)
    assert "36 of 36 frames" in told


def test_ros2_example_without_its_messages():
    """It compiles, and what needs no ROS 2 does what it says; the rest is tested nowhere."""
    file = SOURCE / "examples/ros2/dkp_slam_node.py"
    example = {"__name__": "example"}
    exec(compile(file.read_text(), file, "exec"), example)
    rows = np.arange(2 * 12, dtype=np.uint8).reshape(2, 12)
    image = types.SimpleNamespace(encoding="rgb8", width=3, height=2, step=12, data=rows.tobytes())
    assert np.array_equal(example["array_of"](image), rows[:, :9].reshape(2, 3, 3))
    depth = np.arange(6, dtype=np.uint16).reshape(2, 3)
    image = types.SimpleNamespace(encoding="16UC1", width=3, height=2, step=6, data=depth.tobytes())
    assert np.array_equal(example["array_of"](image), depth)
    info = types.SimpleNamespace(width=320, height=240, d=[0.1], k=[260, 0, 159, 0, 261, 119, 0, 0, 1])
    camera = example["camera_of"](info)
    assert (camera.fx, camera.fy, camera.cx, camera.cy) == (260, 261, 159, 119)
    assert camera.distortion == (0.1, 0, 0, 0, 0) and camera.depth_scale == 1000.0
    # A metre ahead is x in ROS; a camera as it began looks along x, as its optical frame does there.
    pose = np.eye(4)
    pose[2, 3] = 1.0
    position, quaternion = example["position_and_quaternion"](pose)
    assert np.allclose(position, (1, 0, 0)) and np.allclose(quaternion, (-0.5, 0.5, -0.5, 0.5))
    half_a_turn = np.diag([1.0, -1.0, -1.0, 1.0])
    for turned in (half_a_turn, example["ROS_FROM_WORLD"].T @ half_a_turn):
        x, y, z, w = example["position_and_quaternion"](turned)[1]
        matrix = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                           [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                           [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
        assert np.allclose(matrix, (example["ROS_FROM_WORLD"] @ turned)[:3, :3], atol=1e-6)


def test_wheel(tmp_path):
    pytest.importorskip("wheel")
    pytest.importorskip("pip")
    pack = BUILD / "generated/wheel/pack.cmake"
    subprocess.run(["cmake", "-P", pack], check=True, capture_output=True)
    wheel, = BUILD.glob("dkp_slam-*.whl")
    python("-m", "pip", "install", "-q", "--no-index", "--no-deps", "--target", tmp_path, wheel)
    program = """
import dkp_slam
slam = dkp_slam.Slam(dkp_slam.Config(dkp_slam.Camera.load("fr1")), "motion")
slam.finish()
print(dkp_slam.__file__)
print("".join(l for l in open("/proc/self/maps") if "libdkp_slam" in l or "libonnx" in l))
dkp_slam.scenarios()
"""
    told = python("-c", program, PYTHONPATH=str(tmp_path), LD_LIBRARY_PATH="")
    assert told.startswith(str(tmp_path))
    loaded = set(re.findall(r"(/\S*(?:libdkp_slam|libonnx)\S*)", told))
    assert loaded and all(file.startswith(str(tmp_path)) for file in loaded), loaded
