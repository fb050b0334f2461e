"""Keypoints and oriented boxes that networks give, against plain NumPy and OpenCV."""

import cv2
import numpy as np
import pytest
from head_outputs import CLASSES, HEIGHT, WIDTH, head_params, kept, with_extras

import robot_vision as rv

NAN = float("nan")
PLACEMENTS = [
    (rv.InputPlacement(), (WIDTH, HEIGHT)),
    (rv.InputPlacement(0.25, 0.25, 0.0, 10.0), (640, 300)),
    (rv.InputPlacement(2.0, 1.5, 3.0, 0.0, 5, 9), (70, 61)),
]


@pytest.mark.parametrize("values", [2, 3])
@pytest.mark.parametrize("place", range(len(PLACEMENTS)))
def test_keypoints_are_where_they_are_in_the_image(place, values):
    placement, image_size = PLACEMENTS[place]
    rng = np.random.default_rng(3)
    points = rng.uniform(-10, 200, (77, 4, values)).astype(np.float32)
    points[..., 2:] = rng.uniform(0, 1, (77, 4, values - 2))
    output = with_extras("yolov8", points.reshape(77, -1))
    params = head_params("yolov8", task="pose", keypoints=4, keypoint_values=values)
    objects = rv.HeadDecoder(params).decode([output], placement, image_size)
    assert len(objects) >= 3
    scores = output[0, 4 : 4 + CLASSES].max(axis=0)
    for one in objects:
        expected = points[int(np.argmin(np.abs(scores - one.score)))]
        x = (expected[:, 0] - placement.left) / placement.scale_x + placement.x
        y = (expected[:, 1] - placement.top) / placement.scale_y + placement.y
        sure = expected[:, 2] if values == 3 else np.ones(4)
        np.testing.assert_allclose(one.keypoints, np.stack([x, y, sure], 1), rtol=1e-4, atol=1e-3)


def test_keypoint_that_is_not_finite_has_no_score():
    points = np.tile([10.0, 20.0, 0.5, 30.0, NAN, 0.9, 1.0, 2.0, NAN], (77, 1))
    output = with_extras("yolov8", points)
    params = head_params("yolov8", task="pose", keypoints=3)
    objects = rv.HeadDecoder(params).decode([output], *PLACEMENTS[0])
    assert objects
    for one in objects:
        np.testing.assert_allclose(one.keypoints, [[10, 20, 0.5], [0, 0, 0], [0, 0, 0]])


def outline(x, y, width, height, angle):
    """Corners, clockwise in an image from the one at the top left of the box not yet turned."""
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [width / 2, height / 2]
    return corners @ turn.T + [x, y]


def shared_by_opencv(a, b):
    area, _ = cv2.intersectConvexConvex(a.astype(np.float32), b.astype(np.float32))
    areas = [cv2.contourArea(corners.astype(np.float32)) for corners in (a, b)]
    return area / (sum(areas) - area)


@pytest.mark.parametrize(
    "values", [{}, {"class_agnostic": True}, {"iou_threshold": 0.2}, {"max_detections": 4}], ids=str
)
def test_oriented_boxes_are_those_that_opencv_finds_apart(values):
    for seed in range(5):
        angles = np.random.default_rng(seed).uniform(-np.pi / 4, 3 * np.pi / 4, (77, 1))
        output = with_extras("yolov8", angles, seed)
        params = head_params("yolov8", task="oriented", **values)
        found = rv.HeadDecoder(params).decode([output], *PLACEMENTS[0])
        columns = output[0].astype(float)
        boxes = []
        for column in columns.T:
            class_id = int(np.argmax(column[4 : 4 + CLASSES]))
            score = column[4 + class_id]
            if score >= 0.25:
                boxes.append((class_id, score, outline(*column[:4], column[-1])))
        expected = kept(boxes, params, shared_by_opencv)
        assert [one.class_id for one in found] == [one[0] for one in expected]
        for one, (_, score, corners) in zip(found, expected):
            assert one.score == pytest.approx(score, rel=1e-6)
            np.testing.assert_allclose(one.outline, corners, atol=1e-3)
            low, high = corners.min(axis=0), corners.max(axis=0)
            around = np.clip([*low, *high], 0, [WIDTH, HEIGHT, WIDTH, HEIGHT])
            np.testing.assert_allclose(one.box, around, atol=1e-3)
            assert one.center == pytest.approx(corners.mean(axis=0), abs=1e-3)


def oriented(boxes):
    """A network's output of (x, y, width, height, angle), each less sure than the one before."""
    columns = np.zeros((1, 4 + CLASSES + 1, len(boxes)), np.float32)
    for i, box in enumerate(boxes):
        columns[0, :4, i], columns[0, -1, i], columns[0, 4, i] = box[:4], box[4], 0.9 - 0.1 * i
    return columns


def test_boxes_across_each_other_are_both_kept_although_straight_ones_would_not():
    crossed = [(80, 48, 60, 6, np.pi / 4), (80, 48, 60, 6, -np.pi / 4)]
    params = head_params("yolov8", task="oriented")
    found = rv.HeadDecoder(params).decode([oriented(crossed)], *PLACEMENTS[0])
    assert len(found) == 2
    np.testing.assert_allclose(found[0].box, found[1].box, atol=1e-3)
    same = [
        (80, 48, 60, 6, 0.3),
        (80, 48, 6, 60, 0.3 + np.pi / 2),
    ]  # width and height changed round
    assert len(rv.HeadDecoder(params).decode([oriented(same)], *PLACEMENTS[0])) == 1


@pytest.mark.parametrize("angle", [NAN, float("inf"), -float("inf")])
def test_oriented_box_without_a_finite_angle_is_left_out(angle):
    params = head_params("yolov8", task="oriented")
    output = oriented([(80, 48, 60, 6, angle), (20, 20, 10, 10, 0)])
    (found,) = rv.HeadDecoder(params).decode([output], *PLACEMENTS[0])
    assert found.center == pytest.approx((20, 20))


def test_outline_is_that_of_the_image_when_its_sides_are_scaled_apart():
    placement = rv.InputPlacement(0.5, 0.25, 8.0, 4.0, 3, 2)
    params = head_params("yolov8", task="oriented")
    output = oriented([(80, 48, 40, 12, 0.7)])
    (found,) = rv.HeadDecoder(params).decode([output], placement, (640, 480))
    corners = (outline(80, 48, 40, 12, 0.7) - [8, 4]) / [0.5, 0.25] + [3, 2]
    np.testing.assert_allclose(found.outline, corners, atol=1e-3)


@pytest.mark.parametrize(
    "box, pixels",
    [
        ((1.0, 2.0, 4.0, 6.0), (1, 2, 3, 4)),
        ((0.9999, 1.9999, 4.0001, 6.0001), (1, 2, 3, 4)),  # what float32 makes of the same
        ((0.9, 1.9, 4.1, 6.1), (0, 1, 5, 6)),
        ((3.2, 3.2, 3.3, 3.3), (3, 3, 1, 1)),
        ((5.0, 5.0, 5.0, 5.0), (5, 5, 1, 1)),
        ((-2.5, -1.0, 0.5, 0.0), (-3, -1, 4, 1)),
        ((639.9995, 479.9999, 640.0, 480.0), (639, 479, 1, 1)),  # at the border of an image
        ((0.0, 0.0, 0.0005, 0.0001), (0, 0, 1, 1)),
        ((-1e30, 1.0, 1e30, 2.0), (-(10**9), 1, 2 * 10**9, 1)),
    ],
)
def test_the_pixels_that_a_box_touches(box, pixels):
    assert rv.box_pixels(box) == pixels
