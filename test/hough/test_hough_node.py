"""The node hough: what it publishes of drawn images, and its live parameters."""

import cv2
import numpy as np
import pytest
import support
from frames import Camera
from sensor_msgs.msg import Image

import robot_vision as rv
from robot_vision.msg import DetectionArray

HEIGHT, WIDTH = 160, 220


def drawn():
    """A bar that begins at the left border, and a disc."""
    image = np.full((HEIGHT, WIDTH, 3), 40, np.uint8)
    image[30:50, :120] = (200, 220, 240)
    cv2.circle(image, (150, 100), 40, (240, 200, 180), -1)
    return image


def outline_of(detection):
    return np.array([(point.x, point.y) for point in detection.outline])


class Watched:
    """A running node, and what it says of images."""

    def __init__(self, start, *arguments):
        self.camera = Camera(10.0)
        self.process = start("hough.py", "__name:=hough", f"image:={self.camera.topic}", *arguments)
        self.objects = support.subscribed("/hough/objects", DetectionArray)
        self.edges = support.subscribed("/hough/edges", Image)
        self.overlays = support.subscribed("/hough/processed_image", Image)
        self.camera.wait_for()

    def show(self, image):
        """The detections, the edges and the overlay of an image, as a message and two arrays."""
        stamp = self.camera.show(image).stamp
        found, edges, overlay = (
            topic.of(stamp) for topic in (self.objects, self.edges, self.overlays)
        )
        assert {one.header.frame_id for one in (found, edges, overlay)} == {"eye"}
        assert (edges.encoding, overlay.encoding) == ("mono8", "bgr8")
        shape = image.shape[:2]
        return (
            found,
            np.frombuffer(edges.data, np.uint8).reshape(shape),
            np.frombuffer(overlay.data, np.uint8).reshape(image.shape),
        )


def test_lines_segments_and_circles_are_published(start):
    node = Watched(start, "_threshold:=60")
    image = drawn()
    found, edges, overlay = node.show(image)
    assert (found.width, found.height) == (WIDTH, HEIGHT)
    core = rv.HoughParams()
    core.threshold = 60
    expected = rv.HoughTransform(core).apply(image)
    assert np.array_equal(edges, expected.edges)
    assert len(found.detections) == len(expected.lines) >= 2
    for one, line in zip(found.detections, expected.lines):
        assert (one.label, one.id, one.area, one.circle_radius) == ("line", -1, 0.0, 0.0)
        assert one.score == pytest.approx(line.score)
        assert np.allclose(outline_of(one), [line.begin, line.end], atol=1e-4)
        assert (one.center.x, one.center.y) == pytest.approx(np.mean(outline_of(one), axis=0))
    first = found.detections[0]  # an edge of the bar, which goes through the whole image
    assert (first.box.x_offset, first.box.width, first.score) == (0, WIDTH, 1.0)
    assert first.box.y_offset in (29, 30, 49, 50)
    row = first.box.y_offset
    assert (overlay[row, :100] == (0, 255, 0)).all() and (overlay[5] == 40).all()

    support.reconfigured("/hough", method="segments", min_length=80.0)
    found, _, _ = node.show(image)
    assert {one.label for one in found.detections} == {"segment"}
    (x1, y1), (x2, y2) = sorted(outline_of(found.detections[0]).tolist())
    assert x1 <= 2 and abs(x2 - 119) <= 2 and min(abs(y1 - 30), abs(y1 - 49)) <= 1 and y1 == y2

    config = support.reconfigured("/hough", method="circles", circle_method="spiral")
    assert config["method"] == "segments"  # the whole change is refused
    node.process.wait_for_output("circle_method is spiral, must be gradient or gradient_alt")
    support.reconfigured("/hough", method="circles")
    found, edges, overlay = node.show(image)
    (circle,) = found.detections
    assert (circle.label, circle.id, circle.score) == ("circle", -1, 1.0)
    assert (circle.circle_center.x, circle.circle_center.y) == pytest.approx((150, 100), abs=1.0)
    assert (
        circle.circle_radius == pytest.approx(40, abs=1.0) and circle.center == circle.circle_center
    )
    assert circle.area == pytest.approx(np.pi * circle.circle_radius**2, rel=1e-4)
    away = np.hypot(*(outline_of(circle) - (circle.center.x, circle.center.y)).T)
    assert len(away) == 64 and np.allclose(away, circle.circle_radius, atol=1e-3)
    box = circle.box
    assert (box.x_offset, box.y_offset) == pytest.approx((110, 60), abs=2)
    assert (box.width, box.height) == pytest.approx((81, 81), abs=4)
    assert edges[60, 150] or edges[59, 150] or edges[61, 150]
    assert (overlay[100, 150] == (0, 0, 255)).all()

    noise = np.random.default_rng(1).integers(0, 256, image.shape, np.uint8)
    support.reconfigured("/hough", blur="none")
    found, _, overlay = node.show(noise)
    assert not found.detections
    said = noise.copy()
    rv.draw_text(said, "too many edges", (10, 20))
    assert np.array_equal(overlay, said)
    node.process.wait_for_output("no circles are looked for in so many edges")


def test_an_image_too_large_for_its_steps_is_refused_and_the_next_one_comes(start):
    node = Watched(start, "_rho:=0.25", "_theta:=0.05", "_always_subscribe:=true")
    node.camera.show(np.zeros((1000, 1000, 3), np.uint8))
    node.process.wait_for_output("bgr8, 1000x1000): rho is 0.25, must be larger, or theta, 0.05")
    found, _, _ = node.show(drawn()[:50, :60])
    assert (found.width, found.height) == (60, 50)


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("method", "ellipses", "method is ellipses, must be lines, segments or circles"),
        ("max_radius", 5, "max_radius is 5, must be 0 or above min_radius, 10"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "hough.py", name, value, text)
