"""The fields of a page's requests: what is taken, and what is refused in words."""

import json

import pytest

from robot_vision.dashboard.fields import (
    Choice,
    Flag,
    Mapping,
    Names,
    Number,
    Region,
    Text,
    checked,
)

RECTANGLE = {"x": 1, "y": 2, "width": 3, "height": 65535}


@pytest.mark.parametrize(
    ("field", "value", "expected"),
    [
        (Text(), "/usb_cam/image_raw", "/usb_cam/image_raw"),
        (Text(), "", ""),
        (Text(3), "äöü", "äöü"),
        (Number(0, 1), 1, 1.0),
        (Number(-5, 5), -0.5, -0.5),
        (Number(0, 9, integer=True), 3.0, 3),
        (Number(0, 9, integer=True), 9, 9),
        (Flag(), False, False),
        (Choice("a", "b"), "b", "b"),
        (Names(2), ["a", "b"], ["a", "b"]),
        (Names(2), [], []),
        (Mapping(4), {"a": True, "b": 1, "c": 0.5, "d": "x\ny"}, None),
        (Region(), RECTANGLE, RECTANGLE),
        (Region(), {**RECTANGLE, "x": 1.0}, RECTANGLE),
    ],
)
def test_what_fits_is_taken(field, value, expected):
    given = json.dumps(value)
    result = field.check("field", value)
    assert result == (value if expected is None else expected)
    assert json.dumps(value) == given
    assert type(result) is type(value if expected is None else expected)


INFINITE, NAN = float("inf"), float("nan")


@pytest.mark.parametrize(
    ("field", "value"),
    [
        *[(Text(), value) for value in (1, None, True, [], {}, "x" * 257, "a\nb", "a\x1b[2J")],
        (Text(), "\ud800"),  # half of a letter, which JSON can hold
        (Text(), "\u202egnp.exe"),  # has what follows read from right to left
        *[(Number(0, 1), value) for value in ("1", None, True, [1], -0.1, 1.1, INFINITE, NAN)],
        (Number(0, 1), 10**400),
        *[(Number(0, 9, integer=True), value) for value in (0.5, 10, INFINITE, -INFINITE, NAN)],
        *[(Flag(), value) for value in (0, 1, "true", None)],
        *[(Choice("a", "b"), value) for value in ("c", "", None, ["a"], 1)],
        *[(Names(2), value) for value in ("a", [1], ["a"] * 3, {"a": 1}, [["a"]], ["a\n"])],
        *[(Mapping(1), value) for value in ([], "a", {"a": 1, "b": 2}, {"a": None}, {"a": [1]})],
        *[(Mapping(1), {"a": value}) for value in (NAN, INFINITE, 10**400, {}, "x" * 4097)],
        (Mapping(1), {"a\n": 1}),
        *[(Region(), value) for value in ([1, 2, 3, 4], {}, {"x": 1}, {**RECTANGLE, "z": 1})],
        *[(Region(), {**RECTANGLE, "x": value}) for value in (-1, 0.5, "1", True, 65536, NAN)],
    ],
)
def test_what_does_not_fit_is_refused_by_its_name(field, value):
    with pytest.raises(ValueError, match=r"field.* must be "):
        field.check("field", value)


def test_a_long_value_is_not_repeated_at_length():
    with pytest.raises(ValueError, match="field is ") as refused:
        Number(0, 1).check("field", "x" * 10000)
    assert len(str(refused.value)) < 200


FIELDS = {"topic": Text(), "rate": Number(0, 100, default=0.0)}


def test_a_request_gets_all_fields_with_their_defaults():
    assert checked(FIELDS, {"topic": "/a"}) == {"topic": "/a", "rate": 0.0}
    assert checked(FIELDS, {"topic": "/a", "rate": 5}) == {"topic": "/a", "rate": 5.0}


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ({}, "the field topic is missing"),
        ({"topic": "/a", "speed": 1}, "no field 'speed', the fields are: topic, rate"),
        ({"topic": "/a", "rate": 101}, "rate is 101, must be from 0"),
        ({"topic": "/a", "rate": None}, "rate is None, must be a number"),
    ],
)
def test_a_request_with_other_fields_is_refused(request_, message):
    with pytest.raises(ValueError, match=message):
        checked(FIELDS, request_)
