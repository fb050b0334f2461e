"""Text of others for people: on the overlay, whose letters are those of ASCII, and in logs."""

import unicodedata
from typing import Any

LONGEST_NAME = 255  # letters
NAME = f"a name of 1 to {LONGEST_NAME} printable letters"


def printable(text: str, length: int = 100) -> str:
    """What somebody else has sent, as a part of one line: what is no letter or sign is escaped.

    So it ends no line and tells no terminal what to do; what is longer ends in "...".
    """
    line = "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode()
        for letter in text[: length + 1]
    )
    return line[: length - 3] + "..." if len(line) > length else line


def is_name(text: str) -> bool:
    """Whether it can be a frame's, node's or the like, that all of ROS can show in a line."""
    return 0 < len(text) <= LONGEST_NAME and text.isprintable()


def plain(text: str, length: int = 100) -> str:
    """A line of at most `length` letters: without accents, and ? for what has no plain letter."""
    letters = unicodedata.normalize("NFKD", text[:length])
    letters = "".join(letter for letter in letters if not unicodedata.combining(letter))
    line = "".join(letter if " " <= letter <= "~" else "?" for letter in letters)
    return line[: length - 3] + "..." if max(len(text), len(line)) > length else line


def told(value: Any, length: int = 100) -> str:
    """A value as its source code, for an error; at most `length` letters of it."""
    text = repr(value)
    return text if len(text) <= length else text[: length - 3] + "..."
