"""The parameters of object_detector that are read at start: which network it is."""

import os
from typing import Any, Tuple

from ..common.package_path import package_path
from ..common.plain_text import brief
from ..common.ranges import require_range
from ..ros.image_node import MAX_THREADS
from ..ros.params import read_any, read_param
from .heads import EXPECTED, TASKS
from .input_preferences import FITS, ORDERS
from .known_names import KNOWN_NAMES
from .network import NetworkSettings
from .network_input import MAX_SIDE
from .runtimes import BACKENDS

OWN_NETWORK = "config/networks/scene.onnx"  # in this package


def network_settings() -> NetworkSettings:
    """Returns which network the parameters of the node name, and how it is run.

    Raises:
        ValueError: A parameter has the wrong type or is out of range.
    """
    return NetworkSettings(
        model=_path("model", read_param("model", "")) or package_path(OWN_NETWORK),
        weights=_path("weights", read_param("weights", "")),
        class_names=_names(read_param("class_names", "")),
        backend=_choice("backend", read_param("backend", "auto"), BACKENDS[1:]),
        threads=read_param("threads", 1, 0, MAX_THREADS, zero="all cores"),
        affinity=_processors(read_any("affinity", [])),
        head=_choice("head", read_param("head", "auto"), tuple(EXPECTED)),
        task=_choice("task", read_param("task", "auto"), TASKS),
        input_width=read_param("input_width", 0, 0, MAX_SIDE),
        input_height=read_param("input_height", 0, 0, MAX_SIDE),
        fit=_choice("fit", read_param("fit", "auto"), FITS),
        pad=read_param("pad", -1, -1, 255),
        order=_choice("order", read_param("order", "auto"), ORDERS),
        mean=_numbers("mean", read_any("mean", [])),
        std=_numbers("std", read_any("std", [])),
        background=read_param("background", True),
    )


def _path(name: str, path: str) -> str:
    """Returns the path of a parameter that names a file or nothing."""
    path = os.path.expanduser(path)
    if path and not os.path.isabs(path):  # roslaunch and a node run in different folders.
        raise ValueError(f"{name} is {brief(path)}, must be an absolute path")
    return path


def _names(value: str) -> str:
    """Returns the value of ~class_names, which may be a list that is known by its name."""
    return value if value in KNOWN_NAMES else _path("class_names", value)


def _choice(name: str, value: str, choices: Tuple[str, ...]) -> str:
    if value not in ("auto", *choices):
        known = f"auto, {', '.join(choices[:-1])} or {choices[-1]}"
        raise ValueError(f"{name} is {brief(value)}, must be {known}")
    return value


def _numbers(name: str, values: Any) -> Tuple[float, ...]:
    """Returns the value of a parameter that is a list of three numbers, or empty."""
    if not isinstance(values, list) or len(values) not in (0, 3):
        raise ValueError(f"{name} is {brief(values)}, must be a list of three numbers, or empty")
    for value in values:
        if type(value) not in (int, float):
            raise ValueError(f"{name} is {brief(values)}, must be a list of three numbers")
        require_range(name, value, -1e6, 1e6)
    return tuple(map(float, values))


def _processors(values: Any) -> Tuple[int, ...]:
    """Returns the value of ~affinity, a list of numbers of processors."""
    there = sorted(os.sched_getaffinity(0))
    if not isinstance(values, list) or any(
        type(one) is not int or one not in there for one in values
    ):
        raise ValueError(
            f"affinity is {brief(values)}, must be a list of some of {brief(there)}, which are the "
            "processors that this process may run on, or empty"
        )
    return tuple(values)
