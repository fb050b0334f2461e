"""A window of OpenCV's. It and all its methods belong to the main thread."""

import ctypes
import os
from typing import Any, Callable

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


class Window:
    """A window that shows one picture after the other.

    Args:
        name: its title, until another is set.
        autosize: whether it takes the size of the picture; else it can be resized, and the picture
            is fitted in.
        on_click: is called by poll() with x and y, in px of the picture, for a left click.
    """

    def __init__(self, name: str, autosize: bool, on_click: Callable[[int, int], Any]):
        self._name = name
        self._on_click = on_click
        kind = cv2.WINDOW_AUTOSIZE if autosize else cv2.WINDOW_NORMAL | cv2.WINDOW_KEEPRATIO
        cv2.namedWindow(name, kind | cv2.WINDOW_GUI_NORMAL)
        cv2.setMouseCallback(name, self._on_mouse)

    def show(self, picture: np.ndarray) -> None:
        """Shows a copy of a (height, width, 3) uint8 picture, BGR."""
        cv2.imshow(self._name, picture)

    def set_title(self, title: str) -> None:
        cv2.setWindowTitle(self._name, title)

    def poll(self, milliseconds: int) -> int:
        """Lets the window work for a while or until a key is pressed: its code, else NO_KEY."""
        return cv2.waitKey(milliseconds) & 0xFF  # above are modifiers, on some systems

    def is_open(self) -> bool:
        """Whether the user has not closed it."""
        try:
            # With Qt a closed window is one not visible; with GTK it is gone, and this is unknown.
            visible = cv2.getWindowProperty(self._name, cv2.WND_PROP_VISIBLE)
            return visible != 0 and cv2.getWindowProperty(self._name, cv2.WND_PROP_AUTOSIZE) >= 0
        except cv2.error:  # some versions have no answer without a window
            return False

    def _on_mouse(self, event: int, x: int, y: int, _flags: int, _parameter: Any) -> None:
        if event == cv2.EVENT_LBUTTONDOWN:
            self._on_click(x, y)
