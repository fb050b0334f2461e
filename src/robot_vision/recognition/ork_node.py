"""What an .ork file for detection means for the node object_recognizer: words of a command line."""

import json
from typing import Any, Dict, List, Mapping, Sequence, Set

from ..common.plain_text import brief, printable
from ..ros.transport import camera_info_beside
from .ork_file import Cell, OrkFile

IMAGE, DEPTH = "/camera/rgb/image_raw", "/camera/depth_registered/image_raw"
SIDES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")
SOURCES = {  # by their types in lower case: what is told of those that are not topics
    "roskinect": "",
    "openni": "a driver is a node of its own, as of freenect.launch: its topics are taken",
    "bagreader": "rosbag plays bags: the topics of a camera are taken",
}
TOPICS = {  # parameters of a sink that name topics, and the names here
    "recognized_object_array_topic": "recognized_object_array",
    "table_array_topic": "table_array",
}
NOT_USED = {  # parameters of sources and sinks that have no meaning here
    "rgb_frame_id": "it is that of the images",
    "depth_frame_id": "it is that of the images",
    "visualize": "there are markers on ~markers while somebody subscribes to them",
    "markers_topic": "markers are on ~markers",
    "pose_topic": "poses are in what is recognized, and on /tf",
    "object_ids_topic": "ids are in what is recognized",
    "publish_clusters": "the points of an object are in what is recognized",
    "latched": "what is recognized is published for each image",
    "object_ids": "that of the pipeline says which objects",
    "db_params": "db of the pipeline says which database",
}


def node_words(file: OrkFile) -> List[str]:
    """Returns the words that remap topics and set parameters, as sources and sinks say.

    What is not used is added to the warnings of the file.

    Raises:
        ValueError: A parameter is not what it must be.
    """
    words = _source_words(file.sources, file.warnings)
    for sink in file.sinks:
        words += _sink_words(sink, file.warnings)
    return words


def with_typed(words: Sequence[str], typed: Sequence[str]) -> List[str]:
    """Returns the words of a file and then those that a user has typed, which count more.

    Images that are looked at in the end are rectified if the name of their topic says so, as ORK's.
    """
    both = [*words, *typed]
    rectified = []
    for name, parameter in {"image": "rectified", "depth": "depth_rectified"}.items():
        topics = [word.partition(":=")[2] for word in both if word.startswith(f"{name}:=")]
        if "rect" in topics[-1].rsplit("/", 1)[-1]:
            rectified.append(parameter_word(parameter, True))
    return [*words, *rectified, *typed]


def set_by(words: Sequence[str]) -> Set[str]:
    """Returns the names of the private parameters that words of a command line set."""
    return {
        word[1:].partition(":=")[0] for word in words if word.startswith("_") and word[1] != "_"
    }


def parameter_word(name: str, value: Any) -> str:
    """Returns the word that sets a private parameter of a node."""
    return f"_{name}:={json.dumps(value)}"


def _source_words(sources: Sequence[Cell], warnings: List[str]) -> List[str]:
    if not sources:
        return [f"image:={IMAGE}", f"depth:={DEPTH}"]
    for other in sources[1:]:
        warnings.append(f"{other.name} is not used: there is one camera, that of {sources[0].name}")
    source = sources[0]
    told = SOURCES.get(source.type.lower(), "of its type nothing is known: topics are taken")
    if told:
        warnings.append(f"{source.name}: {printable(source.type)} is not used: {told}")
        return [f"image:={IMAGE}", f"depth:={DEPTH}"]
    given = dict(source.parameters)
    image = _topic(source, given.pop("rgb_image_topic", IMAGE))
    depth = _topic(source, given.pop("depth_image_topic", DEPTH))
    words = [f"image:={image}", f"depth:={depth}"]
    info = _topic(source, given.pop("rgb_camera_info", camera_info_beside(image)))
    words += [f"camera_info:={info}"] if info != camera_info_beside(image) else []
    if _topic(source, given.pop("depth_camera_info", "")) not in ("", camera_info_beside(depth)):
        warnings.append(f"{source.name}: depth_camera_info is not used: it is that beside {depth}")
    words += _crop_words(source, given)
    _warn(source, given, warnings)
    return words


def _crop_words(source: Cell, given: Dict[str, Any]) -> List[str]:
    """Returns the words for the box to which results are cropped, and takes it out of `given`."""
    enabled = given.pop("crop_enabled", False)
    sides = {side: given.pop(side) for side in SIDES if side in given}
    for side, value in sides.items():
        if not isinstance(value, (int, float)) or isinstance(value, bool):
            raise ValueError(f"{source.name}: {side} is {brief(value)}, must be a number")
    if not enabled:
        return []
    return [parameter_word("crop", True)] + [
        parameter_word(side, float(value)) for side, value in sides.items()
    ]


def _sink_words(sink: Cell, warnings: List[str]) -> List[str]:
    given = dict(sink.parameters)
    words = []
    for parameter, name in TOPICS.items():
        if parameter in given:
            words.append(f"{name}:={_topic(sink, given.pop(parameter))}")
    _warn(sink, given, warnings)
    return words


def _topic(cell: Cell, value: Any) -> str:
    if not isinstance(value, str) or set(value) - set(_TOPIC_LETTERS):
        raise ValueError(f"{cell.name}: {brief(value)} must be the name of a topic")
    return value


_TOPIC_LETTERS = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_/~"


def _warn(cell: Cell, given: Mapping[str, Any], warnings: List[str]) -> None:
    for name in given:
        reason = NOT_USED.get(name)
        what = f"is not used: {reason}" if reason else "is not known, and not used"
        warnings.append(f"{cell.name}: {name} {what}")
