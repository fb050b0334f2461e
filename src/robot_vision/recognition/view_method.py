"""The method LINEMOD, which learns how objects look from all sides."""

import time
from typing import Any, List, Mapping, Optional, Sequence, Tuple

from .. import ObjectMatcher, ObjectMatchParams, ViewModel, ViewParams, ViewTrainer
from .core_method import CoreMethod, with_models
from .database import Mesh
from .mesh_data import unpack_mesh
from .methods import register

STEP = 0.2  # s, about as long as a step of a training takes


class ViewTraining:
    """Learns how a mesh looks from all sides."""

    def __init__(self, stored: Mesh, params: ViewParams, state: Optional[bytes]) -> None:
        symmetries = [(tuple(one.axis), one.fold) for one in stored.symmetries]
        self._trainer = ViewTrainer(unpack_mesh(stored.converted), params, symmetries)
        self._model = ViewModel.from_bytes(state) if state else self._trainer.untrained()

    @property
    def done(self) -> int:
        """How many views it has learned."""
        return self._model.views

    @property
    def total(self) -> int:
        """How many there are."""
        return self._model.all_views

    def step(self) -> None:
        """Learns some more views."""
        end = time.monotonic() + STEP
        self._trainer.train(self._model, progress=lambda *_: time.monotonic() < end)

    def state(self) -> bytes:
        """What it has learned so far."""
        return self._model.to_bytes()

    def model(self) -> bytes:
        """What it has learned."""
        return self._model.to_bytes()


class _ViewMethod(CoreMethod):
    name = "LINEMOD"
    kind = ViewParams
    model = ViewModel
    matcher = ObjectMatcher

    def trainer(
        self, mesh: Mesh, parameters: Mapping[str, Any], state: Optional[bytes]
    ) -> ViewTraining:
        return ViewTraining(mesh, self.params_of(parameters), state)


VIEWS = _ViewMethod()
register(VIEWS)


def view_matcher(
    models: Sequence[Tuple[int, bytes]], params: ObjectMatchParams
) -> Tuple[ObjectMatcher, List[int]]:
    """Returns a matcher of views, and the numbers of its models.

    Args:
        models: What was learned, each with its number.
        params: The parameters of the matcher.

    Raises:
        ValueError: A model is damaged.
    """
    return with_models(ObjectMatcher(params), ViewModel, models)
