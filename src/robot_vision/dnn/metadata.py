"""What exporters write into a model's metadata.

Ultralytics (https://docs.ultralytics.com) writes names, task, stride, imgsz, kpt_shape and end2end
as texts of Python, which are read as YAML here, as that is bounded.
"""

from typing import Any, List, Mapping, Optional, Tuple

from ..common.yaml_text import load_yaml

MAX_CLASSES = 10000
MAX_LENGTH = 1 << 18  # letters of a value, of which 1 MB takes seconds


def value_of(metadata: Mapping[str, str], key: str) -> Any:
    """Returns a value, or None if it is not there, cannot be read, or is longer than any."""
    text = metadata.get(key, "")
    try:
        return load_yaml(text) if len(text) <= MAX_LENGTH else None
    except ValueError:
        return None


def image_size(metadata: Mapping[str, str]) -> Optional[Tuple[int, int]]:
    """Returns the width and height that the network was exported for, or None."""
    sides = value_of(metadata, "imgsz")
    if isinstance(sides, int):
        sides = [sides, sides]
    if not isinstance(sides, list) or len(sides) != 2:
        return None
    if not all(type(side) is int and side > 0 for side in sides):
        return None
    return sides[1], sides[0]


def class_names(metadata: Mapping[str, str]) -> List[str]:
    """Returns the names of the classes in their order, or nothing."""
    return names_of(value_of(metadata, "names"))


def names_of(values: Any) -> List[str]:
    """Returns names that are a list, or a map from each class's number; nothing if they are not."""
    if isinstance(values, dict):
        numbers = [number for number in values if type(number) is int]
        if len(numbers) != len(values) or not all(0 <= one < MAX_CLASSES for one in numbers):
            return []
        values = [values.get(one, f"class {one}") for one in range(max(numbers, default=-1) + 1)]
    if not isinstance(values, list):
        return []
    return [str(name) for name in values if not isinstance(name, (dict, list))]


def class_count(metadata: Mapping[str, str]) -> Optional[int]:
    """Returns how many classes the model says that it has, or None."""
    names = class_names(metadata)
    count = value_of(metadata, "classes")
    if not names and type(count) is int and 0 < count <= MAX_CLASSES:
        return count
    return len(names) or None


def keypoint_shape(metadata: Mapping[str, str]) -> Optional[Tuple[int, int]]:
    """Returns how many keypoints a pose has, and of how many numbers each is, or None."""
    shape = value_of(metadata, "kpt_shape")
    if not isinstance(shape, list) or [type(one) for one in shape] != [int, int]:
        return None
    return (shape[0], shape[1]) if 0 < shape[0] <= 1000 and shape[1] in (2, 3) else None


def is_end_to_end(metadata: Mapping[str, str]) -> bool:
    """Returns whether the network itself leaves out what overlaps."""
    return value_of(metadata, "end2end") is True
