"""The node lane_detector: what it publishes of a road, with a calibration and without."""

import math

import numpy as np
import pytest
import support
from calibrated_camera import CalibratedCamera, info_of, not_calibrated, show_until_known
from frames import pixels
from road import LANE, WIDTH, Road, corners_in_image
from sensor_msgs.msg import CameraInfo, Image

from robot_vision import draw_lane, draw_text
from robot_vision.msg import LaneState

ROAD = Road(0.25, LANE, distortion=(-0.1, 0.02, 0.0, 0.0))
OFFSET, HEADING = 0.05, -0.1  # m, rad
TEXT = 70  # px, the height of what is written above


class Robot:
    """A robot's camera at 10 Hz of its own time, and what the node says of its frames."""

    def __init__(self, start, *arguments, info=None):
        self.camera = CalibratedCamera(10.0, info or info_of(ROAD.camera))
        words = "__name:=lane", f"image:={self.camera.topic}"
        self.process = start("lane_detector.py", *words, *arguments)
        self.lanes = support.subscribed("/lane/lanes", LaneState)
        images = ("processed_image", "birds_eye", "mask")
        self.images = [support.subscribed(f"/lane/{name}", Image) for name in images]
        self.camera.wait_for()

    def show(self, image):
        """Shows an image; the stamp of its header, and the overlay."""
        stamp = self.camera.show(image).stamp
        overlay = self.images[0].of(stamp)
        assert (overlay.header.frame_id, overlay.encoding) == ("eye", "bgr8")
        return stamp, pixels(overlay)


def places(points):
    assert all(point.z == 0.0 for point in points)
    return np.array([(point.x, point.y) for point in points])


def assert_lane(lane):
    assert lane.found and lane.header.frame_id == "eye"
    assert lane.offset == pytest.approx(OFFSET, abs=0.01)
    assert lane.heading == pytest.approx(HEADING, abs=math.radians(1.0))
    assert lane.curvature == pytest.approx(0.25, abs=0.03)
    assert lane.width == pytest.approx(WIDTH, abs=0.01)


def test_the_lane_the_views_and_the_overlay_of_a_frame(start):
    robot = Robot(start)
    image = ROAD.view(OFFSET, HEADING)
    stamp, overlay = show_until_known(robot.show, image)
    lane = robot.lanes.of(stamp)
    assert_lane(lane)
    assert lane.left.found and lane.right.found and 0.3 <= lane.left.confidence <= 1.0
    for line, beside in ((lane.left, 0.2), (lane.right, -0.2)):
        x, y = places(line.points)[0]
        left = y * math.cos(HEADING) + x * math.sin(HEADING) + OFFSET - x * x * 0.25 / 2.0
        assert left == pytest.approx(beside, abs=0.02)
    assert np.hypot(*places(lane.middle)[0]) == pytest.approx(OFFSET, abs=0.01)
    view, mask = (pixels(topic.of(stamp)) for topic in robot.images[1:])
    assert view.shape == (200, 240, 3) and mask.shape == (200, 240)
    assert 0.005 < (mask == 255).mean() < 0.1 and set(np.unique(mask)) == {0, 255}
    assert (view[:, :, 1] == 255).any() or (view[:, :, 2] == 255).any()  # the lines
    changed = (overlay != image).any(axis=2)
    drawn, nothing = image.copy(), np.empty((0, 2))
    draw_lane(drawn, nothing, nothing)
    assert np.array_equal(drawn, image)  # without lines there is nothing to draw
    assert changed[TEXT:].mean() > 0.1 and changed[:TEXT, :150].any()

    support.reconfigured("/lane", near=0.3, view_width=1.0, resolution=0.01)
    stamp, _ = robot.show(image)
    assert_lane(robot.lanes.of(stamp))
    assert pixels(robot.images[2].of(stamp)).shape == (90, 100)
    config = support.reconfigured("/lane", method="magic", windows=20)
    assert (config["method"], config["windows"]) == ("ridge", 10)
    robot.process.wait_for_output("method is magic, must be ridge, color or gradient")

    plain = np.full(image.shape, 150, np.uint8)
    stamp, overlay = robot.show(plain)
    lane = robot.lanes.of(stamp)
    assert not lane.found and not lane.left.found and not lane.middle and lane.width == 0.0
    draw_text(plain, "no lane", (10, 20))
    assert np.array_equal(overlay, plain)


def test_without_a_calibration_four_points_are_enough(start, diagnostics):
    zeros = CameraInfo(width=320, height=240, distortion_model="plumb_bob", D=[0.0] * 5)
    robot = Robot(start, "_diagnostic_period:=0.02", info=zeros)
    road = Road(0.25)
    image = road.view(OFFSET, HEADING)
    said = f"camera_info on {robot.camera.topic.replace('image', 'camera_info')}: "

    def is_told():
        assert np.array_equal(robot.show(image)[1], not_calibrated(image))
        return f"no lanes: {said}the camera is not calibrated" in robot.process.output()

    support.wait_for(is_told, "what is missing")
    assert not robot.lanes.received
    robot.show(image)
    support.wait_for(lambda: int(diagnostics.value("lane", "frames refused")) > 0, "the count")
    assert said in diagnostics.value("lane", "last error")
    assert int(diagnostics.value("lane", "frames published")) == 0
    points = corners_in_image(0.3, 1.2)
    values = dict(ground="points", near=0.3, near_row=points[0, 1], far_row=points[2, 1])
    values.update(zip(("near_left", "near_right", "far_left", "far_right"), points[:, 0]))
    support.reconfigured("/lane", **values)
    stamp, _ = robot.show(image)
    assert_lane(robot.lanes.of(stamp))


def test_a_view_that_the_camera_does_not_have_is_said(start):
    robot = Robot(start, "_near:=30.0", "_far:=31.0", "_pitch:=1.5")
    image = ROAD.view(0.0, 0.0)
    support.wait_for(
        lambda: (
            robot.camera.show(image) and "the view from above is black" in robot.process.output()
        ),
        "the refusal",
    )
    robot.process.wait_for_output(
        f"refused a frame on {robot.camera.topic} (bgr8, 320x240): the vi"
    )


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("ground", "moon", "ground is moon, must be camera or points"),
        ("pitch", 2.0, "pitch is 2, must be from 0 to 1.6"),
        ("far", 0.1, "far is 0.1, must be above near, 0.2"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "lane_detector.py", name, value, text)
