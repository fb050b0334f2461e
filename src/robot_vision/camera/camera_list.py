"""Several cameras as a list: what cameras.launch reads."""

import re
from typing import Any, Dict

from ..common.plain_text import told

NAME = "[A-Za-z][A-Za-z0-9_]*"


def parse_cameras(values: Any) -> Dict[str, Dict[str, Any]]:
    """The parameters of each camera's node by its name.

    Where the list does not say it, a camera's calibration and its frame have the camera's name.

    Args:
        values: a list of maps, each with a name, a source, and further parameters of the camera;
            rate is its framerate.

    Raises:
        ValueError: it is none; says what is wrong, and where.
    """
    if not isinstance(values, list) or not values:
        raise ValueError(f"cameras is {told(values)}, must be a list of maps with name and source")
    cameras: Dict[str, Dict[str, Any]] = {}
    for index, entry in enumerate(values):
        where = f"cameras[{index}]"
        if not isinstance(entry, dict):
            raise ValueError(f"{where} is {told(entry)}, must be a map with name and source")
        parameters = dict(entry)
        name = parameters.pop("name", None)
        if not isinstance(name, str) or not re.fullmatch(NAME, name):
            raise ValueError(f"{where}: name is {told(name)}, must be letters, digits and _")
        if name in cameras:
            raise ValueError(f"{where}: the name {name} is there twice")
        if "source" not in parameters:
            raise ValueError(f"{where} ({name}): there is no source")
        source = parameters["source"]
        if not isinstance(source, str):
            raise ValueError(f"{where} ({name}): source is {told(source)}, must be a string")
        cameras[name] = _of_node(name, parameters, f"{where} ({name})")
    return cameras


def _of_node(name: str, parameters: Dict[str, Any], where: str) -> Dict[str, Any]:
    if "rate" in parameters:
        if "framerate" in parameters:
            raise ValueError(f"{where}: rate and framerate are the same, one is enough")
        parameters["framerate"] = parameters.pop("rate")
    return {"camera_name": name, "camera_frame_id": name, **parameters}
