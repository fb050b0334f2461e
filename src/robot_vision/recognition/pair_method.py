"""The method PPF, which learns pairs of points of the surfaces of objects."""

from typing import Any, List, Mapping, Optional, Sequence, Tuple

from .. import (
    PointPairMatcher,
    PointPairMatchParams,
    PointPairModel,
    PointPairParams,
    train_point_pairs,
)
from .core_method import CoreMethod, with_models
from .database import Mesh
from .mesh_data import unpack_mesh
from .methods import register


class PairTraining:
    """Learns the points of a mesh, at once."""

    total = 1

    def __init__(self, stored: Mesh, params: PointPairParams) -> None:
        self._mesh = unpack_mesh(stored.converted)
        self._params = params
        self._model: Optional[PointPairModel] = None

    @property
    def done(self) -> int:
        """1 when all is learned."""
        return int(self._model is not None)

    def step(self) -> None:
        """Learns all of it."""
        self._model = train_point_pairs(self._mesh, self._params)

    def state(self) -> bytes:
        """Nothing: it begins anew."""
        return b""

    def model(self) -> bytes:
        """What it has learned."""
        return self._model.to_bytes()


class _PairMethod(CoreMethod):
    name = "PPF"
    kind = PointPairParams
    model = PointPairModel
    matcher = PointPairMatcher

    def trainer(
        self, mesh: Mesh, parameters: Mapping[str, Any], _state: Optional[bytes]
    ) -> PairTraining:
        return PairTraining(mesh, self.params_of(parameters))


PAIRS = _PairMethod()
register(PAIRS)


def pair_matcher(
    models: Sequence[Tuple[int, bytes]], params: PointPairMatchParams
) -> Tuple[PointPairMatcher, List[int]]:
    """Returns a matcher of pairs of points, and the numbers of its models.

    Args:
        models: What was learned, each with its number.
        params: The parameters of the matcher.

    Raises:
        ValueError: A model is damaged.
    """
    return with_models(PointPairMatcher(params), PointPairModel, models)
