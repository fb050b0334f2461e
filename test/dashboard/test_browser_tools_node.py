"""The tools of the dashboard's page, used by a real browser with the nodes that they are for."""

import cv2
import numpy as np
import pytest
import rospy
import support
import yaml
from pattern_camera import PatternCamera
from people import ANNA, photograph

from robot_vision import to_hsv
from robot_vision.faces.face_images import find_face
from robot_vision.msg import Detection, DetectionArray, TrackStateArray
from robot_vision.ros.messages import region_of

pytest_plugins = ["browser", "dashboards"]  # their fixtures
SIZE = 640, 480
PATCHES = {"red": (60, 60, 120, 100), "green": (240, 60, 120, 100)}  # x, y, width, height
COLORS = {"red": (40, 40, 220), "green": (60, 200, 60)}  # BGR
RANGES = {
    "red": {"low": [0, 200, 250], "high": [2, 202, 252]},  # nothing of the image
    "green": {"low": [50, 100, 100], "high": [70, 255, 255]},
}
TEXTURE = 60, 250, 160, 140
FACE_PLACE = 310, 235  # x, y of the photograph's corner
TRACKER = '[data-test="tile"][data-node="/hsv_tracker"]'
FOLLOWER = '[data-test="tile"][data-node="/object_tracker"]'


def scene():
    """A wall with patches of colours, something with a texture, and a portrait."""
    image = np.full((SIZE[1], SIZE[0], 3), 128, np.uint8)
    for name, (x, y, width, height) in PATCHES.items():
        image[y : y + height, x : x + width] = COLORS[name]
    x, y, width, height = TEXTURE
    noise = np.random.default_rng(5).integers(0, 256, (height // 4, width // 4), np.uint8)
    image[y : y + height, x : x + width] = cv2.resize(
        noise, (width, height), interpolation=cv2.INTER_CUBIC
    )[:, :, None]
    portrait, _ = photograph(ANNA, 1)
    x, y = FACE_PLACE
    image[y : y + portrait.shape[0], x : x + portrait.shape[1]] = portrait
    return image


@pytest.fixture(scope="module")
def camera(master):
    """A camera that sees the scene, and the detector's word on each frame."""
    image = scene()
    x, y = FACE_PLACE
    left, top, width, height = find_face(image[y:, x:])
    face = Detection(
        label="face", id=1, score=0.9, box=region_of((x + left, y + top, width, height))
    )
    faces = rospy.Publisher("/faces", DetectionArray, queue_size=5, tcp_nodelay=True)
    made = PatternCamera("eye", image)
    made.beside.append(lambda header: faces.publish(DetectionArray(header, *SIZE, [face])))
    yield made
    made.close()
    faces.unregister()


@pytest.fixture(scope="module")
def color_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("colors") / "hsv_tracker.yaml"
    lines = [
        f"  {name}: {{low: {one['low']}, high: {one['high']}}}" for name, one in RANGES.items()
    ]
    path.write_text("\n".join(["colors:", *lines, ""]))
    return path


@pytest.fixture(scope="module")
def nodes(start_once, camera, color_file, tmp_path_factory):
    """The nodes that the tools are for, all on the camera's images."""
    rospy.set_param("/hsv_tracker/colors", RANGES)
    image = f"image:={camera.topic}"
    start_once("hsv_tracker.py", image, f"_config_file:={color_file}")
    start_once("object_tracker.py", image)
    gallery = tmp_path_factory.mktemp("gallery")
    words = "faces:=/faces", f"_gallery:={gallery}", "_enroll_timeout:=60.0"
    start_once("face_recognizer.py", image, *words)
    for service in ("/hsv_tracker/save_parameters", "/object_tracker/forget"):
        rospy.wait_for_service(service, support.DEADLINE)
    rospy.wait_for_service("/face_recognizer/enroll", support.DEADLINE)


@pytest.fixture
def view(page, dashboard, nodes):
    """The page, when it shows the image of hsv_tracker."""
    page.open(dashboard.address)
    page.wait(
        "['/hsv_tracker', '/object_tracker'].every((node) =>"
        " robotVision.tiles.list().some((one) => one.node === node && one.size[0] > 0))"
    )
    return page


def at(page, tile, x, y):
    """The place of the window, CSS px, where a pixel of the tile's image is shown."""
    left, top, width, height = page.box(f'{tile} [data-test="image"]')
    return left + (x + 0.5) * width / SIZE[0], top + (y + 0.5) * height / SIZE[1]


def middle(patch):
    x, y, width, height = patch
    return x + width // 2, y + height // 2


def open_tool(page, name):
    page.click(f'[data-test="tool-{name}"]')
    page.wait("document.getElementById('panel').dataset.tool === arguments[0]", name)


def value_of(name, node="/hsv_tracker"):
    return support.reconfigured(node)[name]


def test_a_slider_sets_a_parameter_and_a_refusal_is_told(view, color_file):
    open_tool(view, "parameters")
    view.fill('[data-test="parameter-node"]', "/hsv_tracker")
    view.fill('[data-test="parameter-slider"][data-name="min_area"]', "40")
    view.wait("Number(document.querySelector('.number-field[data-name=min_area]').value) !== 200")
    shown = float(view.value("document.querySelector('.number-field[data-name=min_area]').value"))
    support.wait_for(lambda: value_of("min_area") == pytest.approx(shown, rel=1e-3), "the slider")
    view.fill('[data-test="parameter"][data-name="opening"]:not([type=range])', "4")
    view.wait_for_text("odd", '.parameter[data-name="opening"]')
    assert value_of("opening") == 3
    view.click('[data-test="save-parameters"]')
    view.wait_for_text("hsv_tracker.yaml", '[data-test="save-answer"]')
    saved = yaml.safe_load(color_file.read_text())
    assert saved["min_area"] == pytest.approx(shown, rel=1e-3) and set(saved["colors"]) == {
        "red",
        "green",
    }
    support.reconfigured("/hsv_tracker", min_area=200.0)
    view.wait("document.querySelector('.number-field[data-name=min_area]').value === '200'")


def test_what_is_dragged_around_is_followed_until_it_is_forgotten(view):
    states = support.subscribed("/object_tracker/state", TrackStateArray)

    def followed():
        return [track.label for track in states.received[-1].tracks] if states.received else []

    open_tool(view, "select")
    view.fill('[data-test="select-label"]', "carpet")
    x, y, width, height = TEXTURE
    corners = [(x + 10, y + 10), (x + 60, y + 60), (x + width - 10, y + height - 10)]
    view.drag([at(view, FOLLOWER, *corner) for corner in corners])
    support.wait_for(lambda: followed() == ["carpet"], "the object")
    view.wait_for_text("carpet", '[data-test="object"]')
    view.wait_for_text("followed", '[data-test="object"]')
    view.fill('[data-test="select-label"]', "part")
    view.drag([at(view, FOLLOWER, *corner) for corner in (corners[0], corners[1])])
    support.wait_for(lambda: followed() == ["carpet", "part"], "another one")
    view.wait("document.querySelectorAll('[data-test=object]').length === 2")
    view.click('[data-test="object"]:last-child [data-test="forget"]')
    support.wait_for(lambda: followed() == ["carpet"], "that only the other one is forgotten")
    view.wait("document.querySelectorAll('[data-test=object]').length === 1")
    view.click('[data-test="forget"]')
    support.wait_for(lambda: not followed(), "that it is forgotten")
    view.wait("!document.querySelector('[data-test=object]')")


def drawn(page, tile):
    """Where something is drawn over the image, (height, width), bool."""
    text = page.run(
        """const small = new OffscreenCanvas(640, 480);
        const context = small.getContext("2d");
        context.drawImage(document.querySelector(arguments[0] + " .overlay"), 0, 0, 640, 480);
        const { data } = context.getImageData(0, 0, 640, 480);
        let text = "";
        for (let at = 3; at < data.length; at += 4) text += data[at] > 60 ? "1" : "0";
        return text;""",
        tile,
    )
    return (np.frombuffer(text.encode(), np.uint8) == ord("1")).reshape(SIZE[1], SIZE[0])


def test_what_a_node_has_found_is_drawn_at_its_pixels(view):
    x, y, width, height = PATCHES["green"]

    def is_framed():
        found = drawn(view, TRACKER)
        rows, columns = slice(y + 10, y + height - 10), slice(x + 10, x + width - 10)
        sides = (
            found[rows, x - 5 : x + 6].any(axis=1).all(),
            found[rows, x + width - 6 : x + width + 5].any(axis=1).all(),
            found[y + height - 6 : y + height + 5, columns].any(axis=0).all(),
        )
        inside = found[y + 25 : y + height - 10, columns].any()
        return all(sides) and not inside and not found[y + height + 10 :].any()

    support.wait_for(is_framed, "the box around the green patch")


def tinted(page, tile):
    """Which pixels of the image have a layer over them, (height, width), bool."""
    canvas = page.run(
        """const canvas = document.querySelector(arguments[0] + " .overlay");
        const small = new OffscreenCanvas(640, 480);
        small.getContext("2d").drawImage(canvas, 0, 0, 640, 480);
        const { data } = small.getContext("2d").getImageData(0, 0, 640, 480);
        let text = "";
        for (let at = 0; at < data.length; at += 4) {
          text += data[at] > 150 && data[at + 1] < 90 && data[at + 2] > 100 ? "1" : "0";
        }
        return text;""",
        tile,
    )
    return (np.frombuffer(canvas.encode(), np.uint8) == ord("1")).reshape(SIZE[1], SIZE[0])


def test_another_colour_is_tuned_by_a_click_and_saved(view, color_file):
    hue, saturation, _ = to_hsv(COLORS["red"])
    open_tool(view, "color")
    view.wait("document.querySelector('[data-test=color-name]').options.length === 3")
    view.fill('[data-test="color-name"]', "red")
    support.wait_for(lambda: value_of("color") == "red", "the colour that is shown")
    view.drag([at(view, TRACKER, *middle(PATCHES["red"]))])
    view.wait_for_text("40, 40, 220", '[data-test="color-numbers"] [data-space="bgr"]')
    support.wait_for(lambda: value_of("s_low") < saturation <= value_of("s_high"), "the range")
    low, high = value_of("h_low"), value_of("h_high")
    assert low <= hue <= high or (low > high and (hue >= low or hue <= high))
    x, y, width, height = PATCHES["red"]

    def mask_is_shown():
        mask = tinted(view, TRACKER)
        inside = mask[y + 20 : y + height - 6, x + 6 : x + width - 6].mean()
        mask[y - 6 : y + height + 6, x - 6 : x + width + 6] = False
        x_green, y_green = middle(PATCHES["green"])
        others = mask[y_green - 20 : y_green + 20, x_green - 20 : x_green + 20].mean()
        return inside > 0.9 and others > 0.9 and mask.sum() < 1.1 * width * height

    support.wait_for(mask_is_shown, "the mask over the image")
    view.run("document.querySelector('[data-test=range-1-low]').focus();")
    before = value_of("s_low")
    view.keys("\ue014\ue014")  # the right arrow, twice
    support.wait_for(lambda: value_of("s_low") == before + 2, "the end of the bar")
    view.click('[data-test="color-save"]')
    view.wait_for_text("hsv_tracker.yaml", '[data-test="color-answer"]')
    saved = yaml.safe_load(color_file.read_text())["colors"]
    assert (
        "not overwritten" not in view.text()
        and saved["red"]["low"][1] == before + 2
        and saved["green"] == RANGES["green"]
    )
    view.click('[data-test="color-undo"]')
    support.wait_for(lambda: value_of("s_low") == before + 2, "the saved range")
    open_tool(view, "log")
    support.wait_for(lambda: not tinted(view, TRACKER).any(), "the end of the mask")


def test_a_new_colour_is_added_by_a_click(view):
    open_tool(view, "color")
    view.wait("document.querySelector('[data-test=color-name]').options.length === 3")
    view.fill('[data-test="color-name"]', "+")
    view.drag([at(view, TRACKER, *middle(PATCHES["green"]))])
    view.wait_for_text("Give the new colour a name first", '[data-test="color-answer"]')
    view.fill('[data-test="color-new-name"]', "grass")
    view.drag([at(view, TRACKER, *middle(PATCHES["green"]))])
    support.wait_for(lambda: value_of("color") == "grass", "the new colour")
    hue, saturation, _ = to_hsv(COLORS["green"])
    assert value_of("h_low") <= hue <= value_of("h_high") and value_of("s_low") <= saturation
    view.wait("document.querySelector('[data-test=color-name]').value === 'grass'")


def test_a_face_is_enrolled_and_forgotten(view):
    open_tool(view, "faces")
    view.wait_for_text("Nobody is known", '[data-test="faces"]')
    view.fill('[data-test="face-name"]', "Anna <b>")
    view.fill('[data-test="face-pictures"]', "1")
    view.click('[data-test="face-enroll"]')
    row = '[data-test="face"][data-name="Anna <b>"]'
    view.wait_for_text("1 image", row)
    view.wait("document.querySelector('img.face')?.naturalWidth")
    assert view.count("#panel b") == 0
    view.click(f'{row} [data-test="face-forget"]')
    view.click(f'{row} [data-test="face-forget-sure"]')
    view.wait_for_text("Nobody is known", '[data-test="faces"]')


def test_who_may_only_look_changes_nothing(view, dashboard):
    view.command("Network.clearBrowserCookies")
    view.open(dashboard.view_address)
    view.wait("robotVision.role === 'view' && robotVision.graph")
    open_tool(view, "parameters")
    view.fill('[data-test="parameter-node"]', "/hsv_tracker")
    view.wait("document.querySelector('[data-test=parameter][data-name=min_area]').disabled")
    assert view.value("document.querySelector('[data-test=save-parameters]').disabled")
    for op, fields in (
        ("set_parameters", {"node": "/hsv_tracker", "values": {"min_area": 1.0}}),
        ("save_parameters", {"node": "/hsv_tracker"}),
        ("forget_face", {"node": "/face_recognizer", "name": "Anna"}),
        ("capture", {"node": "/camera", "start": False}),
    ):
        answer = view.run(
            "return robotVision.connection.request(arguments[0], arguments[1])"
            ".then(() => 'done', (error) => error.message);",
            op,
            fields,
        )
        assert "may only look" in answer or "control" in answer, answer
    assert value_of("min_area") == 200.0


def test_a_camera_is_stopped_and_started(start, page, dashboard):
    start("camera_node", "__name:=room", "_source:=synthetic")
    page.open(dashboard.address)
    tile = '[data-test="tile"][data-node="/room"]'
    frames = "robotVision.tiles.list().find((one) => one.node === '/room').view.drawn.header.seq"
    page.wait(frames)
    page.wait(
        "robotVision.graph.nodes.find((one) => one.name === '/room')"
        ".services.includes('/room/stop_capture')"
    )

    def choose(text):
        page.click(f'{tile} [data-test="tile-menu"]')
        items = "[...document.querySelectorAll('.menu-item')]"
        item = f"{items}.find((one) => one.innerText === arguments[0])"
        page.wait(item, text)
        page.run(f"{item}.click();", text)

    choose("Stop the camera")
    page.wait_for_notice("the capture of /room has stopped")
    choose("Start the camera")
    page.wait_for_notice("the capture of /room goes on")
    before = page.value(frames)
    page.wait(f"{frames} > arguments[0] + 3", before)
