"""Progress messages of a command."""


class Progress:
    """Prints lines at once, but not the same line twice in a row."""

    def __init__(self) -> None:
        self._last = ""

    def tell(self, line: str) -> None:
        if line != self._last:
            print(line, flush=True)
        self._last = line
