"""The node contours: what it publishes of a drawn image, clicks, templates and live parameters."""

import math

import cv2
import numpy as np
import pytest
import support
from frames import Camera, Source
from sensor_msgs.msg import Image

import robot_vision as rv
from robot_vision.msg import Click, ContourArray, DetectionArray

DRAWN = ("contour", "approximation", "hull", "defects", "rectangle", "ellipse", "line")


def drawn():
    """A box with a round hole, and an ellipse."""
    image = np.full((160, 240, 3), 30, np.uint8)
    image[20:121, 20:121] = (200, 220, 240)
    cv2.circle(image, (70, 70), 25, (30, 30, 30), -1)
    cv2.ellipse(image, (180, 80), (40, 20), 30, 0, 360, (240, 200, 180), -1)
    return image


def rows(points):
    return np.array([(point.x, point.y) for point in points])


def pair(point):
    assert point.z == 0.0
    return point.x, point.y


class Watched:
    """A running node, and what it says of images."""

    def __init__(self, start, *arguments):
        self.camera = Camera(10.0)
        self.clicks = Source("/contours/click", Click)
        words = "__name:=contours", f"image:={self.camera.topic}"
        self.process = start("contours.py", *words, *arguments)
        self.topics = [
            support.subscribed(f"/contours/{name}", kind)
            for name, kind in (
                ("contours", ContourArray),
                ("objects", DetectionArray),
                ("mask", Image),
                ("processed_image", Image),
            )
        ]
        self.camera.wait_for()
        self.clicks.wait_for()

    def show(self, image):
        """The contours and detections of an image as messages, the mask and the overlay."""
        stamp = self.camera.show(image).stamp
        contours, objects, mask, overlay = (topic.of(stamp) for topic in self.topics)
        for message in (contours, objects, mask, overlay):
            assert message.header.frame_id == "eye"
        assert (mask.encoding, overlay.encoding) == ("mono8", "bgr8")
        for message in (contours, objects, mask, overlay):
            assert (message.width, message.height) == (image.shape[1], image.shape[0])
        mask = np.frombuffer(mask.data, np.uint8).reshape(image.shape[:2])
        return contours, objects, mask, np.frombuffer(overlay.data, np.uint8).reshape(image.shape)


@pytest.fixture
def node(start):
    return Watched(start)


def assert_same(message, contour):
    """All fields of a message but the label are those of the core's contour."""
    assert (message.parent, message.depth) == (contour.parent, contour.depth)
    assert (message.hole, message.convex) == (contour.hole, contour.convex)
    box = message.box
    assert (box.x_offset, box.y_offset, box.width, box.height) == contour.box
    for name in ("center", "circle_center", "line_point"):
        assert pair(getattr(message, name)) == getattr(contour, name)
    for name in ("outline", "approximation", "hull"):
        assert np.array_equal(rows(getattr(message, name)), getattr(contour, name))
    for name in ("area", "length", "solidity", "circle_radius", "line_angle"):
        assert getattr(message, name) == getattr(contour, name), name
    assert pair(message.rectangle_center) == contour.rectangle.center
    for name in ("length", "width", "angle"):
        assert getattr(message, f"rectangle_{name}") == getattr(contour.rectangle, name)
    assert message.has_ellipse == (contour.ellipse is not None)
    if contour.ellipse is not None:
        assert pair(message.ellipse_center) == contour.ellipse.center
        for name in ("length", "width", "angle"):
            assert getattr(message, f"ellipse_{name}") == getattr(contour.ellipse, name)
    defects = contour.defects
    assert list(message.defect_depths) == [one.depth for one in defects]
    for of, name in (("starts", "start"), ("ends", "end"), ("points", "farthest")):
        places = [(point.x, point.y) for point in getattr(message, f"defect_{of}")]
        assert places == [getattr(one, name) for one in defects]
    assert list(message.hu) == contour.hu


def test_contours_objects_mask_and_overlay_are_published(node):
    image = drawn()
    contours, objects, mask, overlay = node.show(image)
    expected = rv.ContourFinder().apply(image)
    assert np.array_equal(mask, expected.mask)
    assert len(contours.contours) == len(expected.contours) == len(objects.detections) == 3
    for message, detection, contour in zip(
        contours.contours, objects.detections, expected.contours
    ):
        assert_same(message, contour)
        assert message.label == detection.label == contour.shape
        assert (message.match_distance, message.point_distance) == (-1.0, 0.0)
        assert (detection.id, detection.score) == (-1, 1.0)
        assert detection.area == contour.area and detection.box == message.box
        assert np.array_equal(rows(detection.outline), contour.outline)
        assert pair(detection.center) == contour.center
        assert detection.circle_radius == pytest.approx(contour.circle_radius, rel=1e-6)
    assert [one.label for one in objects.detections] == ["square", "ellipse", "circle"]
    assert [one.hole for one in contours.contours] == [False, False, True]
    assert not contours.has_point and pair(contours.point) == (0.0, 0.0)
    assert (overlay[20, 60:100] == (0, 255, 0)).all()  # the box is green
    assert (overlay == (0, 255, 255)).all(axis=2)[40:100, 40:100].sum() > 100  # its hole yellow


def test_a_click_gives_the_distance_of_its_pixel(node):
    node.clicks.send(Click(x=70, y=110))

    def with_point():
        contours = node.show(drawn())[0]
        return contours if contours.has_point else None

    contours = support.wait_for(with_point, "the point")
    assert pair(contours.point) == (70.0, 110.0)
    image = drawn()
    expected = rv.ContourFinder().apply(image, point=(70.0, 110.0)).contours
    distances = [one.point_distance for one in contours.contours]
    assert distances == [one.point_distance for one in expected]
    assert distances[0] == pytest.approx(10.0, abs=1.0) and max(distances[1:]) < 0.0


def test_each_thing_that_can_be_drawn_is_drawn_otherwise(node):
    image = np.full((160, 240, 3), 30, np.uint8)
    corners = [(20, 20), (120, 40), (60, 70), (140, 130), (30, 120)]
    cv2.fillPoly(image, [np.array(corners, np.int32)], (220, 220, 220))
    seen = {}
    for name in DRAWN:
        support.reconfigured("/contours", draw=name)
        seen[name] = node.show(image)[3]
        assert (seen[name] == (0, 255, 0)).all(axis=2).sum() > 100, name
    assert len({one.tobytes() for one in seen.values()}) == len(DRAWN)
    red = {name: (one == (0, 0, 255)).all(axis=2).sum() for name, one in seen.items()}
    assert red["defects"] > 50 and not any(red[name] for name in DRAWN if name != "defects")
    config = support.reconfigured("/contours", draw="all")
    assert config["draw"] == "line"
    node.process.wait_for_output("draw is 'all', must be contour, approximation, hull, defects, ")
    support.reconfigured("/contours", draw="contour")


def test_a_template_is_set_live_and_a_bad_one_leaves_the_old_one(node, tmp_path):
    good, empty = tmp_path / "ellipse.png", tmp_path / "empty.png"
    pattern = np.zeros((100, 100), np.uint8)
    cv2.ellipse(pattern, (50, 50), (30, 15), 80, 0, 360, 255, -1)
    cv2.imwrite(str(good), pattern)
    cv2.imwrite(str(empty), np.zeros((10, 10), np.uint8))
    support.reconfigured("/contours", template_file=str(good))
    contours, objects, _, _ = node.show(drawn())
    assert [one.label for one in objects.detections] == ["square", "match", "circle"]
    for message, detection in zip(contours.contours, objects.detections):
        assert message.label == detection.label and message.match_distance >= 0.0
        assert detection.score == pytest.approx(1.0 / (1.0 + message.match_distance))
    assert contours.contours[1].match_distance < 0.05 < contours.contours[2].match_distance
    for bad, told in (
        (tmp_path / "none.png", "the absolute path of an image file: No such file or directory"),
        ("ellipse.png", "template_file is 'ellipse.png', must be the absolute path of an"),
        (empty, "the template has no contour with an area"),
    ):
        assert support.reconfigured("/contours", template_file=str(bad))["template_file"] == str(
            good
        )
        node.process.wait_for_output(told)
    good.unlink()  # it has been read
    support.reconfigured("/contours", max_distance=1000.0)
    objects = node.show(drawn())[1]
    assert {one.label for one in objects.detections} == {"match"}
    support.reconfigured("/contours", template_file="", max_distance=0.1)
    assert math.isclose(node.show(drawn())[0].contours[0].match_distance, -1.0)


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("method", "magic", "method is magic, must be fixed, otsu"),
        ("draw", "all", "draw is 'all', must be contour, approximation"),
        ("template_file", "/none.png", "template_file is '/none.png', must be the absolute path"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "contours.py", name, value, text)
