"""Requests as JSON, the roles of operations, and what is told to a page as JSON."""

import json

import numpy as np
import pytest

from robot_vision.dashboard.encoding import to_json
from robot_vision.dashboard.fields import Number
from robot_vision.dashboard.operations import (
    Operation,
    OperationTable,
    may,
    parse_request,
    request_number,
)


def test_a_request_is_a_json_object():
    assert parse_request('{"op": "graph", "id": 1, "x": [0.5]}') == {
        "op": "graph",
        "id": 1,
        "x": [0.5],
    }


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is no JSON"),
        ("{", "is no JSON"),
        ("[1]", "no JSON object"),
        ("null", "no JSON object"),
        ('"op"', "no JSON object"),
        ("[" * 10000, "nested too deeply"),
        ('{"a":' * 10000 + "1" + "}" * 10000, "nested too deeply"),
        ('{"a": NaN}', "the number NaN"),
        ('{"a": -Infinity}', "the number -Infinity"),
        (f'{{"a": {"9" * 41}}}', "more than 40 digits"),
        (f'{{"a": {"9" * 60000}}}', "more than 40 digits"),
    ],
    ids=lambda value: value[:20],
)
def test_what_is_no_request_is_refused_in_words(text, message):
    with pytest.raises(ValueError, match=message):
        parse_request(text)


@pytest.mark.parametrize("number", [None, -1, 0.5, "1", True, [1], 2**53 + 1])
def test_a_request_has_a_number(number):
    with pytest.raises(ValueError, match="id is"):
        request_number({"id": number})
    request = {"id": 7, "op": "x"}
    assert (request_number(request), request) == (7, {"op": "x"})


def operation(name, role):
    return Operation(name, lambda *_: None, role, {"x": Number(0, 1, default=0.5)})


TABLE = OperationTable([operation("look", "view"), operation("change", "control")])


def test_each_role_gets_its_operations():
    for name, role in (("look", "view"), ("look", "control"), ("change", "control")):
        found, values = TABLE.find(name, role, {})
        assert (found.name, values) == (name, {"x": 0.5})


@pytest.mark.parametrize(
    ("name", "role", "request_", "message"),
    [
        ("change", "view", {}, "change needs the role control"),
        ("look", "", {}, "look needs"),
        ("none", "control", {}, "no operation 'none'"),
        (None, "control", {}, "no operation None"),
        (["look"], "control", {}, "no operation"),
        ({}, "control", {}, "no operation"),
        ("look", "view", {"y": 1}, "no field 'y'"),
    ],
)
def test_other_requests_are_refused(name, role, request_, message):
    with pytest.raises(ValueError, match=message):
        TABLE.find(name, role, request_)


def test_an_operation_controls_unless_it_says_otherwise():
    assert Operation("x", print).role == "control"


def test_names_and_roles_are_unique_and_known():
    with pytest.raises(ValueError, match="two operations look"):
        OperationTable([operation("look", "view"), operation("look", "control")])
    with pytest.raises(ValueError, match="role admin"):
        OperationTable([operation("look", "admin")])
    with pytest.raises(ValueError, match="look has the field id"):
        OperationTable([Operation("look", print, "view", {"id": Number(0, 9)})])


def test_roles_include_one_another():
    pairs = [(a, b) for a in ("view", "control") for b in ("", "view", "control") if may(b, a)]
    assert pairs == [("view", "view"), ("view", "control"), ("control", "control")]


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        ({"a": float("nan"), "b": [float("inf"), 1.5]}, {"a": None, "b": [None, 1.5]}),
        ({"a": np.float32(0.5), "b": np.arange(3), "c": np.bool_(True)}, None),
        ({"a": np.array([np.nan, 1.0])}, {"a": [None, 1.0]}),
        ({"a": (1, "ä\ud800</script>\u2028")}, {"a": [1, "ä\ud800</script>\u2028"]}),
    ],
)
def test_browsers_can_read_what_is_told(data, expected):
    def no_constant(name):
        raise AssertionError(name)

    text = to_json(data)
    text.encode()
    found = json.loads(text, parse_constant=no_constant)
    assert found == (expected or {"a": 0.5, "b": [0, 1, 2], "c": True})


def test_what_json_cannot_hold_is_an_error():
    with pytest.raises(TypeError, match="object"):
        to_json({"a": object()})
