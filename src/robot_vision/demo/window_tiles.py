"""Arranges the windows of other processes side by side on the X display."""

import ctypes
import math
from typing import Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

TITLE_BAR = 30  # px that a window manager adds above a window

Xid = ctypes.c_ulong
Display = ctypes.c_void_p
_ErrorHandler = ctypes.CFUNCTYPE(ctypes.c_int, Display, ctypes.c_void_p)


class Area(NamedTuple):
    """A part of the screen in px."""

    x: int
    y: int
    width: int
    height: int


def tile(number: int, count: int, screen: Tuple[int, int]) -> Area:
    """Returns the area of one of `count` tiles, which cover the screen row by row.

    Args:
        number: The number of the tile, from 0.
        count: How many tiles there are.
        screen: The width and height of the screen in px.
    """
    columns = math.ceil(math.sqrt(count * 4 / 3))  # as images are wider than high
    rows = math.ceil(count / columns)
    row, column = divmod(number, columns)
    left, right = (screen[0] * i // columns for i in (column, column + 1))
    top, bottom = (screen[1] * i // rows for i in (row, row + 1))
    return Area(left, top + TITLE_BAR, right - left, bottom - top - TITLE_BAR)


def place_of(title: str, starts: Sequence[str]) -> Optional[int]:
    """Returns the index of the longest of `starts` that the title starts with, or None."""
    fitting = [n for n, start in enumerate(starts) if (title + " ").startswith(start + " ")]
    return max(fitting, key=lambda number: len(starts[number]), default=None)


class Tiles:
    """Puts each window into its tile once, and leaves it to the user from then on.

    Args:
        starts: The starts of the windows' titles, in the order of their tiles.

    Raises:
        OSError: There is no X11 library, or no display.
    """

    def __init__(self, starts: Sequence[str]) -> None:
        self._starts = starts
        self._placed: Dict[int, int] = {}  # tiles by windows
        self._x11 = _x11()
        self._display = self._x11.XOpenDisplay(None)
        if not self._display:
            raise OSError("the display cannot be opened")
        screen = self._x11.XDefaultScreen(self._display)
        sizes = (self._x11.XDisplayWidth, self._x11.XDisplayHeight)
        self._screen = tuple(size(self._display, screen) for size in sizes)

    def place(self) -> bool:
        """Puts the windows that are open into their tiles; returns whether some are missing."""
        for window, title in self._titled(self._x11.XDefaultRootWindow(self._display)):
            number = place_of(title, self._starts)
            if number is not None and self._placed.get(window) != number:  # Titles may change.
                area = tile(number, len(self._starts), self._screen)
                self._x11.XMoveResizeWindow(self._display, window, *area)
                self._placed[window] = number
        self._x11.XSync(self._display, 0)
        return len(set(self._placed.values())) < len(self._starts)

    def close(self) -> None:
        self._x11.XCloseDisplay(self._display)

    def _titled(self, window: int) -> Iterator[Tuple[int, str]]:
        """Yields all titled windows below a window, also inside the frames of a window manager."""
        for child in self._children(window):
            yield from self._titled(child)
            text = ctypes.c_char_p()
            if self._x11.XFetchName(self._display, child, ctypes.byref(text)) and text.value:
                yield child, text.value.decode("utf-8", "replace")
                self._x11.XFree(text)

    def _children(self, window: int) -> List[int]:
        root, parent, count = Xid(), Xid(), ctypes.c_uint()
        children = ctypes.POINTER(Xid)()
        found = map(ctypes.byref, (root, parent, children, count))
        if not self._x11.XQueryTree(self._display, window, *found) or not children:
            return []
        numbers = children[: count.value]
        self._x11.XFree(children)
        return numbers


# By default an error of Xlib ends the process. Here it only means that a window was closed.
_ignore = _ErrorHandler(lambda _display, _error: 0)


def _x11() -> ctypes.CDLL:
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = Display
    x11.XDefaultRootWindow.restype = Xid
    for name in ("XDefaultRootWindow", "XDefaultScreen", "XCloseDisplay"):
        getattr(x11, name).argtypes = [Display]
    for name in ("XDisplayWidth", "XDisplayHeight", "XSync"):
        getattr(x11, name).argtypes = [Display, ctypes.c_int]
    pointer = ctypes.c_void_p
    x11.XQueryTree.argtypes = [Display, Xid, pointer, pointer, pointer, pointer]
    x11.XFetchName.argtypes = [Display, Xid, pointer]
    x11.XFree.argtypes = [pointer]
    x11.XMoveResizeWindow.argtypes = [Display, Xid, *[ctypes.c_int] * 2, *[ctypes.c_uint] * 2]
    x11.XSetErrorHandler(_ignore)
    return x11
