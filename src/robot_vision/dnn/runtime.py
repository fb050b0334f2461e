"""What all runtimes of networks have in common."""

import contextlib
import os
from typing import Iterator, List, Sequence, Set

import numpy as np

from ..common.plain_text import printable
from .network_input import NetworkInput

MAX_REASON = 300  # letters


class NetworkError(RuntimeError):
    """A network that had been read, and tried, threw when it was run."""


class Runtime:
    """A network that can be run. It belongs to one thread at a time.

    Args:
        network_input: What the network takes.
        affinity: The processors that it may run on; empty: any. The thread that calls run() stays
            on them from then on.
    """

    name = ""
    converts = False  # whether it takes 32 bits for any type of input
    output_names: Sequence[str] = ()  # in the order in which run() returns the outputs

    def __init__(self, network_input: NetworkInput, affinity: Sequence[int] = ()):
        self._input = network_input
        self._affinity = set(affinity)

    def run(self, values: np.ndarray) -> List[np.ndarray]:
        """Returns the outputs of the network, all float32, in the order of output_names.

        Args:
            values: The input, float32, of the network's shape.

        Raises:
            ValueError: The input has another shape or type.
            NetworkError: The runtime threw.
        """
        if values.shape != self._input.shape or values.dtype != np.float32:
            raise ValueError(
                f"the input is {values.dtype} of shape {values.shape}, must be float32 of shape "
                f"{self._input.shape}"
            )
        if self._affinity:
            os.sched_setaffinity(0, self._affinity)
        if self._input.type == "uint8":
            values = values.clip(0.0, 255.0).round()
        try:
            kind = "float32" if self.converts else self._input.type
            outputs = self._forward(values.astype(kind, copy=False))
            # What is text, or a list of anything, raises what it likes as well.
            return [np.ascontiguousarray(one, np.float32) for one in outputs]
        except Exception as error:  # each runtime has its own
            raise NetworkError(f"{self.name} failed: {reason_of(error)}") from error

    def _forward(self, values: np.ndarray) -> Sequence[np.ndarray]:
        raise NotImplementedError

    def flop(self) -> int:
        """Returns the floating point operations of a run as the runtime counts them; 0: unknown."""
        return 0


@contextlib.contextmanager
def on_processors(processors: Set[int]) -> Iterator[None]:
    """Keeps this thread, and those that it starts, on these processors; none: where they are.

    Afterwards this thread may run where it did before, whatever has been done meanwhile.
    """
    before = os.sched_getaffinity(0)
    try:
        if processors:
            os.sched_setaffinity(0, processors)
        yield
    finally:
        os.sched_setaffinity(0, before)


def reason_of(error: Exception) -> str:
    """Returns what a runtime's exception says, in one line."""
    text = getattr(error, "err", "") or str(error)
    return printable(" ".join(text.split()), MAX_REASON) or type(error).__name__
