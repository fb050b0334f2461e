"""What a command says of its work while it goes on."""


class Progress:
    """Prints a line at once, unless it is the one that was printed last."""

    def __init__(self) -> None:
        self._last = ""

    def tell(self, line: str) -> None:
        if line != self._last:
            print(line, flush=True)
        self._last = line
