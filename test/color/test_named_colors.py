"""The entries of ~colors: limits in lists or named, of every space, and what is refused."""

import re

import pytest
import rospy

from robot_vision.color.named_colors import NamedColors

LAB = {"l_low": 1, "a_low": 2, "b_low": 3, "l_high": 4, "a_high": 5, "b_high": 6}
HSV = {"h_low": 170, "s_low": 2, "v_low": 3, "h_high": 4, "s_high": 5, "v_high": 6}


@pytest.fixture
def named(monkeypatch):
    """named(entry) is the colour that ~colors names a, without a parameter server."""

    def make(entry):
        monkeypatch.setattr(rospy, "get_param", lambda *_: {"a": entry})
        monkeypatch.setattr(rospy, "has_param", lambda _: False)
        return NamedColors().ranges["a"]

    return make


@pytest.mark.parametrize(
    "entry, space, low, high",
    [
        ({"low": [170, 2, 3], "high": [4, 5, 6]}, "hsv", (170, 2, 3), (4, 5, 6)),
        ({"space": "lab", "low": [1, 2, 3], "high": [4, 5, 6]}, "lab", (1, 2, 3), (4, 5, 6)),
        (HSV, "hsv", (170, 2, 3), (4, 5, 6)),
        ({"space": "hsv", "min_area": 7, **HSV}, "hsv", (170, 2, 3), (4, 5, 6)),
        ({"space": "lab", **LAB}, "lab", (1, 2, 3), (4, 5, 6)),
        (
            {"space": "ycrcb", "low": [0, 133, 77], "high": [255, 173, 127], "note": "skin"},
            "ycrcb",
            (0, 133, 77),
            (255, 173, 127),
        ),
    ],
)
def test_a_color_is_given_in_lists_or_by_the_names_of_its_limits(named, entry, space, low, high):
    found = named(entry)
    assert (found.space, found.low, found.high) == (space, low, high)


LAB_NAMES = "must be l_low, a_low, b_low, l_high, a_high, b_high"


@pytest.mark.parametrize(
    "entry, error",
    [
        ({"space": "lab", **HSV}, f"a_high is missing, {LAB_NAMES}"),
        ({"space": "lab", **LAB, "h_low": 3}, f"h_low is there, {LAB_NAMES}"),
        ({"space": "lab", **LAB, "low": [1, 2, 3]}, f"low is there, {LAB_NAMES}"),
        (LAB, "a_high is there, must be h_low, s_low, v_low, h_high, s_high, v_high"),
        ({"space": "lab", "l_low": 3}, f"a_high is missing, {LAB_NAMES}"),
        ({"space": "cmyk", "low": [1, 2, 3], "high": [4, 5, 6]}, "space is 'cmyk', must be one of"),
        ({"space": 3, "low": [1, 2, 3], "high": [4, 5, 6]}, "space is 3, must be a string"),
        (
            {"space": "ycrcb", "low": [1, 2], "high": [4, 5, 6]},
            "must be {space: ycrcb, low: [y, cr, cb], high: [y, cr, cb]}",
        ),
        (
            {"space": "lab", "low": [1, 2, 9], "high": [4, 5, 6]},
            "b_high is 6, must be from 9 to 255",
        ),
        (
            {"space": "lab", "low": [1, 2, "x"], "high": [4, 5, 6]},
            "must be {space: lab, low: [l, a",
        ),
    ],
)
def test_what_is_mixed_or_wrong_is_refused_in_words(named, entry, error):
    with pytest.raises(ValueError, match="^colors/a.*" + re.escape(error)):
        named(entry)
