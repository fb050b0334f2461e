"""Lanes that are known exactly, found in images of the floor."""

import functools
import math

import cv2
import numpy as np
import pytest
from road import CAMERA, LANE, WIDTH, YELLOW, Line, Road, corners_in_image
from track import Pose

import robot_vision as rv

road_of = functools.lru_cache(maxsize=None)(Road)  # painting takes longer than finding
SOLID = (Line(WIDTH / 2.0), Line(-WIDTH / 2.0, YELLOW))
LENS = (-0.25, 0.06, 0.001, -0.001)


def filled(params, values):
    for name, value in values.items():
        if hasattr(params, name):
            setattr(params, name, value)
    return params


def detector(**values):
    return rv.LaneDetector(filled(rv.GroundParams(), values), filled(rv.LaneParams(), values))


def lane_in(road, offset=0.0, heading=0.0, noise=2.0, **values):
    """The lane that a new detector with these parameters finds."""
    return detector(**values).update(0.0, road.view(offset, heading, noise), camera=road.camera)


def assert_lane(lane, offset, heading, curvature, degrees=1.0):
    assert lane.found
    assert lane.offset == pytest.approx(offset, abs=0.01)
    assert lane.heading == pytest.approx(heading, abs=math.radians(degrees))
    assert lane.curvature == pytest.approx(curvature, rel=0.1, abs=0.03)
    assert lane.width == pytest.approx(WIDTH, abs=0.01)


def assert_nothing(lane):
    """All is zero or empty."""
    assert not lane.found
    assert (lane.offset, lane.heading, lane.curvature, lane.width) == (0.0, 0.0, 0.0, 0.0)
    assert not len(lane.middle) and not len(lane.middle_in_image)
    for line in (lane.left, lane.right):
        assert not line.found and line.confidence == 0.0 and not len(line.points)


@pytest.mark.parametrize("heading", [-0.2, 0.0, 0.2])
@pytest.mark.parametrize("offset", [-0.1, 0.0, 0.1])
@pytest.mark.parametrize("curvature", [0.0, 0.25, -0.5])
def test_offset_heading_and_curvature_are_those_of_the_road(curvature, offset, heading):
    lane = lane_in(road_of(curvature), offset, heading)
    assert_lane(lane, offset, heading, curvature)


def test_the_mean_over_frames_is_not_off():
    road, found = road_of(0.25), []
    for frame in range(30):
        lane = detector().update(0.0, road.view(0.05, -0.1, 4.0, frame), camera=road.camera)
        found.append((lane.offset - 0.05, math.degrees(lane.heading + 0.1), lane.curvature - 0.25))
    assert (np.abs(np.mean(found, axis=0)) < (0.003, 0.4, 0.015)).all()
    assert (np.std(found, axis=0) < (0.002, 0.4, 0.02)).all()


@pytest.mark.parametrize("missing", ["left", "right"])
@pytest.mark.parametrize("curvature", [0.25, -0.5])
def test_one_line_is_enough(curvature, missing):
    road = road_of(curvature, LANE[:1] if missing == "right" else LANE[1:])
    lane = lane_in(road, 0.05, -0.05)
    assert_lane(lane, 0.05, -0.05, curvature)
    assert lane.width == WIDTH
    assert lane.left.found == (missing == "right") and lane.right.found == (missing == "left")


def test_a_lost_line_is_where_the_other_one_says():
    """With the width that was seen, which is not that of the parameters."""
    road = road_of(0.25, SOLID)
    tool = detector(lane_width=0.46)
    width = tool.update(0.0, road.view(0.0, 0.0), camera=road.camera).width
    assert width == pytest.approx(WIDTH, abs=0.01)
    alone = road_of(0.25, SOLID[:1])
    lane = tool.update(0.1, alone.view(0.0, 0.0), camera=alone.camera)
    assert not lane.right.found and lane.width == width
    assert_lane(lane, 0.0, 0.0, 0.25)
    assert lane_in(alone, lane_width=0.46).offset == pytest.approx(0.03, abs=0.01)


@pytest.mark.parametrize("frame", range(3))
def test_dashes_shadows_and_a_grainy_floor(frame):
    dashed = tuple(Line(line.left, line.color, dashed=True) for line in LANE)
    for road, curvature in (
        (road_of(0.25, dashed), 0.25),
        (road_of(-0.5, shadows=True, grain=3.0), -0.5),
        (road_of(0.0, shadows=True, grain=3.0), 0.0),
    ):
        lane = detector().update(0.0, road.view(0.05, 0.1, 3.0, frame), camera=road.camera)
        assert_lane(lane, 0.05, 0.1, curvature, degrees=1.5)


@pytest.mark.parametrize("method", ["ridge", "color", "gradient"])
@pytest.mark.parametrize("noise", [0.0, 2.0, 8.0])
def test_a_plain_floor_has_no_lane(method, noise):
    road = road_of(0.0, (), grain=noise)
    for frame in range(3):
        image = road.view(0.0, 0.0, noise, frame)
        assert_nothing(detector(method=method).update(0.0, image, camera=road.camera))


@pytest.mark.parametrize("method", ["ridge", "color", "gradient"])
def test_what_is_no_road_has_no_lane_and_never_nan(method):
    shape = CAMERA.height, CAMERA.width, 3
    black, white = (np.full(shape, value, np.uint8) for value in (0, 255))
    noise = np.random.RandomState(5).randint(0, 256, shape).astype(np.uint8)
    across, along = black.copy(), black.copy()
    across[::8] = across[1::8] = along[:, ::8] = along[:, 1::8] = 255
    for image in (black, white, noise, across, along):
        lane = detector(method=method).update(0.0, image, camera=CAMERA.model())
        values = [lane.offset, lane.heading, lane.curvature, lane.width]
        assert np.isfinite(values).all() and lane.found == any(values)
        assert np.isfinite(lane.middle).all() and np.isfinite(lane.left.points).all()
        if image is black:
            assert_nothing(lane)


@pytest.mark.parametrize("method", ["ridge", "gradient"])
def test_the_border_of_a_shadow_is_no_line(method):
    half = np.full((CAMERA.height, CAMERA.width, 3), 150, np.uint8)
    half[:, : CAMERA.width // 2] = 70
    assert_nothing(detector(method=method).update(0.0, half, camera=CAMERA.model()))


@pytest.mark.parametrize("method", ["color", "gradient"])
@pytest.mark.parametrize("curvature", [0.25, -0.5])
def test_other_methods_find_the_same_lane(method, curvature):
    lane = lane_in(road_of(curvature), -0.05, 0.1, method=method)
    assert_lane(lane, -0.05, 0.1, curvature)
    assert lane.left.found and lane.right.found


def test_gray_paint_has_no_color():
    road = road_of(0.0, (Line(0.2, (160, 160, 160)), Line(-0.2, (160, 160, 160))), floor=(90,) * 3)
    assert_lane(lane_in(road), 0.0, 0.0, 0.0)
    assert_nothing(lane_in(road, method="color"))


@pytest.mark.parametrize(
    "values, left, right",
    [
        ({}, True, True),
        ({"white_low": 240}, False, True),
        ({"yellow_saturation": 250}, True, False),
        ({"yellow_lightness": 160}, True, False),
        ({"yellow_low": 30}, True, False),
        ({"yellow_high": 16}, True, False),
    ],
)
def test_colors_are_those_of_the_parameters(values, left, right):
    lane = lane_in(road_of(0.0, SOLID), method="color", **values)
    assert (lane.left.found, lane.right.found) == (left, right)


@pytest.mark.parametrize("floor", [(3, 6, 9), (12, 15, 18)])
def test_the_noise_of_a_dark_floor_is_not_yellow(floor):
    lane = lane_in(road_of(0.0, SOLID, floor=floor), 0.05, noise=3.0, method="color")
    assert_lane(lane, 0.05, 0.0, 0.0)
    assert lane.left.found and lane.right.found


def test_the_lens_is_respected():
    road = road_of(0.25, LANE, LENS)
    image = road.view(0.05, -0.1)
    assert_lane(detector().update(0.0, image, camera=road.camera), 0.05, -0.1, 0.25)
    plain = detector().update(0.0, image, camera=CAMERA.model())
    assert not plain.found or abs(plain.width - WIDTH) > 0.01 or abs(plain.curvature - 0.25) > 0.05


@pytest.mark.parametrize("curvature, offset, heading", [(0.0, 0.05, 0.1), (0.25, -0.05, -0.1)])
def test_four_points_take_the_place_of_a_calibration(curvature, offset, heading):
    points = corners_in_image(0.3, 1.2)
    values = dict(ground="points", near=0.3, near_row=points[0, 1], far_row=points[2, 1])
    values.update(zip(("near_left", "near_right", "far_left", "far_right"), points[:, 0]))
    lane = lane_in(road_of(curvature), offset, heading, **values)
    assert_lane(lane, offset, heading, curvature)
    half = lane_in(road_of(0.0), 0.06, lane_width=0.2, **values)
    assert half.offset == pytest.approx(0.03, abs=0.01)  # in the width that is given
    moved = {name: values[name] + 0.1 for name in ("near_left", "near_right")}
    assert lane_in(road_of(0.0), **{**values, **moved}).heading != pytest.approx(0.0, abs=0.02)


def test_the_camera_may_be_anywhere_on_the_robot():
    road, heading = road_of(0.0), 0.15
    lane = lane_in(road, 0.02, heading, camera_x=0.3, near=0.5, far=1.5)
    assert_lane(lane, 0.02 - 0.3 * math.sin(heading), heading, 0.0)
    assert lane_in(road, 0.02, heading, camera_y=0.1).offset == pytest.approx(
        0.02 - 0.1 * math.cos(heading), abs=0.01
    )
    assert lane_in(road, camera_height=0.275).width == pytest.approx(1.1 * WIDTH, abs=0.01)
    steeper = lane_in(road, pitch=0.65)
    assert not steeper.found or steeper.width < 0.97 * WIDTH


def test_the_view_from_above_is_what_the_parameters_say():
    lane = lane_in(
        road_of(0.0, SOLID), noise=0.0, near=0.3, far=1.1, view_width=0.9, resolution=0.004
    )
    assert lane.view.shape == (200, 225, 3) and lane.mask.shape == (200, 225)
    rows = np.arange(60, 160)
    assert (np.abs(lane.view[rows, 112].astype(int) - 150) <= 2).all()  # floor in the middle
    left, right = (round((0.45 - y) / 0.004 - 0.5) for y in (0.2, -0.2))
    assert (lane.view[rows, left] > 180).all() and (lane.view[rows, right, 0] < 100).all()
    assert lane.mask[rows, left].all() and lane.mask[rows, right].all()
    assert not lane.mask[rows, 112].any()
    assert not lane.view[-1, 0].any()  # The camera does not see this corner.
    for line, y in ((lane.left, 0.2), (lane.right, -0.2)):
        assert np.allclose(line.points[:, 1], y, atol=0.005)
        view = np.column_stack([(0.45 - line.points[:, 1]), 1.1 - line.points[:, 0]]) / 0.004 - 0.5
        assert np.allclose(line.from_above, view)
        assert (np.diff(line.points[:, 0]) > 0.0).all()


def test_points_are_on_the_lines_and_where_the_camera_sees_them():
    road = road_of(-0.5, SOLID, LENS)
    lane = lane_in(road, 0.05, 0.1)
    to_camera = np.linalg.inv(CAMERA.pose_on(Pose()))
    for curve, pixels, beside in (
        (lane.left.points, lane.left.in_image, WIDTH / 2.0),
        (lane.right.points, lane.right.in_image, -WIDTH / 2.0),
        (lane.middle[5:], lane.middle_in_image[5:], 0.0),
    ):
        cos, sin = math.cos(0.1), math.sin(0.1)  # into the frame of the lane
        x, y = curve[:, 0] * cos - curve[:, 1] * sin, curve[:, 0] * sin + curve[:, 1] * cos + 0.05
        assert np.allclose(np.hypot(x, y + 2.0) - 2.0, beside, atol=0.01)
        places = np.column_stack([curve, np.zeros(len(curve))])
        seen, _ = road.camera.project(places @ to_camera[:3, :3].T + to_camera[:3, 3])
        assert np.allclose(pixels, seen, atol=1e-6)
    assert np.linalg.norm(lane.middle[0]) == pytest.approx(0.05, abs=0.01)


@pytest.mark.parametrize(
    "values, left, right",
    [
        ({}, True, True),
        ({"contrast": 65.0}, True, False),  # white is brighter than yellow
        ({"lane_width": 0.6}, True, False),  # alone: no other line is so far away
        ({"lane_width": 0.6, "width_tolerance": 0.5}, True, True),
        ({"min_rows": 15}, True, True),
        ({"min_rows": 15, "window_width": 0.005, "tolerance": 0.002}, False, False),
        ({"min_length": 0.99}, False, False),
        ({"min_confidence": 1.0}, False, False),
        ({"tolerance": 0.001, "min_confidence": 0.7}, False, False),
    ],
)
def test_what_counts_as_a_line(values, left, right):
    lane = lane_in(road_of(0.0, SOLID), 0.03, 0.05, **values)
    assert (lane.left.found, lane.right.found) == (left, right)
    assert lane.found == (left or right)


def test_wide_lines_need_a_wide_look():
    wide = tuple(Line(line.left, line.color, width=0.08) for line in SOLID)
    assert_nothing(lane_in(road_of(0.0, wide)))
    assert_lane(lane_in(road_of(0.0, wide), line_width=0.08), 0.0, 0.0, 0.0)


def test_what_is_wider_than_a_line_is_left_out():
    road = road_of(0.0, (*SOLID, Line(0.0, width=0.12)))
    lane = lane_in(road, method="color")
    assert_lane(lane, 0.0, 0.0, 0.0)
    assert not lane.mask[:, 110:130].any() and (lane.view[100:180, 110:130] > 200).all()


def test_a_lane_that_bends_too_much_is_none():
    assert_nothing(lane_in(road_of(-0.5), max_curvature=0.2))
    assert_lane(lane_in(road_of(-0.5), max_curvature=0.7), 0.0, 0.0, -0.5)


def test_the_confidence_is_less_if_less_is_seen():
    solid, dashed = lane_in(road_of(0.0, SOLID)), lane_in(road_of(0.0))
    assert 0.9 < solid.left.confidence <= 1.0 and 0.9 < solid.right.confidence <= 1.0
    assert 0.5 < dashed.right.confidence <= 1.0
    image = road_of(0.0, SOLID).view(0.0, 0.0)
    image[:100] = 150  # the farther part of the lines is not there
    part = detector().update(0.0, image, camera=CAMERA.model())
    assert part.left.confidence < 0.8 * solid.left.confidence


LANES = (Line(0.2), Line(-0.2, YELLOW), Line(-0.6))  # two of them


def test_the_lane_is_kept_until_the_robot_has_left_it():
    road, tool = road_of(0.0, LANES), detector()

    def offset(time, true):
        return tool.update(time, road.view(true, 0.0), camera=road.camera).offset

    assert offset(0.0, -0.1) == pytest.approx(-0.1, abs=0.01)
    assert offset(0.1, -0.17) == pytest.approx(-0.17, abs=0.01)
    offset(0.2, -0.2)
    assert offset(0.3, -0.23) == pytest.approx(-0.23, abs=0.01)  # past its line, but not far
    assert offset(0.9, -0.23) == pytest.approx(0.17, abs=0.01)  # after a gap: the nearer one
    tool.reset()
    assert offset(1.0, -0.19) == pytest.approx(-0.19, abs=0.01)
    offset(1.1, -0.22)
    offset(1.2, -0.25)
    assert offset(1.3, -0.25) == pytest.approx(0.15, abs=0.01)


NARROW = (Line(0.125, dashed=True), Line(-0.125), Line(-0.375))  # two that are 0.25 m wide


@pytest.mark.parametrize(
    "lines, hidden, width, offset, heading",
    [
        (LANES, 0, WIDTH, -0.1, -0.1),  # The other lane is there with both lines,
        (NARROW, 1, 0.25, 0.0, 0.0),  # or one of it is clearer than the own one.
    ],
)
def test_a_hidden_line_does_not_lead_into_the_lane_beside(lines, hidden, width, offset, heading):
    tool = detector(lane_width=width)
    both, one = road_of(0.0, lines), road_of(0.0, lines[:hidden] + lines[hidden + 1 :])
    for time, road in enumerate((both, one, one, both)):
        image = road.view(offset, heading, frame=time)
        lane = tool.update(0.03 * time, image, camera=road.camera)
        assert lane.found and lane.offset == pytest.approx(offset, abs=0.01), time
        is_there = [road is both or hidden != line for line in (0, 1)]
        assert [lane.left.found, lane.right.found] == is_there, time


def test_a_lane_beside_is_taken_only_after_a_gap_if_all_else_is_hidden():
    both, beside, tool = road_of(0.0, LANES), road_of(0.0, LANES[2:]), detector(view_width=1.8)

    def lane(road, time):
        return tool.update(time, road.view(-0.1, -0.2), camera=road.camera)

    assert lane(both, 0.0).found
    assert_nothing(lane(beside, 0.4))
    assert lane(both, 0.5).offset == pytest.approx(-0.1, abs=0.01)
    assert lane(beside, 1.1).offset == pytest.approx(0.3, abs=0.01)


def test_a_quick_turn_loses_no_part_of_the_lines():
    road, tool = road_of(0.0, SOLID), detector()
    for time, heading in enumerate((0.0, 0.07, 0.0)):
        lane = tool.update(0.1 * time, road.view(0.0, heading), camera=road.camera)
        assert lane.left.points[-1, 0] > 1.0 and lane.right.points[-1, 0] > 1.0
        assert_lane(lane, 0.0, heading, 0.0)


def test_time_that_goes_back_begins_anew():
    road, tool = road_of(0.0, LANES), detector(max_gap=60.0)
    for time, true, expected in ((5.0, -0.19, -0.19), (5.1, -0.22, -0.22), (1.0, -0.22, 0.18)):
        lane = tool.update(time, road.view(true, 0.0), camera=road.camera)
        assert lane.offset == pytest.approx(expected, abs=0.01)


def test_smoothing_is_a_mean_with_a_time_constant():
    road, tool = road_of(0.0, SOLID), detector(smoothing=0.4)
    plain = [lane_in(road, offset) for offset in (0.0, 0.04)]
    expected = plain[0].offset
    for step in range(5):
        time, now = 0.1 * step, plain[min(step, 1)].offset
        image = road.view(0.04 if step else 0.0, 0.0)
        lane = tool.update(time, image, camera=road.camera)
        expected += (1.0 - math.exp(-0.1 / 0.4)) * (now - expected) if step else 0.0
        assert lane.offset == pytest.approx(expected, abs=0.002)


def test_the_mean_begins_anew_in_another_lane():
    """And it delays no change: the robot drifts to the right into it, and stops in its middle."""
    road = road_of(0.0, LANES)
    plain, smooth = detector(), detector(smoothing=0.5)
    expected, before, changes = 0.0, 0.0, []
    for step in range(20):
        image = road.view(-min(0.025 * step, 0.4), 0.0)
        seen, lane = (
            tool.update(0.1 * step, image, camera=road.camera) for tool in (plain, smooth)
        )
        changes += [step] if seen.offset - before > WIDTH / 2.0 else []
        is_first = step == 0 or step in changes
        expected += (1.0 if is_first else 1.0 - math.exp(-0.1 / 0.5)) * (seen.offset - expected)
        assert lane.offset == pytest.approx(expected, abs=1e-9), step
        assert np.array_equal(lane.left.points, seen.left.points)
        before = seen.offset
    assert changes == [11]


def test_the_same_frame_has_the_same_lane_and_is_not_changed():
    road = road_of(0.25)
    image = road.view(0.05, 0.1)
    before = image.copy()
    lanes = [detector().update(0.0, image, camera=road.camera) for _ in range(2)]
    assert np.array_equal(image, before)
    assert lanes[0].offset == lanes[1].offset and lanes[0].curvature == lanes[1].curvature
    assert np.array_equal(lanes[0].left.points, lanes[1].left.points)


def test_every_encoding_shows_the_same_lane():
    road = road_of(0.25)
    image = road.view(0.05, -0.1)
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    padded = np.zeros((*image.shape[:1], image.shape[1] + 9, 3), np.uint8)[:, : image.shape[1]]
    padded[:] = image
    for pixels, encoding in (
        (np.ascontiguousarray(image[:, :, ::-1]), "rgb8"),
        (padded, "bgr8"),
        (gray, "mono8"),
        (gray.astype(np.uint16) * 257, "mono16"),
    ):
        lane = detector().update(0.0, pixels, encoding, road.camera)
        assert_lane(lane, 0.05, -0.1, 0.25)


def test_the_camera_may_change_from_frame_to_frame():
    tool, plain, bent = detector(), road_of(0.25), road_of(0.25, LANE, LENS)
    for time, road in enumerate((plain, bent, plain)):
        lane = tool.update(0.1 * time, road.view(0.05, -0.1), camera=road.camera)
        assert_lane(lane, 0.05, -0.1, 0.25)


def test_a_lane_is_drawn_between_its_lines():
    image = np.zeros((100, 100, 3), np.uint8)
    left, right = np.array([[20.0, 90.0], [40.0, 10.0]]), np.array([[80.0, 90.0], [60.0, 10.0]])
    rv.draw_lane(image, left, right)
    assert tuple(image[50, 50]) == (0, 76, 0) or tuple(image[50, 50]) == (0, 77, 0)
    assert image[50, 30, 2] > 200 and image[50, 70, 2] > 200  # the lines
    assert not image[50, :25].any() and not image[:8].any()
    alone = np.zeros((100, 100, 3), np.uint8)
    rv.draw_lane(alone, np.array([[20.0, 90.0], [np.nan, 3.0], [40.0, 10.0]]), np.empty((0, 2)))
    assert alone[50, 30, 2] > 200 and not alone[50, 50].any()


def test_what_cannot_be_drawn_on_is_refused():
    line = np.zeros((2, 2))
    with pytest.raises(ValueError, match="bgr8"):
        rv.draw_lane(np.zeros((9, 9), np.uint8), line, line)
    locked = np.zeros((9, 9, 3), np.uint8)
    locked.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        rv.draw_lane(locked, line, line)
    with pytest.raises(ValueError, match=r"an \(n, 2\) array of points"):
        rv.draw_lane(np.zeros((9, 9, 3), np.uint8), np.zeros((2, 3)), line)


@pytest.mark.parametrize(
    "values, text",
    [
        ({"ground": "moon"}, "ground is moon, must be camera or points"),
        ({"camera_height": 0.0}, "camera_height is 0, must be above 0"),
        ({"pitch": math.nan}, "pitch is nan, must be from 0 to 1.6"),
        ({"far": 0.1}, "far is 0.1, must be above near, 0.2"),
        ({"resolution": 0.1}, "resolution is 0.1, must be such that 1 m are 20 to 1000 px"),
        ({"view_width": 6.0}, "resolution is 0.005, must be such that 6 m are 20 to 1000 px"),
        ({"near_row": 0.3}, "near_row is 0.3, must be below far_row, 0.4"),
        ({"near_right": 0.1}, "near_right is 0.1, must be right of near_left"),
        ({"far_left": 0.7}, "far_right is 0.6, must be right of far_left"),
        ({"method": "magic"}, "method is magic, must be ridge, color or gradient"),
        ({"contrast": 0.0}, "contrast is 0, must be from 1 to 255"),
        ({"line_width": 0.5}, "line_width is 0.5, must be at most a quarter of view_width, 0.3"),
        ({"yellow_high": 10}, "yellow_high is 10, must be yellow_low or more, 15"),
        ({"width_tolerance": 1.0}, "width_tolerance is 1, must be from 0.01 to 0.9"),
        ({"windows": 2}, "windows is 2, must be from 3 to 50"),
        ({"min_rows": 0}, "min_rows is 0, must be from 1 to 1000"),
        ({"tolerance": 0.05}, "tolerance is 0.05, must be below half of window_width, 0.05"),
        ({"window_width": 0.03}, "tolerance is 0.015, must be below half of window_width, 0.015"),
        ({"min_length": 1.0}, "min_length is 1, must be below far - near, 1"),
        ({"near": 0.3, "far": 0.6}, "min_length is 0.3, must be below far - near, 0.3"),
        ({"min_rows": 21}, "min_rows is 21, must be at most the rows of a window, .*, 20"),
        (
            {"windows": 50, "resolution": 0.03},
            "windows is 50, must be at most the rows of the view, ",
        ),
        ({"windows": 50}, "min_rows is 5, must be at most the rows of a window, .*, 4"),
        ({"smoothing": -1.0}, "smoothing is -1, must be from 0 to 10"),
    ],
)
def test_parameters_that_cannot_be_are_refused(values, text):
    with pytest.raises(ValueError, match=text):
        detector(**values)


def test_frames_and_cameras_that_do_not_fit_are_refused():
    image, camera = np.zeros((240, 320, 3), np.uint8), CAMERA.model()
    with pytest.raises(
        ValueError, match="the camera is not known, must be given, as ground is cam"
    ):
        detector().update(0.0, image)
    with pytest.raises(
        ValueError, match="the image is 160x240, must be of the camera's size, 320x"
    ):
        detector().update(0.0, image[:, :160], camera=camera)
    with pytest.raises(ValueError, match="mono8"):
        detector().update(0.0, image, "mono8", camera)
    for _ in range(2):  # each time anew
        tool = detector(near=30.0, far=31.0, pitch=1.5)
        with pytest.raises(ValueError, match="the view from above is black, must be of floor that"):
            tool.update(0.0, image, camera=camera)


def test_white_and_yellow_are_as_bright_to_a_ridge():
    """A floor that has as much blue as the white paint is dark to it."""
    road = road_of(0.0, SOLID, floor=(230, 100, 90))
    lane = lane_in(road)
    assert lane.left.found and lane.right.found
    assert_lane(lane, 0.0, 0.0, 0.0)
