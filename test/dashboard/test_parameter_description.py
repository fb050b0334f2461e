"""Descriptions of live parameters, and values for them."""

import pytest
from dynamic_reconfigure.encoding import encode_config
from dynamic_reconfigure.msg import ConfigDescription, Group, ParamDescription

from robot_vision.dashboard.parameter_description import (
    choices_of,
    groups_of,
    parameters_in,
    split_unit,
    types_of,
    values_of,
)
from robot_vision.dashboard.parameter_values import same, typed


def parameter(name, kind, text="", edit=""):
    return ParamDescription(name=name, type=kind, description=text, edit_method=edit)


def group(name, number, parent, *parameters):
    return Group(name=name, id=number, parent=parent, parameters=list(parameters))


@pytest.mark.parametrize(
    "text, description, unit",
    [
        ("side of the blur; 1: none (px, odd)", "side of the blur; 1: none", "px, odd"),
        ("held so long (s)", "held so long", "s"),
        ("lowest hue (half degrees)", "lowest hue", "half degrees"),
        ("share", "share", ""),
        ("(px)", "", "px"),
        ("", "", ""),
        ("an (inner) one", "an (inner) one", ""),
        ("only used if the other one is set (see the wiki for all of it)", None, ""),
    ],
)
def test_the_unit_is_what_the_last_parentheses_hold(text, description, unit):
    assert split_unit(text) == (text if description is None else description, unit)


def test_a_parameter_has_all_that_a_slider_needs():
    description = ConfigDescription(
        groups=[group("Default", 0, 0, parameter("size", "int", "of the blur (px)"))],
        min=encode_config({"size": 1}),
        max=encode_config({"size": 99}),
        dflt=encode_config({"size": 21}),
    )
    (made,) = groups_of(description)
    assert made["name"] == "Default" and made["groups"] == []
    assert made["parameters"] == [
        {
            "name": "size",
            "type": "int",
            "min": 1,
            "max": 99,
            "default": 21,
            "description": "of the blur",
            "unit": "px",
            "choices": [],
        }
    ]


@pytest.mark.parametrize(
    "kind, low, high",
    [
        ("int", -(2**31), 2**31 - 1),
        ("double", float("-inf"), float("inf")),
        ("double", -1.7e308, 1.7e308),
        ("str", "", ""),
        ("bool", False, True),
    ],
)
def test_limits_that_mean_none_are_null(kind, low, high):
    description = ConfigDescription(
        groups=[group("Default", 0, 0, parameter("x", kind))],
        min=encode_config({"x": low}),
        max=encode_config({"x": high}),
    )
    (made,) = groups_of(description)[0]["parameters"]
    assert made["min"] is None and made["max"] is None and made["default"] is None


def test_groups_are_nested_as_their_parents_say():
    groups = [
        group("Default", 0, 0, parameter("a", "int")),
        group("outer", 1, 0, parameter("b", "int")),
        group("inner", 2, 1, parameter("c", "int")),
        group("lost", 3, 77, parameter("d", "int")),
        group("ring", 4, 5, parameter("e", "int")),
        group("of", 5, 4, parameter("f", "int")),
        group("itself", 6, 6, parameter("g", "int")),
    ]
    made = groups_of(ConfigDescription(groups=groups))
    assert [one["name"] for one in made] == ["Default", "lost", "ring", "itself"]
    assert [one["name"] for one in made[0]["groups"]] == ["outer"]
    assert [one["name"] for one in made[0]["groups"][0]["groups"]] == ["inner"]
    assert [one["name"] for one in parameters_in(made)] == list("abcdefg")


def test_types_that_do_not_exist_are_left_out():
    description = ConfigDescription(
        groups=[group("Default", 0, 0, parameter("a", "double"), parameter("b", "matrix"))]
    )
    assert types_of(description) == {"a": "double"}
    assert [one["name"] for one in parameters_in(groups_of(description))] == ["a"]


def test_choices_are_read_from_the_edit_method():
    edit = (
        "{'enum': [{'name': 'bm', 'value': 'bm', 'type': 'str', 'description': 'blocks',"
        " 'ctype': 'std::string', 'cconsttype': 'const char * const', 'srcline': 1,"
        " 'srcfile': 'x'}, {'name': 'hh', 'value': 'hh', 'description': ''}],"
        " 'enum_description': ''}"
    )
    assert choices_of(edit, "str") == [
        {"value": "bm", "name": "bm", "description": "blocks"},
        {"value": "hh", "name": "hh", "description": "hh"},
    ]


@pytest.mark.parametrize(
    "edit",
    [
        "",
        "{'enum': [{'name': 'a', 'value': __import__('os')}]}",
        "{'enum': 3}",
        "{'enum': [{'name': 'a'}]}",
        "{'enum': [{'name': 'a', 'value': 3}]}",
        "[1, 2]",
        "(" * 10000,
        "{'enum': [" + "1," * 200000,
        "{'enum': [" + "1+" * 30000 + "1]}",
        "\0",
    ],
)
def test_edit_methods_that_are_no_menus_are_left_out(edit):
    assert choices_of(edit, "str") == []


def test_menus_are_too_short_to_exhaust_the_stack_of_a_parser():
    entries = "{'name': 'a', 'value': 'a'}," * 400
    assert len(choices_of(f"{{'enum': [{entries}]}}", "str")) == 400
    assert choices_of(f"{{'enum': [{entries}]}}" + " " * 65536, "str") == []


def test_edit_methods_are_never_evaluated(tmp_path):
    file = tmp_path / "made"
    edit = f"{{'enum': [{{'name': 'a', 'value': open({str(file)!r}, 'w').name}}]}}"
    assert choices_of(edit, "str") == [] and not file.exists()


def test_values_are_read_from_all_lists():
    values = {"a": True, "b": 3, "c": 0.5, "d": "x"}
    assert values_of(encode_config(values)) == values


TYPES = {"flag": "bool", "count": "int", "size": "double", "name": "str"}


@pytest.mark.parametrize(
    "name, value, expected",
    [
        ("flag", True, True),
        ("count", 3, 3),
        ("count", 3.0, 3),
        ("size", 3, 3.0),
        ("size", 0.5, 0.5),
        ("name", "x", "x"),
    ],
)
def test_values_get_the_type_of_the_parameter(name, value, expected):
    wanted, refused = typed({name: value}, TYPES)
    assert not refused and wanted == {name: expected} and type(wanted[name]) is type(expected)


@pytest.mark.parametrize(
    "name, value, says",
    [
        ("flag", 1, "must be true or false"),
        ("count", 0.5, "must be an integer"),
        ("count", True, "must be an integer"),
        ("count", "3", "must be an integer"),
        ("count", 2**31, "32 bits"),
        ("count", -(2**40), "32 bits"),
        ("size", "0.5", "must be a number"),
        ("size", True, "must be a number"),
        ("name", 3, "must be a text"),
        ("other", 3, "no such parameter"),
    ],
)
def test_values_of_other_types_are_refused_by_name(name, value, says):
    wanted, refused = typed({name: value, "flag": True} if name != "flag" else {name: value}, TYPES)
    assert says in refused[name] and name not in wanted
    assert name == "flag" or wanted == {"flag": True}


@pytest.mark.parametrize(
    "one, other, expected",
    [
        (0.1, 0.1 + 1e-9, True),
        (0.1, 0.2, False),
        (0.0, 0.0, True),
        (3, 3, True),
        (1, True, False),
        ("a", "a", True),
        ("a", None, False),
    ],
)
def test_the_same_value(one, other, expected):
    assert same(one, other) is expected
