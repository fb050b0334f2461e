"""Ids of tags as people write them."""

import re
from typing import List

from .._core import tag_family
from ..common.plain_text import brief

LIST = re.compile(r"\s*[0-9]+\s*(-\s*[0-9]+\s*)?(,\s*[0-9]+\s*(-\s*[0-9]+\s*)?)*")


def parse_ids(text: str, family: str) -> List[int]:
    """Returns the ids of a list such as 0,3,7-9, in its order.

    Raises:
        ValueError: The text is not such a list, or the family does not have all of the ids.
    """
    if not LIST.fullmatch(text):
        raise ValueError(f"ids is {brief(text)}, must be a list such as 0,3,7-9")
    ids: List[int] = []
    for part in text.split(","):
        ends = [int(number) for number in part.split("-")]
        first, last = ends[0], ends[-1]
        if first > last:
            raise ValueError(
                f"ids is {brief(text)}, must have the lower id of {part.strip()} first"
            )
        require_id(last, family)  # before a mistyped number becomes a huge list
        ids += range(first, last + 1)
    return ids


def require_id(id: int, family: str) -> None:
    """Raises ValueError if the family has no tag with this id."""
    ids = tag_family(family).ids
    if not 0 <= id < ids:
        raise ValueError(f"id is {id}, {family} has 0 to {ids - 1}")
