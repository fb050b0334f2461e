"""Text from outside made safe for people: in logs, and in overlays, whose font has only ASCII."""

import unicodedata
from typing import Any

MAX_NAME_LENGTH = 255  # letters
NAME = f"a name of 1 to {MAX_NAME_LENGTH} printable letters"


def printable(text: str, length: int = 100) -> str:
    """Returns text from outside as a part of one line, with unprintable characters escaped.

    So it can neither end a line nor control a terminal. Longer text is cut and ends in "...".
    """
    line = "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode()
        for letter in text[: length + 1]
    )
    return line[: length - 3] + "..." if len(line) > length else line


def error_text(error: Exception, length: int = 1000) -> str:
    """Returns what an error says as a part of one line; of one that says nothing its type.

    The length is enough for the path that an error may name.
    """
    return printable(str(error), length) or type(error).__name__


def is_name(text: str) -> bool:
    """Returns whether the text can name a frame or a node that all tools of ROS can show."""
    return 0 < len(text) <= MAX_NAME_LENGTH and text.isprintable()


def to_ascii(text: str, length: int = 100) -> str:
    """Returns at most `length` ASCII characters: accents are dropped, other letters become "?"."""
    letters = unicodedata.normalize("NFKD", text[:length])
    letters = "".join(letter for letter in letters if not unicodedata.combining(letter))
    line = "".join(letter if " " <= letter <= "~" else "?" for letter in letters)
    return line[: length - 3] + "..." if max(len(text), len(line)) > length else line


def brief(value: Any, length: int = 100) -> str:
    """Returns the source code of a value for an error message, cut to `length` characters."""
    text = repr(value)
    return text if len(text) <= length else text[: length - 3] + "..."
