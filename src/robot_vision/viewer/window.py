"""A window of OpenCV's. It and all its methods belong to the main thread."""

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
DRAG = 4  # px that the pointer moves before a click becomes a rectangle
GREEN = (0, 255, 0)


class Window:
    """A window that shows one picture after the other.

    Args:
        name: its title, until another is set.
        autosize: whether it takes the size of the picture; else it can be resized, and the picture
            is fitted in.
        on_click: is called by poll() with x and y, in px of the picture, for a left click.
        on_drag: is called by poll() with x, y, width and height of a rectangle, in px of the
            picture, that has been drawn with the left button; it is shown while it is drawn.
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
        self._picture: Optional[np.ndarray] = None
        self._pressed: Optional[Point] = None  # where the button was
        self._dragged: Optional[Point] = None  # where the pointer is, if it has been moved since
        self._autosize = autosize
        self._shown_size: Optional[Tuple[int, int]] = None  # px, what imshow was given
        kind = cv2.WINDOW_AUTOSIZE if autosize else cv2.WINDOW_NORMAL | cv2.WINDOW_KEEPRATIO
        cv2.namedWindow(name, kind | cv2.WINDOW_GUI_NORMAL)
        cv2.setMouseCallback(name, self._on_mouse)

    def show(self, picture: np.ndarray) -> None:
        """Shows a (height, width, 3) uint8 picture, BGR, which must stay as it is."""
        self._picture = picture
        if self._dragged:
            x, y, width, height = self._rectangle()
            picture = picture.copy()
            cv2.rectangle(picture, (x, y), (x + width - 1, y + height - 1), GREEN, 1)
        self._shown_size = self._fitting_size()
        if self._shown_size != self._size():
            picture = cv2.resize(picture, self._shown_size, interpolation=cv2.INTER_NEAREST)
        cv2.imshow(self._name, picture)

    def set_title(self, title: str) -> None:
        cv2.setWindowTitle(self._name, title)

    def poll(self, milliseconds: int) -> int:
        """Lets the window work for a while or until a key is pressed: its code, else NO_KEY."""
        key = cv2.waitKey(milliseconds) & 0xFF  # above are modifiers, on some systems
        if self._picture is not None and self._shown_size != self._fitting_size():
            self.show(self._picture)
        return key

    def is_open(self) -> bool:
        """Whether the user has not closed it."""
        try:
            # With Qt a closed window is one not visible; with GTK it is gone, and this is unknown.
            visible = cv2.getWindowProperty(self._name, cv2.WND_PROP_VISIBLE)
            return visible != 0 and cv2.getWindowProperty(self._name, cv2.WND_PROP_AUTOSIZE) >= 0
        except cv2.error:  # some versions have no answer without a window
            return False

    def _size(self) -> Tuple[int, int]:
        """Width and height of the picture."""
        height, width = self._picture.shape[:2]
        return width, height

    def _fitting_size(self) -> Tuple[int, int]:
        """Width and height to show the picture in: OpenCV 4.10 shrinks to fit, but enlarges not."""
        width, height = self._size()
        if self._autosize or not self.is_open():
            return width, height
        room = cv2.getWindowImageRect(self._name)[2:]
        scale = max(1.0, min(room[0] / width, room[1] / height))
        return int(width * scale), int(height * scale)

    def _on_mouse(self, event: int, x: int, y: int, flags: int, _parameter: Any) -> None:
        if self._picture is None:
            return
        x, y = (a * size // shown for a, size, shown in zip((x, y), self._size(), self._shown_size))
        if event == cv2.EVENT_LBUTTONDOWN:
            self._pressed, self._dragged = (x, y), None
        elif event == cv2.EVENT_MOUSEMOVE and self._pressed and flags & cv2.EVENT_FLAG_LBUTTON:
            if self._dragged or max(abs(x - self._pressed[0]), abs(y - self._pressed[1])) >= DRAG:
                self._dragged = (x, y)
                self._show_again()
        elif event == cv2.EVENT_LBUTTONUP and self._pressed:
            pressed, rectangle = self._pressed, self._dragged and self._rectangle()
            self._pressed = self._dragged = None
            if rectangle:
                self._show_again()
                self._on_drag(*rectangle)
            else:
                self._on_click(*pressed)

    def _rectangle(self) -> Tuple[int, int, int, int]:
        """x, y, width and height of what has been drawn, as far as it is in the picture."""
        (left, right), (top, bottom) = (
            sorted(min(max(end, 0), size - 1) for end in ends)
            for ends, size in zip(zip(self._pressed, self._dragged), self._size())
        )
        return left, top, right - left + 1, bottom - top + 1

    def _show_again(self) -> None:
        if self._picture is not None:
            self.show(self._picture)
