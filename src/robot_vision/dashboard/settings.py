"""The parameters of the dashboard."""

import os
import re
from dataclasses import dataclass
from typing import Tuple

import rospkg

from ..common.plain_text import brief
from ..ros.params import read_any, read_param, read_secret

MAX_PORT = 65535
MAX_HOSTS = 64


@dataclass(frozen=True)
class Settings:
    """The node's parameters, as docs/parameters.md has them."""

    address: str = "127.0.0.1"
    port: int = 8080
    port_tries: int = 10
    token: str = ""
    view_token: str = ""
    hosts: Tuple[str, ...] = ()
    open_streams: bool = False
    foxglove: bool = False
    foxglove_origins: Tuple[str, ...] = ()
    open_browser: bool = False
    max_clients: int = 32
    quality: int = 80  # of JPEG
    bag_folder: str = ""
    max_bag_size: int = 2000  # MB


def read_settings() -> Settings:
    """Returns the node's parameters; raises ValueError if one has a value that it may not have."""
    return Settings(
        address=_read_address(),
        port=read_param("port", 8080, 0, MAX_PORT, zero="any that is free"),
        port_tries=read_param("port_tries", 10, 1, 100),
        token=read_secret("token"),
        view_token=read_secret("view_token"),
        hosts=_read_hosts(),
        open_streams=read_param("open_streams", False),
        foxglove=read_param("foxglove", False),
        foxglove_origins=_read_origins(),
        open_browser=read_param("open_browser", False),
        max_clients=read_param("max_clients", 32, 1, 1000),
        quality=read_param("quality", 80, 1, 100),
        bag_folder=_read_folder(),
        max_bag_size=read_param("max_bag_size", 2000, 1, 1000000),
    )


def _read_address() -> str:
    address = read_param("address", "127.0.0.1")
    if not re.fullmatch(r"[A-Za-z0-9.:_%-]{1,253}", address):
        raise ValueError(f"address is {brief(address)}, must be an address or name of this machine")
    return address


def _read_hosts() -> Tuple[str, ...]:
    hosts = read_any("hosts", [])
    good = isinstance(hosts, list) and all(isinstance(host, str) for host in hosts)
    if not good or len(hosts) > MAX_HOSTS:
        raise ValueError(f"hosts is {brief(hosts)}, must be a list of at most {MAX_HOSTS} names")
    return tuple(hosts)


def _read_origins() -> Tuple[str, ...]:
    origins = read_any("foxglove_origins", [])
    good = isinstance(origins, list) and all(
        isinstance(origin, str) and origin.startswith(("http://", "https://")) for origin in origins
    )
    if not good or len(origins) > MAX_HOSTS:
        raise ValueError(
            f"foxglove_origins is {brief(origins)}, must be a list of at most {MAX_HOSTS} origins "
            "as https://app.foxglove.dev"
        )
    return tuple(origins)


def _read_folder() -> str:
    folder = read_param("bag_folder", "")
    if folder and not (os.path.isabs(folder) and folder.isprintable()):
        raise ValueError(f"bag_folder is {brief(folder)}, must be an absolute path")
    return folder or os.path.join(rospkg.get_ros_home(), "robot_vision_bags")
