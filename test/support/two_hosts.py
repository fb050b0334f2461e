"""Two hosts, which are network namespaces, with a cable between them.

Only addresses inside these namespaces are used; they have no connection to the outside.
"""

import contextlib
import os
import shutil
import subprocess
from typing import Any, Callable, Iterator

import pytest

ROBOT, DESK = "10.231.7.1", "10.231.7.2"


def ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True, stderr=subprocess.PIPE)


class Network:
    """Two hosts with a cable that can be unplugged."""

    def __init__(self) -> None:
        self.names = {host: f"robot_vision_{os.getpid()}_{host[-1]}" for host in (ROBOT, DESK)}
        self._ends = {host: f"rv{os.getpid()}_{host[-1]}" for host in (ROBOT, DESK)}

    def connect(self) -> None:
        for name in self.names.values():
            ip("netns", "add", name)
        robot, desk = (["name", self._ends[host], "netns", self.names[host]] for host in self.names)
        ip("link", "add", *robot, "type", "veth", "peer", *desk)
        for host, name in self.names.items():
            ip("-n", name, "address", "add", host + "/30", "dev", self._ends[host])
            for device in ("lo", self._ends[host]):
                ip("-n", name, "link", "set", device, "up")

    def cable(self, state: str) -> None:
        """Unplugs the cable ("down") or plugs it in ("up")."""
        ip("-n", self.names[ROBOT], "link", "set", self._ends[ROBOT], state)

    def remove(self) -> None:
        for name in self.names.values():
            subprocess.run(["ip", "netns", "delete", name], check=False, stderr=subprocess.DEVNULL)


@contextlib.contextmanager
def network_of_two() -> Iterator[Network]:
    if os.geteuid() != 0:
        pytest.skip("network namespaces need root")
    made = Network()
    try:
        made.connect()
    except (FileNotFoundError, subprocess.CalledProcessError) as error:
        made.remove()
        pytest.skip(f"no network namespaces to be had here: {error}")
    try:
        yield made
    finally:
        made.remove()


def runner(network: Network, start: Callable[..., Any]) -> Callable[..., Any]:
    """run(host, command, ...) starts a command on a host; it ends before the network does."""

    def on_host(host: str, command: str, *arguments: str) -> Any:
        addresses = {"ROS_MASTER_URI": f"http://{ROBOT}:11311", "ROS_HOSTNAME": host}
        environment = {**addresses, "PYTHONUNBUFFERED": "1"}
        words = ["netns", "exec", network.names[host], shutil.which(command), *arguments]
        return start(shutil.which("ip"), *words, env=environment)

    return on_host
