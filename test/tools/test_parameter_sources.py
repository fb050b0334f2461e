"""One truth about parameters, told by the core, the .cfg files, config/*.yaml and README."""

import importlib
import pathlib
import re

import pytest
import yaml

import robot_vision as rv
from robot_vision.color.named_colors import DEFAULT, HIGH, LOW
from robot_vision.faces.face_detector import COURSE, PARAMS
from robot_vision.line.line_control import LineControlParams

ROOT = pathlib.Path(__file__).resolve().parents[2]
CORE = {
    "brightness": rv.BrightnessParams,
    "edge_detector": rv.EdgeParams,
    "camera": rv.CaptureParams,
}
# Nodes whose parameters the .cfg file declares, and nobody else.
PYTHON = (
    "hsv_tracker",
    "ball_tracker",
    "line_follower",
    "face_detector",
    "motion_detector",
    "object_tracker",
    "face_recognizer",
    "apriltag_detector",
    "code_reader",
    "simple_camera_view",
)
# What the launch files set otherwise: the course's node finds small faces only.
CONFIGURED = {("face_detector", "haar_maxSize"): "0"}
# Parameters of the nodes that the core knows nothing of: their C++ defaults.
OF_THE_NODES = {
    "camera": {
        "loop": "false",
        "keep_streaming": "false",
        "create_suspended": "false",
        "intrinsic_controls": "",
        "controls": "",
        "camera_name": "head_camera",
        "camera_frame_id": "head_camera",
        "camera_info_url": "",
        "output_encoding": "auto",
    },
    "hsv_tracker": {"colors": "blue: {low: [90, 50, 50], high: [120, 255, 255]}"},
    "ball_tracker": {"ball_diameter": "0", "ball_frame_id": "ball"},
    "line_follower": {},
    "face_detector": {},
    "motion_detector": {},
    "object_tracker": {},
    "face_recognizer": {"gallery": ""},
    "apriltag_detector": {
        "families": "tag36h11",
        "tag_size": "0.1",
        "standalone_tags": "",
        "tag_bundles": "",
    },
    "code_reader": {},
    "simple_camera_view": {"autosize": "true"},
    "all": {"config_file": ""},
    "all but the viewer": {"always_subscribe": "false", "diagnostic_period": "1"},
    "Python but the viewer": {"threads": "1"},
    "all but camera": {"image_transport": "raw"},
}


def readme_rows():
    """The README's table of parameters as {(node, parameter): row}."""
    lines = (ROOT / "README.md").read_text().splitlines()
    begin = lines.index("| node | parameter | type | default | range | unit | live | meaning |")
    names = [cell.strip() for cell in lines[begin].strip("|").split("|")]
    rows = {}
    for line in lines[begin + 2 :]:
        if not line.startswith("|"):
            break
        cells = [cell.strip() for cell in re.split(r"\|", line.strip("|"))]
        row = dict(zip(names, cells))
        rows[row["node"], row["parameter"].strip("`")] = row
    return rows


def cfg(node):
    """The parameter descriptions that the node's .cfg file generates, by name."""
    name = "".join(word.capitalize() for word in node.split("_"))
    module = importlib.import_module(f"robot_vision.cfg.{name}Config")
    return {p["name"]: p for p in module.config_description["parameters"]}


def core_defaults(node):
    params = CORE[node]()
    return {name: getattr(params, name) for name in dir(params) if not name.startswith("_")}


def text(value):
    """A value as the README writes it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float)):
        return f"{value:.0f}" if abs(value) >= 1e5 else f"{value:g}"
    return value


@pytest.mark.parametrize("node", CORE)
def test_cfg_defaults_equal_the_core_s(node):
    core = core_defaults(node)
    for name, description in cfg(node).items():
        if name not in OF_THE_NODES.get(node, {}):
            assert core[name] == description["default"], name


@pytest.mark.parametrize("node", [*CORE, *PYTHON])
def test_config_files_equal_the_defaults(node):
    values = yaml.safe_load((ROOT / "config" / (node + ".yaml")).read_text())
    colors = values.pop("colors", None)
    assert colors in (None, DEFAULT)
    rows = readme_rows()
    for name, value in values.items():
        assert text(value) == CONFIGURED.get((node, name), rows[node, name]["default"]), name
    live = {name for (of, name), row in rows.items() if of == node and row["live"] == "yes"}
    of_colors = {"color", *LOW, *HIGH} if colors else set()
    assert live - of_colors <= set(values)
    assert not of_colors & set(values)


@pytest.mark.parametrize("node", PYTHON)
def test_readme_says_what_the_cfg_files_of_python_nodes_say(node):
    rows = {name: row for (of, name), row in readme_rows().items() if of == node}
    described = cfg(node)
    assert set(rows) == set(described) | set(OF_THE_NODES[node])
    for name, row in rows.items():
        if name in OF_THE_NODES[node]:
            assert (row["default"], row["live"]) == (OF_THE_NODES[node][name], "no"), name
            continue
        parameter = described[name]
        types = {"str": "string"}
        assert row["type"] == types.get(parameter["type"], parameter["type"]), name
        assert (row["default"], row["live"]) == (text(parameter["default"]), "yes"), name
        if parameter["type"] in ("int", "double"):
            assert row["range"] == f"{text(parameter['min'])} to {text(parameter['max'])}", name
        assert row["unit"] in parameter["description"], name


def test_line_follower_s_defaults_are_those_of_its_controller():
    described = cfg("line_follower")
    for name, field in LineControlParams.__dataclass_fields__.items():
        assert described[name]["default"] == field.default, name
    assert described["min_area"]["default"] == rv.LineParams().min_area


def test_motion_detector_s_defaults_are_the_core_s():
    described, params = cfg("motion_detector"), rv.MotionParams()
    for name in (name for name in dir(params) if not name.startswith("_")):
        of_node = "minArea" if name == "min_area" else name  # as the course names it
        assert described[of_node]["default"] == getattr(params, name), name


def test_apriltag_detector_s_defaults_are_the_core_s():
    described = cfg("apriltag_detector")
    for params in (rv.TagDetectorParams(), rv.TagPoseParams()):
        for name in {name for name in dir(params) if not name.startswith("_")} & set(described):
            assert described[name]["default"] == getattr(params, name), name


def test_object_tracker_s_defaults_and_ranges_are_the_core_s():
    described = cfg("object_tracker")
    for name in (name for name in dir(rv.ObjectTrackerParams()) if not name.startswith("_")):
        assert described[name]["default"] == getattr(rv.ObjectTrackerParams(), name), name
        for end, beyond in (("min", -1), ("max", 1)):
            params = rv.ObjectTrackerParams()
            setattr(params, name, described[name][end])
            rv.validate(params)
            setattr(params, name, described[name][end] + beyond)
            with pytest.raises(ValueError, match=name):
                rv.validate(params)


def test_face_detector_s_defaults_are_the_core_s():
    described, params = cfg("face_detector"), rv.FaceParams()
    for name in (*PARAMS, *COURSE):
        if name != "haar_maxSize":
            assert described[name]["default"] == getattr(params, COURSE.get(name, name)), name


def test_rviz_looks_from_the_camera():
    shown = yaml.safe_load((ROOT / "config/robot_vision.rviz").read_text())
    frame = shown["Visualization Manager"]["Global Options"]["Fixed Frame"]
    assert frame == yaml.safe_load((ROOT / "config/camera.yaml").read_text())["camera_frame_id"]


@pytest.mark.parametrize("node", ["hsv_tracker", "ball_tracker"])
def test_trackers_defaults_are_the_core_s(node):
    described = cfg(node)
    for params in (rv.RegionParams(), rv.BallTrackerParams()):
        for name in set(described) & set(dir(params)):
            if (node, name) != ("ball_tracker", "min_area"):  # a ball far away is small
                assert described[name]["default"] == getattr(params, name), name
    blue = rv.HsvRange()
    assert tuple(described[name]["default"] for name in LOW) == tuple(blue.low)
    assert tuple(described[name]["default"] for name in HIGH) == tuple(blue.high)


@pytest.mark.parametrize("node", CORE)
def test_readme_lists_every_parameter_with_its_default(node):
    rows = {name: row for (of, name), row in readme_rows().items() if of == node}
    expected = {name: text(value) for name, value in core_defaults(node).items()}
    expected.update(OF_THE_NODES.get(node, {}))
    assert {name: row["default"] for name, row in rows.items()} == expected
    live = {name for name, row in rows.items() if row["live"] == "yes"}
    assert live == set(cfg(node))


def test_readme_lists_what_all_nodes_have():
    rows = readme_rows()
    for of in ("all", "all but the viewer", "Python but the viewer", "all but camera"):
        found = {name: row["default"] for (node, name), row in rows.items() if node == of}
        assert found == OF_THE_NODES[of]


@pytest.mark.parametrize("node", CORE)
def test_readme_types_are_those_of_the_code(node):
    types = {"int": int, "double": float, "bool": bool, "string": str}
    for (of, name), row in readme_rows().items():
        if of == node and name in core_defaults(node):
            assert types[row["type"]] is type(core_defaults(node)[name]), name


@pytest.mark.parametrize("node", CORE)
def test_numeric_ranges_are_what_validate_accepts(node):
    checked = 0
    for (of, name), row in readme_rows().items():
        match = re.fullmatch(r"(-?[\d.]+) to (-?[\d.]+)", row["range"])
        if of != node or not match:
            continue
        low, high = (float(end) for end in match.groups())
        if name in cfg(node):
            assert (cfg(node)[name]["min"], cfg(node)[name]["max"]) == (low, high), name
        kind = type(core_defaults(node)[name])
        for value in (low, high):
            rv.validate(with_value(node, name, kind(value)))
        for value in (low - 1, high + 1):
            with pytest.raises(ValueError, match=name):
                rv.validate(with_value(node, name, kind(value)))
        checked += 1
    assert checked >= 3


def with_value(node, name, value):
    """Default parameters with one changed, and others moved where the two belong together."""
    params = CORE[node]()
    setattr(params, name, value)
    if name == "low_threshold":
        params.high_threshold = max(params.high_threshold, min(value, 10000.0))
    if name == "high_threshold":
        params.low_threshold = max(0.0, min(params.low_threshold, value))
    return params


def documented(node, name):
    """What the code says of a parameter: the .cfg file's description, or the core's comment."""
    if name in cfg(node):
        return cfg(node)[name]["description"]
    header = (ROOT / "include/robot_vision/camera/frame_source.hpp").read_text()
    return re.search(rf"^ *\S+ {name}(?: = [^;]+)?;(.*)$", header, re.MULTILINE).group(1)


@pytest.mark.parametrize("node", CORE)
def test_units_are_those_of_the_code(node):
    for (of, name), row in readme_rows().items():
        if of == node and row["unit"]:
            assert re.search(r"\b{}\b".format(row["unit"]), documented(node, name)), name


def test_choices_are_what_validate_accepts():
    for name in ("pixel_format", "io_method", "scene"):
        choices = re.split(", | or ", readme_rows()["camera", name]["range"])
        for choice in choices:
            rv.validate(with_value("camera", name, choice))
        with pytest.raises(ValueError, match="must be " + readme_rows()["camera", name]["range"]):
            rv.validate(with_value("camera", name, "other"))
