"""The node dashboard on the private master, for tests of what it serves."""

import pathlib
import re
from typing import Callable, Optional

import support

TOKEN = "token-of-the-test"
VIEW_TOKEN = "token-that-only-looks"
PROGRAM = str(pathlib.Path(__file__).with_name("patient_dashboard.py"))


class Dashboard:
    """A running node dashboard, on a port of its own.

    Args:
        start: a fixture of that name.
        arguments: parameters and remappings.
    """

    def __init__(
        self,
        start: Callable[..., support.Process],
        *arguments: str,
        env: Optional[dict] = None,
    ):
        self._start, self._arguments, self._env = start, arguments, env
        self._port = support.free_port()  # which no other program gets while it is killed
        self.begin()

    def begin(self) -> None:
        """Starts the node; again on the port that it had before."""
        words = f"_token:={TOKEN}", f"_view_token:={VIEW_TOKEN}", f"_port:={self._port}"
        self.process = self._start(
            PROGRAM,
            "__name:=dashboard",
            *words,
            *self._arguments,
            env={"PYTHONUNBUFFERED": "1", **(self._env or {})},
        )
        self.process.wait_for_output("dashboard: http://")
        self.address = re.search(r"dashboard: (http://\S+)", self.process.output())[1]
        self._port = int(re.search(r":(\d+)/", self.address)[1])

    @property
    def origin(self) -> str:
        return f"http://127.0.0.1:{self._port}"

    @property
    def view_address(self) -> str:
        """For those who may only look."""
        return f"{self.origin}/?token={VIEW_TOKEN}"
