"""The segments of label images, and how they are painted."""

import numpy as np
import pytest

import robot_vision as rv


def example():
    """Two pieces of segment 3, one segment 7 in a hole, and nothing else."""
    labels = np.zeros((40, 60), np.uint16)
    labels[5:25, 10:40] = 3
    labels[10:15, 20:30] = 0
    labels[12:14, 22:26] = 7
    labels[30:33, 50:60] = 3
    return labels


def test_segments_are_measured():
    labels = example()
    found = rv.find_segments(labels)
    assert [one.label for one in found] == [3, 7]
    large, small = (one.region for one in found)
    y, x = np.nonzero(labels == 3)
    assert large.area == 20 * 30 - 5 * 10 + 30 == len(x)
    assert large.center == pytest.approx((x.mean(), y.mean()))
    assert large.box == (10, 5, 50, 28)
    corners = [[10, 5], [10, 24], [39, 24], [39, 5]]
    assert large.outline.tolist() == corners  # of the larger piece
    assert large.circle_center == pytest.approx((24.5, 14.5), abs=0.01)
    assert (small.area, small.box, small.center) == (8, (22, 12, 4, 2), (23.5, 12.5))
    assert rv.find_segments(np.zeros((4, 5), np.uint16)) == []


def test_another_kind_of_image_has_no_segments():
    with pytest.raises(ValueError, match="label image"):
        rv.find_segments(np.zeros((4, 5), np.uint8))
    with pytest.raises(ValueError, match=r"^a label image of 5x0 is empty"):
        rv.find_segments(np.zeros((0, 5), np.uint16))


def painted(image, labels, **values):
    params = rv.SegmentPaintParams()
    for name, value in values.items():
        setattr(params, name, value)
    return rv.paint_segments(image, labels, params)


def test_segments_are_painted_over_the_image():
    labels = example()
    image = np.random.default_rng(0).integers(0, 256, (40, 60, 3)).astype(np.uint8)
    border = np.zeros(labels.shape, bool)
    border[:, :-1] |= labels[:, :-1] != labels[:, 1:]
    border[:-1] |= labels[:-1] != labels[1:]
    inside = {label: (labels == label) & ~border for label in (0, 3, 7)}
    full = painted(image, labels, opacity=1.0)
    assert (full[border] == 255).all()
    assert np.array_equal(full[inside[0]], image[inside[0]])
    colors = [np.unique(full[inside[label]], axis=0) for label in (3, 7)]
    assert [len(one) for one in colors] == [1, 1]
    assert np.abs(colors[0].astype(int) - colors[1]).max() > 80  # they can be told apart
    half = painted(image, labels, opacity=0.5)[inside[3]].astype(float)
    assert np.abs(half - (image[inside[3]] + colors[0].astype(float)) / 2).max() <= 1.0
    clear = painted(image, labels, opacity=0.0)
    assert np.array_equal(clear[~border], image[~border])
    mean = painted(image, labels, opacity=1.0, paint="mean", outlines=False)
    for label in (3, 7):
        expected = image[labels == label].mean(axis=0)
        assert np.abs(mean[labels == label] - expected).max() <= 1.0
    assert np.array_equal(mean[labels == 0], image[labels == 0])


@pytest.mark.parametrize(
    "image, labels, values, text",
    [
        ((4, 5, 3), (4, 6), {}, "the labels' size is 6x4, must be the image's, 5x4"),
        ((4, 5), (4, 5), {}, "bgr8"),
        ((4, 5, 3), (4, 5), {"opacity": 2.0}, "opacity is 2, must be from 0 to 1"),
        ((4, 5, 3), (4, 5), {"paint": "red"}, "paint is red, must be distinct or mean"),
    ],
)
def test_what_does_not_fit_is_refused(image, labels, values, text):
    with pytest.raises(ValueError, match=text):
        painted(np.zeros(image, np.uint8), np.zeros(labels, np.uint16), **values)
