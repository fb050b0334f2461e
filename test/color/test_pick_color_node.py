"""The command pick_color.py: every kind of input, saving, and clear errors."""

import cv2
import numpy as np
import pytest
import rosgraph
import rospy
import support
import yaml
from sensor_msgs.msg import Image

BLUE, RED = (255, 144, 30), (20, 10, 220)  # BGR
BLUE_HSV, RED_HSV = (105, 225, 255), (179, 243, 220)
BLUE_YAML = "{low: [95, 100, 100], high: [115, 255, 255]}"
RED_YAML = "{low: [169, 100, 100], high: [9, 255, 255]}"
FILE = """\
# what to look for
colors:
  blue: {low: [90, 50, 50], high: [120, 255, 255]}   # the course's
min_area: 200.0   # px^2
"""


@pytest.fixture
def pick(start):
    """Runs the command to its end: (exit code, output)."""

    def run(*arguments, env=None):
        process = start("pick_color.py", *arguments, env=env)
        return process.exit_code(), process.output()

    return run


@pytest.fixture
def image(tmp_path):
    """A blue image file of 60x40 with a red rectangle at (30, 20), in which one pixel is gray."""
    pixels = np.full((40, 60, 3), BLUE, np.uint8)
    pixels[20:30, 30:40] = RED
    pixels[25, 35] = 128
    path = tmp_path / "image.png"
    cv2.imwrite(str(path), pixels)
    return path


def printed(bgr, hsv, text, name="name"):
    color = f"BGR {bgr}, HSV {hsv}" if bgr else f"HSV {hsv}"
    return f"{color}; for the colors of hsv_tracker:\n  {name}: {text}\n"


@pytest.mark.parametrize(
    "arguments, output",
    [
        (["--bgr", 255, 144, 30], printed(BLUE, BLUE_HSV, BLUE_YAML)),
        (["--rgb", 30, 144, 255], printed(BLUE, BLUE_HSV, BLUE_YAML)),
        (["--hex", "#1e90ff"], printed(BLUE, BLUE_HSV, BLUE_YAML)),
        (["--hex", "1E90FF", "--name", "sky"], printed(BLUE, BLUE_HSV, BLUE_YAML, "sky")),
        (
            ["--hsv", 179, 1, 2],
            printed(None, (179, 1, 2), RED_YAML) + "the range does not hold this colour: "
            "saturation 1 is below 100, value 2 is below 100\n",
        ),
        (
            ["--bgr", 255, 144, 30, "--margin", 20],
            printed(BLUE, BLUE_HSV, "{low: [85, 100, 100], high: [125, 255, 255]}"),
        ),
    ],
)
def test_color_of_the_command_line(pick, arguments, output):
    assert pick(*arguments) == (0, output)


@pytest.mark.parametrize(
    "place, output",
    [
        (["--at", 29, 20], printed(BLUE, BLUE_HSV, BLUE_YAML)),
        (["--at", 30, 20], printed(RED, RED_HSV, RED_YAML)),
        (["--region", 30, 20, 10, 10], printed(None, RED_HSV, RED_YAML)),
        (["--region", 0, 0, 60, 40], printed(None, BLUE_HSV, BLUE_YAML)),
    ],
)
def test_color_of_an_image_file(pick, image, place, output):
    assert pick(image, *place) == (0, output)


@pytest.mark.parametrize(
    "arguments, output",
    [
        (
            ["--bgr", 255, 144, 30, "--space", "lab"],
            f"BGR {BLUE}, Lab (152, 138, 65); for the colors of hsv_tracker:\n"
            "  name: {space: lab, low: [92, 118, 45], high: [212, 158, 85]}\n",
        ),
        (
            ["--rgb", 30, 144, 255, "--space", "bgr", "--margin", 5, "--name", "sky"],
            f"BGR {BLUE}; for the colors of hsv_tracker:\n"
            "  sky: {space: bgr, low: [250, 139, 25], high: [255, 149, 35]}\n",
        ),
        (
            ["--hsv", 120, 255, 255, "--space", "rgb"],
            "RGB (0, 0, 255); for the colors of hsv_tracker:\n"
            "  name: {space: rgb, low: [0, 0, 235], high: [20, 20, 255]}\n",
        ),
        (
            ["--hex", "#ffffff", "--space", "hls"],
            "BGR (255, 255, 255), HLS (0, 255, 0); for the colors of hsv_tracker:\n"
            "  name: {space: hls, low: [170, 50, 100], high: [10, 205, 255]}\n"
            "the range does not hold this colour: lightness 255 is above 205, "
            "saturation 0 is below 100\n",
        ),
    ],
)
def test_the_range_may_be_of_another_space(pick, arguments, output):
    assert pick(*arguments) == (0, output)


def test_a_median_of_another_space_is_saved_with_its_space(pick, image, tmp_path):
    path = tmp_path / "hsv_tracker.yaml"
    path.write_text(FILE)
    region = [image, "--region", 30, 20, 10, 10]
    code, output = pick(*region, "--space", "ycrcb", "--save", path, "--name", "blue")
    y, cr, cb = cv2.cvtColor(np.uint8([[RED]]), cv2.COLOR_BGR2YCrCb)[0, 0].tolist()
    assert code == 0 and output.startswith(f"YCrCb ({y}, {cr}, {cb}); for the colors")
    low, high = [y - 60, cr - 20, cb - 20], [y + 60, min(cr + 20, 255), cb + 20]
    saved = yaml.safe_load(path.read_text())["colors"]["blue"]
    assert saved == {"space": "ycrcb", "low": [max(0, one) for one in low], "high": high}


def publish(encoding, pixels):
    publisher = rospy.Publisher("/pictures", Image, queue_size=1, latch=True)
    height, width = pixels.shape[:2]
    step = pixels[0].nbytes
    publisher.publish(
        Image(encoding=encoding, width=width, height=height, step=step, data=pixels.tobytes())
    )
    return publisher


def test_color_of_a_topic(pick, image):
    rgb = np.ascontiguousarray(cv2.imread(str(image))[:, :, ::-1])
    publisher = publish("rgb8", rgb)
    assert pick("--topic", "/pictures", "--at", 30, 20) == (0, printed(RED, RED_HSV, RED_YAML))
    region = ["--region", 30, 20, 10, 10]
    # Names are resolved and remapped as those of any node.
    code, output = pick("--topic", "image", *region, "image:=/pictures")
    assert (code, output) == (0, printed(None, RED_HSV, RED_YAML))
    publisher.unregister()


def test_topic_without_publisher_is_an_error(pick):
    code, output = pick("--topic", "/silent", "--at", 1, 1, "--timeout", 0.5)
    assert code == 1
    assert output == (
        "pick_color.py: /silent: no image came within 0.5 s; nobody publishes images there\n"
    )


def test_topic_without_a_usable_image_is_an_error(pick):
    publisher = publish("32FC2", np.zeros((4, 4, 2), np.float32))

    def has_come():
        code, output = pick("--topic", "/pictures", "--at", 1, 1, "--timeout", 3)
        assert code == 1
        return None if "no image came" in output else output

    output = support.wait_for(has_come, "an image within 3 s")
    assert output.endswith("pick_color.py: /pictures: no image was usable within 3 s\n")
    publisher.unregister()


def test_missing_master_is_an_error(pick):
    uri = f"http://127.0.0.1:{support.free_port()}"
    code, output = pick("--topic", "/silent", "--at", 1, 1, env={"ROS_MASTER_URI": uri})
    assert (code, output) == (1, f"pick_color.py: no ROS master answers at {uri}\n")


def test_waiting_can_be_interrupted(start):
    process = start("pick_color.py", "--topic", "/silent", "--at", 1, 1)
    state = rosgraph.Master("/test").getSystemState
    support.wait_for(lambda: "/silent" in dict(state()[1]), "its subscription")
    process.interrupt()
    assert process.prompt_exit_code() == 130
    assert process.output() == ""


def test_range_without_the_color_is_saved_only_by_force(pick, tmp_path):
    path = tmp_path / "hsv_tracker.yaml"
    path.write_text(FILE)
    gray = ["--hsv", 5, 20, 200, "--save", path, "--name", "blue"]
    code, output = pick(*gray)
    assert code == 1 and "the range does not hold this colour: saturation 20 is below" in output
    assert f"{path}: not saved; --force saves this range all the same\n" in output
    assert path.read_text() == FILE
    code, output = pick(*gray, "--force")
    assert code == 0 and output.endswith(f"saved in {path}\n")
    assert path.read_text() != FILE


def test_saving_twice_changes_one_line(pick, tmp_path):
    path = tmp_path / "hsv_tracker.yaml"
    path.write_text(FILE)
    for _ in range(2):
        code, output = pick("--hex", "#1e90ff", "--save", path, "--name", "blue")
        assert code == 0 and output.endswith(f"saved in {path}\n")
        assert path.read_text() == FILE.replace(
            "{low: [90, 50, 50], high: [120, 255, 255]}   #", BLUE_YAML + " #"
        )
    assert pick("--bgr", *RED, "--save", path, "--name", "red")[0] == 0
    assert yaml.safe_load(path.read_text()) == {
        "colors": {
            "blue": {"low": [95, 100, 100], "high": [115, 255, 255]},
            "red": {"low": [169, 100, 100], "high": [9, 255, 255]},
        },
        "min_area": 200.0,
    }


@pytest.mark.parametrize(
    "text, error",
    [("colors: [1, 2]\n", "its colors are no map"), ("colors: {a\n", "is no valid YAML")],
)
def test_bad_file_is_not_changed(pick, tmp_path, text, error):
    path = tmp_path / "hsv_tracker.yaml"
    path.write_text(text)
    code, output = pick("--hex", "#1e90ff", "--save", path, "--name", "blue")
    assert code == 1
    assert f"pick_color.py: {path}: not overwritten, for " in output and error in output
    assert path.read_text() == text


def test_errors_of_files_name_them(pick, image, tmp_path):
    no_image = tmp_path / "text.png"
    for content in ("", "text"):
        no_image.write_text(content)
        code, output = pick(no_image, "--at", 1, 1)
        assert (code, output) == (
            1,
            f"pick_color.py: {no_image}: no image that OpenCV can read\n",
        )
    missing = tmp_path / "missing" / "file"
    for arguments, tried in (
        ([missing, "--at", 1, 1], "read"),
        (["--hsv", 1, 200, 200, "--name", "a", "--save", missing], "written"),
    ):
        code, output = pick(*arguments)
        assert code == 1
        assert f"pick_color.py: {missing} cannot be {tried}: No such file or directory\n" in output


@pytest.mark.parametrize(
    "place",
    [
        ["--at", 60, 0],
        ["--at", 0, 40],
        ["--at", -1, 0],
        ["--region", 50, 0, 11, 1],
        ["--region", 0, 0, 0, 5],
        ["--region", 0, 0, 5, -1],
    ],
)
def test_places_outside_of_the_image_are_refused(pick, image, place):
    code, output = pick(image, *place)
    assert code == 1 and "not inside of the image of 60x40" in output


@pytest.mark.parametrize(
    "arguments, error",
    [
        ([], "required"),
        (["--bgr", 1, 2, 256], "256 must be from 0 to 255"),
        (["--bgr", 1, 2, "x"], "invalid integer value: 'x'"),
        (["--hsv", 180, 0, 0], "the hue is 180, must be from 0 to 179"),
        (["--hex", "#12345"], "six hexadecimal digits"),
        (["--hex", "#1e90ff", "--rgb", 1, 2, 3], "not allowed with"),
        (["--hex", "#1e90ff", "--at", 1, 2], "needs --at or --region"),
        (["--topic", "/a"], "needs --at or --region"),
        (["p.png", "--at", 1, 2, "--region", 1, 2, 3, 4], "not allowed with"),
        (["--hex", "#1e90ff", "--margin", 91], "91 must be from 0 to 90"),
        (["--hex", "#1e90ff", "--space", "cmyk"], "argument --space: invalid choice: 'cmyk'"),
        (["--hex", "#1e90ff", "--save", "f"], "--save needs --name"),
        (["--topic", "/a", "--at", 1, 1, "--timeout", 0], "must be above 0"),
    ],
)
def test_invalid_commands_are_refused(pick, arguments, error):
    code, output = pick(*arguments)
    assert code == 2 and error in output


def test_help_has_examples(pick):
    code, output = pick("--help")
    assert code == 0 and "examples:\n  pick_color.py --hex '#1e90ff'" in output
