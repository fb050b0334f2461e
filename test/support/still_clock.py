"""A clock that stands still until a test moves it."""


class StillClock:
    """Takes the place of the module `time` in a module under test.

    Attributes:
        now: s, which the test changes.
    """

    def __init__(self) -> None:
        self.now = 1000.0

    def monotonic(self) -> float:
        return self.now
