"""What networks must not give, and what is made of it: refusals, or nothing."""

import numpy as np
import pytest
from head_outputs import (
    CLASSES,
    HEADS,
    HEIGHT,
    SIZE,
    WIDTH,
    found_in,
    head_params,
    random_outputs,
)
from single_boxes import with_box

import robot_vision as rv

NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    "box", [(50, 40, 50, 60), (50, 40, 70, 40), (70, 40, 50, 60), (5, 60, 9, 40)]
)
@pytest.mark.parametrize("head", ["yolov3", "yolov5", "yolov8", "yolov10", "ssd", "detr", "rtdetr"])
def test_box_without_area_is_left_out(head, box):
    assert found_in(head_params(head), with_box(head, box)) == []


@pytest.mark.parametrize("damage", [NAN, INF, -INF, -NAN])
@pytest.mark.parametrize("head", HEADS)
def test_what_is_not_finite_is_left_out(head, damage):
    outputs = random_outputs(head, 5)
    intact = found_in(head_params(head, iou_threshold=1.0, max_detections=10000), outputs)
    for output in outputs:
        for place in range(0, output.size, 41):
            output.reshape(-1)[place] = damage
    found = found_in(head_params(head, iou_threshold=1.0, max_detections=10000), outputs)
    assert 0 < len(found) < len(intact)
    assert all(np.isfinite(one.box).all() and np.isfinite(one.score) for one in found)
    for output in outputs:
        output[:] = damage
    assert found_in(head_params(head, score_threshold=0.0), outputs) == []


def test_class_that_is_not_finite_is_none_but_the_others_are():
    for damage in (NAN, INF, -INF):
        outputs = with_box("yolov8", (10, 10, 50, 50))
        outputs[0][0, 4:, 13] = [0.1, damage, 0.6, damage, 0.3]
        (found,) = found_in(head_params("yolov8"), outputs)
        assert (found.class_id, found.score) == (2, pytest.approx(0.6))


def test_of_very_many_boxes_the_surest_count():
    rng = np.random.default_rng(3)
    columns = np.zeros((1, 4 + CLASSES, 100_000), np.float32)
    columns[0, 0] = rng.uniform(0, WIDTH, 100_000)
    columns[0, 1] = rng.uniform(0, HEIGHT, 100_000)
    columns[0, 2:4] = rng.uniform(0.1, 3, (2, 100_000))
    columns[0, 4:] = rng.uniform(0.5, 1, (CLASSES, 100_000))
    params = head_params("yolov8", max_detections=10000)
    best = columns[0, 4:].max(axis=0)
    surest = np.sort(np.argsort(-best, kind="stable")[:4096])
    found = found_in(params, [columns])
    expected = found_in(params, [np.ascontiguousarray(columns[:, :, surest])])
    assert [one.box for one in found] == [one.box for one in expected]
    assert 100 < len(found) <= 4096


WRONG = [
    ("yolov3", [(4, 4 + CLASSES)], r"\(1, n, 10\)"),
    ("yolov3", [], "0 outputs, must have 1"),
    ("yolov5", [(1, 20, 9)], r"yolov5: output 0 is of shape \(1, 20, 9\), must be of \(1, n, 10\)"),
    (
        "yolov8",
        [(1, 84, 77)],
        r"yolov8: output 0 is of shape \(1, 84, 77\), must be of \(1, 9, n\)",
    ),
    ("yolov8", [(2, 9, 77)], r"\(2, 9, 77\)"),
    ("yolov8", [(9,)], r"\(9\)"),
    ("yolov8", [()], r"\(\)"),
    ("yolov8", [(1, 9, 77), (1, 32, 4, 4)], "2 outputs, must have 1"),
    ("yolov10", [(1, 300, 7)], r"\(1, n, 6\)"),
    (
        "yolox",
        [(1, 316, 10)],
        r"yolox: output 0 is of shape \(1, 316, 10\), must be of \(1, 315, 10\)",
    ),
    ("nanodet", [(1, 315, 37)], r"\(1, 321, 37\)"),
    ("ssd", [(1, 1, 9, 6)], r"\(1, n, 7\)"),
    ("ssd", [(1, 9, 4), (1, 9)], "2 outputs, must have 3"),
    ("ssd", [(1, 9, 4), (1, 9), (1, 8)], r"output 2 is of shape \(1, 8\), must be of \(1, 9\)"),
    ("detr", [(1, 9, 5), (1, 9, 4)], r"\(1, n, 6\)"),
    ("detr", [(1, 9, 6), (1, 8, 4)], r"\(1, 9, 4\)"),
    ("rtdetr", [(1, 9, 4)], r"\(1, n, 9\)"),
    ("rtdetr", [(1, 9, 4), (1, 9, 4)], r"\(1, n, 5\)"),
]


@pytest.mark.parametrize("head, shapes, words", WRONG, ids=str)
def test_outputs_of_another_shape_are_refused(head, shapes, words):
    outputs = [np.zeros(shape, np.float32) for shape in shapes]
    with pytest.raises(ValueError, match=words):
        found_in(head_params(head), outputs)


@pytest.mark.parametrize(
    "head, shapes",
    [
        ("yolov3", [(0, 10)]),
        ("yolov5", [(1, 0, 10)]),
        ("yolov8", [(1, 9, 0)]),
        ("yolov10", [(1, 0, 6)]),
        ("ssd", [(1, 1, 0, 7)]),
        ("detr", [(1, 0, 6), (1, 0, 4)]),
        ("rtdetr", [(1, 0, 9)]),
    ],
)
def test_no_boxes_are_no_objects(head, shapes):
    assert found_in(head_params(head), [np.zeros(shape, np.float32) for shape in shapes]) == []


@pytest.mark.parametrize(
    "values, words",
    [
        ({"head": "yolo"}, "head is yolo"),
        ({"task": "pose", "head": "yolov5"}, "task of yolov5 is pose, must be detect or segment"),
        ({"task": "segment", "head": "detr"}, "must be detect"),
        ({"task": "track"}, "task is track"),
        ({"classes": 0}, "classes is 0"),
        ({"score_threshold": NAN}, "score_threshold is nan"),
        (
            {"class_thresholds": [0.5]},
            "class_thresholds is 1 numbers, must be none, or one for each",
        ),
        ({"class_thresholds": [0, 0, 0, 0, 1.5]}, "class_thresholds is 1.5"),
        ({"iou_threshold": -0.1}, "iou_threshold"),
        ({"max_detections": 10001}, "max_detections"),
        ({"keypoint_values": 4}, "keypoint_values is 4"),
        ({"strides": [8, 3]}, "strides is 3, must be from 4 to 1024"),
        ({"strides": [8] * 9}, "strides is 9 numbers, must be at most 8"),
        ({"input_width": 0}, "input_width"),
    ],
)
def test_parameter_out_of_range_is_refused(values, words):
    with pytest.raises(ValueError, match=words):
        rv.HeadDecoder(head_params(**{"head": "yolov8", **values}))


@pytest.mark.parametrize(
    "placement, size",
    [
        (rv.InputPlacement(scale_x=0.0), SIZE),
        (rv.InputPlacement(scale_y=NAN), SIZE),
        (rv.InputPlacement(left=INF), SIZE),
        (rv.InputPlacement(), (0, 10)),
        (rv.InputPlacement(), (10, -1)),
    ],
)
def test_placement_and_size_that_cannot_be_are_refused(placement, size):
    with pytest.raises(ValueError):
        found_in(head_params("yolov8"), random_outputs("yolov8"), placement, size)


@pytest.mark.parametrize("head", ["yolov3", "yolov5", "yolox"])
def test_box_with_an_objectness_below_the_threshold_is_left_out(head):
    for objectness, expected in ((0.24, 0), (0.26, 1), (NAN, 0), (INF, 0)):
        outputs = with_box(head, (70.0, 31.0, 103.0, 57.0))
        rows = outputs[-1].reshape(-1, 5 + CLASSES)
        rows[rows[:, 4] > 0, 5:] = [0, 0, 0, 2.0, 0]  # more than a score can be
        rows[rows[:, 4] > 0, 4] = objectness
        assert len(found_in(head_params(head), outputs)) == expected


@pytest.mark.parametrize("number", [-1, CLASSES, 2.5, 1e9, -1e9, 3e38, NAN, INF])
def test_box_of_a_class_that_there_is_not_is_left_out(number):
    outputs = with_box("yolov10", (10, 10, 50, 50))
    outputs[0][0, 0, 5] = number
    assert found_in(head_params("yolov10"), outputs) == []
    for background in (True, False):
        outputs = with_box("ssd", (10, 10, 50, 50))
        outputs[0][0, 0, 0, 1] = number + 1 if background else number
        assert found_in(head_params("ssd", background=background), outputs) == []


def test_background_and_boxes_of_other_images_are_left_out():
    outputs = with_box("ssd", (10, 10, 50, 50), class_id=0)
    assert len(found_in(head_params("ssd"), outputs)) == 1
    outputs[0][0, 0, 0, 1] = 0
    assert found_in(head_params("ssd"), outputs) == []
    for image in (-1, 1, NAN):
        outputs = with_box("ssd", (10, 10, 50, 50))
        outputs[0][0, 0, 0, 0] = image
        assert found_in(head_params("ssd"), outputs) == []


# Where with_box() has the four numbers of the box: the output, and the place in it of number k.
BOX_PLACES = {
    "yolov3": (1, lambda k: (4, k)),
    "yolov5": (0, lambda k: (0, 7, k)),
    "yolov8": (0, lambda k: (0, k, 13)),
    "yolov10": (0, lambda k: (0, 0, k)),
    "yolox": (0, lambda k: (0, 7, k)),
    "ssd": (0, lambda k: (0, 0, 0, 3 + k)),
    "detr": (1, lambda k: (0, 1, k)),
    "rtdetr": (0, lambda k: (0, 1, k)),
}


@pytest.mark.parametrize("head", sorted(BOX_PLACES))
def test_box_with_a_number_that_is_not_finite_is_left_out(head):
    output, place = BOX_PLACES[head]
    for k in range(4):
        for damage in (NAN, INF, -INF):
            outputs = with_box(head, (10.0, 10.0, 50.0, 50.0))
            outputs[output][place(k)] = damage
            assert found_in(head_params(head), outputs) == []


def test_size_whose_exponential_is_not_finite_is_left_out():
    outputs = with_box("yolox", (10.0, 10.0, 50.0, 50.0))
    outputs[0][0, 7, 2] = 1000.0
    assert found_in(head_params("yolox"), outputs) == []


@pytest.mark.parametrize("damage", [NAN, INF])
def test_distance_of_bins_that_are_not_finite_is_left_out(damage):
    for side in range(4):
        outputs = with_box("nanodet", (10.0, 10.0, 50.0, 50.0))
        outputs[0][0, :, CLASSES + 8 * side + 3] = damage
        assert found_in(head_params("nanodet"), outputs) == []
