#!/usr/bin/env python3
"""A ROS master that talks to the processes of its own test only; it takes rosmaster's words.

A master keeps in mind where a node is that was killed, and tells it of publishers, and to shut down
when another one of its name comes. Where tests run beside each other, the port may have been given
to a node of another test by then, which would lose its publishers, or end.
"""

import http.client
import os
import pathlib
import xmlrpc.client
from typing import Any, Optional

MARK = "ROBOT_VISION_TEST"  # names a test in the environment of its processes: its own process id


def mark_own_processes() -> None:
    """Marks what this process starts from now on as what its masters may talk to."""
    os.environ[MARK] = str(os.getpid())


def is_of_test(pid: int, test: str) -> bool:
    """Returns whether a process is that of a test, or was started by it; False if it has ended."""
    if str(pid) == test:
        return True
    try:
        environment = pathlib.Path(f"/proc/{pid}/environ").read_bytes()
    except OSError:
        return False
    return f"{MARK}={test}".encode() in environment.split(b"\0")


class OwnProcesses(xmlrpc.client.Transport):
    """Asks who it is with each new connection, and refuses to talk to another test's process."""

    def single_request(
        self, host: Any, handler: str, request_body: Any, verbose: bool = False
    ) -> Any:
        connection: Optional[http.client.HTTPConnection] = self._connection[1]
        if connection is None or connection.sock is None:
            question = xmlrpc.client.dumps(("/master",), "getPid").encode()
            ((_, _, pid),) = super().single_request(host, handler, question, verbose)
            if not is_of_test(pid, os.environ[MARK]):
                self.close()
                raise ConnectionRefusedError(f"{host} is process {pid}, of another test")
        return super().single_request(host, handler, request_body, verbose)


def own_process(uri: str) -> xmlrpc.client.ServerProxy:
    return xmlrpc.client.ServerProxy(uri, transport=OwnProcesses())


def main() -> None:
    import rosmaster.util  # not where this is imported, as it changes xmlrpc

    rosmaster.util.ServerProxy = own_process
    rosmaster.rosmaster_main()


if __name__ == "__main__":
    main()
