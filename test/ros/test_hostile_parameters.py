"""Every parameter of every Python node with invalid values: one line reports each."""

import importlib
import os
import pathlib
import re
from types import SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest
import rospy
from fake_params import use_params
from hostile import DEEP, INF, NAN, is_flag, is_number
from std_msgs.msg import Header

from robot_vision.camera.camera_list import parse_cameras
from robot_vision.color.named_colors import NamedColors
from robot_vision.dashboard import dashboard
from robot_vision.dnn import check_for_objects
from robot_vision.recognition import recognize_action
from robot_vision.ros import context, live_params, params, transport
from robot_vision.tags.bundle_files import parse_bundles
from robot_vision.tags.tag_layout import TagLayout
from robot_vision.viewer import simple_camera_view_node
from robot_vision.viewer.simple_camera_view_node import CameraView

ROOT = pathlib.Path(__file__).resolve().parents[2]
HOSTILE = {
    "a map": {"a": {"b": 1}},
    "a long map": {"a": "x" * 100000},
    "a list": [1, 2],
    "a deep list": DEEP,
    "NaN": NAN,
    "infinity": INF,
    "minus infinity": -INF,
    "a huge number": 1e300,
    "a huge integer": 2**31 - 1,
    "a long text": "x" * 1000000,
    "a text for terminals": "\n\x9b2J\u202e",
    "bytes": b"\x00\xff",
    "nothing": None,
    "true": True,
}
NOWHERE = {"NaN", "infinity", "minus infinity", "a huge number"}
LONGEST = 500  # characters, of a line


def config_of(node):
    name = "".join(word.capitalize() for word in node.split("_"))
    return importlib.import_module(f"robot_vision.cfg.{name}Config")


def python_nodes():
    """The nodes in Python that have a .cfg file."""
    for path in sorted((ROOT / "config").glob("*.yaml")):
        names = (f"*/{path.stem}.py", f"*/{path.stem}_node.py")
        config = "".join(word.capitalize() for word in path.stem.split("_"))
        if not (ROOT / f"cfg/{config}.cfg").exists():
            continue
        if any(any((ROOT / "src/robot_vision").glob(name)) for name in names):
            yield path.stem


CONFIGS = {node: config_of(node) for node in python_nodes()}
assert len(CONFIGS) >= 9, "nodes with parameters are not found"


class Server:
    """Starts like dynamic_reconfigure's server, but has no services."""

    def __init__(self, _config_type, callback, values):
        callback(dict(values), 0)


server_values = {}


@pytest.fixture
def at_start(monkeypatch):
    """at_start(values) fakes a parameter server with these values, with names such as ~gain."""
    monkeypatch.setattr(live_params, "_Server", Server)
    monkeypatch.setattr(rospy, "Service", lambda *_: None)
    use_params(monkeypatch, server_values)

    def start(values):
        server_values.clear()
        server_values.update(values)

    return start


def refused(name, work):
    """The error: one line that must name the parameter, its value and the possible values."""
    with pytest.raises(ValueError) as error:
        work()
    line = str(error.value)
    assert re.match(rf"{name}(\[0\]|/\w+|: tag family)? is .*, must be ", line), line[:LONGEST]
    assert line.isprintable() and len(line) <= LONGEST, line[:LONGEST]
    return line


def fits(parameter, value):
    """True if a value has the parameter's type and is in its range."""
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
            live_params.LiveParams(config, lambda _: None)
        else:
            refused(name, lambda: live_params.LiveParams(CONFIGS[node], lambda _: None))


@pytest.mark.parametrize("node", CONFIGS)
def test_live_numbers(at_start, monkeypatch, node):
    """Numbers that dynamic_reconfigure lets pass: the old values stay, with a line that says so."""
    told = []
    monkeypatch.setattr(rospy, "logwarn", lambda text, error: told.append(text % error))
    at_start({})
    config = CONFIGS[node]
    live = live_params.LiveParams(config, lambda _: None)
    for parameter in config.config_description["parameters"]:
        for what in NOWHERE:
            if parameter["type"] == "double":
                values = {**config.defaults, parameter["name"]: HOSTILE[what]}
                assert live._change(values, 0) == config.defaults
                assert f": {parameter['name']} is " in told.pop() and not told


def is_name(value):
    return type(value) is str and value.isprintable() and 0 < len(value) <= 255


# The values that parameters read only at start can have, by the class of the node. The lists
# and maps among them have their own test.
IMAGE_NODE = {
    "always_subscribe": is_flag,
    "threads": lambda value: type(value) is int and 0 <= value <= 256,
    "image_transport": lambda value: type(value) is str,  # image_transport checks the name
}
AT_START = {
    "ball.ball_tracker.BallTracker": {
        "ball_diameter": is_number(0.0, 100.0),
        "ball_frame_id": is_name,
        **IMAGE_NODE,
    },
    "tags.apriltag_detector.ApriltagDetector": {
        "families": lambda _: False,
        "tag_size": lambda value: is_number(0.0, 100.0)(value) and value > 0.0,
        "standalone_tags": lambda _: False,
        "tag_bundles": lambda _: False,
        "depth_image_transport": IMAGE_NODE["image_transport"],
        "diagnostic_period": is_number(0.01, 3600.0),
        **IMAGE_NODE,
    },
    "faces.face_recognizer.FaceRecognizer": {
        "gallery": lambda value: type(value) is str and len(value) < 256,
        **IMAGE_NODE,
    },
    "color.hsv_tracker.HsvTracker": {
        "colors": lambda value: value is None,
        "more_colors": lambda value: value == {},
        **IMAGE_NODE,
    },
    "line.line_follower.LineFollower": {"enabled": is_flag, **IMAGE_NODE},
    "faces.face_detector.FaceDetector": IMAGE_NODE,
    "motion.motion_detector.MotionDetector": IMAGE_NODE,
    "lanes.lane_detector.LaneDetector": IMAGE_NODE,
    "calibration.cube_overlay.CubeOverlay": {"board_frame_id": is_name, **IMAGE_NODE},
    "tracking.object_tracker.ObjectTracker": IMAGE_NODE,
    "tracking.window_tracker.WindowTracker": IMAGE_NODE,
    "histogram.histogram.Histogram": IMAGE_NODE,
    "codes.code_reader.CodeReader": IMAGE_NODE,
    "hough.hough.Hough": IMAGE_NODE,
    "contours.contours.Contours": IMAGE_NODE,
    "features.features.Features": IMAGE_NODE,
    "templates.template_matcher.TemplateMatcher": IMAGE_NODE,
    "people.people_detector.PeopleDetector": IMAGE_NODE,
    "depth.detections_3d.Detections3d": {
        "frame_prefix": lambda value: value == "" or is_name(value),
        **IMAGE_NODE,
    },
    "recognition.object_recognizer.ObjectRecognizer": {
        "database": lambda _: False,
        "methods": lambda value: value == "",
        "frame_prefix": lambda value: value == "" or is_name(value),
        "depth_image_transport": IMAGE_NODE["image_transport"],
        "ork_names": is_flag,
        "diagnostic_period": is_number(0.01, 3600.0),
        **IMAGE_NODE,
    },
    "dnn.object_detector.ObjectDetector": {
        "model": lambda value: value == "",
        "weights": lambda value: value == "",
        "class_names": lambda value: value == "",
        "backend": lambda value: value in ("auto", "opencv"),
        "head": lambda value: value == "auto",
        "task": lambda value: value == "auto",
        "input_width": lambda value: type(value) is int and value == 0,
        "input_height": lambda value: type(value) is int and value == 0,
        "fit": lambda value: value == "auto",
        "pad": lambda value: type(value) is int and -1 <= value <= 255,
        "order": lambda value: value == "auto",
        "mean": lambda value: value == [],
        "std": lambda value: value == [],
        "affinity": lambda value: value in ([], [0]),
        "background": is_flag,
        "darknet_names": is_flag,
        "diagnostic_period": is_number(0.01, 3600.0),
        **IMAGE_NODE,
    },
    "depth.tabletop.Tabletop": {"table_frame_id": is_name, **IMAGE_NODE},
    "viewer.simple_camera_view_node.CameraView": {
        "autosize": is_flag,
        "image_transport": IMAGE_NODE["image_transport"],
    },
    "camera.camera_loader.CameraLoader": {"manager": is_name},
    "demo.demo_status.DemoStatus": {
        **dict.fromkeys(("view", "synthetic", "basics", "depth", "recognition"), is_flag),
        "dashboard": is_flag,
        "period": is_number(0.0, 3600.0),
    },
    "dashboard.dashboard.Dashboard": {
        "address": lambda _: False,
        "port": lambda _: False,
        "port_tries": lambda _: False,
        "token": lambda _: False,
        "view_token": lambda _: False,
        "hosts": lambda _: False,
        "open_streams": is_flag,
        "foxglove": is_flag,
        "foxglove_origins": lambda _: False,
        "open_browser": is_flag,
        "max_clients": lambda _: False,
        "quality": lambda _: False,
        "bag_folder": lambda _: False,
        "max_bag_size": lambda _: False,
    },
}
# Parameters that are read later, when values are saved or periodically, only make a difference with
# a database, or are a command's, have their own tests.
LATER = {"config_file", "cameras", "needs_models", "set_by_file"}
# These read all live parameters, those of a color, all of a camera, and what others ask for.
ASK_BY_VARIABLE = {
    "params.py",
    "live_params.py",
    "named_colors.py",
    "camera_loader.py",
    "context.py",
}


@pytest.fixture
def alone(at_start, monkeypatch, tmp_path):
    """Makes nodes without ROS, windows and threads, so that they only read their parameters."""
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    nothing = MagicMock()
    monkeypatch.setattr(rospy, "core", nothing)
    for name in ("Publisher", "Subscriber", "on_shutdown", "get_name", "logwarn", "loginfo"):
        monkeypatch.setattr(rospy, name, nothing)
    monkeypatch.setattr(transport, "node_images", lambda: nothing)
    for module in (recognize_action, check_for_objects):
        monkeypatch.setattr(module, "action_server", nothing)
    monkeypatch.setattr(context.NodeContext, "thread", nothing)
    for name in ("Server", "bind", "make_features", "open_browser"):
        monkeypatch.setattr(dashboard, name, nothing)
    monkeypatch.setattr(simple_camera_view_node, "Window", nothing)
    monkeypatch.setattr(simple_camera_view_node, "require_display", nothing)
    return at_start


def node_class(of):
    module, _, name = of.rpartition(".")
    return getattr(importlib.import_module("robot_vision." + module), name)


@pytest.mark.parametrize("value", [NAN, INF, -INF])
def test_a_number_without_a_range_is_finite_at_least(at_start, value):
    at_start({"~size": value})
    with pytest.raises(ValueError, match=f"size is {value}, must be finite"):
        params.read_param("size", 1.0)


@pytest.mark.parametrize("of", AT_START)
def test_parameters_that_are_read_only_at_start(alone, of):
    """Each node is made with each value: it accepts valid ones and reports others in a line."""
    alone({})
    node_class(of)()
    for name, can_be in AT_START[of].items():
        for value in HOSTILE.values():
            alone({"~" + name: value})
            if can_be(value):
                node_class(of)()
            else:
                refused(name, node_class(of))


@pytest.mark.parametrize("what", HOSTILE)
def test_an_unsuitable_file_for_saving_is_reported_in_one_line(at_start, monkeypatch, what):
    monkeypatch.setattr(rospy, "logerr", lambda *_: None)
    at_start({})
    live = live_params.LiveParams(CONFIGS["code_reader"], lambda _: None)
    values = [HOSTILE[what]]
    if isinstance(values[0], str):
        values.append("/" + values[0] + "/x.yaml")
    for value in values:
        rospy.set_param("~config_file", value)
        answer = live._on_save(None)
        assert not answer.success and re.search("config_file|x.yaml", answer.message)
        assert answer.message.isprintable() and len(answer.message) <= 1200, answer.message


def node_of(of):
    """The name of a class's node, as CONFIGS has it."""
    return of.split(".")[1].replace("_node", "")


@pytest.mark.parametrize("of", [of for of in AT_START if node_of(of) in CONFIGS])
def test_live_texts_at_start(alone, of):
    """The node checks the content of texts."""
    for parameter in CONFIGS[node_of(of)].config_description["parameters"]:
        for what in ("a long text", "a text for terminals"):
            if parameter["type"] == "str":
                alone({"~" + parameter["name"]: HOSTILE[what]})
                accepted_or_told(parameter["name"], node_class(of), what)


def test_all_parameters_are_tested():
    """The parameters are found where the sources read the parameter server."""
    named, others = set(), set()
    for path in (ROOT / "src" / "robot_vision").rglob("*.py"):
        for name in re.findall(
            r"\b(?:read_(?:param|name|any|secret)|get_param)\(\s*([^\s,)]+)", path.read_text()
        ):
            literal = re.fullmatch(r'"~?(\w+)"', name)
            if literal:
                named.add(literal.group(1))
            elif path.name not in ASK_BY_VARIABLE:
                others.add((path.name, name))
    assert named == set().union(*AT_START.values()) | LATER
    assert not others


@pytest.mark.parametrize("what", HOSTILE)
def test_lists_and_maps(at_start, what):
    """Invalid values replace the whole parameter and each value in it; the line names the place."""
    value = HOSTILE[what]
    tag = {"id": 1, "size": 0.1, "x": 0.0, "qw": 1.0, "shift_noise": 0.0, "turn_noise": 0.0}
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
        ("standalone_tags[0]", lambda: TagLayout("tag36h11", 0.1, [{"id": 1, "name": value}])),
        ("tag_bundles[0]", lambda: parse_bundles([{"name": value, "layout": [{"id": -1}]}])),
        ("famil", lambda: TagLayout(value, 0.1)),
    ]
    for where, attempt in attempts:
        accepted_or_told(where, attempt, what)
    for colors in (
        value,
        {"red": value},
        {str(value): 1},
        {"red": {"low": value, "high": [1, 2, 3]}},
    ):
        for name in ("colors", "more_colors"):
            at_start({f"~{name}": colors})
            accepted_or_told("colors", NamedColors, what)
    at_start({"~colors": {"red": {"low": [0, 0, value], "high": [1, 2, 3]}}})
    accepted_or_told("colors/red", NamedColors, what)


def accepted_or_told(where, attempt, what):
    """Some values are valid for some of the parameters, but those of NOWHERE for none."""
    try:
        attempt()
        assert what not in NOWHERE, where
    except ValueError as error:
        line = str(error)
        assert where in line and line.isprintable() and len(line) <= LONGEST, line[:LONGEST]


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
def test_an_unsuitable_folder_for_saving_is_an_error_but_not_fatal(
    monkeypatch, tmp_path, folder, why
):
    (tmp_path / "file").touch()
    os.mkfifo(str(tmp_path / "pipe"))
    told = []
    monkeypatch.setattr(rospy, "logerr", lambda text, *values: told.append(text % values))
    monkeypatch.chdir(tmp_path)
    view = viewer()
    view._configure(saving_in(folder.format(tmp_path)))
    view._save()
    (line,) = told
    assert line.startswith("no image saved in /") and line.endswith(": " + why)
    assert sorted(os.listdir(tmp_path)) == ["file", "pipe"]


def test_a_folder_with_an_impossible_character_is_refused():
    refused("save_folder", lambda: viewer()._configure(saving_in("a\0b")))


def saving_in(folder):
    """The viewer's live parameters."""
    return {**CONFIGS["simple_camera_view"].defaults, "save_folder": folder}


def viewer():
    """A viewer without a window that shows an image with the latest possible stamp."""
    view = object.__new__(CameraView)
    header = Header(stamp=rospy.Time(2**32 - 1, 999999999))
    view._shown = SimpleNamespace(image=np.zeros((2, 2, 3), np.uint8), header=header)
    return view
