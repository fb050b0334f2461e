"""A connection of the dashboard that takes messages when a test says so."""

import asyncio
from typing import Any, List, Tuple

from robot_vision.dashboard.outbox import Outbox


class Peer:
    """A connection that takes messages when it is told to, on a loop that the test turns."""

    def __init__(self) -> None:
        self.taken: List[Tuple[Any, bool]] = []
        self.events: List[str] = []
        self._loop = asyncio.new_event_loop()
        asyncio.set_event_loop(self._loop)  # Python 3.8 gives the event that of this thread
        self._open = asyncio.Event()
        self.outbox = Outbox(
            lambda call: self._loop.call_soon(self._start, call),
            self._write,
            lambda: self.events.append("overflow"),
            lambda: self.events.append("gone"),
        )
        self.broken = False

    def read_all(self) -> None:
        self._open.set()
        self.turn()

    def stall(self) -> None:
        self._open.clear()

    def turn(self) -> None:
        for _ in range(50):
            self._loop.run_until_complete(asyncio.sleep(0))

    def end(self) -> None:
        for task in asyncio.all_tasks(self._loop):
            task.cancel()
        self.turn()
        asyncio.set_event_loop(None)
        self._loop.close()

    def _start(self, call: Any) -> None:
        result = call()
        if result is not None:
            self._loop.create_task(result)

    async def _write(self, message: Any, binary: bool) -> None:
        if self.broken:
            raise ConnectionError
        self.taken.append((b"".join(message) if binary else message, binary))
        await self._open.wait()
