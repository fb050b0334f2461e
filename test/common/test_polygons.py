"""Polygons, beside OpenCV's functions."""

import cv2
import numpy as np
import pytest

from robot_vision.common.polygons import area_of, is_inside

SQUARE = np.array([(2, 1), (6, 1), (6, 5), (2, 5)])
ARROW = np.array([(0, 0), (8, 4), (0, 8), (3, 4)])  # not convex
POLYGONS = {"square": SQUARE, "turned": SQUARE[::-1], "arrow": ARROW, "slim": ARROW * (1.0, 0.25)}


@pytest.mark.parametrize("polygon", POLYGONS.values(), ids=list(POLYGONS))
def test_points_are_inside_as_opencv_says(polygon):
    for x in np.arange(-1.0, 9.5, 0.5):
        for y in np.arange(-1.0, 9.5, 0.5):
            expected = cv2.pointPolygonTest(polygon.astype(np.float32), (x, y), False) >= 0.0
            assert is_inside(polygon, (x, y)) == expected, (x, y)


@pytest.mark.parametrize("polygon", POLYGONS.values(), ids=list(POLYGONS))
def test_areas_are_opencv_s(polygon):
    assert area_of(polygon) == pytest.approx(cv2.contourArea(polygon.astype(np.float32)))


def test_nothing_has_no_area_and_no_inside():
    assert area_of(np.zeros((0, 2))) == 0.0
    assert not is_inside(np.zeros((0, 2)), (0.0, 0.0))
