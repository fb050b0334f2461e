"""Tracked objects as detections, without a node."""

import cv2
import numpy as np
import pytest
import skimage.data

import robot_vision as rv
from robot_vision.ros.messages import box_of
from robot_vision.tracking.tracks import detection_of

PHOTO = cv2.resize(cv2.cvtColor(skimage.data.coffee(), cv2.COLOR_RGB2BGR), (320, 240))
TRIANGLE = np.array([(100, 100), (200, 100), (100, 175)])


def selected(tracker, image, box):
    tracker.update(0.0, image)
    tracker.select(box)
    return tracker.objects()[0]


def test_the_box_of_what_was_selected_is_what_was_selected():
    box = (100, 90, 64, 80)
    found = detection_of(selected(rv.ObjectTracker(), PHOTO, box), PHOTO)
    assert box_of(found.box) == box and found.area == pytest.approx(64 * 80)


@pytest.mark.parametrize("method", ["camshift", "meanshift"])
def test_the_circle_is_the_smallest_around_the_outline(method):
    image = np.full((240, 320, 3), 100, np.uint8)
    cv2.fillPoly(image, [TRIANGLE], (200, 60, 20))
    params = rv.WindowTrackerParams()
    params.method = method
    found = detection_of(
        selected(rv.WindowTracker(params), image, cv2.boundingRect(TRIANGLE)), image
    )
    corners = np.array([(point.x, point.y) for point in found.outline])
    middle = found.circle_center.x, found.circle_center.y
    assert np.hypot(*(corners - middle).T) == pytest.approx(np.full(4, found.circle_radius))
    assert np.hypot(*(np.mean(corners, axis=0) - (found.center.x, found.center.y))) > 0.5
