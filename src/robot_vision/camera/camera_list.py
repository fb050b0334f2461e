"""The list of cameras that cameras.launch reads."""

import re
from typing import Any, Dict

from ..common.plain_text import brief

NAME = "[A-Za-z][A-Za-z0-9_]*"


def parse_cameras(values: Any) -> Dict[str, Dict[str, Any]]:
    """Returns the parameters of each camera's node by the camera's name.

    Where the list does not say otherwise, a camera's calibration and its frame are named after it.

    Args:
        values: A list of maps. Each has a name, a source, and further parameters of the camera;
            rate stands for framerate.

    Raises:
        ValueError: The list is not of this form; the message says what is wrong, and where.
    """
    if not isinstance(values, list) or not values:
        raise ValueError(f"cameras is {brief(values)}, must be a list of maps with name and source")
    cameras: Dict[str, Dict[str, Any]] = {}
    for index, entry in enumerate(values):
        where = f"cameras[{index}]"
        if not isinstance(entry, dict):
            raise ValueError(f"{where} is {brief(entry)}, must be a map with name and source")
        parameters = dict(entry)
        name = parameters.pop("name", None)
        if not isinstance(name, str) or not re.fullmatch(NAME, name):
            raise ValueError(f"{where}: name is {brief(name)}, must be letters, digits and _")
        if name in cameras:
            raise ValueError(f"{where}: the name {name} is there twice")
        if "source" not in parameters:
            raise ValueError(f"{where} ({name}): there is no source")
        source = parameters["source"]
        if not isinstance(source, str):
            raise ValueError(f"{where} ({name}): source is {brief(source)}, must be a string")
        cameras[name] = _of_node(name, parameters, f"{where} ({name})")
    return cameras


def _of_node(name: str, parameters: Dict[str, Any], where: str) -> Dict[str, Any]:
    if "rate" in parameters:
        if "framerate" in parameters:
            raise ValueError(f"{where}: rate and framerate are the same, one is enough")
        parameters["framerate"] = parameters.pop("rate")
    return {"camera_name": name, "camera_frame_id": name, **parameters}
