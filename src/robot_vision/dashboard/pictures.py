"""Images on their way from ROS to those who look at them, and how they want to see them."""

import math
import threading
from dataclasses import dataclass
from typing import NamedTuple, Optional, Tuple

from .. import DisplayEncoder, DisplayParams
from ..ros.transport import Frame
from .channels import JPEG, PNG

SIZES = (160, 240, 320, 480, 640, 960, 1280, 1920, 2560, 3840)  # px, widths
MAX_ENLARGED = 4 << 20  # px of an image that is made larger than it came
FORMATS = {JPEG: "jpeg", PNG: "png"}


@dataclass(frozen=True, eq=False)
class Picture:
    """An image as it came.

    Attributes:
        stamp: Its time in s of ROS' clock.
        received: When it had come, in s of the wall clock.
        width: px.
        height: px.
        frame: Its pixels, or None if it came compressed.
        kind: What it came as, JPEG or PNG, if it came compressed.
        data: Its bytes, if it came compressed.
    """

    stamp: float
    received: float
    width: int
    height: int
    frame: Optional[Frame] = None
    kind: int = 0
    data: bytes = b""


class Display(NamedTuple):
    """How a picture is encoded; who wants the same shares one encoding. No size: as it came."""

    kind: int
    width: int = 0
    height: int = 0
    quality: int = 0
    turned: bool = False


class Wish(NamedTuple):
    """How somebody wants to see the pictures of a topic.

    Attributes:
        needed: The width that is needed, in px; it is rounded up to one of SIZES, so that views of
            nearly the same size share an encoding, and no image is made larger. 0: as it is.
        width: The width in px, 0: by the height, or as it is. Both together are made smaller where
            the image would have more than MAX_ENLARGED px and more than it came with.
        height: The height in px, 0: by the width, or as it is.
        quality: Of JPEG, 1 to 100.
        kind: JPEG or PNG.
        turned: By half a turn.
    """

    needed: int = 0
    width: int = 0
    height: int = 0
    quality: int = 80
    kind: int = JPEG
    turned: bool = False

    def of(self, picture: Picture) -> Display:
        """Returns how a picture is encoded. What came compressed stays as it is."""
        if picture.frame is None:
            return Display(picture.kind)
        width, height = self._size(picture.width, picture.height)
        quality = self.quality if self.kind == JPEG else 0
        return Display(self.kind, width, height, quality, self.turned)

    def _size(self, width: int, height: int) -> Tuple[int, int]:
        if self.width and self.height:
            scales = self.width / width, self.height / height
        elif self.width or self.height:
            scales = (self.width / width if self.width else self.height / height,) * 2
        else:
            scales = (min(1.0, (rounded_up(self.needed) or width) / width),) * 2
        wide, high = width * scales[0], height * scales[1]
        shrink = min(1.0, math.sqrt(max(width * height, MAX_ENLARGED) / (wide * high)))
        return max(1, round(wide * shrink)), max(1, round(high * shrink))


def rounded_up(needed: int) -> int:
    """Returns the one of SIZES that is large enough, or 0 if none is, or none is asked for."""
    return next((size for size in SIZES if size >= needed), 0) if needed else 0


_of_thread = threading.local()


def encoded(picture: Picture, display: Display) -> bytes:
    """Returns the bytes of a picture; all but those that came compressed are work without the GIL.

    Raises:
        ValueError: Its encoding cannot be shown, or it is too large.
    """
    if picture.frame is None:
        return picture.data
    if not hasattr(_of_thread, "encoder"):
        _of_thread.encoder = DisplayEncoder()
    params = DisplayParams()
    params.format = FORMATS[display.kind]
    params.quality = display.quality or params.quality
    params.width, params.height = display.width, display.height
    params.turned = display.turned
    return _of_thread.encoder.encode(picture.frame.image, picture.frame.encoding, params)
