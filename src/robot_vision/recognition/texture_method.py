"""The method TOD, which learns the texture of objects, by meshes or by what cameras have seen."""

import itertools
import time
from typing import Any, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from .. import (
    DepthErrorParams,
    Mesh,
    TextureMatcher,
    TextureMatchParams,
    TextureModel,
    TextureParams,
    TextureTrainer,
    TextureViews,
)
from ..meshes import mesh_extent
from .core_method import CoreMethod, with_models
from .database import Mesh as StoredMesh
from .mesh_data import unpack_mesh
from .methods import register
from .observed_views import ObservationSource, extent_of, seen_by

# The sides of a box whose corners differ in z first, counter-clockwise for who sees the outside.
QUADS = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
BOX = np.array([corners for a, b, c, d in QUADS for corners in ((a, b, c), (a, c, d))])
STEP = 0.2  # s, about as long as a step of a training takes
MAX_OBSERVATIONS = 300  # that are learned of an object, those that are spread best


class _Training:
    """What trainings by meshes and by observations have in common.

    Args:
        trainer: That of the core.
        total: How many views there are.
    """

    def __init__(self, trainer: TextureTrainer, total: int) -> None:
        self._trainer = trainer
        self.total = total
        if trainer.views > total:
            raise ValueError(f"there are {trainer.views} views in it, must be {total} at most")

    @property
    def done(self) -> int:
        """How many views it has learned."""
        return self._trainer.views

    def step(self) -> None:
        """Learns some more views."""
        end = time.monotonic() + STEP
        while self.done < self.total and time.monotonic() < end:
            self._learn(self.done)

    def state(self) -> bytes:
        """What it has learned so far."""
        return self._trainer.state().to_bytes()

    def model(self) -> bytes:
        """What it has learned."""
        return self._trainer.model().to_bytes()

    def _learn(self, view: int) -> None:
        raise NotImplementedError


class MeshTexture(_Training):
    """Learns the texture of a mesh."""

    def __init__(self, stored: StoredMesh, params: TextureParams, state: Optional[bytes]) -> None:
        mesh = unpack_mesh(stored.converted)
        self._views = TextureViews(mesh, params)
        extent = mesh_extent(mesh)
        super().__init__(_trainer(params, extent.center, extent.size, state), len(self._views))

    def _learn(self, view: int) -> None:
        self._trainer.add_of(self._views, view)


class SeenTexture(_Training):
    """Learns the texture that was seen in observations."""

    def __init__(
        self, source: ObservationSource, params: TextureParams, state: Optional[bytes]
    ) -> None:
        self._source = source
        self._chosen = source.spread(MAX_OBSERVATIONS)
        center, size = np.zeros(3), np.ones(3)
        if not state:
            center, size = extent_of(source.of(one) for one in self._chosen)
        super().__init__(_trainer(params, center, size, state), len(self._chosen))

    def _learn(self, view: int) -> None:
        seen = seen_by(self._source.of(self._chosen[view]))
        self._trainer.add(seen.image, seen.depth, seen.mask, seen.camera, seen.pose)


def _trainer(
    params: TextureParams, center: Sequence[float], size: Sequence[float], state: Optional[bytes]
) -> TextureTrainer:
    if not state:
        return TextureTrainer(params, center, size)
    model = TextureModel.from_bytes(state)
    if model.params != params:
        raise ValueError("it is of other parameters")
    return TextureTrainer(model)


class _TextureMethod(CoreMethod):
    name = "TOD"
    kind = TextureParams
    model = TextureModel
    matcher = TextureMatcher

    def trainer(
        self, mesh: StoredMesh, parameters: Mapping[str, Any], state: Optional[bytes]
    ) -> MeshTexture:
        return MeshTexture(mesh, self.params_of(parameters), state)

    def trainer_of_observations(
        self, source: ObservationSource, parameters: Mapping[str, Any], state: Optional[bytes]
    ) -> SeenTexture:
        return SeenTexture(source, self.params_of(parameters), state)


TEXTURES = _TextureMethod()
register(TEXTURES)


def texture_matcher(
    models: Sequence[Tuple[int, bytes]], params: TextureMatchParams, errors: DepthErrorParams
) -> Tuple[TextureMatcher, List[int]]:
    """Returns a matcher of textures, and the numbers of its models.

    Args:
        models: What was learned, each with its number.
        params: The parameters of the matcher.
        errors: The errors of the depths.

    Raises:
        ValueError: A model is damaged.
    """
    return with_models(TextureMatcher(params, errors), TextureModel, models)


def box_around(models: Mapping[str, bytes]) -> Mesh:
    """Returns a box around an object that has no mesh, by what was learned of its texture.

    Raises:
        ValueError: It was learned by no method that does without a mesh, or the model is damaged.
    """
    if TEXTURES.name not in models:
        raise ValueError("it has no mesh")
    extent = TextureModel.from_bytes(models[TEXTURES.name]).extent
    signs = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
    corners = np.asarray(extent.center) + signs * np.asarray(extent.size)
    return Mesh(corners, BOX)
