"""Tables in the depths of an image, and which pixels are of what stands on them."""

from typing import Any, Optional, Tuple

import numpy as np

from .. import CameraModel, TabletopFinder
from ..common import opencv as cv2
from ..depth.table_messages import table_array
from ..depth.vertical_axis import VerticalAxis
from ..msg import TableArray
from ..ros.transport import Frame
from .recognition_settings import Settings

GROWTH = 7  # px, by which what stands on a table is widened: depths at its edge are missing


class TablesBelow:
    """Finds tables, as the node tabletop does. For one thread at a time."""

    def __init__(self) -> None:
        self._finder: Optional[TabletopFinder] = None
        self._made_of: Tuple[Any, ...] = ()
        self._vertical = VerticalAxis()

    def clear(self) -> None:
        """Ends listening where frames are."""
        self._vertical.forget()

    def find(
        self, depth: np.ndarray, camera: CameraModel, frame: Frame, settings: Settings
    ) -> Optional[Tuple[TableArray, np.ndarray]]:
        """Returns the tables, and a mask, (height, width) uint8, of what stands on them.

        It is None as long as the transform that says what is up may still come.

        Raises:
            FrameError: There is no transform from the vertical frame.
        """
        up = self._vertical.of(frame, settings.vertical_frame)
        if up is None:
            return None
        made_of = camera, settings.planes, settings.tables
        if made_of != self._made_of:
            self._finder, self._made_of = TabletopFinder(*made_of), made_of
        tables, labels = self._finder.find(depth, up)
        mask = cv2.dilate((labels > 0).astype(np.uint8), np.ones((GROWTH, GROWTH), np.uint8))
        return table_array(frame.header, tables), mask
