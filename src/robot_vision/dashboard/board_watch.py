"""What of a calibration is known frame by frame: where the board is, and which views are kept."""

import time
from typing import Any, Dict, List, Optional, Tuple

import numpy as np

from ..calibration.board_search import BoardParams, BoardSearch, make_board
from ..calibration.boards import Observation
from ..calibration.coverage import CELLS, seen_cells
from ..calibration.view_progress import view_progress
from ..calibration.views import ViewCollection
from ..common import opencv as cv2
from ..common.plain_text import error_text
from ..recordings.gray_images import gray_pixels
from ..ros.transport import Frame

SEARCH_SIZE = 640  # px, longer side of the image in which a chessboard is looked for
MAX_VIEWS = 60
MAX_BLUR = 6.0  # px, width of an edge above which an image is too blurred
KEPT_TIME = 1.0  # s, for which it is said that a view was kept


class BoardWatch:
    """Looks for a board in one frame after the other.

    All attributes are replaced, never changed, so that other threads may read them.

    Attributes:
        size: The width and height of the images in px; None: none has shown the board yet.
        corners: Where the board is in the newest frame, [x, y] px each; [] if it is not there.
        words: What was found of the newest frame, and what to do.
        observations: The views that are kept.
        progress: As of view_progress().
        coverage: Rows of cells of the image, whether a point of a view was in them.

    Raises:
        ValueError: OpenCV cannot find such a board.
    """

    def __init__(self, params: BoardParams):
        self._search = _Search(params)
        self._views = ViewCollection(self._search, MAX_VIEWS, MAX_BLUR)
        self._kept_until = 0.0  # s of the monotonic clock
        self.size: Optional[Tuple[int, int]] = None
        self.corners: List[List[float]] = []
        self.words = ""
        self.observations: List[Observation] = []
        self.progress: Dict[str, float] = view_progress([], (1, 1))
        self.coverage: List[List[bool]] = np.zeros(CELLS[::-1], bool).tolist()

    def look(self, frame: Frame) -> None:
        """Looks for the board in a frame; what cannot be used is said in `words`."""
        self._search.found = None
        views = self._views
        before = (len(views.views), views.without_board, views.blurred)
        try:
            views.offer("", gray_pixels(frame.image, frame.encoding))
            self.words = self._words_after(*before)
        except (TypeError, ValueError, cv2.error) as error:
            self.words = f"an image that cannot be used: {error_text(error, 200)}"
        self.size = views.size
        found = self._search.found
        self.corners = np.round(found.pixels, 1).tolist() if found else []
        if len(views.views) > before[0]:
            self.observations = [view.observation for view in views.views]
            self.progress = view_progress(self.observations, views.size)
            self.coverage = seen_cells(self.observations, views.size).tolist()

    def _words_after(self, kept: int, without_board: int, blurred: int) -> str:
        views, now = self._views, time.monotonic()
        if len(views.views) > kept:
            self._kept_until = now + KEPT_TIME
        if views.full:
            return f"{MAX_VIEWS} views are kept, which is enough"
        if len(views.views) > kept or now < self._kept_until:
            return f"kept view {len(views.views)}"
        if views.without_board > without_board:
            return "no board in the image"
        if views.blurred > blurred:
            return "hold it still: the image is blurred"
        return "this view is like one before: move the board, or tilt it"


class _Search:
    """What a ViewCollection looks for the board with; it keeps what was found, however blurred."""

    def __init__(self, params: BoardParams):
        self._search = BoardSearch(make_board(params), SEARCH_SIZE, params.search_period)
        self.found: Any = None

    def find(self, gray: np.ndarray) -> Optional[Observation]:
        self.found = self._search.find(time.monotonic(), gray)
        return self.found
