"""Menus of live parameters: the values that the core accepts, each with a meaning."""

import importlib.machinery
import importlib.util
import pathlib
import re

import pytest

import robot_vision.cfg
from robot_vision import color_spaces, operations
from robot_vision.contours.contour_drawing import DRAWN
from robot_vision.dashboard.parameter_description import choices_of
from robot_vision.ros import configs
from robot_vision.viewer.simple_camera_view_node import SHOWS

ROOT = pathlib.Path(__file__).resolve().parents[2]


def loaded(name, path):
    """A Python file of the checkout that is no module of a package."""
    loader = importlib.machinery.SourceFileLoader(name, str(path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


TOOL = loaded("parameters_tool", ROOT / "tools/parameters")
CONFIGS = {config.name: config for config in TOOL.configs()}


def menus_of(name):
    """The values of each menu of a node's generated module, and the defaults."""
    module = getattr(configs, f"{name}Config")
    found = {}
    for one in module.config_description["parameters"]:
        choices = choices_of(one["edit_method"], one["type"])
        assert bool(choices) == bool(one["edit_method"]), one["name"]
        for choice in choices:
            assert choice["description"] not in ("", choice["name"]), choice
        if choices:
            found[one["name"]] = [choice["value"] for choice in choices]
            assert module.defaults[one["name"]] in found[one["name"]]
    return found


def listed(text):
    return re.split(", | or ", text)


def test_there_are_modules_for_all():
    folder = pathlib.Path(robot_vision.cfg.__path__[0])
    assert {path.name[: -len("Config.py")] for path in folder.glob("*Config.py")} == set(CONFIGS)


@pytest.mark.parametrize("name", CONFIGS)
def test_a_menu_has_the_values_that_the_core_takes(name):
    known = TOOL.structs()
    menus = menus_of(name)
    for parameter in CONFIGS[name].parameters:
        field = TOOL.field_for(CONFIGS[name], parameter, known)
        if field and " or " in field.span:
            assert list(map(str, menus[parameter.name])) == listed(field.span), parameter.name
        elif field:
            assert parameter.name not in menus


@pytest.mark.parametrize(
    "name, value, meaning",
    [
        ("flip_axis", "horizontal", "top and bottom change places"),
        ("flip_axis", "vertical", "left and right change places"),  # as test_operations.py has it
        ("resize_interpolation", "linear", "of 2x2 pixels"),
    ],
)
def test_what_values_of_filters_mean(name, value, meaning):
    parameters = {one["name"]: one for one in configs.FilterConfig.config_description["parameters"]}
    choices = choices_of(parameters[name]["edit_method"], parameters[name]["type"])
    assert {choice["value"]: choice["description"] for choice in choices}[value] == meaning


def test_the_menus_of_filters_have_the_values_of_the_operations():
    menus = menus_of("Filter")
    expected = {
        f"{operation.name}_{param.name}": listed(param.limits)
        for operation in operations()
        for param in operation.params
        if " or " in param.limits
    }
    assert menus == expected and len(menus) > 10


@pytest.mark.parametrize(
    "name, parameter, values",
    [
        ("HsvTracker", "space", color_spaces()),
        ("SimpleCameraView", "space", color_spaces()),
        ("SimpleCameraView", "show", SHOWS),
        ("Contours", "draw", DRAWN),
        ("LineFollower", "mode", ("course", "pid")),
        ("CubeOverlay", "draw", ("cube", "axes")),
        ("CompressedPublisher", "format", ("jpeg", "png")),
    ],
)
def test_menus_of_what_the_nodes_check_themselves(name, parameter, values):
    assert sorted(menus_of(name)[parameter]) == sorted(values)


def test_all_meanings_are_used():
    text = (ROOT / "cfg/menus.py").read_text()
    meanings = re.findall(r'^    "([\w.]+)": "', text, re.M)
    used = {
        key
        for name in CONFIGS
        for parameter, values in menus_of(name).items()
        for value in values
        for key in (str(value), f"{parameter}.{value}")
    }
    assert len(meanings) > 100 and len(set(meanings)) == len(meanings)
    assert set(meanings) <= used
