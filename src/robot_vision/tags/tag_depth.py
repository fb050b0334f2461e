"""The planes of tags in a depth image."""

from typing import NamedTuple, Optional

import numpy as np

from .. import CameraModel, DepthErrorParams, DepthPlane, measure_tag_plane


class TagDepth(NamedTuple):
    """A registered depth image of the time of an image.

    Attributes:
        image: (height, width) uint16 in mm, 0 where there is none, or float32 in m, NaN there.
        camera: The camera of its pixels; its optical frame is that of the image's camera, its size
            and lens may be others.
        params: How wrong its depths are.
    """

    image: np.ndarray
    camera: CameraModel
    params: DepthErrorParams

    def plane_of(self, corners: np.ndarray, camera: CameraModel) -> Optional[DepthPlane]:
        """Returns the plane of a tag whose corners, (4, 2) px, a camera has seen, or None."""
        if camera is not self.camera:
            rays = camera.rays(corners)
            corners, _ = self.camera.project(np.column_stack([rays, np.ones(4)]))
        if not np.isfinite(corners).all():  # One of the cameras has no rays there.
            return None
        return measure_tag_plane(self.image, corners, self.camera, self.params)
