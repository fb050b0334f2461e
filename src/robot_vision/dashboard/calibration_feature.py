"""The calibration of a camera by a page: one at a time, for all pages."""

import threading
from typing import Any, Dict, Optional

from ..calibration.board_search import BoardParams
from ..calibration.boards import BOARDS
from ..calibration.solving import MODELS
from .calibration_run import CalibrationRun, State
from .fields import Choice, Number, Text
from .graph_calls import graph_name
from .operations import Operation
from .settings import Settings
from .watchers import Watchers

NOBODY = {"topic": "", "state": "nobody calibrates a camera"}


class CalibrationFeature:
    """Runs a calibration as long as pages want it; it waits, with its views, while none looks.

    Pages that may only look are shown what there is, and change nothing by it.

    Args:
        settings: The node's parameters.
        image_hub: Where images come from.
    """

    def __init__(self, settings: Settings, image_hub: Any):
        self._hub = image_hub
        self._lock = threading.RLock()  # guards _run and _owner
        self._run: Optional[CalibrationRun] = None
        self._owner = 0  # id of the session that has started it
        self._watchers = Watchers()  # all that are told
        self._controllers = Watchers(self._on_nobody)  # those of them that may control
        board = {
            "topic": Text(),
            "kind": Choice(*BOARDS),
            "columns": Number(3, 100, integer=True),
            "rows": Number(3, 100, integer=True),
            "square": Number(0.0001, 10.0),
            "model": Choice(*MODELS, default=MODELS[0]),
            "marker": Number(0.0001, 10.0, default=BoardParams.marker),
            "dictionary": Text(40, default=BoardParams.dictionary),
        }
        self.operations = [
            Operation("calibration", self._look, "view"),
            Operation("close_calibration", self._leave, "view"),
            Operation("calibration_start", self._start, fields=board),
            Operation("calibration_solve", lambda *_: self._running().solve()),
            Operation("calibration_more", lambda *_: self._running().more()),
            Operation("calibration_commit", self._commit, fields={"node": Text(default="")}),
            Operation("calibration_stop", self._stop),
        ]

    def close(self) -> None:
        """Ends a calibration."""
        with self._lock:
            if self._run:
                self._run.close()
            self._run = None

    def _look(self, session: Any, _fields: Dict[str, Any]) -> State:
        """Has a session told of the calibration, and returns what is known of it now."""
        self._add(session)
        with self._lock:
            if self._run is None:
                return NOBODY
            problem = ""
            try:
                if session.role == "control":
                    self._run.resume()
            except ValueError as error:  # The camera has gone; the views are still there.
                problem = str(error)
            state = self._run.state()
            return self._known({**state, "state": problem or state["state"]})

    def _leave(self, session: Any, _fields: Dict[str, Any]) -> None:
        self._watchers.remove(session)
        self._controllers.remove(session)

    def _add(self, session: Any) -> None:
        self._watchers.add(session)
        if session.role == "control":
            self._controllers.add(session)

    def _start(self, session: Any, fields: Dict[str, Any]) -> State:
        topic = graph_name(fields["topic"])
        params = BoardParams(
            board=fields["kind"],
            **{
                name: fields[name] for name in ("columns", "rows", "square", "marker", "dictionary")
            },
        )
        with self._lock:
            if self._run and len(self._controllers):
                raise ValueError(
                    f"{self._run.topic} is being calibrated by page {self._owner}: one at a time"
                )
            run = CalibrationRun(
                topic, params, fields["model"], self._hub, lambda state: self._tell(run, state)
            )
            try:
                run.resume()
            except ValueError:
                run.close()
                raise
            self.close()
            self._run, self._owner = run, session.id
            self._add(session)
            return self._known(run.state())

    def _commit(self, _session: Any, fields: Dict[str, Any]) -> Dict[str, str]:
        node = graph_name(fields["node"]) if fields["node"] else ""
        return {"message": self._running().commit(node)}

    def _stop(self, _session: Any, _fields: Dict[str, Any]) -> None:
        with self._lock:
            self.close()
            self._watchers.push("calibration", NOBODY)

    def _running(self) -> CalibrationRun:
        with self._lock:
            if self._run is None:
                raise ValueError("nobody calibrates a camera: start first")
            return self._run

    def _tell(self, run: CalibrationRun, state: State) -> None:
        with self._lock:
            if run is self._run:  # Its thread may have made the state before it was stopped.
                self._watchers.push("calibration", self._known(state))

    def _known(self, state: State) -> State:
        return {**state, "owner": self._owner}

    def _on_nobody(self) -> None:
        with self._lock:
            if self._run and not len(self._controllers):
                self._run.pause()
