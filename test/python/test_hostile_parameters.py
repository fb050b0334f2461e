"""Every parameter of every Python node, with values that it cannot have: one line says so."""

import importlib
import os
from types import SimpleNamespace

import numpy as np
import pytest
import rospy
from std_msgs.msg import Header
from test_parameter_sources import PYTHON

from robot_vision.bundle_files import parse_bundles
from robot_vision.camera_list import parse_cameras
from robot_vision.nodes import params
from robot_vision.nodes.camera_view import CameraView
from robot_vision.nodes.colors import NamedColors
from robot_vision.nodes.image_node import read_threads
from robot_vision.tag_layout import TagLayout

NAN, INF = float("nan"), float("inf")
DEEP = []
for _ in range(50):
    DEEP = [DEEP]
HOSTILE = {
    "a map": {"a": {"b": 1}},
    "a list": [1, 2],
    "a deep list": DEEP,
    "NaN": NAN,
    "infinity": INF,
    "minus infinity": -INF,
    "a huge number": 1e300,
    "a huge integer": 2**31 - 1,
    "a long text": "x" * 1000000,
    "bytes": b"\x00\xff",
    "nothing": None,
    "true": True,
}
LONGEST = 400  # characters of a line


def config_of(node):
    name = "".join(word.capitalize() for word in node.split("_"))
    return importlib.import_module(f"robot_vision.cfg.{name}Config")


CONFIGS = {node: config_of(node) for node in PYTHON}


class Server:
    """As dynamic_reconfigure's at its start, but for the services."""

    def __init__(self, config_type, callback):
        config = dict(config_type.defaults)
        config.update({name[1:]: value for name, value in server_values.items()})
        callback(config, 0)


server_values = {}


@pytest.fixture
def at_start(monkeypatch):
    """at_start(values): makes a parameter server that has these, with names such as ~gain."""
    monkeypatch.setattr(params, "_Server", Server)
    monkeypatch.setattr(rospy, "Service", lambda *_: None)
    monkeypatch.setattr(rospy, "get_param", lambda name, default: server_values.get(name, default))
    monkeypatch.setattr(rospy, "has_param", lambda name: name in server_values)
    monkeypatch.setattr(rospy, "delete_param", server_values.pop)
    monkeypatch.setattr(rospy, "set_param", server_values.__setitem__)

    def start(values):
        server_values.clear()
        server_values.update(values)

    return start


def refused(name, work):
    """The error, which must be a line that names the parameter, its value and what it can be."""
    with pytest.raises(ValueError) as error:
        work()
    line = str(error.value)
    assert line.startswith(f"{name} is ") and ", must be " in line, line[:LONGEST]
    assert "\n" not in line and len(line) <= LONGEST
    return line


def fits(parameter, value):
    """Whether a value is of the parameter's type and in its range."""
    kind = {"double": float, "int": int, "str": str, "bool": bool}[parameter["type"]]
    if type(value) is not kind and not (kind is float and type(value) is int):
        return False
    return kind in (str, bool) or parameter["min"] <= value <= parameter["max"]


@pytest.mark.parametrize("what", HOSTILE)
@pytest.mark.parametrize("node", CONFIGS)
def test_live_parameters_at_start(at_start, node, what):
    config, value = CONFIGS[node], HOSTILE[what]
    for parameter in config.config_description["parameters"]:
        name = parameter["name"]
        at_start({"~" + name: value})
        if fits(parameter, value):
            params.LiveParams(config, lambda _: None)
        else:
            refused(name, lambda: params.LiveParams(CONFIGS[node], lambda _: None))


@pytest.mark.parametrize("what", set(HOSTILE) - {"a huge integer"})
def test_parameters_that_only_are_read_at_start(at_start, what):
    defaults = {"threads": 1, "tag_size": 0.1, "always_subscribe": False, "gallery": ""}
    for name, default in defaults.items():
        at_start({"~" + name: HOSTILE[what]})
        kind = type(default)
        if type(HOSTILE[what]) is kind:
            assert params.read_param(name, default) is HOSTILE[what] or kind is float
        else:
            refused(name, lambda: params.read_param(name, default))  # noqa: B023
    at_start({"~threads": HOSTILE[what]})
    refused("threads", read_threads)


@pytest.mark.parametrize("what", HOSTILE)
def test_lists_and_maps(at_start, what):
    """At their top, and in the place of each value in them; what names the place is in the line."""
    value = HOSTILE[what]
    tag = {"id": 1, "size": 0.1, "x": 0.0, "qw": 1.0}
    attempts = [
        ("cameras", lambda: parse_cameras(value)),
        ("cameras[0]", lambda: parse_cameras([value])),
        ("cameras[0]", lambda: parse_cameras([{"name": value, "source": "synthetic"}])),
        ("tag_bundles", lambda: parse_bundles(value)),
        ("tag_bundles[0]", lambda: parse_bundles([value])),
        ("layout", lambda: parse_bundles([{"layout": value}])),
        ("layout", lambda: parse_bundles([{"layout": [value]}])),
        *(
            ("bundle", lambda key=key: parse_bundles([{"layout": [{**tag, key: value}]}]))
            for key in tag
        ),
        ("tag_size", lambda: TagLayout("tag36h11", value)),
        ("standalone_tags", lambda: TagLayout("tag36h11", 0.1, value)),
        ("standalone_tags[0]", lambda: TagLayout("tag36h11", 0.1, [value])),
        ("standalone_tags[0]", lambda: TagLayout("tag36h11", 0.1, [{"id": value}])),
        ("standalone_tags[0]", lambda: TagLayout("tag36h11", 0.1, [{"ids": value}])),
        ("standalone_tags[0]", lambda: TagLayout("tag36h11", 0.1, [{"id": 1, "size": value}])),
        ("standalone_tags[0]", lambda: TagLayout("tag36h11", 0.1, [{"id": 1, "family": value}])),
        ("famil", lambda: TagLayout(value, 0.1)),
    ]
    for where, attempt in attempts:
        accepted_or_told(where, attempt)
    for colors in (value, {"red": value}, {"red": {"low": value, "high": [1, 2, 3]}}):
        at_start({"~colors": colors})
        accepted_or_told("colors", NamedColors)
    at_start({"~colors": {"red": {"low": [0, 0, value], "high": [1, 2, 3]}}})
    accepted_or_told("colors/red", NamedColors)


def accepted_or_told(where, attempt):
    try:
        attempt()
    except ValueError as error:
        line = str(error)
        assert where in line and "\n" not in line and len(line) <= LONGEST, line[:LONGEST]


@pytest.mark.parametrize(
    "folder, why",
    [
        ("{}/none", "No such file or directory"),
        ("{}/file", "Not a directory"),
        ("{}/pipe", "Not a directory"),
        ("{}/" + "x" * 5000, "File name too long"),
        ("~nobody_of_this_name/x", "No such file or directory"),
    ],
)
def test_a_folder_that_nothing_can_be_saved_in_is_an_error_and_no_end(
    monkeypatch, tmp_path, folder, why
):
    (tmp_path / "file").touch()
    os.mkfifo(str(tmp_path / "pipe"))
    told = []
    monkeypatch.setattr(rospy, "logerr", lambda text, *values: told.append(text % values))
    monkeypatch.chdir(tmp_path)
    view = viewer()
    view._configure({"save_folder": folder.format(tmp_path)})
    view._save()
    (line,) = told
    assert line.startswith("no picture saved in /") and line.endswith(": " + why)
    assert sorted(os.listdir(tmp_path)) == ["file", "pipe"]


def test_a_folder_with_a_letter_that_none_has_is_refused():
    refused("save_folder", lambda: viewer()._configure({"save_folder": "a\0b"}))


def viewer():
    """A viewer without a window that shows a picture of the latest stamp that there is."""
    view = object.__new__(CameraView)
    header = Header(stamp=rospy.Time(2**32 - 1, 999999999))
    view._shown = SimpleNamespace(image=np.zeros((2, 2, 3), np.uint8), header=header)
    return view
