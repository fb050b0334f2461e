"""The node window_tracker: how an object is selected, followed, lost, found and published."""

import concurrent.futures

import cv2
import numpy as np
import pytest
import rospy
import support
from frames import Camera, Source, pixels
from sensor_msgs.msg import Image, RegionOfInterest

from robot_vision.msg import DetectionArray, TrackState, TrackStateArray
from robot_vision.srv import ForgetObject, SelectObject

RATE = 30.0  # Hz, by the stamps of the images
AXES = (30, 16)  # px, half of the ellipse's
NOTHING = RegionOfInterest(width=2**32 - 1, height=1)
GREEN, YELLOW, RED = (0, 255, 0), (0, 255, 255), (0, 0, 255)
TOPICS = {
    "objects": DetectionArray,
    "state": TrackStateArray,
    "processed_image": Image,
    "back_projection": Image,
}


def view(*centers):
    """A gray image with blue ellipses around these centers."""
    image = np.full((240, 320, 3), 100, np.uint8)
    for center in centers:
        cv2.ellipse(image, center, AXES, 0, 0, 360, (200, 60, 20), cv2.FILLED)
    return image


def region(center):
    (x, y), (a, b) = center, AXES
    return RegionOfInterest(x_offset=x - a, y_offset=y - b, width=2 * a + 1, height=2 * b + 1)


class Desk:
    """A camera, the node, and what it says of each frame."""

    def __init__(self, start, *arguments, topics=TOPICS):
        self._camera = Camera(RATE)
        self.topic = self._camera.topic
        words = "__name:=hand", f"image:={self.topic}"
        self.process = start("window_tracker.py", *words, *arguments)
        self._messages = {
            name: support.subscribed(f"/hand/{name}", topics[name]) for name in topics
        }
        self._camera.wait_for()

    def send(self, image):
        return self._camera.show(image).stamp

    def show(self, image, *more):
        """Sends a frame; its objects, the states, the overlay, and what is on further topics."""
        stamp = self.send(image)
        names = ("objects", "state", "processed_image", *more)
        answers = [self._messages[name].of(stamp) for name in names]
        assert {answer.header.frame_id for answer in answers} == {"eye"}
        objects, states, overlay, *rest = answers
        assert (objects.width, objects.height) == (320, 240)
        return [objects.detections, states.tracks, pixels(overlay), *map(pixels, rest)]

    def select(self, where, image, label=""):
        """Selects by the service while frames are sent, and returns its answer."""
        rospy.wait_for_service("/hand/select_object", support.DEADLINE)
        service = rospy.ServiceProxy("/hand/select_object", SelectObject)
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            answer = pool.submit(service, where, label)
            while not answer.done():
                self.send(image)
                concurrent.futures.wait([answer], 1.0 / RATE)
            return answer.result()


def has(color, drawn):
    return (drawn == color).all(axis=2).any()


def test_select_by_the_service_follow_lose_and_find_again(start):
    desk = Desk(start, "_max_prediction:=0.31")
    center = (80, 100)
    found, states, overlay = desk.show(view(center))
    assert not found and not states and (overlay[:30] != 100).any()  # "nothing is selected"
    assert np.array_equal(overlay[30:], view(center)[30:])
    answer = desk.select(region(center), view(center), "fish")
    assert (answer.success, answer.message, answer.id) == (True, "", 1)
    for step in range(1, 25):
        center = (80 + 3 * step, 100 + step)
        (found,), (state,), overlay, projection = desk.show(view(center), "back_projection")
    assert (found.label, found.id, found.predicted, found.has_velocity) == ("fish", 1, False, True)
    assert (found.center.x, found.center.y) == pytest.approx(center, abs=0.5)
    assert (found.box.x_offset, found.box.y_offset) == pytest.approx(
        (center[0] - 30, center[1] - 16), abs=3
    )
    assert (found.box.width, found.box.height) == pytest.approx((61, 33), abs=5)
    assert len(found.outline) == 4 and found.area == pytest.approx(61 * 33, rel=0.1)
    assert (found.velocity.x, found.velocity.y) == pytest.approx((90.0, 30.0), abs=8.0)
    assert (state.id, state.label, state.state) == (1, "fish", TrackState.TRACKED)
    assert found.score == state.confidence > 0.6
    assert (state.scale, state.angle) == pytest.approx((1.0, 0.0), abs=0.05)
    blue = (view(center) == (200, 60, 20)).all(axis=2)
    assert np.array_equal(projection, np.where(blue, 255, 0))
    around = overlay[center[1] - 3 : center[1] + 4, center[0] - 36 : center[0] - 24]
    assert has(GREEN, around) and has(RED, overlay[center[1] - 2 : center[1] + 3])
    for step in range(1, 15):
        found, (state,), overlay = desk.show(view())
        assert state.state == TrackState.LOST and state.confidence == 0.0
        expected = step / RATE <= 0.31
        assert len(found) == expected
        if expected:
            assert found[0].predicted and found[0].score == 0.0
            assert found[0].center.x == pytest.approx(center[0] + 3 * step, abs=step)
            assert has(YELLOW, overlay) and not has(GREEN, overlay)
    assert not has(YELLOW, overlay)
    blue, green, red = np.moveaxis(overlay[:30].astype(int), 2, 0)
    assert np.count_nonzero((red > 150) & (blue < 60) & (green < 60)) > 20  # "fish 1: lost"
    (found,), (state,), _ = desk.show(view((250, 40)))
    assert (found.center.x, found.center.y) == pytest.approx((250, 40), abs=0.5)
    assert state.state == TrackState.TRACKED
    forget = rospy.ServiceProxy("/hand/forget", ForgetObject)
    assert forget(3).message == "id is 3, must be of an object (1), or -1 for all"
    assert forget(1).success
    assert desk.show(view((250, 40)))[:2] == [[], []]


def test_the_topic_selects_another_object_and_parameters_change_live(start):
    desk = Desk(start, "_method:=meanshift")
    image = view((60, 60), (240, 180))
    viewer = Source("/hand/select", RegionOfInterest)
    viewer.wait_for()

    def selected(where, number):
        """The object with this number, selected by the topic."""
        viewer.send(where)
        return support.wait_for(
            lambda: [found for found in desk.show(image)[0] if found.id == number], "the object"
        )[0]

    for number, center in enumerate([(60, 60), (240, 180)], 1):
        found = selected(region(center), number)
        assert (found.center.x, found.center.y) == pytest.approx(center, abs=0.5)
        assert found.area == 61 * 33  # meanShift keeps the size
    viewer.send(NOTHING)
    refused = f"nothing selected on {desk.topic}: region of 1073741824x1 px at (0, 0) is not inside"
    support.wait_for(lambda: desk.show(image) and refused in desk.process.output(), refused)
    assert desk.show(image)[0][0].id == 2
    settings = support.reconfigured("/hand", method="camshift", min_similarity=0.5)
    assert (settings["method"], settings["min_similarity"]) == ("camshift", 0.5)
    assert desk.show(image)[0][0].area != 61 * 33
    assert support.reconfigured("/hand", min_similarity=1.5)["min_similarity"] == 0.5
    assert support.reconfigured("/hand", channels="rgb")["channels"] == "hue"
    desk.process.wait_for_output("channels is rgb, must be hue or hue_saturation")
    support.reconfigured("/hand", x=30, y=44, width=61, height=33)
    assert desk.show(image)[0][0].id == 3


def test_a_region_of_parameters_is_followed_though_nobody_subscribes(start, diagnostics):
    where = [
        f"_{name}:={value}" for name, value in zip(("x", "y", "width", "height"), (50, 84, 61, 33))
    ]
    desk = Desk(start, *where, "_diagnostic_period:=0.02", topics={})
    for step in range(12):
        desk.send(view((80 + 5 * step, 100)))
        support.wait_for(
            lambda: int(diagnostics.value("hand", "frames published")) > step,  # noqa: B023
            "the frame to be processed",
        )
    states = support.subscribed("/hand/state", TrackStateArray)
    (state,) = states.of(desk.send(view((80 + 5 * 12, 100)))).tracks
    assert (state.id, state.state) == (1, TrackState.TRACKED)


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("method", "kalman", "method is kalman, must be meanshift or camshift"),
        ("width", -5, "width is -5, must be from 0 to 65535"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "window_tracker.py", name, value, text)
