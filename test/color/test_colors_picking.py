"""Ranges around picked colours, median colours, and saving them in hsv_tracker's file."""

import os
import stat

import cv2
import numpy as np
import pytest
import yaml

from robot_vision import HsvRange, range_around
from robot_vision.color.color_file import save_colors
from robot_vision.color.colors import median_color
from robot_vision.common.files import add_file, create_file, replace_file
from robot_vision.viewer.window_content import Rate, placeholder, title

TEAL = HsvRange((80, 100, 100), (100, 255, 255))
TEAL_YAML = {"low": [80, 100, 100], "high": [100, 255, 255]}


@pytest.mark.parametrize("margin", [0, 1, 10, 45, 89, 90])
def test_range_contains_exactly_the_hues_within_the_margin(margin):
    for hue in range(180):
        near = range_around((hue, 200, 200), margin)
        low, high = near.low, near.high
        assert (low[1:], high[1:]) == ((100, 100), (255, 255))
        for other in range(180):
            apart = min((hue - other) % 180, (other - hue) % 180)
            wraps = low[0] > high[0]
            above, below = other >= low[0], other <= high[0]
            inside = (above or below) if wraps else (above and below)
            assert inside == (apart <= margin), (hue, other)


def test_default_margin_is_that_of_the_course():
    near = range_around((105, 225, 255))
    assert (near.low, near.high) == ((95, 100, 100), (115, 255, 255))


def hues(*values, saturation=200, value=180):
    """A row of pixels of these hues, BGR."""
    hsv = np.array([[(hue, saturation, value) for hue in values]], np.uint8)
    return cv2.cvtColor(hsv, cv2.COLOR_HSV2BGR)


@pytest.mark.parametrize(
    "values, median",
    [
        ([100, 110, 120], 110),
        ([100, 100, 100, 100, 170], 100),
        ([170, 178, 2, 6, 10], 2),
        ([150, 178, 178, 2, 30], 178),
        ([0], 0),
    ],
)
def test_median_hue_is_circular(values, median):
    region = hues(*values)
    before = region.copy()
    found = median_color(region, "hsv")
    assert found[0] == median
    assert abs(found[1] - 200) <= 1 and abs(found[2] - 180) <= 1  # rounding to BGR and back
    assert np.array_equal(region, before)


def test_gray_pixels_have_no_hue():
    gray = np.full((1, 4, 3), 90, np.uint8)
    mixed = np.concatenate([gray, hues(60, 60, 60)], axis=1)
    assert median_color(mixed, "hsv")[0] == 60
    assert median_color(gray, "hsv") == (0, 0, 90)


def test_region_may_be_a_view_but_not_empty():
    image = np.zeros((20, 30, 3), np.uint8)
    image[4:8, 5:9] = (255, 0, 0)
    assert median_color(image[4:8, 5:9], "hsv") == (120, 255, 255)
    assert median_color(image[:, :, ::-1][4:8, 5:9], "hsv") == (0, 255, 255)
    with pytest.raises(ValueError, match="empty"):
        median_color(image[4:4], "hsv")


FILE = """\
# What to look for
gamma: 1.0

colors:                                              # by name
  # the course's
  blue: {low: [90, 50, 50], high: [120, 255, 255]}   # OpenCV's 8-bit HSV
  red:  {high: [10, 255, 255], low: [170, 9, 9]}     # wraps
# behind
min_area: 200.0   # px^2
label: "a # no comment"
"""


def test_replacing_a_color_keeps_the_rest_of_the_file(tmp_path):
    path = tmp_path / "hsv_tracker.yaml"
    path.write_text(FILE)
    save_colors(str(path), {"red": TEAL})
    expected = FILE.replace(
        "{high: [10, 255, 255], low: [170, 9, 9]}     # wraps",
        "{high: [100, 255, 255], low: [80, 100, 100]} # wraps",
    )
    assert path.read_text() == expected
    save_colors(str(path), {"red": HsvRange((1, 2, 3), (4, 5, 6))})
    assert path.read_text() == expected.replace(
        "{high: [100, 255, 255], low: [80, 100, 100]} # wraps",
        "{high: [4, 5, 6], low: [1, 2, 3]}            # wraps",
    )


def test_new_color_is_added_below_the_others(tmp_path):
    path = tmp_path / "hsv_tracker.yaml"
    path.write_text(FILE)
    for _ in range(2):
        save_colors(str(path), {"teal": TEAL})
        assert path.read_text() == FILE.replace(
            "# wraps\n",
            "# wraps\n  teal: {low: [80, 100, 100], high: [100, 255, 255]}\n",
        )


@pytest.mark.parametrize(
    "text",
    [
        None,
        "",
        "min_area: 200.0",
        "colors:\n",
        "colors:",
        "colors:   # none yet\n# more\nmin_area: 1\n",
        "colors: {}  # none yet\nmin_area: 1\n",
        "colors: {blue: {low: [1, 2, 3], high: [4, 5, 6]}}  # in one line\n",
        "colors:\n    blue: {low: [1, 2, 3], high: [4, 5, 6]}",
        "colors:\n  teal: {low: [1, 2, 3], high: [4, 5, 6], min_area: 7}  # more of it\n",
        "colors:\n  blue:\n    high: [4, 5, 6]\n    low:\n    - 1\n    - 2\n# behind\nx: 1\n",
        "colors:\n  teal:  # of the sea\n    high: [4, 5, 6]  # up\n    low: [1, 2, 3]\nx: 1\n",
        "a: 1\r\ncolors:\r\n  blue: {low: [1, 2, 3], high: [4, 5, 6]}\r\nx: 1\r\n",
        'colors:\n  "teal": {low: [0, 0, 0], high: [0, 0, 0]}\n',
        "---\ncolors: {blue: {low: [1, 2, 3],\n    high: [4, 5, 6]}}\n",
    ],
)
def test_all_usual_layouts_can_be_edited(tmp_path, text):
    path = tmp_path / "hsv_tracker.yaml"
    before = (yaml.safe_load(text) if text else None) or {}
    if text is not None:
        path.write_bytes(text.encode())
    save_colors(str(path), {"teal": TEAL})
    colors = before.get("colors") or {}
    colors["teal"] = {**colors.get("teal", {}), **TEAL_YAML}
    edited = path.read_bytes().decode()
    assert yaml.safe_load(edited) == {**before, "colors": colors}
    for comment in ("# none yet", "# more", "# in one line", "# behind", "# of the sea", "# up"):
        assert (comment in edited) == (comment in (text or ""))
    assert os.listdir(tmp_path) == [path.name]


@pytest.mark.parametrize(
    "text, error",
    [
        ("colors: [1, 2]\n", "its colors are no map"),
        ("colors: blue\n", "its colors are no map"),
        ("- 1\n", "no map of parameters"),
        ("just text\n", "no map of parameters"),
        ("colors: {blue\n", "no valid YAML"),
        ("{a: 1}\n", "not laid out"),
        ("colors: ~\n", "not laid out"),
        ("a: 1\n...\n", "not laid out"),
        ("colors:\n  teal: [1, 2]\n", "not laid out"),
        ("colors:\n  teal: {low: [1, 2, 3]}\n", "not laid out"),
        ("colors:\n  teal:\n    low: [1]\n    high:\n      - 1\n      # last\n", "not laid out"),
        ("a: &x {teal: {low: [1], high: [2]}}\ncolors: *x\n", "not laid out"),
        ("colors: {a: {low: [1], high: [2]},}\n", "not laid out"),
        (b"colors:\n  bl\xfce: 1\n", "no text"),
    ],
)
def test_files_of_other_layouts_are_not_changed(tmp_path, text, error):
    path = tmp_path / "hsv_tracker.yaml"
    data = text if isinstance(text, bytes) else text.encode()
    path.write_bytes(data)
    with pytest.raises(ValueError, match=error) as caught:
        save_colors(str(path), {"teal": TEAL})
    assert str(caught.value).startswith(f"{path}: not overwritten")
    assert path.read_bytes() == data
    assert os.listdir(tmp_path) == [path.name]


def test_several_colors_are_saved_in_one_step(tmp_path):
    path = tmp_path / "hsv_tracker.yaml"
    path.write_text(FILE)
    save_colors(str(path), {"teal": TEAL, "blue": TEAL})
    colors = yaml.safe_load(path.read_text())["colors"]
    assert colors == {
        "blue": TEAL_YAML,
        "red": {"low": [170, 9, 9], "high": [10, 255, 255]},
        "teal": TEAL_YAML,
    }
    before = path.read_text()
    with pytest.raises(ValueError, match="no name for a colour"):
        save_colors(str(path), {"blue": HsvRange((1, 2, 3), (4, 5, 6)), "two words": TEAL})
    assert path.read_text() == before


@pytest.mark.parametrize("name", ["", "two words", "1st", "yes", "null", "a: b", "blau#", "grün"])
def test_names_that_yaml_or_ros_would_misread_are_refused(tmp_path, name):
    with pytest.raises(ValueError, match="no name for a colour"):
        save_colors(str(tmp_path / "new.yaml"), {name: TEAL})
    assert not os.listdir(tmp_path)


def test_permissions_and_links_are_kept(tmp_path):
    file = tmp_path / "real" / "file.yaml"
    file.parent.mkdir()
    file.write_text("old")
    file.chmod(0o640)
    link = tmp_path / "link.yaml"
    link.symlink_to(file)
    replace_file(str(link), b"new")
    assert link.is_symlink() and file.read_text() == "new"
    assert stat.S_IMODE(file.stat().st_mode) == 0o640
    assert os.listdir(file.parent) == ["file.yaml"]


def test_failure_keeps_the_old_file_and_leaves_no_other(tmp_path, monkeypatch):
    file = tmp_path / "file.yaml"
    file.write_text("old")

    def full(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        replace_file(str(file), b"new")
    with pytest.raises(OSError, match="No space left"):
        add_file(str(tmp_path), "file", ".png", b"new")
    with pytest.raises(OSError, match="No space left"):
        create_file(str(tmp_path / "new.png"), b"new")
    assert file.read_text() == "old" and os.listdir(tmp_path) == ["file.yaml"]


def test_added_files_never_replace_one(tmp_path):
    (tmp_path / "a.png").write_text("mine")
    (tmp_path / "a-2.png").symlink_to("nowhere")
    paths = [add_file(str(tmp_path), "a", ".png", text) for text in (b"one", b"two")]
    assert [os.path.basename(path) for path in paths] == ["a-1.png", "a-3.png"]
    texts = [(tmp_path / name).read_text() for name in ("a.png", "a-1.png", "a-3.png")]
    assert texts == ["mine", "one", "two"]
    assert not os.path.exists(tmp_path / "nowhere") and len(os.listdir(tmp_path)) == 4
    with pytest.raises(FileNotFoundError) as error:
        add_file(str(tmp_path / "missing"), "a", ".png", b"")
    assert str(error.value) == (
        f"{tmp_path}/missing/a.png cannot be written: No such file or directory"
    )


def test_created_files_never_replace_one(tmp_path):
    (tmp_path / "mine").write_text("mine")
    (tmp_path / "link").symlink_to("nowhere")
    create_file(str(tmp_path / "new"), b"new")
    for name in ("mine", "link", "new"):
        with pytest.raises(FileExistsError, match=name):
            create_file(str(tmp_path / name), b"other")
    assert (tmp_path / "mine").read_text() == "mine" and (tmp_path / "new").read_text() == "new"
    assert sorted(os.listdir(tmp_path)) == ["link", "mine", "new"]


def test_rate_is_that_of_the_last_seconds():
    rate = Rate(3.0)
    assert rate.hz(0.0) == 0.0
    for i in range(100):
        rate.add(i / 10)  # up to 9.9 s
    assert rate.hz(9.9) == pytest.approx(10.0)
    rate.add(10.4)  # from 7.4 s on: 26 intervals in 3 s
    assert rate.hz(10.4) == pytest.approx(26 / 3)
    assert rate.hz(13.5) == 0.0


def test_title_and_waiting_image_of_the_window():
    assert title("/camera/image", 29.96, (640, 480)) == "/camera/image  30.0 Hz  640x480"
    assert title("/camera/image", 0.0, None) == "/camera/image  waiting"
    for topic in (
        "/a",
        "/a_very_long/name_of/a_topic/that/does_not_fit/into_the_image/image_raw",
    ):
        image = placeholder(topic)
        written = np.argwhere(image[:, :, 0] != 128)
        assert image.shape == (480, 640, 3) and len(written) > 100
        assert written.min() >= 15 and written[:, 1].max() < 625
