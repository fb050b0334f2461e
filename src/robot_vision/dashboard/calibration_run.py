"""One calibration of a camera, from the first image of a board to its parameters."""

import threading
import time
from typing import Any, Callable, Dict, Optional

import numpy as np
from sensor_msgs.srv import SetCameraInfo

from .. import CameraModel
from ..calibration.board_search import BoardParams
from ..calibration.headless_steps import camera_info
from ..calibration.solving import MIN_VIEWS, Calibration, calibrate
from ..calibration.view_progress import is_enough
from ..common.plain_text import error_text, printable
from ..ros.transport import Frame
from .board_watch import MAX_VIEWS, BoardWatch
from .calibration_result import result_of
from .graph_calls import call_service

MIN_PERIOD = 0.1  # s between frames in which the board is looked for

State = Dict[str, Any]


class CalibrationRun:
    """Looks for a board in the newest frames, keeps views that tell something, and solves.

    A thread of its own does all that, at its own pace: of frames that come meanwhile the newest
    is looked at. Begin with resume().

    Args:
        topic: The images.
        params: The board.
        model: One of solving.MODELS.
        hub: The ImageHub that the images come from.
        tell: A function that gets the state, as the page shows it, whenever it changes.

    Raises:
        ValueError: OpenCV cannot find such a board.
    """

    def __init__(
        self, topic: str, params: BoardParams, model: str, hub: Any, tell: Callable[[State], Any]
    ):
        self.topic = topic
        self._settings = {"kind": params.board, "columns": params.columns, "rows": params.rows}
        self._settings.update(square=params.square, model=model)
        self._settings.update(marker=params.marker, dictionary=params.dictionary)
        self._model = model
        self._hub = hub
        self._tell = tell
        self._watch = BoardWatch(params)
        self._switch = threading.Lock()  # guards the subscription
        self._handle: Any = None  # of the images, while they are wanted
        self._changed = threading.Condition()  # guards what follows
        self._newest: Optional[Frame] = None
        self._solving = self._closed = False
        self._untold = False  # whether it was resumed or paused since the state was told
        self._found: Optional[Calibration] = None
        self._problem = ""
        self._thread = threading.Thread(target=self._work, name="calibration", daemon=True)
        self._thread.start()

    def resume(self) -> None:
        """Has images looked at, unless there is a result.

        Raises:
            ValueError: The topic has no images.
        """
        with self._switch:
            if self._handle is None and self._found is None and not self._closed:
                self._handle = self._hub.watch(self.topic, self._on_frame)
                self._have_told()

    def pause(self) -> None:
        """Ends the subscription; what was found stays."""
        with self._switch:
            handle, self._handle = self._handle, None
            if handle:
                handle.close()
        with self._changed:
            self._newest = None
        self._have_told()

    def solve(self) -> None:
        """Has the camera computed.

        Raises:
            ValueError: There are too few views.
        """
        views = len(self._watch.observations)
        if views < MIN_VIEWS:
            raise ValueError(f"{views} views of the board, {MIN_VIEWS} are needed at least")
        with self._changed:
            self._solving, self._problem = True, ""
            self._changed.notify()
        self._tell(self.state())

    def more(self) -> None:
        """Forgets the result, and goes on looking at images; the views stay."""
        with self._changed:
            self._found, self._problem = None, ""
        self.resume()
        self._tell(self.state())

    def commit(self, node: str = "") -> str:
        """Gives the result to a camera node, and returns a line that says so.

        Args:
            node: Its name, or the namespace of its set_camera_info; "": beside the images, which
                may be in the global namespace.

        Raises:
            ValueError: There is no result yet.
            OSError: There is no such service, or the camera does not take it.
        """
        found = self._found
        if found is None:
            raise ValueError("there is no result yet: solve first")
        node = node or self.topic.rsplit("/", 1)[0]
        camera = CameraModel(*found.size, found.K, found.D, found.model)
        info = camera_info(camera, np.eye(3), found.P)
        answer = call_service(f"{node}/set_camera_info", SetCameraInfo, info)
        camera_name = node or f"the camera of {self.topic}"
        if not answer.success:
            raise OSError(f"{camera_name}: {printable(answer.status_message, 300) or 'refused'}")
        return f"{camera_name} has the calibration now"

    def close(self) -> None:
        """Ends all; nothing is told any more."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self.pause()

    def state(self) -> State:
        """Returns what the page shows, as the contract of the push `calibration` has it."""
        watch, views = self._watch, len(self._watch.observations)
        size = watch.size or (0, 0)
        waits = self._is_waiting()
        return {
            "topic": self.topic,
            "settings": self._settings,
            "size": list(size),
            "corners": [] if waits else watch.corners,
            "state": self._problem or self._words(waits),
            "views": views,
            "needed": MIN_VIEWS,
            "max_views": MAX_VIEWS,
            "progress": watch.progress,
            "enough": is_enough(watch.progress, views),
            "coverage": watch.coverage,
            "solving": self._solving,
            "result": result_of(self._found) if self._found else None,
        }

    def _words(self, waits: bool) -> str:
        if self._solving:
            return "computing the camera"
        if self._found:
            return "the camera is computed"
        if waits:
            return "it goes on when somebody looks who may control"
        return self._watch.words or f"waiting for images of {self.topic}"

    def _is_waiting(self) -> bool:
        return self._handle is None and self._found is None

    def _have_told(self) -> None:
        """Has the state told by the thread, so that no older one comes after it."""
        with self._changed:
            self._untold = True
            self._changed.notify()

    def _on_frame(self, frame: Frame) -> None:
        with self._changed:
            self._newest = frame
            self._changed.notify()

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(
                    lambda: self._closed or self._solving or self._newest or self._untold
                )
                if self._closed:
                    return
                frame, self._newest = self._newest, None
                self._untold = False
            begin = time.monotonic()
            if self._solving:
                self._solve()
            elif frame:
                self._watch.look(frame)
            if not self._closed:
                self._tell(self.state())
            time.sleep(max(MIN_PERIOD - (time.monotonic() - begin), 0.0))

    def _solve(self) -> None:
        found, problem = None, ""
        try:
            found = calibrate(self._watch.observations, self._watch.size, self._model)
        except ValueError as error:
            problem = error_text(error, 300)
        with self._changed:
            self._found, self._problem, self._solving = found, problem, False
        if found:
            self.pause()
