"""Disparities, depth and points of pairs of images, without ROS.

>>> from robot_vision import stereo
>>> pair = stereo.calibrated_pair(left_camera, right_camera, rotation, translation)
>>> found = stereo.match(left, right, pair, method="sgbm", disparities=96)
>>> found.disparity, found.depth, found.points
"""

from dataclasses import dataclass
from typing import Any, Sequence

import numpy as np

from .. import (
    CameraModel,
    DepthPoints,
    RectifiedCamera,
    Rectifier,
    StereoCamera,
    StereoGeometry,
    StereoMatcher,
    StereoParams,
    depth_from_disparity,
    is_equidistant,
)
from ..common import opencv as cv2
from ..common.params import with_values

__all__ = ["Match", "calibrated_pair", "match", "match_rectified"]


@dataclass(frozen=True, eq=False)
class Match:
    """What is known of a pair of images.

    Attributes:
        image: The left image, rectified, (height, width, 3) uint8, BGR.
        disparity: (height, width) float32, px; NaN where none was found.
        geometry: What turns disparities into places.
    """

    image: np.ndarray
    disparity: np.ndarray
    geometry: StereoGeometry

    @property
    def depth(self) -> np.ndarray:
        """Distances along the optical axis, (height, width) float32, m; NaN where there is none."""
        return depth_from_disparity(self.disparity, self.geometry)

    @property
    def points(self) -> np.ndarray:
        """x, y, z in the rectified left optical frame, (height, width, 3) float32, m, or NaN."""
        (height, width), of = self.disparity.shape, self.geometry
        matrix = [[of.fx, 0.0, of.cx], [0.0, of.fy, of.cy], [0.0, 0.0, 1.0]]
        return DepthPoints(CameraModel(width, height, matrix)).points(self.depth)


def calibrated_pair(
    left: CameraModel, right: CameraModel, rotation: np.ndarray, translation: Sequence[float]
) -> StereoCamera:
    """Two cameras that were calibrated together, rectified by cv2.stereoRectify.

    The rectified images have no black border; those of equidistant lenses are rectified by
    cv2.fisheye.stereoRectify, which may leave some.

    Args:
        rotation: R of cv2.stereoCalibrate, 3x3, from the left to the right optical frame.
        translation: T of cv2.stereoCalibrate, m: its x is negative, about minus the baseline.

    Raises:
        ValueError: The cameras are no pair: of two kinds of lenses, of images of two sizes, or the
            right one is not to the right.
    """
    kinds = {is_equidistant(model.distortion_model) for model in (left, right)}
    if len(kinds) > 1:
        raise ValueError("one camera is equidistant, must be both or none")
    arguments = [
        *(part for model in (left, right) for part in (np.array(model.K), _coefficients(model))),
        (left.width, left.height),
        np.asarray(rotation, float).reshape(3, 3),
        np.asarray(translation, float).reshape(3, 1),
    ]
    if kinds == {True}:
        found = cv2.fisheye.stereoRectify(*arguments, flags=cv2.CALIB_ZERO_DISPARITY)
    else:
        found = cv2.stereoRectify(*arguments, flags=cv2.CALIB_ZERO_DISPARITY, alpha=0)
    turn_left, turn_right, projection_left, projection_right = found[:4]
    return StereoCamera(
        RectifiedCamera(left, turn_left, projection_left),
        RectifiedCamera(right, turn_right, projection_right),
    )


def match(
    left: np.ndarray, right: np.ndarray, pair: StereoCamera, encoding: str = "bgr8", **values: Any
) -> Match:
    """Rectifies and matches two images of a calibrated pair of cameras.

    `values` are StereoParams by their names: disparities=96. For a stream of images use Rectifier
    and StereoMatcher, which keep their maps and memory.

    Raises:
        ValueError: An image or a parameter cannot be used.
        AttributeError: There is no such parameter.
    """
    rectifiers = Rectifier(pair.left), Rectifier(pair.right)
    gray = [one.apply(image, encoding, "mono8") for one, image in zip(rectifiers, (left, right))]
    matcher = StereoMatcher(with_values(StereoParams(), values))
    disparity = matcher.match(*gray, "mono8", *(one.seen for one in rectifiers))
    return Match(rectifiers[0].apply(left, encoding), disparity, pair.geometry)


def match_rectified(
    left: np.ndarray, right: np.ndarray, encoding: str = "bgr8", **values: Any
) -> np.ndarray:
    """Disparities of images that are rectified already, (height, width) float32, px, or NaN.

    Raises as match() does.
    """
    return StereoMatcher(with_values(StereoParams(), values)).match(left, right, encoding)


def _coefficients(model: CameraModel) -> np.ndarray:
    return np.array(model.D or [0.0] * 5)
