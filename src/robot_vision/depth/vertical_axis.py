"""What is up in an image, as a frame whose z axis is vertical says."""

from typing import Optional, Tuple

from ..common.plain_text import printable
from ..ros.frame_transforms import FrameTransforms
from ..ros.transport import Frame, FrameError

TRANSFORM_GRACE = 2.0  # s, for the first transforms to come
RENEWAL_PERIOD = 10.0  # s without a transform, until listening begins anew
UNKNOWN = (0.0, 0.0, 0.0)


class VerticalAxis:
    """Asks /tf and /tf_static what is up, from the first frame on until forget()."""

    def __init__(self) -> None:
        self._transforms = FrameTransforms()
        self._is_missing = False  # whether the last frame was refused

    def of(self, frame: Frame, vertical: str) -> Optional[Tuple[float, ...]]:
        """Returns the unit vector that points up in the optical frame of a frame's image.

        It is UNKNOWN if no frame is named, and None as long as the transform may still come.

        Raises:
            FrameError: There is no transform from the vertical frame.
        """
        if not vertical:
            self.forget()
            return UNKNOWN
        own = frame.header.frame_id
        axes = self._transforms.rotation(own, vertical)
        if axes is not None:
            self._is_missing = False
            return tuple(axes[:, 2].tolist())
        if not self._is_missing and self._transforms.age < TRANSFORM_GRACE:
            return None
        self._is_missing = True
        if self._transforms.age >= RENEWAL_PERIOD:
            # Of a bag that plays again tf2 leaves out what is older than what it knows.
            self._transforms.forget()
        raise FrameError(
            f"no transform from the vertical_frame '{vertical}' to its frame '{printable(own)}', "
            "expected on /tf_static or /tf"
        )

    def forget(self) -> None:
        """Ends listening."""
        self._transforms.forget()
        self._is_missing = False
