"""The node spectrum: what it publishes of frames whose frequencies and shifts are known."""

import cv2
import numpy as np
import pytest
import rospy
import support
from frames import Camera, pixels
from geometry_msgs.msg import Vector3Stamped
from sensor_msgs.msg import Image

import robot_vision as rv

NOISE = np.random.default_rng(2).integers(0, 256, (75, 100, 3), np.uint8)
TEXTURE = cv2.resize(NOISE, (200, 150), interpolation=cv2.INTER_CUBIC)


def frame(x=0, y=0):
    """The texture moved by so many px."""
    return np.ascontiguousarray(np.roll(TEXTURE, (y, x), (0, 1))[:120, :160])


def params(**values):
    made = rv.SpectrumParams()
    for name, value in values.items():
        setattr(made, name, value)
    return made


@pytest.fixture
def camera():
    return Camera(10.0)


class Watched:
    """The node behind a camera, and its topics."""

    def __init__(self, start, camera, *arguments, topics=()):
        image = f"image:={camera.topic}"
        self.process = start("spectrum_node", "__name:=spectrum", image, *arguments)
        self._camera = camera
        self.images = {
            name: support.subscribed(f"/spectrum/{name}", Image)
            for name in topics or ("magnitude", "filtered", "processed_image")
        }
        camera.wait_for()

    def show(self, image):
        """What the images of a frame are, by topics; all have the frame's header."""
        header = self._camera.show(image)
        found = {name: topic.of(header.stamp) for name, topic in self.images.items()}
        assert all(message.header.frame_id == "eye" for message in found.values())
        return {name: pixels(message) for name, message in found.items()}


def test_spectrum_and_filter_are_those_of_the_core(start, camera):
    watched = Watched(start, camera, "_filter:=low_pass", "_radius:=0.3")
    found = watched.show(frame())
    values = params(filter="low_pass", radius=0.3)
    magnitude = rv.spectrum_image(rv.spectrum_magnitude(frame(), params=values))
    assert np.array_equal(found["magnitude"], magnitude)
    low = rv.filter_frequencies(frame(), params=values)
    assert np.array_equal(found["filtered"], np.clip(np.rint(low), 0, 255))
    drawn = cv2.cvtColor(magnitude, cv2.COLOR_GRAY2BGR)
    rv.draw_passband(drawn, values)
    assert np.array_equal(found["processed_image"], drawn)  # there is no shift of a first frame

    answer = support.reconfigured("/spectrum", filter="high_pass", shape="ideal", window="none")
    assert answer["filter"] == "high_pass"
    found = watched.show(frame())
    values = params(filter="high_pass", shape="ideal", radius=0.3, window="none")
    high = rv.filter_frequencies(frame(), params=values)
    assert np.array_equal(found["filtered"], np.clip(np.rint(high + 128), 0, 255))
    magnitude = rv.spectrum_image(rv.spectrum_magnitude(frame(), params=values))
    assert np.array_equal(found["magnitude"], magnitude)

    assert support.reconfigured("/spectrum", window="hamming")["window"] == "none"
    watched.process.wait_for_output("stay as they are: window is hamming, must be hann or none")
    assert np.array_equal(watched.show(frame())["magnitude"], magnitude)


def with_text(image, text):
    """The spectrum of an image with a line of text."""
    spectrum = rv.spectrum_image(rv.spectrum_magnitude(image))
    expected = cv2.cvtColor(spectrum, cv2.COLOR_GRAY2BGR)
    rv.draw_text(expected, text, (8, 110))
    return expected


def test_the_shift_is_published_and_written_on_the_spectrum(start, camera):
    watched = Watched(start, camera, "_min_response:=0.3", topics=["processed_image"])
    shifts = support.subscribed("/spectrum/shift", Vector3Stamped)
    watched.show(frame())
    drawn = watched.show(frame(5, -3))["processed_image"]
    (shift,) = shifts.wait()
    assert shift.header.frame_id == "eye"
    assert (shift.vector.x, shift.vector.y) == pytest.approx((5, -3), abs=0.1)
    assert shift.vector.z == 0.0
    correlator = rv.PhaseCorrelator()
    correlator.update(0.0, frame())
    response = correlator.update(0.1, frame(5, -3)).response
    text = f"shift {shift.vector.x:.1f} {shift.vector.y:.1f} px, response {response:.2f}"
    assert np.array_equal(drawn, with_text(frame(5, -3), text))

    strange = np.random.default_rng(9).integers(0, 256, frame().shape, np.uint8)
    drawn = watched.show(strange)["processed_image"]
    response = correlator.update(0.2, strange).response
    assert np.array_equal(drawn, with_text(strange, f"no shift, response {response:.2f}"))
    watched.show(np.roll(strange, 4, axis=1))
    second = shifts.wait(2)[1]  # nothing was published of the frame before
    assert (second.vector.x, second.vector.y) == pytest.approx((4, 0), abs=0.1)


def test_the_first_frame_after_a_time_without_subscribers_has_no_shift(start, camera):
    """Nobody subscribes to ~shift for a time, then nobody to anything."""
    watched = Watched(start, camera, topics=["magnitude"])
    for x in (0, 30):
        shifts = support.subscribed("/spectrum/shift", Vector3Stamped)
        watched.show(frame(x))
        watched.show(frame(x + 5))
        (shift,) = shifts.wait()
        assert (shift.vector.x, shift.vector.y) == pytest.approx((5, 0), abs=0.1)
        shifts.close()
        support.wait_for(
            lambda: not support.sends("/spectrum", "/spectrum/shift"), "the end of the shifts"
        )
        watched.show(frame(x + 10))
    watched.images["magnitude"].close()
    camera.wait_for(0)
    watched.images["magnitude"] = support.subscribed("/spectrum/magnitude", Image)
    shifts = support.subscribed("/spectrum/shift", Vector3Stamped)
    camera.wait_for()
    for x in (60, 65):
        watched.show(frame(x))
    (shift,) = shifts.wait()
    assert (shift.vector.x, shift.vector.y) == pytest.approx((5, 0), abs=0.1)


def test_another_filter_leaves_no_gap_in_the_shifts(start, camera):
    watched = Watched(start, camera, topics=["magnitude"])
    shifts = support.subscribed("/spectrum/shift", Vector3Stamped)
    watched.show(frame())
    support.reconfigured("/spectrum", filter="low_pass", radius=0.2)
    watched.show(frame(5))
    (shift,) = shifts.wait()
    assert (shift.vector.x, shift.vector.y) == pytest.approx((5, 0), abs=0.1)
    support.reconfigured("/spectrum", min_response=1.0)  # holds at once
    watched.show(frame(10))
    watched.show(frame(15))
    support.reconfigured("/spectrum", min_response=0.1)
    watched.show(frame(40))
    watched.show(frame(45))
    assert [round(one.vector.x) for one in shifts.wait(2)] == [5, 5]


def test_it_is_a_nodelet_behind_the_camera(start):
    manager = support.NodeletManager(start)
    rospy.set_param("/camera/source", "synthetic")
    assert manager.load("/camera", "camera")
    assert manager.load("/spectrum", "spectrum", {"/image": "/camera/image_raw"})
    (message,) = support.Messages("/spectrum/magnitude", Image).wait()
    assert (message.header.frame_id, *pixels(message).shape) == ("head_camera", 480, 640)


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("filter", "magic", "filter is magic, must be none, low_pass, high_pass or band_pass"),
        ("radius", 2.0, "radius is 2, must be above 0 and at most 1.5"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "spectrum_node", name, value, text)
