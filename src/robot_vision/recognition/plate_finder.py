"""Finds the plate that an object is captured on in images."""

from typing import NamedTuple, Optional

import numpy as np

from .. import (
    CameraModel,
    DepthErrorParams,
    TagDetector,
    TagDetectorParams,
    TagPoseParams,
    to_gray,
)
from ..tags.tag_depth import TagDepth
from ..tags.tag_layout import TagLayout
from ..tags.tag_poses import TagLocator
from .capture_plate import Plate

MAX_SHIFT, MAX_TURN = 0.003, np.radians(0.6)  # standard deviations of a pose that is used
MIN_PROBABILITY = 0.99  # that a pose is the right one of two


class FoundPlate(NamedTuple):
    """A plate in an image.

    Attributes:
        pose: 4x4, of the plate's frame in the camera's optical frame, m; None: it was not found.
        problem: The reason then, else "".
    """

    pose: Optional[np.ndarray]
    problem: str = ""


class PlateFinder:
    """Finds a plate by its tags. For one thread.

    Args:
        plate: The plate.
    """

    def __init__(self, plate: Plate) -> None:
        params, tags = TagDetectorParams(), plate.tags
        params.families = [tags.family]
        self._detector = TagDetector(params)
        layout = TagLayout(tags.family, tags.bundle.tags[0].size, (), [tags.entry])
        self._locator = TagLocator(layout, TagPoseParams())
        self._plate = plate

    def find(self, bgr: np.ndarray, depth: np.ndarray, camera: CameraModel) -> FoundPlate:
        """Finds the plate.

        Args:
            bgr: (height, width, 3) uint8.
            depth: Depths of its pixels, uint16 in mm or float32 in m.
            camera: The camera.
        """
        gray = to_gray(bgr, "bgr8")
        tags = self._detector.detect(gray, "mono8")
        depths = TagDepth(depth, camera, DepthErrorParams())
        _, bundles = self._locator.locate_at_once(tags, camera, gray, depths)
        if not bundles:
            return FoundPlate(None, "no tag of the plate is seen")
        poses = bundles[0].poses
        deviations = np.sqrt(np.diag(poses.best.covariance))
        shift, turn = (float(np.linalg.norm(part)) for part in (deviations[:3], deviations[3:]))
        if poses.probability < MIN_PROBABILITY or shift > MAX_SHIFT or turn > MAX_TURN:
            return FoundPlate(None, "too few tags of the plate are seen, or too small ones")
        return FoundPlate(poses.best.pose @ self._plate.frame)
