"""Tables in the depths of an image, and which pixels are of what stands on them."""

from typing import Any, Optional, Tuple

import numpy as np
import rospy

from .. import CameraModel, TabletopFinder
from ..common import opencv as cv2
from ..depth.table_messages import table_array
from ..msg import TableArray
from ..ros.frame_transforms import FrameTransforms
from ..ros.transport import Frame
from .recognition_settings import Settings

GROWTH = 7  # px, by which what stands on a table is widened: depths at its edge are missing
UNKNOWN = (0.0, 0.0, 0.0)  # what is up, if nothing says it


class TablesBelow:
    """Finds tables, as the node tabletop does. For one thread at a time."""

    def __init__(self) -> None:
        self._finder: Optional[TabletopFinder] = None
        self._made_of: Tuple[Any, ...] = ()
        self._transforms = FrameTransforms()

    def clear(self) -> None:
        """Ends to listen where frames are."""
        self._transforms.forget()

    def find(
        self, depth: np.ndarray, camera: CameraModel, frame: Frame, settings: Settings
    ) -> Tuple[TableArray, np.ndarray]:
        """Returns the tables, and a mask, (height, width) uint8, of what stands on them."""
        made_of = camera, settings.planes, settings.tables
        if made_of != self._made_of:
            self._finder, self._made_of = TabletopFinder(*made_of), made_of
        tables, labels = self._finder.find(depth, self._up(frame, settings.vertical_frame))
        mask = cv2.dilate((labels > 0).astype(np.uint8), np.ones((GROWTH, GROWTH), np.uint8))
        return table_array(frame.header, tables), mask

    def _up(self, frame: Frame, vertical: str) -> Tuple[float, ...]:
        if not vertical:
            return UNKNOWN
        axes = self._transforms.rotation(frame.header.frame_id, vertical)
        if axes is None:
            rospy.logwarn_throttle(
                10.0, f"the largest plane is the table: nothing is known of {vertical} on /tf"
            )
            return UNKNOWN
        return tuple(axes[:, 2].tolist())
