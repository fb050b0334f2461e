"""The entries of ~colors: limits in lists or named, of every space, and what is refused."""

import re

import pytest
import rospy
from fake_params import use_params

from robot_vision.color.named_colors import NamedColors
from robot_vision.ros.configs import HsvTrackerConfig

LAB = {"l_low": 1, "a_low": 2, "b_low": 3, "l_high": 4, "a_high": 5, "b_high": 6}
HSV = {"h_low": 170, "s_low": 2, "v_low": 3, "h_high": 4, "s_high": 5, "v_high": 6}


@pytest.fixture
def named(monkeypatch):
    """named(entry) is the colour that ~colors names a, without a parameter server."""

    def make(entry):
        use_params(monkeypatch, {"~colors": {"a": entry}})
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


@pytest.fixture
def server(monkeypatch):
    """server(params) starts NamedColors with these parameters; it returns what was warned of."""

    def start(params):
        there, warnings = {"~" + name: value for name, value in params.items()}, []
        use_params(monkeypatch, there)
        monkeypatch.setattr(rospy, "logwarn", lambda text, *values: warnings.append(text % values))
        NamedColors()
        assert there.keys() <= {"~colors", "~color"}
        return warnings

    return start


SKY = {"space": "lab", "low": [120, 100, 60], "high": [255, 140, 110]}
BLUE = {"low": [90, 50, 50], "high": [120, 255, 255]}
OF_LAB = "space is lab, whose limits are low_1 to high_3 (lightness, green to red, blue to yellow)"


@pytest.mark.parametrize(
    "params, ignored",
    [
        ({"h_low": 70, "space": "hsv"}, ""),
        ({"low_1": 70, "space": "lab", "h_low": 90}, ""),  # the default
        ({"s_low": 70, "h_high": 7, "space": "lab"}, f"s_low 70, h_high 7, because {OF_LAB}"),
        ({"low_1": 7}, "low_1 7, because space is hsv, whose limits are h_low to v_high (hue, sa"),
        ({"colors": {"blue": BLUE}, "h_low": 90, "space": "hsv"}, ""),  # what a run has left
        ({"colors": {"blue": BLUE}, "h_low": 70}, "h_low 70, because ~colors has all limits"),
        ({"colors": {"sky": SKY}, "space": "hls"}, "space 'hls', because ~colors has all"),
        ({"colors": {"sky": SKY, "blue": BLUE}, "color": "blue", "h_low": 90}, ""),
        ({"colors": {"sky": SKY}, "low_1": 120, "low_2": "x"}, "low_2 'x', because ~colors has"),
    ],
)
def test_live_parameters_without_effect_at_start_are_said(server, params, ignored):
    warnings = server(params)
    assert bool(warnings) == bool(ignored) and len(warnings) <= 1
    assert "".join(warnings).startswith(f"without effect: {ignored}" if ignored else "")


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


@pytest.fixture
def colors(monkeypatch):
    """colors(entries, more) starts NamedColors; with it what the parameter server has then."""

    def start(entries, more=None):
        there = {"~colors": entries, **({} if more is None else {"~more_colors": more})}
        use_params(monkeypatch, there)
        return NamedColors(), there

    return start


def shown(named):
    """The live parameters as they are at the start."""
    config = dict(HsvTrackerConfig.defaults)
    named.update(config)
    return config


BLUE = {"low": [100, 1, 2], "high": [130, 250, 251]}


@pytest.mark.parametrize("entry", [BLUE, {"space": "lab", **LAB}, {**HSV, "h_low": 9}])
def test_a_color_of_more_colors_replaces_the_entry_of_its_name(colors, entry):
    green = {"low": [40, 3, 4], "high": [80, 5, 6]}
    named, there = colors({"blue": entry, "green": green}, {"blue": HSV, "red": HSV})
    for name in ("blue", "red"):
        found = named.ranges[name]
        assert (found.space, found.low, found.high) == ("hsv", (170, 2, 3), (4, 5, 6))
    assert there["~colors"] == {"blue": HSV, "green": green, "red": HSV}
    assert list(named.ranges) == ["blue", "green", "red"]


def test_more_colors_that_are_no_map_are_refused(colors):
    with pytest.raises(ValueError, match=r"^more_colors is 3, must be a map of names to ranges$"):
        colors({"blue": BLUE}, 3)


def test_a_plus_adds_a_color_with_all_limits_that_are_given(colors):
    named, there = colors({"blue": BLUE})
    config = {**shown(named), "color": "+red", "h_high": 9}
    named.update(config)
    assert config["color"] == "red"
    red = named.ranges["red"]  # with the limits of blue that were not changed
    assert (red.space, red.low, red.high) == ("hsv", (100, 1, 2), (9, 250, 251))
    assert named.ranges["blue"].high == (130, 250, 251)
    assert set(there["~colors"]) == {"blue", "red"} and there["~colors"]["blue"] == BLUE
    config.update(color="blue")
    named.update(config)
    assert config["h_high"] == 130


def test_a_plus_before_a_known_name_gives_it_all_limits(colors):
    named, there = colors({"blue": BLUE, "green": {"low": [40, 3, 4], "high": [80, 5, 6]}})
    config = {**shown(named), "color": "+green"}
    named.update(config)
    assert (named.ranges["green"].low, named.ranges["green"].high) == ((100, 1, 2), (130, 250, 251))
    assert set(there["~colors"]) == {"blue", "green"}


def test_a_plus_in_another_space(colors):
    named, _ = colors({"blue": BLUE})
    limits = {"low_1": 1, "low_2": 2, "low_3": 3, "high_1": 4, "high_2": 5, "high_3": 6}
    named.update({**shown(named), "color": "+skin", "space": "lab", **limits})
    skin = named.ranges["skin"]
    assert (skin.space, skin.low, skin.high) == ("lab", (1, 2, 3), (4, 5, 6))


@pytest.mark.parametrize("name", ["+", "+1", "+a b", "+yes", "++a", "+<b>", "+a.b"])
def test_a_color_is_added_only_under_a_name_that_a_file_can_have(colors, name):
    named, there = colors({"blue": BLUE})
    with pytest.raises(ValueError, match=re.escape(f"color is {name!r}, must be + and letters")):
        named.update({**shown(named), "color": name})
    assert set(named.ranges) == set(there["~colors"]) == {"blue"}


def test_a_range_that_is_none_adds_no_color(colors):
    named, there = colors({"blue": BLUE})
    with pytest.raises(ValueError, match="s_high is 100, must be from 200 to 255"):
        named.update({**shown(named), "color": "+red", "s_low": 200, "s_high": 100})
    assert set(named.ranges) == set(there["~colors"]) == {"blue"}
