"""Ports of this machine that the programs of one test alone use."""

import contextlib
import random
import socket
from typing import Set

given: Set[int] = set()  # by free_port()


def free_port() -> int:
    """A free TCP port, another one each time, that no program gets that asks for any port."""
    while True:
        port = random.SystemRandom().randrange(11400, 32768)  # Linux gives any ports from 32768 on
        with contextlib.suppress(OSError), socket.socket() as probe:
            probe.bind(("127.0.0.1", port))
            if port not in given:
                given.add(port)
                return port
