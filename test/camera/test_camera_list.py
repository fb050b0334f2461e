"""The list of cameras: the parameters that their nodes get, and the lists that are refused."""

import pathlib
import threading

import pytest
import rospy
import yaml

from robot_vision.camera.camera_list import parse_cameras
from robot_vision.camera.camera_loader import CameraLoader

ROOT = pathlib.Path(__file__).resolve().parents[2]


def test_each_camera_has_its_own_parameters():
    entries = [
        {"name": "front", "source": "/dev/video0", "rate": 15, "image_width": 320},
        {"name": "rear", "source": "a.mp4", "camera_frame_id": "eye", "framerate": 5.0},
    ]
    before = [dict(entry) for entry in entries]
    assert parse_cameras(entries) == {
        "front": {
            "camera_name": "front",
            "camera_frame_id": "front",
            "source": "/dev/video0",
            "framerate": 15,
            "image_width": 320,
        },
        "rear": {
            "camera_name": "rear",
            "camera_frame_id": "eye",
            "source": "a.mp4",
            "framerate": 5.0,
        },
    }
    assert entries == before


def test_the_example_in_config_is_valid():
    values = yaml.safe_load((ROOT / "config" / "cameras.yaml").read_text())
    assert list(parse_cameras(values["cameras"])) == ["front", "rear"]


@pytest.mark.parametrize(
    "values, reason",
    [
        (None, "cameras is None, must be a list of maps with name and source"),
        ([], r"cameras is \[\], must be a list"),
        ("front", "cameras is 'front', must be a list"),
        (["front"], r"cameras\[0\] is 'front', must be a map"),
        ([{"source": "a"}], r"cameras\[0\]: name is None, must be letters, digits and _"),
        ([{"name": "a/b", "source": "a"}], r"cameras\[0\]: name is 'a/b', must be letters"),
        ([{"name": 1, "source": "a"}], r"cameras\[0\]: name is 1, must be letters"),
        ([{"name": "a"}], r"cameras\[0\] \(a\): there is no source"),
        ([{"name": "a", "source": 12345}], r"\(a\): source is 12345, must be a string$"),
        ([{"name": "a", "source": None}], r"\(a\): source is None, must be a string$"),
        ([{"name": "a", "source": ["b"] * 99}], r"\(a\): source is .{97}\.\.\., must be a string$"),
        ([{"name": "a", "source": "b"}] * 2, r"cameras\[1\]: the name a is there twice"),
        ([{"name": "a", "source": "b", "rate": 1, "framerate": 1}], "one is enough"),
    ],
)
def test_other_values_are_refused(values, reason):
    with pytest.raises(ValueError, match=reason):
        parse_cameras(values)


def test_a_loader_whose_node_was_shut_down_while_it_started_ends(monkeypatch):
    for flag in ("_in_shutdown", "_shutdown_flag"):
        monkeypatch.setattr(rospy.core, flag, True)
    monkeypatch.setattr(CameraLoader, "_work", lambda _: None)
    loader = object.__new__(CameraLoader)
    loader._done = threading.Event()  # which _end() would set, had it been called
    run = threading.Thread(target=loader.run, daemon=True)
    run.start()
    run.join(30.0)
    assert not run.is_alive()
    loader._done.set()
