"""Boxes of every family of networks, against a plain decoding in NumPy and boxes that are known."""

import numpy as np
import pytest
from head_outputs import (
    CLASSES,
    HEADS,
    HEIGHT,
    SIZE,
    WIDTH,
    decoded,
    found_in,
    head_params,
    random_outputs,
)
from single_boxes import with_box

import robot_vision as rv

NAN, INF = float("nan"), float("inf")


def assert_same(found, expected):
    assert [one.class_id for one in found] == [one[0] for one in expected]
    np.testing.assert_allclose(
        [one.score for one in found], [one[1] for one in expected], rtol=1e-5
    )
    clipped = [np.clip(one[2], 0, [WIDTH, HEIGHT, WIDTH, HEIGHT]) for one in expected]
    np.testing.assert_allclose([one.box for one in found], clipped, rtol=1e-5, atol=1e-3)


VARIANTS = [
    {},
    {"class_agnostic": True},
    {"iou_threshold": 0.1, "score_threshold": 0.05},
    {"iou_threshold": 1.0, "max_detections": 10000},
    {"max_detections": 3},
    {"class_thresholds": [0.9, 0.1, 0.5, 0.2, 1.0]},
]


@pytest.mark.parametrize("values", VARIANTS, ids=str)
@pytest.mark.parametrize("head", HEADS)
def test_boxes_are_those_that_numpy_decodes(head, values):
    for seed in range(4):
        params = head_params(head, **values)
        outputs = random_outputs(head, seed)
        before = [output.copy() for output in outputs]
        expected = decoded(params, outputs)
        assert len(expected) >= 1
        assert_same(found_in(params, outputs), expected)
        for output, old in zip(outputs, before):
            np.testing.assert_array_equal(output, old)


@pytest.mark.parametrize("boxes", [1, 2, 15, 16, 17, 33, 2047, 2048, 2049])
def test_any_number_of_boxes_is_scanned(boxes):
    params = head_params("yolov8", max_detections=10000, score_threshold=0.9)
    outputs = random_outputs("yolov8", boxes, boxes)
    assert_same(found_in(params, outputs), decoded(params, outputs))


@pytest.mark.parametrize("head", HEADS)
def test_one_box_is_where_it_is_in_the_image(head):
    box = (70.0, 31.0, 103.0, 57.0)  # px of the input
    placement = rv.InputPlacement(0.5, 0.25, 20.0, 6.0, 11, 7)
    (found,) = found_in(head_params(head), with_box(head, box), placement, (640, 480))
    # (70 - 20) / 0.5 + 11, (31 - 6) / 0.25 + 7, ...
    np.testing.assert_allclose(found.box, (111, 107, 177, 211), atol=1e-3)
    assert (found.class_id, found.score) == (2, pytest.approx(0.75, rel=1e-5))
    assert found.center == pytest.approx((144, 159), abs=1e-3)
    assert found.outline.shape == (0, 2) and found.keypoints.shape == (0, 3)
    assert found.mask.shape == (0, 0)


def test_boxes_of_the_inputs_placement_are_those_of_the_image():
    image = np.zeros((301, 503, 3), np.uint8)
    wanted = rv.InputParams()
    wanted.width, wanted.height = SIZE
    out = np.empty((1, 3, HEIGHT, WIDTH), np.float32)
    for fit in ("letterbox", "stretch", "corner"):
        wanted.fit = fit
        placement = rv.fill_input(image, (50, 40, 430, 200), wanted, out)
        truth = np.array([120.5, 60.25, 333.0, 210.0])
        x, y = truth[[0, 2]], truth[[1, 3]]
        x = (x - 50) * placement.scale_x + placement.left
        y = (y - 40) * placement.scale_y + placement.top
        outputs = with_box("yolov8", (x[0], y[0], x[1], y[1]))
        (found,) = found_in(head_params("yolov8"), outputs, placement, (503, 301))
        np.testing.assert_allclose(found.box, truth, atol=1e-3)


@pytest.mark.parametrize("head", [head for head in HEADS if head != "nanodet"])  # its are inside
def test_box_is_cut_off_at_the_border_and_left_out_beyond_it(head):
    (found,) = found_in(head_params(head), with_box(head, (-20.0, -9.0, 30.0, 200.0)))
    np.testing.assert_allclose(found.box, (0, 0, 30, HEIGHT), atol=1e-3)
    assert found_in(head_params(head), with_box(head, (-50.0, 10.0, -1.0, 50.0))) == []
    tiny = found_in(head_params(head), with_box(head, (3.0, 3.0, 90.0, 90.0)), size=(1, 1))
    assert tiny == []
    (tiny,) = found_in(head_params(head), with_box(head, (-3.0, -3.0, 90.0, 90.0)), size=(1, 1))
    assert tiny.box == (0, 0, 1, 1) and tiny.box_pixels == (0, 0, 1, 1)


def test_of_equal_scores_the_first_class_and_the_first_box_count():
    outputs = [np.zeros((1, 4 + CLASSES, 40), np.float32)]
    for i in range(40):
        outputs[0][0, :4, i] = 10 + i, 40, 30, 30
    outputs[0][0, 5:8] = 0.5
    found = found_in(head_params("yolov8"), outputs)
    assert [one.class_id for one in found] == [1, 1, 1, 1]
    # Moved by 12 of their 30 px, they overlap by less than 0.45; the border cuts the first off.
    np.testing.assert_allclose([one.center[0] for one in found], [12.5, 22, 34, 46], atol=1e-3)
    rows = np.concatenate([np.zeros((1, 40, 5)), np.zeros((1, 40, CLASSES))], axis=2)
    rows[0, :, :4], rows[0, :, 4], rows[0, :, 6:8] = outputs[0][0, :4].T, 1, 0.5
    found = found_in(head_params("yolov5"), [rows.astype(np.float32)])
    assert [one.class_id for one in found] == [1, 1, 1, 1]


def test_score_at_the_threshold_is_enough_and_at_the_iou_it_is_kept():
    outputs = with_box("yolov8", (10, 10, 50, 50), np.float32(0.7))
    assert len(found_in(head_params("yolov8", score_threshold=0.7), outputs)) == 1
    above = float(np.nextafter(np.float32(0.7), np.float32(1)))
    assert found_in(head_params("yolov8", score_threshold=above), outputs) == []
    outputs[0][0, :, 1] = outputs[0][0, :, 13]
    outputs[0][0, :4, 1] = 30, 20, 40, 20  # half of the other: an IoU of 0.5
    assert len(found_in(head_params("yolov8", iou_threshold=0.5), outputs)) == 2
    assert len(found_in(head_params("yolov8", iou_threshold=0.49), outputs)) == 1


def test_arrays_of_other_types_and_with_gaps_are_read_as_they_are():
    (columns,) = random_outputs("yolov8", 2)
    params = head_params("yolov8")
    expected = [one.box for one in found_in(params, [columns])]
    wide = np.zeros((1, 9, 2 * columns.shape[2]), np.float32)
    wide[..., ::2] = columns
    for output in (
        columns.astype(np.float64),
        np.asfortranarray(columns),
        wide[..., ::2],
        columns[0],
    ):
        assert [one.box for one in found_in(params, [output])] == expected


def test_separate_boxes_labels_and_scores_of_an_ssd():
    boxes = np.array([[[0.1, 0.2, 0.5, 0.6], [0.3, 0.3, 0.4, 0.9], [0, 0, 1, 1]]], np.float32)
    labels, scores = np.array([[3, 0, 5]]), np.array([[0.4, 0.99, 0.8]], np.float32)
    found = found_in(head_params("ssd"), [boxes, labels, scores])
    assert [(one.class_id, round(one.score, 3)) for one in found] == [(4, 0.8), (2, 0.4)]
    np.testing.assert_allclose(found[1].box, (16, 19.2, 80, 57.6), rtol=1e-6)
    found = found_in(head_params("ssd", background=False), [boxes, labels, scores])
    assert [one.class_id for one in found] == [0, 3]  # there is no class 5


def test_logits_and_boxes_of_an_rtdetr():
    logits = np.array([[[-3, 2, NAN, 2, INF], [0, -1, -2, -3, -9]]], np.float32)
    boxes = np.array([[[0.5, 0.5, 0.25, 0.5], [0.25, 0.25, 0.5, 0.5]]], np.float32)
    found = found_in(head_params("rtdetr"), [logits, boxes])
    assert [one.class_id for one in found] == [1, 0]
    np.testing.assert_allclose([one.score for one in found], [1 / (1 + np.exp(-2)), 0.5], rtol=1e-6)
    np.testing.assert_allclose(found[0].box, (60, 24, 100, 72))


def test_strides_of_other_grids_are_taken_in_their_order():
    # Of two grids, 16 then 8: the second row of the first grid begins behind its 10 columns.
    rows = np.zeros((1, 60 + 240, 5 + CLASSES), np.float32)
    rows[0, 10, :6] = 0.5, 0.25, 0, np.log(2), 1, 0.9
    rows[0, 60 + 239, :6] = 0, 0, 0, 0, 1, 0.8
    found = found_in(head_params("yolox", strides=[16, 8]), [rows])
    # Centres at (0.5, 1.25) * 16 and (19, 11) * 8, sizes of 16x32 and 8x8 px.
    np.testing.assert_allclose([one.box for one in found], [(0, 4, 16, 36), (148, 84, 156, 92)])
