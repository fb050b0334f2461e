"""Text for the overlay, whose letters are those of ASCII."""

import unicodedata


def plain(text: str, length: int = 100) -> str:
    """A line of at most `length` letters: without accents, and ? for what has no plain letter."""
    letters = unicodedata.normalize("NFKD", text[:length])
    letters = "".join(letter for letter in letters if not unicodedata.combining(letter))
    line = "".join(letter if " " <= letter <= "~" else "?" for letter in letters)
    return line[: length - 3] + "..." if max(len(text), len(line)) > length else line
