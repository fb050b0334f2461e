"""Conversion of the core's results to messages, without a node."""

import numpy as np
import pytest

from robot_vision.ros.messages import box_around, box_of

IMAGE = np.zeros((240, 320), np.uint8)


@pytest.mark.parametrize(
    "begin, end, box",
    [
        ((100, 90), (163, 169), (100, 90, 64, 80)),  # the middles of pixels
        ((99.5, 89.5), (163.5, 169.5), (100, 90, 64, 80)),  # the edges of the same
        ((99.6, 89.4), (163.4, 169.6), (100, 89, 64, 82)),
        ((10.3, 20.7), (10.3, 20.7), (10, 21, 1, 1)),
        ((10.5, 20.5), (10.5, 30.5), (11, 21, 1, 10)),  # a line between two columns
        ((-0.5, -0.5), (319.5, 239.5), (0, 0, 320, 240)),
        ((-7, -9), (400, 300), (0, 0, 320, 240)),
        ((-7, 50), (-3, 60), (0, 50, 0, 11)),
        ((-1, 236), (-0.5, 250), (0, 236, 0, 4)),
    ],
)
def test_a_box_has_the_pixels_that_an_outline_covers(begin, end, box):
    (left, top), (right, bottom) = begin, end
    outline = np.array([(left, bottom), (right, bottom), (right, top), (left, top)])
    assert box_of(box_around(outline, IMAGE)) == box
