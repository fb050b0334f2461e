"""The self-check of a depth camera: its depths beside what the corners of tags say."""

import collections
from typing import Deque, Dict, Iterable, Optional, Tuple

import numpy as np

from .. import (
    CameraModel,
    DepthErrorParams,
    DepthPlane,
    MeasuredCorners,
    PoseEstimate,
    TagPoseParams,
    estimate_pose,
    single_tag,
)
from .depth_errors import DepthErrorEstimate
from .tag_layout import TagKey
from .tag_poses import MAX_TRACKED, LocatedTag, key_of

MIN_MOTION = 3.0  # px of a corner; a tag at rest has the same errors in each frame
PLANES = 50  # the newest ones, of which those that do not fit the corners are counted
MIN_PLANES = 20  # of these, from which on their number says something


class DepthCheck:
    """Compares a sensor's depths of tags with those that their corners say.

    The corners of a tag of known size tell its distance without the sensor. A tag counts again
    when it has moved in the image. For one thread at a time.

    Attributes:
        estimate: What the comparisons say of the sensor's scale and bias.
    """

    def __init__(self) -> None:
        self.estimate = DepthErrorEstimate()
        self._camera: Optional[CameraModel] = None
        self._depth_noise: Optional[DepthErrorParams] = None
        self._last: Dict[TagKey, np.ndarray] = {}  # corners when a tag was compared
        self._used: Deque[bool] = collections.deque(maxlen=PLANES)

    def add(
        self,
        tags: Iterable[LocatedTag],
        camera: CameraModel,
        noise: TagPoseParams,
        depth_noise: DepthErrorParams,
    ) -> int:
        """Adds the tags of a frame, those that a depth image has shown.

        Args:
            tags: The tags, as a TagLocator has located them.
            camera: Their camera; with another object all is forgotten.
            noise: That of their corners.
            depth_noise: That of their depths; with other values all is forgotten.

        Returns:
            How many tags a depth image has shown.
        """
        if camera is not self._camera or depth_noise != self._depth_noise:
            self.clear()
            self._camera, self._depth_noise = camera, depth_noise
        shown = 0
        for tag in tags:
            corners = tag.corners
            if tag.poses is None or not isinstance(corners, MeasuredCorners):
                continue
            if corners.plane is None:
                continue
            shown += 1
            self._used.append(tag.poses.planes > 0)
            if tag.unique and self._has_moved(key_of(tag.tag), corners.corners):
                self._compare(tag, corners, camera, noise, depth_noise)
        return shown

    def left_out(self) -> Tuple[int, int]:
        """Returns how many of the newest planes do not fit the corners, and how many there are."""
        return len(self._used) - sum(self._used), len(self._used)

    def rejects(self) -> bool:
        """Returns whether so many planes do not fit the corners that it is no accident."""
        wrong, all_of_them = self.left_out()
        return all_of_them >= MIN_PLANES and 2 * wrong > all_of_them

    def clear(self) -> None:
        """Forgets everything."""
        self.estimate.clear()
        self._last.clear()
        self._used.clear()
        self._camera = self._depth_noise = None

    def _has_moved(self, key: TagKey, corners: np.ndarray) -> bool:
        last = self._last.get(key)
        if last is not None and np.abs(corners - last).max() < MIN_MOTION:
            return False
        self._last.pop(key, None)
        self._last[key] = corners
        if len(self._last) > MAX_TRACKED:
            del self._last[next(iter(self._last))]
        return True

    def _compare(
        self,
        tag: LocatedTag,
        corners: MeasuredCorners,
        camera: CameraModel,
        noise: TagPoseParams,
        depth_noise: DepthErrorParams,
    ) -> None:
        alone = MeasuredCorners(corners.corners, corners.covariance)
        body, seen = single_tag(tag.tag.id, tag.size), {tag.tag.id: alone}
        poses = estimate_pose(body, seen, camera, noise.corner_noise, noise.lasting_noise)
        if poses is None:
            return
        measured = depth_at(poses.best, corners.plane, depth_noise.depth_bias)
        if measured is None:
            return
        depth, variance = measured
        deviation = np.sqrt(variance + poses.best.covariance[2, 2])
        self.estimate.add(float(poses.best.pose[2, 3]), depth, float(deviation))


def depth_at(
    estimate: PoseEstimate, plane: DepthPlane, bias: float
) -> Optional[Tuple[float, float]]:
    """Returns the depth of a plane in the middle of a tag, and its variance without that of a bias.

    Args:
        estimate: The tag's pose.
        plane: The plane that a depth image shows.
        bias: The standard deviation of what all its depths have in common, in m, which is a part of
            the plane's covariance.

    Returns:
        m and m^2, or None if the plane is not in front of the camera there.
    """
    ray = estimate.pose[:3, 3] / estimate.pose[2, 3]
    inverse = float(plane.inverse_depth @ ray)
    if not inverse > 0.0:
        return None
    depth = 1.0 / inverse
    variance = float(ray @ plane.covariance @ ray) * depth**4
    # A plane is fitted, so the bias of the middle is not exactly the common one.
    return depth, max(variance - bias**2, 0.01 * variance)
