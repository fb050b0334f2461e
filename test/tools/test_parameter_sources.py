"""What is said of parameters: by the core, the .cfg files, config/*.yaml, the code and its page."""

import ast
import dataclasses
import importlib
import pathlib
import re
from importlib.machinery import SourceFileLoader

import pages
import pytest
import yaml

import robot_vision as rv
from robot_vision.color.named_colors import DEFAULT, SHOWN
from robot_vision.faces.face_detector import COURSE
from robot_vision.ros.live_params import attribute_of

ROOT = pathlib.Path(__file__).resolve().parents[2]
tool = SourceFileLoader("parameters", str(ROOT / "tools/parameters")).load_module()
STRUCTS = tool.structs()
CONFIGS = {config.node: config for config in tool.configs()}
# What the launch files set otherwise: the course's node finds small faces only.
CONFIGURED = {("face_detector", "haar_maxSize"): "0"}
# Of groups of nodes in the table of what is read at start.
SHARED = (
    "all but the dashboard",
    "all but the viewer and the dashboard",
    "Python but the viewer and the dashboard",
    "all but camera",
)
NOTHING_LIVE = ("dashboard",)  # nodes that read all their parameters at start
# Those whose parameters are in dataclasses, not in structs of the core.
OF_DATACLASSES = {"cube_overlay", "face_recognizer", "line_follower"}
RANGELESS = {"simple_camera_view"}  # nodes of names and switches
# Those whose ranges are not one interval: 0, or from 1 on.
IN_PARTS = {("apriltag_detector", "decimate")}
NUMBER = r"(-?[\d.]+(?:e-?\d+)?)"
RANGE = re.compile(rf"(above )?{NUMBER}(?: \([^)]*\))? to {NUMBER}\b")  # "odd, 1 (none) to 31"


def file_of(node):
    """The YAML file of a node's parameters."""
    return ROOT / f"config/{node}.yaml"


def read_at_start():
    """The rows of what nodes read at start, by node and parameter, as the page has them."""
    rows = pages.table(tool.PAGE, "| node | parameter | type | default | range | unit | meaning |")
    return {(node, name.strip("`")): row for node, name, *row in rows}


def defaults_at_start():
    """Their defaults."""
    return {of: default for of, (_, default, *_) in read_at_start().items()}


def defaults(node):
    """A node's parameters and their defaults as the page has them."""
    rows = {name: default for (of, name), default in defaults_at_start().items() if of == node}
    config = CONFIGS[node]
    declared = (*tool.start_fields(config, STRUCTS), *config.parameters)
    return {**rows, **{one.name: tool.text_of(one.default) for one in declared}}


def test_cfg_files_say_what_the_core_says():
    assert tool.faults() == []


def test_a_parameter_that_its_node_does_not_know_is_named(monkeypatch):
    config = CONFIGS["ball_tracker"]
    typo = config.parameters[0]._replace(name="h_lo")
    monkeypatch.setattr(tool, "configs", lambda: [config._replace(parameters=[typo])])
    assert tool.faults() == ["cfg/BallTracker.cfg: h_lo: no source that uses it knows it"]


def test_the_page_is_up_to_date():
    assert tool.PAGE.read_text() == tool.page()


def test_names_are_found_as_nodes_find_them():
    for node, config in CONFIGS.items():
        for parameter in config.parameters:
            prefix = COURSE if node == "face_detector" else ""
            of_tool = tool.attribute_of(node, parameter.name)
            assert of_tool == attribute_of(parameter.name, prefix)


@pytest.mark.parametrize("struct", sorted(STRUCTS.keys() & vars(rv).keys()))
def test_python_has_what_the_headers_say(struct):
    kind = getattr(rv, struct)
    for name, field in STRUCTS[struct].items():
        value = getattr(kind(), name)
        if not isinstance(value, list):
            assert value == field.default, name
        assert getattr(kind, name).__doc__.startswith(field.meaning), name


def dataclasses_of(config):
    """Those of parameters in the modules that use a Config, and in what these import."""
    for path in tool.sources_of(config.name):
        if path.suffix == ".py":
            parts = path.relative_to(ROOT / "src").with_suffix("").parts
            for value in vars(importlib.import_module(".".join(parts))).values():
                if dataclasses.is_dataclass(value) and value.__name__.endswith("Params"):
                    yield value


@pytest.mark.parametrize("node", CONFIGS)
def test_defaults_of_dataclasses_are_those_of_the_cfg(node):
    declared = {parameter.name: parameter.default for parameter in CONFIGS[node].parameters}
    kinds = [*dataclasses_of(CONFIGS[node])]
    assert bool(kinds) == (node in OF_DATACLASSES)
    for kind in kinds:
        for field in dataclasses.fields(kind):
            assert declared[field.name] == field.default, field.name


@pytest.mark.parametrize("node", [one for one in CONFIGS if file_of(one).exists()])
def test_config_files_have_the_defaults(node):
    values = yaml.safe_load(file_of(node).read_text())
    colors = values.pop("colors", None)
    assert colors in (None, DEFAULT)
    expected = defaults(node)
    for name, value in values.items():
        assert tool.text_of(value) == CONFIGURED.get((node, name), expected[name]), name
    live = {parameter.name for parameter in CONFIGS[node].parameters}
    of_colors = {*SHOWN} if colors else set()
    assert live - of_colors <= set(values)
    assert not of_colors & set(values)


def spans_of(node):
    """The ranges of a node's parameters in words."""
    config = CONFIGS[node]
    declared = (*tool.start_fields(config, STRUCTS), *config.parameters)
    rows = {name: row[2] for (of, name), row in read_at_start().items() if of == node}
    return {**rows, **{one.name: one.span for one in declared}}


def is_range(words, low, high):
    """Whether a range in words is this one; "above 0" is any least value that is close to it."""
    above, first, last = words
    begins = 0.0 < low <= 0.001 if above else float(first) == low
    return begins and float(last) == high


@pytest.mark.parametrize("node", [one for one in CONFIGS if file_of(one).exists()])
def test_config_files_tell_the_ranges(node):
    spans, lines = spans_of(node), re.findall(r"^(\w+):.*?#(.*)", file_of(node).read_text(), re.M)
    told = {name: RANGE.findall(words) for name, words in lines}
    for name, ranges in told.items():
        if ranges and (node, name) not in IN_PARTS:
            _, low, high = RANGE.match(spans[name]).groups()
            assert any(is_range(one, float(low), float(high)) for one in ranges), name
    assert any(told.values()) == (node not in RANGELESS)


@pytest.mark.parametrize("node", NOTHING_LIVE)
def test_config_files_of_nodes_without_live_parameters_have_the_defaults(node):
    values = yaml.safe_load(file_of(node).read_text())
    rows = {name: shown for (of, name), shown in defaults_at_start().items() if of == node}
    assert values.keys() <= rows.keys()
    for name, value in values.items():
        assert rows[name] == ("" if value == [] else tool.text_of(value)), name


def asked_in_python():
    """Names and literal defaults of the parameters that Python nodes ask for."""
    for path in sorted((ROOT / "src/robot_vision").rglob("*.py")):
        for call in ast.walk(ast.parse(path.read_text())):
            if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name):
                continue
            if not re.fullmatch(r"read_(param|name|any|secret)", call.func.id):
                continue
            name, default = (*call.args, None)[:2]
            if isinstance(name, ast.Constant):
                yield name.value, default.value if isinstance(default, ast.Constant) else None


def asked_in_cpp():
    for path in sorted((ROOT / "src").rglob("*.?pp")):
        yield from re.findall(r'readParam\(\w+, "(\w+)"', path.read_text())


def test_the_page_has_what_nodes_ask_for_at_start():
    rows = defaults_at_start()
    names = {name for _, name in rows}
    commands = {
        "manager",
        "cameras",
        "view",
        "synthetic",
        "basics",
        "depth",
        "recognition",
        "dashboard",
        "period",
    }  # of the camera loader and of the demo's report
    for name, default in asked_in_python():
        assert name in names | commands, name
        if name in names and default is not None:
            shown = {value for (_, of), value in rows.items() if of == name}
            assert shown == {tool.text_of(default)}, name
    assert set(asked_in_cpp()) <= names


def test_rows_of_what_is_read_at_start_are_of_nodes():
    for node, name in defaults_at_start():
        assert node in CONFIGS or node in SHARED or node in NOTHING_LIVE, node
        if node in CONFIGS:
            assert name not in {parameter.name for parameter in CONFIGS[node].parameters}


@pytest.mark.parametrize("view, camera", [("robot_vision", "camera"), ("rgbd", "rgbd")])
def test_rviz_looks_from_the_camera(view, camera):
    shown = yaml.safe_load((ROOT / f"config/{view}.rviz").read_text())
    frame = shown["Visualization Manager"]["Global Options"]["Fixed Frame"]
    assert frame == yaml.safe_load((ROOT / f"config/{camera}.yaml").read_text())["camera_frame_id"]
