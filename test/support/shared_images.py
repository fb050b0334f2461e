"""Publishers and readers of the transport shm in processes of their own."""

import itertools
import os
import pathlib
from typing import Any, Callable

import rosgraph
import support
from ros_programs import program_of

REPUBLISH = program_of("image_transport", "republish")
if not pathlib.Path(REPUBLISH).exists():
    REPUBLISH = "/opt/ros/noetic/lib/image_transport/republish"

_numbers = itertools.count()


def receives_over(node: str, topic: str) -> bool:
    """Whether a node, which may only be starting, has a connection to a publisher of a topic."""
    try:
        return support.receives_over(node, topic)
    except (rosgraph.MasterException, OSError):
        return False


def uses_shm(node: str, topic: str) -> bool:
    """Whether a node has the images of a topic over shm, and not over raw."""
    return receives_over(node, topic + "/shm") and not receives_over(node, topic)


def uses_raw(node: str, topic: str) -> bool:
    """Whether a node has the images of a topic over raw, and not over shm."""
    return receives_over(node, topic) and not receives_over(node, topic + "/shm")


def share(start: Callable[..., Any], source: str, target: str, *arguments: str) -> Any:
    """Starts a node that publishes the raw images of a topic on another over all transports."""
    name = f"__name:=share_{next(_numbers)}"
    return start(REPUBLISH, "raw", f"in:={source}", f"out:={target}", name, *arguments)


def shared_files(process: support.Process) -> int:
    """How many files of memory a process has open."""
    return sum(map(_is_memory, pathlib.Path(f"/proc/{process.pid}/fd").iterdir()))


def _is_memory(file: pathlib.Path) -> bool:
    try:
        return os.readlink(str(file)).startswith("/memfd:")
    except FileNotFoundError:  # it was closed since the folder was listed
        return False


class Reader:
    """A process that reads a topic over a transport and publishes the images over raw."""

    def __init__(
        self, start: Callable[..., Any], topic: str, transport: str = "shm", *before: str
    ) -> None:
        """Starts it, with these words before the command: those of setpriv, say."""
        number = next(_numbers)
        self.node = f"/reader_{number}"
        self.target = f"/read_{number}/image"
        command = [*before, REPUBLISH, transport, f"in:={topic}", "raw", f"out:={self.target}"]
        self.process = start(*command, f"__name:=reader_{number}")
