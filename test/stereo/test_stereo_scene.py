"""Depth by the pair of cameras of the synthetic scene, against the exact depth of each pixel."""

import cv2
import numpy as np
import pytest

import robot_vision as rv
from robot_vision import stereo

FRAME = 240  # in which everything can be seen
SCENE = rv.Scene()


def pair():
    """The cameras of the scene, which look in parallel."""
    matrix = np.array(SCENE.camera.K)
    left = np.hstack([matrix, np.zeros((3, 1))])
    right = left.copy()
    right[0, 3] = -matrix[0, 0] * SCENE.view_pose("right")[0, 3]
    return rv.StereoCamera(
        rv.RectifiedCamera(SCENE.camera, np.eye(3), left),
        rv.RectifiedCamera(SCENE.view_camera("right"), np.eye(3), right),
    )


def true_depth():
    """z of the pixels of the rectified left image, m."""
    camera = SCENE.camera
    matrix, size = np.array(camera.K), (camera.width, camera.height)
    maps = cv2.initUndistortRectifyMap(
        matrix, np.array(camera.D), np.eye(3), matrix, size, cv2.CV_32FC1
    )
    return cv2.remap(SCENE.render_depth(FRAME, "color"), *maps, cv2.INTER_NEAREST)


@pytest.mark.parametrize("method, share", [("bm", 0.5), ("sgbm_3way", 0.88), ("sgbm", 0.88)])
def test_depth_of_the_scene_is_right(method, share):
    images = SCENE.render(FRAME), SCENE.render(FRAME, "right")
    found, truth = stereo.match(*images, pair(), method=method), true_depth()
    known = np.isfinite(found.depth) & np.isfinite(truth)
    assert known.mean() > share
    relative = (np.abs(found.depth - truth) / truth)[known]
    assert np.median(relative) < 0.015 and (relative < 0.05).mean() > 0.9
    of = found.geometry
    off = np.abs(found.disparity - of.fx * of.baseline / truth)[known]
    assert np.median(off) < 0.3 and (off < 1.0).mean() > 0.88
    assert np.array_equal(found.points[:, :, 2][known], found.depth[known])
