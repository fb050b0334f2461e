"""Errors that say what they are about."""

import contextlib
from typing import Iterator


@contextlib.contextmanager
def about(subject: str) -> Iterator[None]:
    """Puts a subject in front of the message of a ValueError: "<subject>: <message>"."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{subject}: {error}") from None
