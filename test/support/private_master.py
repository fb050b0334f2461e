#!/usr/bin/env python3
"""A ROS master that talks to the processes of its own test only; it takes rosmaster's words.

A master keeps in mind where a node is that was killed, and tells it of publishers, and to shut down
when another one of its name comes. Where tests run beside each other, the port may have been given
to a node of another test by then, which would lose its publishers, or end; or, if it is its port of
topics, take no connections until this master ends, as rospy reads one's first message before it
takes the next.
"""

import contextlib
import functools
import http.client
import os
import pathlib
import xmlrpc.client
from typing import Any, Iterator, Optional

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


def is_port_of_test(port: int, test: str) -> bool:
    """Returns whether a process of a test listens at a TCP port of IPv4 on this machine."""
    return any(_has_socket(inode, test) for inode in _listening(port))


def _listening(port: int) -> Iterator[str]:
    """The inodes of the sockets that listen at a port."""
    for line in pathlib.Path("/proc/net/tcp").read_text().splitlines()[1:]:
        _, local, _, state, *others = line.split()
        if state == "0A" and int(local.rpartition(":")[2], 16) == port:
            yield others[5]


@functools.lru_cache(maxsize=None)
def _has_socket(inode: str, test: str) -> bool:
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        if is_of_test(int(process.name), test):
            with contextlib.suppress(OSError):  # It has ended.
                for descriptor in (process / "fd").iterdir():
                    with contextlib.suppress(OSError):  # It was closed.
                        if os.readlink(descriptor) == f"socket:[{inode}]":
                            return True
    return False


class OwnProcesses(xmlrpc.client.Transport):
    """Refuses to connect to another test's process."""

    def single_request(
        self, host: Any, handler: str, request_body: Any, verbose: bool = False
    ) -> Any:
        connection: Optional[http.client.HTTPConnection] = self._connection[1]
        if connection is None or connection.sock is None:
            port = int(str(host).rpartition(":")[2])
            if not is_port_of_test(port, os.environ[MARK]):
                raise ConnectionRefusedError(f"no process of this test listens at {host}")
        return super().single_request(host, handler, request_body, verbose)


def own_process(uri: str) -> xmlrpc.client.ServerProxy:
    return xmlrpc.client.ServerProxy(uri, transport=OwnProcesses())


def main() -> None:
    import rosmaster.util  # not where this is imported, as it changes xmlrpc

    rosmaster.util.ServerProxy = own_process
    rosmaster.rosmaster_main()


if __name__ == "__main__":
    main()
