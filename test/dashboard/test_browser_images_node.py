"""Images on the dashboard's page, seen by a real browser: every pixel at its place."""

from types import SimpleNamespace

import cv2
import numpy as np
import pytest
import rospy
from exif import sideways
from pattern_camera import TILE, PatternCamera, located, marked, seen
from sensor_msgs.msg import CompressedImage

from robot_vision.srv import SelectObject, SelectObjectResponse

pytest_plugins = ["browser", "dashboards"]  # their fixtures
MEAN_ERROR, MAX_ERROR = 2.5, 30  # gray levels: JPEG with colours of half the resolution
SIZE = 640, 480
MARKS = {"a": (170, 130), "b": (420, 330)}
FRAMES = "Number(document.body.dataset.frames)"


@pytest.fixture(scope="module")
def camera(master):
    made = PatternCamera("eye", located(*SIZE))
    yield made
    made.close()


@pytest.fixture
def view(page, dashboard, camera):
    """The page with the camera's image."""
    camera.offset = 0.0
    page.open(dashboard.address)
    show(page, camera, located(SIZE[0] + 2, SIZE[1] + 2))  # a size that no test shows
    return page


def show(page, camera, image, encoding="bgr8"):
    """Shows an image of a size that was not shown before, or the first one, and waits for it."""
    camera.show(image, encoding)
    height, width = image.shape[:2]
    page.wait(
        "(() => { const tile = robotVision.tiles.list().find((one) => one.image === arguments[0]);"
        " return tile && tile.size[0] === arguments[1] && tile.size[1] === arguments[2]; })()",
        camera.topic,
        width,
        height,
    )
    wait_for_frames(page)


def wait_for_frames(page, count=2):
    drawn = page.value(FRAMES)
    page.wait(f"{FRAMES} >= arguments[0]", drawn + count)


def assert_shown(page, camera, image):
    """Asserts that the canvas has this image, if it is smaller then as it is resized well."""

    def error():
        canvas = page.canvas(camera.canvas)
        scaled = cv2.resize(image, canvas.shape[1::-1], interpolation=cv2.INTER_AREA)
        return np.abs(canvas.astype(int) - scaled)

    difference = error()
    assert difference.mean() < MEAN_ERROR and difference.max() < MAX_ERROR, difference.max()


@pytest.mark.parametrize("width, height", [(640, 480), (333, 77), (64, 500), (1280, 960)])
def test_every_pixel_of_an_image_is_shown(view, camera, width, height):
    image = located(width, height)
    show(view, camera, image)
    assert_shown(view, camera, image)


def test_an_image_may_change_its_size_and_encoding(view, camera):
    image = located(320, 200)
    show(view, camera, cv2.cvtColor(image, cv2.COLOR_BGR2RGB), "rgb8")
    assert_shown(view, camera, image)
    gray = np.ascontiguousarray(located(310, 210)[:, :, 1])
    show(view, camera, gray, "mono8")
    assert_shown(view, camera, cv2.merge([gray] * 3))
    show(view, camera, np.full((90, 160), 1500, np.uint16), "16UC1")
    show(view, camera, located(161, 91))
    assert_shown(view, camera, located(161, 91))


def test_an_image_of_4k_is_shown_in_the_size_of_its_tile(view, camera):
    image = located(3840, 2160)
    show(view, camera, image)
    # The first ones may come as they are, before the size of the tile is known.
    view.wait("document.querySelector(arguments[0]).width <= 2560", camera.canvas)
    wait_for_frames(view)
    assert_shown(view, camera, image)


def test_a_photograph_that_is_to_be_turned_is_shown_as_its_pixels_are(view):
    image = located(320, 240)
    topic = "/phone/compressed"
    publisher = rospy.Publisher(topic, CompressedImage, queue_size=1, latch=True)
    jpeg = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 95])[1].tobytes()
    publisher.publish(CompressedImage(format="jpeg", data=sideways(jpeg)))
    phone = SimpleNamespace(topic=topic, canvas=f'{TILE % topic} [data-test="image"]')
    try:
        view.run("robotVision.tiles.addTopic(arguments[0]);", topic)
        view.wait(
            "robotVision.tiles.list().find((one) => one.image === arguments[0])?.view.drawn", topic
        )
        assert_shown(view, phone, image)
    finally:
        publisher.unregister()


def test_images_are_shown_when_the_clock_jumps_back(view, camera):
    for offset in (3600.0, -3600.0, 0.0):
        camera.offset = offset
        wait_for_frames(view, 3)


@pytest.mark.parametrize(
    "width, height, touch, scale",
    [
        (1280, 720, False, 1.0),
        (1920, 1080, False, 1.0),
        (900, 700, False, 1.5),
        (390, 844, True, 2),
    ],
)
@pytest.mark.parametrize("enlarged", [False, True])
def test_a_drag_selects_in_pixels_of_the_image(view, camera, width, height, touch, scale, enlarged):
    regions = []

    def select(request):
        regions.append((request.region, request.label))
        return SelectObjectResponse(True, "", 7)

    service = rospy.Service("/test/select_object", SelectObject, select)
    try:
        view.size(width, height, touch, scale)
        show(view, camera, marked(SIZE, MARKS))
        if enlarged:
            view.click(f'{camera.tile} [data-test="enlarge"]')
            view.wait("document.querySelector('.enlarged')")
        view.wait("!document.querySelector(arguments[0]).hidden", f"{camera.tile} .tile-hint")
        if touch and not enlarged:  # there a finger scrolls, unless the tool is open
            view.run("robotVision.panels.open('select'); robotVision.panels.panel.hidden = true;")
        wait_for_frames(view)
        begin, end = (seen(view, name, camera.canvas, scale) for name in ("a", "b"))
        middle = (begin[0] + end[0]) / 2, (begin[1] + end[1]) / 2
        view.drag([begin, middle, end], touch)
        # In the panel if it is open, or else in a notice.
        view.wait_for_notice("object 7 of /test is selected", '[data-test="select-answer"]')
    finally:
        service.shutdown()
    ((region, label),) = regions
    per_pixel = view.value("document.querySelector(arguments[0]).clientWidth", camera.canvas)
    tolerance = 1.5 + 1.5 * SIZE[0] / per_pixel
    assert region.x_offset == pytest.approx(MARKS["a"][0], abs=tolerance)
    assert region.y_offset == pytest.approx(MARKS["a"][1], abs=tolerance)
    assert region.x_offset + region.width == pytest.approx(MARKS["b"][0], abs=tolerance)
    assert region.y_offset + region.height == pytest.approx(MARKS["b"][1], abs=tolerance)
    assert label == ""


def test_a_page_that_stands_still_harms_no_other(view, camera, browser, dashboard):
    other = browser.page()
    other.size(1280, 720)
    other.open(dashboard.address)
    show(other, camera, located(1600, 1200))
    view.front().halt()
    other.front()
    show(other, camera, located(1602, 1200))
    wait_for_frames(other, 30)
    assert_shown(other, camera, located(1602, 1200))
    view.resume()
    show(view, camera, located(642, 480))


def test_a_camera_that_has_gone_comes_back_by_itself(view, camera):
    second = PatternCamera("second", located(300, 200))
    tile = f'{second.tile} [data-test="tile-message"]'
    show(view, second, located(300, 200))
    second.close()
    view.wait_for_text("has gone", tile)
    again = PatternCamera("second", located(304, 200))
    try:
        show(view, again, located(304, 200))
        view.wait("document.querySelector(arguments[0]).hidden", tile)
        assert_shown(view, again, located(304, 200))
    finally:
        again.close()


def test_without_a_page_nobody_subscribes(view, camera):
    assert camera.viewers()
    view.open("about:blank")
    view.wait("true")
    import support

    support.wait_for(lambda: not camera.viewers(), "the end of the subscription")
