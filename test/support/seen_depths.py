"""The depth that the scene's color camera sees, and where its depth camera sees the same."""

from typing import Tuple

import numpy as np

import robot_vision as rv
from robot_vision import depth

SAME = 0.03  # of the depth, by which two pixels of a surface may differ


def scene_of(size: Tuple[int, int]) -> rv.Scene:
    """The scene, with color images of this width and height."""
    params = rv.SceneParams()
    params.width, params.height = size
    return rv.Scene(params)


def seen_by_both(scene: rv.Scene, frame: int, around: int = 0) -> Tuple[np.ndarray, np.ndarray]:
    """The exact depth of the color camera, and which of its pixels show what the depth camera sees.

    Args:
        around: So many pixels of the depth image in each direction have to be of the surface, too.
    """
    camera, pose = scene.view_camera("depth"), scene.view_pose("depth")
    truth, exact = scene.render_depth(frame, "color"), scene.render_depth(frame)
    places = depth.points(truth, scene.view_camera("color")).reshape(-1, 3)
    places = np.nan_to_num((places - pose[:3, 3]) @ pose[:3, :3], nan=-1.0)
    pixels = np.nan_to_num(camera.project(places)[0], nan=-1.0)
    low, high = around, np.array([camera.width - 1 - around, camera.height - 1 - around])
    visible = ((pixels >= low) & (pixels <= high)).all(axis=1)
    left, top = np.rint(pixels).astype(int).T
    for x in range(-around, around + 1):
        for y in range(-around, around + 1):
            near = exact[np.where(visible, top + y, 0), np.where(visible, left + x, 0)]
            visible &= np.abs(np.nan_to_num(near) - places[:, 2]) < SAME * places[:, 2]
    return truth, visible.reshape(truth.shape)
