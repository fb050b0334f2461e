"""Masks of objects that networks give, against plain NumPy."""

import numpy as np
import pytest
from head_outputs import CLASSES, HEIGHT, WIDTH, head_params, random_outputs, with_extras

import robot_vision as rv

NAN = float("nan")
PROTOTYPES = 6
PLACEMENTS = [
    (rv.InputPlacement(), (WIDTH, HEIGHT)),
    (rv.InputPlacement(0.25, 0.25, 0.0, 10.0), (640, 300)),
    (rv.InputPlacement(2.0, 1.5, 3.0, 0.0, 5, 9), (70, 61)),
]


def at_pixels(values, start, scale, offset, count, size):
    """The matrix that interpolates an axis linearly at the centres of `count` pixels."""
    at = (np.arange(start, start + count) + 0.5) * scale + offset
    at = np.clip(at * values / size - 0.5, 0, values - 1)
    first = np.minimum(at.astype(int), values - 1)
    second = np.minimum(first + 1, values - 1)
    weights = np.zeros((count, values))
    weights[np.arange(count), first] += 1 - (at - first)
    weights[np.arange(count), second] += at - first
    return weights


def logits_of(found, coefficients, prototypes, placement):
    """What is above 0 on an object, at each pixel of its box."""
    x, y, width, height = found.box_pixels
    columns = at_pixels(
        prototypes.shape[2],
        x,
        placement.scale_x,
        placement.left - placement.scale_x * placement.x,
        width,
        WIDTH,
    )
    rows = at_pixels(
        prototypes.shape[1],
        y,
        placement.scale_y,
        placement.top - placement.scale_y * placement.y,
        height,
        HEIGHT,
    )
    return rows @ np.tensordot(coefficients, prototypes, 1) @ columns.T


def inside(found):
    """Where the centres of the pixels of a box are inside of it."""
    x, y, width, height = found.box_pixels
    x0, y0, x1, y1 = found.box
    xs, ys = x + np.arange(width) + 0.5, y + np.arange(height) + 0.5
    return ((ys >= y0) & (ys < y1))[:, None] & ((xs >= x0) & (xs < x1))[None]


@pytest.mark.parametrize("size", [(24, 40), (7, 9), (1, 1), (1, 5)])
@pytest.mark.parametrize("place", range(len(PLACEMENTS)))
@pytest.mark.parametrize("head", ["yolov5", "yolov8"])
def test_mask_is_the_sum_of_prototypes_above_zero_in_the_box(head, place, size):
    placement, image_size = PLACEMENTS[place]
    rng = np.random.default_rng(place)
    extras = rng.normal(0, 1, (77, PROTOTYPES)).astype(np.float32)
    prototypes = rng.normal(0, 1, (PROTOTYPES, *size)).astype(np.float32)
    output = with_extras(head, extras)
    params = head_params(head, task="segment")
    objects = rv.HeadDecoder(params).decode([output, prototypes[None]], placement, image_size)
    boxes_only = head_params(head)
    plain = rv.HeadDecoder(boxes_only).decode(random_outputs(head, 0), placement, image_size)
    assert [one.box for one in objects] == [one.box for one in plain]
    assert len(objects) >= 3
    (first,) = random_outputs(head, 0)
    scores = (
        first[0, 4:].max(axis=0) if head == "yolov8" else first[0, :, 4] * first[0, :, 5:].max(1)
    )
    for one in objects:
        index = int(np.argmin(np.abs(scores - one.score)))
        logits = logits_of(one, extras[index].astype(float), prototypes.astype(float), placement)
        expected = (logits > 0) & inside(one)
        sure = np.abs(logits) > 1e-4
        assert one.mask.dtype == np.uint8 and one.mask.shape == expected.shape
        np.testing.assert_array_equal(one.mask[sure], np.where(expected, 255, 0)[sure])


def test_mask_of_a_disk_is_a_disk_in_the_image():
    prototypes = np.zeros((1, 2, HEIGHT // 4, WIDTH // 4), np.float32)
    ys, xs = np.mgrid[: HEIGHT // 4, : WIDTH // 4] + 0.5
    prototypes[0, 0] = 10.0 - np.hypot(4 * xs - 80, 4 * ys - 48)  # px of the input
    columns = np.zeros((1, 4 + CLASSES + 2, 3), np.float32)
    columns[0, :, 1] = [80, 48, 40, 40, 0, 0.9, 0, 0, 0, 2.0, 0.0]
    placement = rv.InputPlacement(0.5, 0.5, 10.0, 0.0)
    params = head_params("yolov8", task="segment")
    (found,) = rv.HeadDecoder(params).decode([columns, prototypes], placement, (320, 192))
    assert found.box_pixels == (100, 56, 80, 80)
    ys, xs = np.mgrid[56:136, 100:180] + 0.5
    distance = np.hypot(xs - 140, ys - 96) - 20.0  # from a radius of 20 px of the image
    assert (found.mask[distance < -1] == 255).all() and (found.mask[distance > 1] == 0).all()


def test_mask_of_numbers_that_are_not_finite_is_empty_there():
    extras = np.ones((77, 2))
    extras[:, 1] = NAN
    output = with_extras("yolov8", extras)
    params = head_params("yolov8", task="segment")
    decoder = rv.HeadDecoder(params)
    for one in decoder.decode([output, np.ones((1, 2, 8, 8), np.float32)], *PLACEMENTS[0]):
        assert one.mask.size > 0 and not one.mask.any()


@pytest.mark.parametrize(
    "shape, words",
    [
        ((1, 6, 0, 8), "at least 1x1"),
        ((1, 5, 8, 8), r"output 0 is of shape \(1, 15, 77\), must be of \(1, 14, n\)"),
        ((6, 8), r"output 1 is of shape \(6, 8\), must be of \(1, n, n, n\)"),
    ],
)
def test_prototypes_of_another_shape_are_refused(shape, words):
    output = with_extras("yolov8", np.zeros((77, PROTOTYPES)))
    decoder = rv.HeadDecoder(head_params("yolov8", task="segment"))
    with pytest.raises(ValueError, match=words):
        decoder.decode([output, np.zeros(shape, np.float32)], *PLACEMENTS[0])
    with pytest.raises(ValueError, match="yolov8 has 1 outputs, must have 2"):
        decoder.decode([output], *PLACEMENTS[0])
