"""Ports of this machine that one process of a test alone uses."""

import contextlib
import random
import socket
from typing import List

_marks: List[socket.socket] = []  # of the ports that this process has, until it ends


def free_port() -> int:
    """A free TCP port, another one each time, that no program gets that asks for any port.

    Nor does another process get it here as long as this one runs, before it is used or after.
    """
    while True:
        port = random.SystemRandom().randrange(11400, 32768)  # Linux gives any ports from 32768 on
        mark = socket.socket(socket.AF_UNIX)
        with contextlib.suppress(OSError), socket.socket() as probe:
            mark.bind(f"\0robot_vision_port_{port}")
            probe.bind(("127.0.0.1", port))
            _marks.append(mark)
            return port
        mark.close()
