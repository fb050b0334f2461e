"""Records topics into bags of the folder, one at a time."""

import contextlib
import threading
from typing import Any, Callable, Optional, Sequence

from ..common.plain_text import printable
from .bag_files import BagFolder
from .bag_recording import CLOSING_TIMEOUT, MB, MIN_FREE, Recording, Status
from .graph_calls import graph_name

MAX_TOPICS = 200


class BagRecorder:
    """Records until it is told to stop, or a limit is reached.

    Args:
        folder: Where the bags go.
        tell: A function that gets the status when it changes, by a thread of this class. After
            the end `active` is false, and `state` says the reason.
    """

    def __init__(self, folder: BagFolder, tell: Callable[[Status], Any]):
        self._folder = folder
        self._tell = tell
        self._lock = threading.Lock()  # guards _recording
        self._recording: Optional[Recording] = None

    def start(self, topics: Sequence[str], name: str, max_bytes: int, max_seconds: float) -> Status:
        """Starts to record.

        Args:
            topics: Their full names.
            name: How the bag should be named; "" by the time.
            max_bytes: The largest size.
            max_seconds: The longest time; 0: no limit.

        Raises:
            ValueError: A topic has no such name, there are too many, or a recording is going on.
            OSError: The folder cannot be made, or there is too little space.
        """
        names = list(dict.fromkeys(topics))
        if not 0 < len(names) <= MAX_TOPICS:
            raise ValueError(f"{len(names)} topics are chosen, must be 1 to {MAX_TOPICS}")
        for topic in names:
            graph_name(topic)
        with self._lock:
            self.require_idle()
            self._folder.make()
            free = self._folder.free_space()
            if free < 2 * MIN_FREE:
                needed = 2 * MIN_FREE // MB
                raise OSError(f"the disk has only {free // MB} MB left, must have {needed}")
            limits = max_bytes, max_seconds
            recording = Recording(self._folder, self._folder.free_name(name), names, limits)
            self._recording = recording
        threading.Thread(target=self._run, args=(recording,), daemon=True).start()
        return recording.status()

    def require_idle(self) -> None:
        """Raises ValueError if a recording is going on."""
        recording = self._recording
        if recording:
            raise ValueError(f"{recording.name} is being recorded: stop that first")

    def status(self) -> Optional[Status]:
        """Returns the status of what is being recorded, or None."""
        recording = self._recording
        return recording.status() if recording else None

    def stop(self, timeout: float = CLOSING_TIMEOUT) -> None:
        """Ends the recording, and waits until the bag is whole.

        Raises:
            ValueError: Nothing is being recorded.
        """
        recording = self._recording
        if recording is None:
            raise ValueError("nothing is being recorded")
        recording.stop("stopped")
        recording.ended.wait(timeout)

    def close(self) -> None:
        """Ends the recording; what is left to be written is written without this process."""
        with contextlib.suppress(ValueError):
            self.stop(1.0)

    def _run(self, recording: Recording) -> None:
        # A process that is told when its parent ends is told so when the thread ends that started
        # it. So one thread starts it and stays until it has ended.
        try:
            recording.run(self._tell)
        except OSError as error:
            recording.stop(f"failed: {printable(str(error), 300)}")
        finally:
            self._recording = None
            self._tell({**recording.status(), "active": False})
            recording.ended.set()
