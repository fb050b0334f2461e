"""One recording: the program `record` of rosbag, and what is known of its bag meanwhile.

The program is a process of its own, in a group of its own. Its bag is named .bag.active until it
is whole, and the kernel has it finish the bag when this process ends, however that happens.
"""

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from typing import Any, BinaryIO, Callable, Dict, List, Optional, Sequence, Tuple

import roslib.packages
import rospy

from ..common.plain_text import printable
from .bag_files import UNFINISHED, BagFolder
from .bag_progress import BagProgress
from .bag_summary import summary_of

MB = 10**6  # bytes
PERIOD = 0.5  # s between looks at the bag
MIN_FREE = 500 * MB  # bytes on the disk, below which recording stops
BUFFER = 64  # MB, of messages that wait for the disk
CLOSING_TIMEOUT = 60.0  # s for the index to be written
MAX_NAMED = 5  # topics that are named at the end, as nothing has come on them
MAX_SAID = 64 * 1024  # bytes of what the program says that are looked at
LOSES = b"record buffer exceeded"  # which it says when messages wait longer than there is room

Status = Dict[str, Any]


class Recording:
    """One bag that is being recorded.

    Args:
        folder: Where it goes.
        name: Its name.
        topics: Full names of what is recorded.
        limits: The largest size in bytes, and the longest time in s; 0: no limit of time.
    """

    def __init__(self, folder: BagFolder, name: str, topics: List[str], limits: Tuple[int, float]):
        self.name = name
        self.ended = threading.Event()
        self._folder = folder
        self._topics = topics
        self._max_bytes, self._max_seconds = limits
        self._begin = time.monotonic()
        self._started = time.time()
        self._stop = threading.Event()
        self._reason = ""
        self._size = 0
        self._counts = dict.fromkeys(topics, 0)
        self._counted = True
        self._loses = False  # messages, as the disk is slower than they come

    def status(self) -> Status:
        """Returns what is known of it, as JSON can hold it."""
        return {
            "name": self.name,
            "active": True,
            "state": self._reason or self._progress(),
            "size": self._size,
            "seconds": round(time.monotonic() - self._begin, 1),
            "started": self._started,
            "messages": sum(self._counts.values()) if self._counted else None,
            "topics": [{"name": name, "count": self._counts.get(name)} for name in self._topics],
            "max_size": self._max_bytes,
            "max_seconds": self._max_seconds,
        }

    def stop(self, reason: str) -> None:
        """Has it end; the first reason is the one that is told."""
        self._reason = self._reason or reason
        self._stop.set()

    def run(self, tell: Callable[[Status], Any]) -> None:
        """Records until it is stopped, and tells the status now and then.

        Raises:
            OSError: The program cannot be started.
        """
        with tempfile.TemporaryFile() as output:
            process = subprocess.Popen(
                _command(self.name, self._topics),
                cwd=self._folder.path,
                env=dict(os.environ, ROS_NAMESPACE=rospy.get_namespace()),
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=output,
                start_new_session=True,
            )
            try:
                with contextlib.ExitStack() as stack:
                    self._watch(process, tell, stack, output)
            finally:
                self._finish(process)
            self._judge(process, output)

    def _watch(
        self, process: Any, tell: Callable[[Status], Any], stack: Any, output: BinaryIO
    ) -> None:
        progress: Optional[BagProgress] = None
        while process.poll() is None and not self._stop.wait(PERIOD):
            if progress is None:
                with contextlib.suppress(OSError):
                    file = stack.enter_context(self._folder.open(self.name, unfinished=True))
                    progress = BagProgress(file)
            if progress:
                self._look(progress)
            self._loses = LOSES in _said(output)
            self._check_limits()
            tell(self.status())

    def _look(self, progress: BagProgress) -> None:
        progress.update()
        self._counted = progress.known
        self._counts.update(progress.counts)
        self._size = progress.size()

    def _check_limits(self) -> None:
        free = self._folder.free_space()
        if free < MIN_FREE:
            self.stop(f"stopped, for the disk has only {free // MB} MB left")
        elif self._size >= self._max_bytes:
            self.stop(f"stopped at the limit of {self._max_bytes // MB} MB")
        elif 0.0 < self._max_seconds <= time.monotonic() - self._begin:
            self.stop(f"stopped after {self._max_seconds:g} s, as wanted")

    def _progress(self) -> str:
        if self._loses:
            return "recording, but messages are lost: the disk is too slow"
        silent = self._counted and not any(self._counts.values())
        return "no message has come yet" if silent else "recording"

    def _empty(self) -> str:
        """Returns what is told at the end of topics that the bag has no message of."""
        empty = [name for name in self._topics if not self._counts.get(name)]
        if not empty:
            return ""
        more = len(empty) - MAX_NAMED
        named = ", ".join(empty[:MAX_NAMED]) + (f" and {more} more" if more > 0 else "")
        return f"; nothing has come on {named}"

    def _finish(self, process: Any) -> None:
        """Has the program finish the bag, and ends it by force if it does not."""
        for number in (signal.SIGINT, signal.SIGKILL):
            if process.poll() is None:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, number)
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(CLOSING_TIMEOUT)

    def _judge(self, process: Any, output: BinaryIO) -> None:
        """Says how it ended; what the program has said is the reason if there is no whole bag."""
        path = os.path.join(self._folder.path, self.name)
        if os.path.exists(path):
            self._size = os.path.getsize(path)
            empty = ""
            with contextlib.suppress(ValueError), self._folder.open(self.name) as file:
                topics = summary_of(file)["topics"]
                self._counts.update((topic["name"], topic["count"]) for topic in topics)
                empty = self._empty()
            self.stop("rosbag record has ended by itself")
            if LOSES in _said(output):
                self._reason += "; messages were lost, as the disk was too slow"
            self._reason += empty
            return
        lines = _said(output).decode(errors="replace").split("\n")
        said = [printable(line.strip(), 200) for line in lines if line.strip()]
        left = os.path.exists(path + UNFINISHED)
        self._reason = "failed: " + (
            said[-1] if said else f"rosbag record gave {process.returncode}"
        )
        self._reason += (
            f"; {self.name}{UNFINISHED} is left: rosbag reindex may help" if left else ""
        )


def _said(output: BinaryIO) -> bytes:
    """Returns what the program has said, from whose end on it writes on."""
    return os.pread(output.fileno(), MAX_SAID, 0)


def _command(name: str, topics: Sequence[str]) -> List[str]:
    """Returns the command that records, and that finishes the bag when this process ends.

    Raises:
        OSError: A program is missing.
    """
    record = roslib.packages.find_node("rosbag", "record")
    if not record or not shutil.which("setpriv"):
        raise OSError("rosbag record and setpriv are needed, install rosbag and util-linux")
    node = rospy.get_name().rsplit("/", 1)[-1] + "_recorder"
    given = rospy.names.load_mappings(sys.argv).items()
    passed = [
        f"{key}:={value}" for key, value in given if key in ("__ip", "__hostname", "__master")
    ]
    options = ["--quiet", f"--buffsize={BUFFER}", "--min-space=100M", "-O", name]
    return [
        "setpriv",
        "--pdeathsig",
        "INT",
        record[0],
        *options,
        *topics,
        f"__name:={node}",
        *passed,
    ]
