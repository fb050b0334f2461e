"""Colours and ranges in the spaces of OpenCV from Python, and how they are picked and written."""

import cv2
import numpy as np
import pytest
import yaml

import robot_vision as rv
from robot_vision.color.color_file import save_colors
from robot_vision.color.colors import as_yaml, median_color, outside, title_of

CODES = {
    "hsv": cv2.COLOR_BGR2HSV,
    "hls": cv2.COLOR_BGR2HLS,
    "lab": cv2.COLOR_BGR2Lab,
    "ycrcb": cv2.COLOR_BGR2YCrCb,
    "rgb": cv2.COLOR_BGR2RGB,
}
SKIN = rv.ColorRange("ycrcb", (0, 133, 77), (255, 173, 127))
SKIN_YAML = {"space": "ycrcb", "low": [0, 133, 77], "high": [255, 173, 127]}
BLUE = rv.HsvRange((90, 50, 50), (120, 255, 255))


@pytest.fixture
def image():
    return np.random.RandomState(1).randint(0, 256, (48, 64, 3), np.uint8)


def in_space(image, space):
    return image if space == "bgr" else cv2.cvtColor(image, CODES[space])


@pytest.mark.parametrize("space", rv.color_spaces())
def test_images_colors_and_masks_equal_opencv(image, space):
    before, expected = image.copy(), in_space(image, space)
    converted = rv.image_to_space(image, space)
    assert np.array_equal(converted, expected)
    assert not np.shares_memory(converted, image)
    assert np.array_equal(rv.image_to_space(image[:, :, ::-1].copy(), space, "rgb8"), expected)
    for y, x in [(0, 0), (20, 30), (47, 33)]:
        assert rv.to_space(tuple(image[y, x]), space) == tuple(expected[y, x])
    color = rv.ColorRange(space, (20, 60, 60), (150, 220, 230))
    mask = rv.ColorMask(color).apply(image)
    assert np.array_equal(mask, cv2.inRange(expected, color.low, color.high))
    assert 0 < np.count_nonzero(mask) < mask.size
    assert np.array_equal(image, before)


def test_ranges_have_attributes_and_are_compared():
    color = rv.ColorRange()
    assert (color.space, color.low, color.high) == ("hsv", BLUE.low, BLUE.high)
    color.space, color.low, color.high = "lab", (1, 2, 3), (4, 5, 6)
    assert color == rv.ColorRange("lab", (1, 2, 3), (4, 5, 6))
    for other in (("hls", (1, 2, 3), (4, 5, 6)), ("lab", (0, 2, 3), (4, 5, 6)), ("lab", (1, 2, 3))):
        assert color != rv.ColorRange(*other)


def test_spaces_tell_their_channels():
    assert rv.color_channels("hls") == [
        ("h", "hue", 180),
        ("l", "lightness", 255),
        ("s", "saturation", 255),
    ]
    assert [title_of(space) for space in rv.color_spaces()] == [
        "HSV",
        "HLS",
        "Lab",
        "YCrCb",
        "RGB",
        "BGR",
    ]


@pytest.mark.parametrize("use", [rv.color_channels, rv.default_margin, rv.ColorRange])
def test_a_space_that_is_none_is_refused(use):
    with pytest.raises(ValueError, match="space is 'cmyk', must be one of hsv, hls, lab, ycrcb"):
        rv.validate(use("cmyk"))


def test_margins():
    assert rv.range_around((100, 90, 200), "lab") == rv.range_around((100, 90, 200), "lab", 20)
    assert rv.range_around((9, 90, 200), "hls") == rv.range_around((9, 90, 200), "hls", 10)
    assert type(rv.range_around((9, 90, 200))) is rv.HsvRange


@pytest.mark.parametrize("space", rv.color_spaces())
def test_what_is_picked_is_in_its_range_or_that_is_told(space):
    """Each of some hundred colours."""
    told = 0
    for bgr in np.stack(np.meshgrid(*[range(0, 256, 51)] * 3), -1).reshape(-1, 3).tolist():
        picked = rv.to_space(bgr, space)
        color = rv.range_around(picked, space)
        row = np.full((1, 64, 3), bgr, np.uint8)
        inside = rv.ColorMask(color).apply(row)[0, 0] == 255
        assert inside == (outside(picked, color) == ""), (bgr, picked)
        told += not inside
    assert (told > 0) == (space in ("hsv", "hls"))


def test_it_is_told_what_is_too_little_and_too_much():
    said = outside((9, 240, 30), rv.range_around((9, 240, 30), "hls"))
    assert said.endswith(" colour: lightness 240 is above 205, saturation 30 is below 100")


@pytest.mark.parametrize("space", rv.color_spaces())
def test_medians_are_those_of_the_channels(space):
    region = np.zeros((1, 5, 3), np.uint8)
    region[0] = [(200, 30, 40), (200, 32, 40), (200, 34, 40), (200, 36, 40), (200, 38, 40)]
    assert median_color(region, space) == tuple(in_space(region, space)[0, 2])


def test_the_median_hue_of_hls_is_circular():
    hls = np.array([[(178, 100, 200), (2, 100, 200), (3, 100, 200), (6, 100, 200)]], np.uint8)
    gray = np.full((1, 9, 3), 90, np.uint8)
    region = np.concatenate([cv2.cvtColor(hls, cv2.COLOR_HLS2BGR), gray], axis=1)
    assert median_color(region, "hls")[0] in (2, 3)


def test_a_color_of_hsv_in_bgr_has_this_hsv():
    assert rv.bgr_of_hsv((120, 255, 255)) == (255, 0, 0)
    assert np.allclose(rv.to_hsv(rv.bgr_of_hsv((105, 225, 240))), (105, 225, 240), atol=1)


def test_a_range_of_another_space_names_it_in_yaml():
    assert as_yaml(BLUE) == "{low: [90, 50, 50], high: [120, 255, 255]}"
    assert as_yaml(rv.ColorRange()) == as_yaml(BLUE)
    assert yaml.safe_load(as_yaml(SKIN)) == SKIN_YAML


@pytest.mark.parametrize(
    "text",
    [
        "",
        "colors:\n  skin: {low: [1, 2, 3], high: [4, 5, 6], min_area: 7}  # of faces\nx: 1\n",
        "colors:\n  skin: {low: [1, 2, 3], space: hls, high: [4, 5, 6]}  # of faces\nx: 1\n",
        "colors:\n  skin:  # of faces\n    high: [4, 5, 6]\n    low: [1, 2, 3]\nx: 1\n",
        "colors:\r\n  skin:\r\n    low: [1, 2, 3]\r\n    high: [4, 5, 6]\r\n    space: lab\r\n",
        'colors: {skin: {"space": "lab", low: [1, 2, 3], high: [4, 5, 6]}}  # of faces\n',
    ],
)
def test_the_space_is_saved_in_all_usual_layouts(tmp_path, text):
    path = tmp_path / "hsv_tracker.yaml"
    path.write_bytes(text.encode())
    old = yaml.safe_load(text) or {"colors": {"skin": {}}}
    save_colors(str(path), {"skin": SKIN})
    expected = {**old, "colors": {"skin": {**old["colors"]["skin"], **SKIN_YAML}}}
    edited = path.read_bytes().decode()
    assert yaml.safe_load(edited) == expected
    assert ("# of faces" in edited) == ("# of faces" in text)
    save_colors(str(path), {"skin": BLUE})
    expected["colors"]["skin"].update(space="hsv", low=[90, 50, 50], high=[120, 255, 255])
    assert yaml.safe_load(path.read_text()) == expected


def test_a_file_without_spaces_stays_without(tmp_path):
    path = tmp_path / "hsv_tracker.yaml"
    path.write_text("colors:\n  blue: {low: [1, 2, 3], high: [4, 5, 6]}\n")
    save_colors(str(path), {"blue": BLUE, "skin": SKIN})
    assert path.read_text() == (
        "colors:\n  blue: {low: [90, 50, 50], high: [120, 255, 255]}\n"
        "  skin: {space: ycrcb, low: [0, 133, 77], high: [255, 173, 127]}\n"
    )


def test_named_limits_stay_named(tmp_path):
    """As in config/colors; in another space they would have other names, and are left."""
    path = tmp_path / "hsv_tracker.yaml"
    text = (
        "colors:\n  skin:  # of faces\n    space: ycrcb\n    y_low: 1\n    cr_low: 2\n"
        "    cb_low: 3\n    y_high: 4  # light\n    cr_high: 5\n    cb_high: 6\n"
        "  blue: {h_low: 1, s_low: 2, v_low: 3, h_high: 4, s_high: 5, v_high: 6}\n"
    )
    path.write_text(text)
    save_colors(str(path), {"skin": SKIN, "blue": BLUE})
    expected = (
        "colors:\n  skin:  # of faces\n    space: ycrcb\n    y_low: 0\n    cr_low: 133\n"
        "    cb_low: 77\n    y_high: 255 # light\n    cr_high: 173\n    cb_high: 127\n"
        "  blue: {h_low: 90, s_low: 50, v_low: 50, h_high: 120, s_high: 255, v_high: 255}\n"
    )
    assert path.read_text() == expected
    with pytest.raises(ValueError, match="not laid out like"):
        save_colors(str(path), {"blue": SKIN})
    assert path.read_text() == expected
