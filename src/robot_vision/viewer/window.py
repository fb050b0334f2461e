"""A window of OpenCV. All its methods have to be called by the main thread."""

import ctypes
import os
from typing import Any, Callable, Optional, Tuple

import cv2
import numpy as np

NO_KEY = 255


def require_display() -> None:
    """Raises ValueError unless there is a display: without one, cv2 would abort the process."""
    name = os.environ.get("DISPLAY")
    if not name:
        raise ValueError("DISPLAY is not set, must name an X display to open a window on")
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = x11.XOpenDisplay(None)
    if not display:
        raise ValueError(f"DISPLAY is '{name}', must name an X display that can be opened")
    x11.XCloseDisplay(ctypes.c_void_p(display))


Point = Tuple[int, int]
MIN_DRAG = 4  # px that the pointer has to move before a click becomes a rectangle
GREEN = (0, 255, 0)


class Window:
    """A window that shows one image after the other.

    Args:
        name: The title, until another one is set.
        autosize: Whether the window takes the size of the image. If not, it can be resized, and
            the image is fitted into it.
        on_click: A function that poll() calls for a left click, with x and y in px of the image.
        on_drag: A function that poll() calls for a rectangle drawn with the left button, with x,
            y, width and height in px of the image. The rectangle is shown while it is drawn.
    """

    def __init__(
        self,
        name: str,
        autosize: bool,
        on_click: Callable[[int, int], Any],
        on_drag: Callable[[int, int, int, int], Any] = lambda *_: None,
    ):
        self._name = name
        self._on_click = on_click
        self._on_drag = on_drag
        self._image: Optional[np.ndarray] = None
        self._pressed: Optional[Point] = None  # where the button was pressed
        self._dragged: Optional[Point] = None  # where the pointer was dragged to since
        self._autosize = autosize
        self._shown_size: Optional[Tuple[int, int]] = None  # px, of the image passed to imshow
        kind = cv2.WINDOW_AUTOSIZE if autosize else cv2.WINDOW_NORMAL | cv2.WINDOW_KEEPRATIO
        cv2.namedWindow(name, kind | cv2.WINDOW_GUI_NORMAL)
        cv2.setMouseCallback(name, self._on_mouse)

    def show(self, image: np.ndarray) -> None:
        """Shows a (height, width, 3) uint8 image, BGR, which must not change afterwards."""
        self._image = image
        if self._dragged:
            x, y, width, height = self._rectangle()
            image = image.copy()
            cv2.rectangle(image, (x, y), (x + width - 1, y + height - 1), GREEN, 1)
        self._shown_size = self._fitting_size()
        if self._shown_size != self._size():
            image = cv2.resize(image, self._shown_size, interpolation=cv2.INTER_NEAREST)
        cv2.imshow(self._name, image)

    def set_title(self, title: str) -> None:
        cv2.setWindowTitle(self._name, title)

    def poll(self, milliseconds: int) -> int:
        """Lets the window work until a key is pressed or time is up; returns its code or NO_KEY."""
        key = cv2.waitKey(milliseconds) & 0xFF  # Some systems put modifiers into the upper bits.
        if self._image is not None and self._shown_size != self._fitting_size():
            self.show(self._image)
        return key

    def is_open(self) -> bool:
        """Returns whether the user has not closed the window."""
        try:
            # With Qt a closed window is invisible. With GTK it is gone, and the property unknown.
            visible = cv2.getWindowProperty(self._name, cv2.WND_PROP_VISIBLE)
            return visible != 0 and cv2.getWindowProperty(self._name, cv2.WND_PROP_AUTOSIZE) >= 0
        except cv2.error:  # Some versions raise this for a window that is gone.
            return False

    def _size(self) -> Tuple[int, int]:
        """Returns the width and height of the image."""
        height, width = self._image.shape[:2]
        return width, height

    def _fitting_size(self) -> Tuple[int, int]:
        """Returns the size to show the image in; OpenCV 4.10 shrinks it, but never enlarges it."""
        width, height = self._size()
        if self._autosize or not self.is_open():
            return width, height
        room = cv2.getWindowImageRect(self._name)[2:]
        scale = max(1.0, min(room[0] / width, room[1] / height))
        return int(width * scale), int(height * scale)

    def _on_mouse(self, event: int, x: int, y: int, flags: int, _parameter: Any) -> None:
        if self._image is None:
            return
        x, y = (a * size // shown for a, size, shown in zip((x, y), self._size(), self._shown_size))
        if event == cv2.EVENT_LBUTTONDOWN:
            self._pressed, self._dragged = (x, y), None
        elif event == cv2.EVENT_MOUSEMOVE and self._pressed and flags & cv2.EVENT_FLAG_LBUTTON:
            if (
                self._dragged
                or max(abs(x - self._pressed[0]), abs(y - self._pressed[1])) >= MIN_DRAG
            ):
                self._dragged = (x, y)
                self.show(self._image)
        elif event == cv2.EVENT_LBUTTONUP and self._pressed:
            pressed, rectangle = self._pressed, self._dragged and self._rectangle()
            self._pressed = self._dragged = None
            if rectangle:
                self.show(self._image)
                self._on_drag(*rectangle)
            else:
                self._on_click(*pressed)

    def _rectangle(self) -> Tuple[int, int, int, int]:
        """Returns x, y, width and height of the drawn rectangle, clipped to the image."""
        (left, right), (top, bottom) = (
            sorted(min(max(end, 0), size - 1) for end in ends)
            for ends, size in zip(zip(self._pressed, self._dragged), self._size())
        )
        return left, top, right - left + 1, bottom - top + 1
