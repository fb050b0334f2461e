"""The methods that learn objects, by their names."""

from typing import Any, Dict, Mapping, Optional, Protocol, runtime_checkable

from ..common.plain_text import printable
from .database import Mesh
from .observed_views import ObservationSource


class Trainer(Protocol):
    """A training that can be interrupted between two steps.

    Attributes:
        done: How many views it has learned.
        total: How many there are.
    """

    done: int
    total: int

    def step(self) -> None:
        """Learns some more views, in some tenths of a second."""

    def state(self) -> bytes:
        """What it has learned so far: a trainer that begins with it ends with the same bytes."""

    def model(self) -> bytes:
        """What it has learned, when all is done."""


class Method(Protocol):
    """A method that learns objects.

    Attributes:
        name: As LINEMOD.
        version: Another one after each change by which the same mesh gives other bytes.
        parameters: The names of its parameters.
    """

    name: str
    version: int
    parameters: Mapping[str, Any]

    def complete(self, given: Mapping[str, Any]) -> Dict[str, Any]:
        """All parameters: those given, and the defaults of the others.

        Raises:
            ValueError: One of them cannot be.
        """

    def trainer(self, mesh: Mesh, parameters: Mapping[str, Any], state: Optional[bytes]) -> Trainer:
        """A training of a mesh, from the beginning, or from what an earlier one has done.

        Raises:
            ValueError: The mesh cannot be learned, or the state is damaged.
        """

    def check_model(self, data: bytes) -> None:
        """Raises ValueError unless this is what it has learned, and all of it."""


@runtime_checkable
class ObservingMethod(Protocol):
    """A method that learns objects by observations, too, and rather by them than by a mesh."""

    def trainer_of_observations(
        self, source: ObservationSource, parameters: Mapping[str, Any], state: Optional[bytes]
    ) -> Trainer:
        """A training of observations, as trainer() is of a mesh."""


_methods: Dict[str, Method] = {}


def register(method: Method) -> None:
    """Makes a method known by its name."""
    _methods[method.name] = method


def known_methods() -> str:
    """Returns the names of all methods that learn, between commas."""
    return ", ".join(sorted(_methods))


def method_of(name: str) -> Method:
    """Returns the method of this name.

    Raises:
        ValueError: There is none that learns.
    """
    if name not in _methods:
        raise ValueError(
            f"method is '{printable(name)}', must be one that learns: {known_methods()}"
        )
    return _methods[name]
