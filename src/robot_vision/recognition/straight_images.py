"""Images of a camera, and their depths, as the same camera would make them without distortion."""

from typing import Any, Optional, Tuple

import numpy as np

from .. import CameraModel, DepthRegistration, RectifiedCamera, Rectifier, is_distorted

NOWHERE = np.eye(4)  # the camera stays where it is


class StraightImages:
    """Makes the images of one camera straight, and gives them the depths of each of their pixels.

    Args:
        camera: The camera of the images.
        depth_camera: That of the depths; None: it is that of the images.
    """

    def __init__(self, camera: CameraModel, depth_camera: Optional[CameraModel]) -> None:
        self.made_of = camera, depth_camera
        self.camera = CameraModel(camera.width, camera.height, camera.K)
        bent = is_distorted(camera)
        self._rectifier: Optional[Rectifier] = None
        if bent:
            matrix = np.column_stack([camera.K, np.zeros(3)])
            self._rectifier = Rectifier(RectifiedCamera(camera, np.eye(3), matrix))
        own = depth_camera or camera
        self._registration: Optional[DepthRegistration] = None
        if bent or is_distorted(own) or not _same(own, camera):
            self._registration = DepthRegistration(own, self.camera, NOWHERE)

    def apply(
        self, bgr: np.ndarray, depth: Optional[np.ndarray]
    ) -> Tuple[np.ndarray, Optional[np.ndarray]]:
        """Returns an image, (height, width, 3) uint8, and its depths; the depths may be None."""
        if self._rectifier is not None:
            bgr = self._rectifier.apply(bgr)
        if self._registration is not None and depth is not None:
            depth = self._registration.apply(depth)
        return bgr, depth


def _same(one: Any, other: Any) -> bool:
    sizes = (one.width, one.height) == (other.width, other.height)
    return sizes and np.array_equal(one.K, other.K)
