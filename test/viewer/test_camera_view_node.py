"""The viewer's window: what it shows and says, clicks, keys, and how it ends."""

import ctypes
import pathlib
import re
import subprocess

import cv2
import numpy as np
import pytest
import rosgraph
import rospy
import support
import yaml
from ros_programs import ROSLAUNCH
from sensor_msgs.msg import Image, RegionOfInterest

from robot_vision import range_around, to_space
from robot_vision.color.colors import as_yaml
from robot_vision.msg import Click
from robot_vision.viewer.channel_view import ChannelView

NODE = "simple_camera_view_node.py"
WIDTH, HEIGHT = 320, 200
BLUE, RED = (255, 144, 30), (20, 10, 220)  # BGR
# What the course takes around their hues; red is 179 and wraps around.
RANGES = {
    BLUE: "  name: {low: [95, 100, 100], high: [115, 255, 255]}",
    RED: "  name: {low: [169, 100, 100], high: [9, 255, 255]}",
}
HSV = {BLUE: (105, 225, 255), RED: (179, 243, 220)}


def sample():
    """Blue, but for a red rectangle from (200, 100) to (259, 139), and noise on the left."""
    pixels = np.full((HEIGHT, WIDTH, 3), BLUE, np.uint8)
    pixels[100:140, 200:260] = RED
    pixels[:, :50] = np.random.RandomState(1).randint(0, 256, (HEIGHT, 50, 3))
    return pixels


def message(pixels, seconds):
    """The pixels as rgb8: the node has to convert them."""
    image = Image(encoding="rgb8", width=pixels.shape[1], height=pixels.shape[0])
    image.step = 3 * image.width
    image.data = pixels[:, :, ::-1].tobytes()
    image.header.stamp = rospy.Time(seconds, 7)
    image.header.frame_id = f"camera_{seconds}"
    return image


def xdotool(*arguments):
    subprocess.run(["xdotool", *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


def window(topic="/images", what=""):
    """The number of the window with this topic, and text, in its title, once it is there."""

    def found():
        named = [number for name, number in support.windows().items() if topic + "  " in name]
        return named if any(what in name for name in support.windows()) else []

    return support.wait_for(found, f"a window with {topic} and {what}")[0]


def click(number, x, y):
    xdotool("mousemove", "--window", number, x, y, "click", 1)
    xdotool("mousemove", 1300, 1000)  # the pointer is drawn into the image


def press(number, key):
    xdotool("windowfocus", "--sync", number, "key", key)


def close(number):
    """What a window manager sends when its user closes a window: WM_DELETE_WINDOW (ICCCM)."""

    class Message(ctypes.Structure):
        _fields_ = (
            ("type", ctypes.c_int),
            ("serial", ctypes.c_ulong),
            ("send_event", ctypes.c_int),
            ("display", ctypes.c_void_p),
            ("window", ctypes.c_ulong),
            ("message_type", ctypes.c_ulong),
            ("format", ctypes.c_int),
            ("data", ctypes.c_long * 5),
            ("padding", ctypes.c_long * 24),  # XSendEvent reads a whole XEvent
        )

    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XInternAtom.restype = ctypes.c_ulong
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    protocols, delete = (
        x11.XInternAtom(display, name, 0) for name in (b"WM_PROTOCOLS", b"WM_DELETE_WINDOW")
    )
    client_message = 33
    event = Message(client_message, 0, 1, display, number, protocols, 32, (delete, 0))
    x11.XSendEvent(display, ctypes.c_ulong(number), 0, ctypes.c_long(0), ctypes.byref(event))
    x11.XCloseDisplay(display)


@pytest.fixture
def publisher():
    made = rospy.Publisher("/images", Image, queue_size=1, latch=True)
    yield made
    made.unregister()


@pytest.fixture
def view(start, display, tmp_path):
    """Starts the node, saving into tmp_path/saved, and waits for its window."""
    (tmp_path / "saved").mkdir()

    def start_view(*arguments):
        folder = f"_save_folder:={tmp_path / 'saved'}"
        process = start(NODE, "__name:=view", "image:=/images", folder, *arguments)
        window()
        return process

    return start_view


def show(publisher, pixels, seconds, display):
    """Publishes an image and waits until it is on the screen. The window is at (0, 0)."""
    publisher.publish(message(pixels, seconds))
    height, width = pixels.shape[:2]
    support.wait_for(
        lambda: np.array_equal(support.screen(display)[:height, :width], pixels),
        "the image on the screen, to the bit",
    )


def saved(tmp_path):
    """The files in the folder, but for one that is being written."""
    return sorted((tmp_path / "saved").glob("[!.]*"))


def test_title_tells_topic_rate_and_size(start, display):
    start("camera_node", "__name:=camera", "_source:=synthetic", "_framerate:=5.0")
    start(NODE, "image:=/camera/image_raw")
    window("/camera/image_raw", "640x480")

    def rate():
        titles = [name for name in support.windows() if name.startswith("/camera/image_raw  ")]
        found = re.fullmatch(r"/camera/image_raw  ([\d.]+) Hz  640x480", "".join(titles))
        return found and 3.0 < float(found.group(1)) < 7.0

    support.wait_for(rate, "a rate that is near the camera's")


def test_the_rate_falls_to_zero_when_the_topic_falls_silent(view, publisher, display):
    view()
    show(publisher, sample(), 1, display)
    window(what="0.0 Hz  320x200")


def test_waiting_is_told(view, display):
    view()
    window(what="waiting")

    def text_on_gray():
        pixels = support.screen(display)[:480, :640]
        gray = np.count_nonzero(pixels == 128)
        return gray > 0.9 * pixels.size and np.count_nonzero(pixels > 200) > 500

    support.wait_for(text_on_gray, "the text on gray")
    number = window()
    click(number, 100, 100)  # on no image: nothing comes of it
    press(number, "s")
    press(number, "q")


@pytest.mark.parametrize("x, y, color", [(200, 100, RED), (259, 139, RED), (199, 100, BLUE)])
def test_a_click_is_published_and_printed(view, publisher, display, x, y, color):
    process = view()
    clicks = support.subscribed("/view/clicked", Click)
    show(publisher, sample(), 1, display)
    click(window(), x, y)
    (found,) = clicks.wait()
    assert (found.x, found.y) == (x, y)
    assert (tuple(found.bgr), tuple(found.hsv)) == (color, HSV[color])
    process.wait_for_output(RANGES[color])
    assert f"x {x}, y {y}: BGR {color}, HSV {HSV[color]}" in process.output()


def test_a_click_tells_the_color_in_all_spaces_and_the_range_in_one(view, publisher, display):
    process = view()
    clicks = support.subscribed("/view/clicked", Click)
    show(publisher, sample(), 1, display)
    expected = {name: to_space(RED, name) for name in ("bgr", "hsv", "hls", "lab", "ycrcb")}
    for name, code in (("hls", cv2.COLOR_BGR2HLS), ("lab", cv2.COLOR_BGR2Lab)):
        assert tuple(cv2.cvtColor(sample(), code)[120, 230]) == expected[name]
    for count, space in enumerate(("hls", "lab", "ycrcb", "rgb", "bgr"), 1):
        support.reconfigured("/view", space=space)
        click(window(), 200, 100)
        found = clicks.wait(count)[-1]
        assert {name: tuple(getattr(found, name)) for name in expected} == expected
        wanted = range_around(to_space(RED, space), space)
        process.wait_for_output(
            "x 200, y 100: BGR {bgr}, HSV {hsv}, HLS {hls}, Lab {lab}, YCrCb {ycrcb}; for the "
            "colors of hsv_tracker:\n  name: ".format(**expected)
            + as_yaml(wanted)
        )


def test_c_shows_the_channels_of_one_space_after_the_other(view, publisher, display):
    """Each tile has every second pixel; clicks and rectangles are of the image all the same."""
    view("_show:=lab")
    clicks = support.subscribed("/view/clicked", Click)
    regions = support.subscribed("/view/selected", RegionOfInterest)
    publisher.publish(message(sample(), 1))
    number = window(what="320x200")

    def shown(what):
        def is_shown():
            seen = support.screen(display)[:HEIGHT, :WIDTH]
            return np.array_equal(seen, ChannelView(what, (WIDTH, HEIGHT)).of(sample()))

        support.wait_for(is_shown, what)

    shown("lab")
    for what in ("ycrcb", "bgr", "hsv", "hls", "lab"):
        press(number, "c")
        shown(what)
    click(number, 160 + 101, 100 + 51)  # in the last tile
    (found,) = clicks.wait()
    assert (found.x, found.y, tuple(found.bgr)) == (202, 102, RED)
    drag(number, (100, 120), (129, 139))  # in the third one
    (region,) = regions.wait()
    assert (region.x_offset, region.y_offset, region.width, region.height) == (200, 40, 60, 40)
    support.reconfigured("/view", show="hls")
    shown("hls")


def test_a_click_has_the_header_of_the_image_shown(view, publisher, display):
    view()
    clicks = support.subscribed("/view/clicked", Click)
    for seconds, pixels in [(1, sample()), (2, 255 - sample())]:
        show(publisher, pixels, seconds, display)
        click(window(), 230, 120)
        found = clicks.wait(seconds)[-1]
        assert (found.header.stamp, found.header.frame_id) == (
            rospy.Time(seconds, 7),
            f"camera_{seconds}",
        )
        assert tuple(found.bgr) == tuple(pixels[120, 230])


def drag(number, begin, end, between=lambda: None):
    """Draws a rectangle with the left button; `between` is called before it is released."""
    xdotool("mousemove", "--window", number, *begin, "mousedown", 1)
    middle = [(a + b) // 2 for a, b in zip(begin, end)]
    for place in (middle, end):
        xdotool("mousemove", "--window", number, *place)
    between()
    xdotool("mouseup", 1)
    xdotool("mousemove", 1300, 1000)


@pytest.mark.parametrize(
    "begin, end, expected",
    [
        ((200, 100), (259, 139), (200, 100, 60, 40)),
        ((259, 139), (200, 100), (200, 100, 60, 40)),
        ((300, 150), (600, 500), (300, 150, 20, 50)),  # out of the image
    ],
)
def test_a_dragged_rectangle_is_drawn_and_published(view, publisher, display, begin, end, expected):
    process = view()
    clicks = support.subscribed("/view/clicked", Click)
    regions = support.subscribed("/view/selected", RegionOfInterest)
    show(publisher, sample(), 1, display)
    x, y, width, height = expected

    border = np.zeros((HEIGHT, WIDTH), bool)
    border[y : y + height, x : x + width] = True
    border[y + 1 : y + height - 1, x + 1 : x + width - 1] = False

    def is_drawn():
        green = (support.screen(display)[:HEIGHT, :WIDTH] == (0, 255, 0)).all(axis=2)
        return np.mean(green[border]) > 0.7 and not green[~border].any()  # the pointer is before it

    drag(window(), begin, end, lambda: support.wait_for(is_drawn, "the rectangle"))
    (found,) = regions.wait()
    assert (found.x_offset, found.y_offset, found.width, found.height) == expected
    process.wait_for_output(f"x {x}, y {y}: selected {width}x{height} px")
    support.wait_for(
        lambda: np.array_equal(support.screen(display)[:HEIGHT, :WIDTH], sample()),
        "the image without a rectangle",
    )
    click(window(), 230, 120)  # is no drag, nor was the drag a click
    assert [(one.x, one.y) for one in clicks.wait()] == [(230, 120)]
    assert len(regions.received) == 1


@pytest.mark.parametrize("scale", [0.5, 3])
def test_clicks_hit_the_image_s_pixels_in_a_resized_window(view, publisher, display, scale):
    """However large OpenCV shows the image there: some versions leave it as large as it was."""
    green = (10, 220, 20)
    view("_autosize:=false")
    clicks = support.subscribed("/view/clicked", Click)
    publisher.publish(message(sample(), 1))
    number = window(what="320x200")
    xdotool("windowsize", "--sync", number, int(WIDTH * scale), int(HEIGHT * scale))
    # What is painted after this has its place.
    recolored = sample()
    recolored[100:140, 200:260] = green
    publisher.publish(message(recolored, 2))

    def rectangle():
        """left, top, width and height of the green rectangle on the screen, px."""
        near = np.abs(support.screen(display).astype(int) - green).max(axis=2) < 8
        boxes = cv2.connectedComponentsWithStats(near.astype(np.uint8))[2][1:]
        largest = max(boxes, key=lambda box: box[cv2.CC_STAT_AREA], default=(0, 0, 0, 0, 0))
        return tuple(largest[:4]) if largest[cv2.CC_STAT_AREA] > 100 else None

    left, top, width, height = support.wait_for(rectangle, "the green rectangle")
    shown = width / 60
    assert height / 40 == pytest.approx(shown, abs=3 / 40)
    for x, y, expected in [
        (left, top, (200, 100)),
        (left + width - 1, top + height - 1, (259, 139)),
    ]:
        clicks.received.clear()
        click(number, x, y)
        (found,) = clicks.wait()
        assert np.abs(np.subtract((found.x, found.y), expected)).max() <= max(1, 1 / shown)
        assert tuple(found.bgr) == tuple(recolored[found.y, found.x])


def test_s_saves_the_image_and_never_over_a_file(view, publisher, display, tmp_path):
    process = view()
    show(publisher, sample(), 1, display)
    (tmp_path / "saved" / "1.000000007.png").write_text("mine")
    for count in (2, 3):
        press(window(), "s")
        support.wait_for(lambda: len(saved(tmp_path)) == count, "the file")  # noqa: B023
    mine, *images = saved(tmp_path)[::-1]
    assert mine.read_text() == "mine"
    assert {path.name for path in images} == {"1.000000007-1.png", "1.000000007-2.png"}
    for path in images:
        process.wait_for_output(f"saved {path}")
        assert np.array_equal(cv2.imread(str(path)), sample())


def test_an_image_that_cannot_be_saved_is_an_error_and_no_end(view, publisher, display, tmp_path):
    (tmp_path / "saved").rmdir()
    process = view()
    show(publisher, sample(), 1, display)
    press(window(), "s")
    process.wait_for_output("no image saved in")
    assert "No such file or directory" in process.output()
    (tmp_path / "saved").mkdir()
    press(window(), "s")
    support.wait_for(lambda: len(saved(tmp_path)) == 1, "the file")


@pytest.mark.parametrize("how", ["q", "Escape", "close", "SIGINT"])
@pytest.mark.parametrize("images", [True, False])
def test_all_ways_to_end_it(view, publisher, display, how, images):
    process = view()
    number = window()
    if images:
        show(publisher, sample(), 1, display)
    if how == "SIGINT":
        process.interrupt()
    elif how == "close":
        close(int(number))
    else:
        press(number, how)
    assert process.prompt_exit_code() == 0, process.output()
    assert "Traceback" not in process.output()
    nodes = {
        node for part in rosgraph.Master("/test").getSystemState() for _, of in part for node in of
    }
    assert not nodes & {"/view", "/view_images"}


@pytest.mark.parametrize(
    "display_name, said", [("", "DISPLAY is not set"), (":7654", "DISPLAY is ':7654'")]
)
def test_without_a_display(start, display_name, said):
    process = start(NODE, env={"DISPLAY": display_name})
    assert process.exit_code() == 1
    (line,) = (line for line in process.output().splitlines() if "[FATAL]" in line)
    assert said in line
    assert "Traceback" not in process.output()


@pytest.mark.parametrize(
    "parameter, said",
    [
        ("_autosize:=3", "autosize is 3, must be true or false"),
        ("_save_folder:=7", "save_folder is 7, must be a string"),
        ("_space:=cmyk", "space is 'cmyk', must be one of hsv, hls, lab, ycrcb, rgb, bgr"),
        ("_show:=gray", "show is 'gray', must be one of bgr, hsv, hls, lab, ycrcb"),
        ("_image_transport:=pigeon", "must be one that is installed"),
    ],
)
def test_bad_parameters_are_fatal(start, display, parameter, said):
    process = start(NODE, "image:=/images", parameter)
    assert process.exit_code() == 1
    assert "[FATAL]" in process.output() and said in process.output()
    assert "Traceback" not in process.output()


def test_the_launch_file_loads_the_defaults(start, display):
    config = pathlib.Path(__file__).resolve().parents[2] / "config" / "simple_camera_view.yaml"
    defaults = yaml.safe_load(config.read_text())
    assert defaults == {"autosize": True, "space": "hsv", "show": "bgr", "save_folder": "."}
    start(ROSLAUNCH, "robot_vision", "simple_camera_view.launch", "image:=/a/topic")
    window("/a/topic")
    for name, value in defaults.items():
        assert rospy.get_param("/simple_camera_view/" + name) == value
