"""Frames of the package's sample meshes on a table, in many orders and turned in all directions."""

from typing import Any, List

import numpy as np

from robot_vision import Mesh, SceneParams, TabletopScene, sample_mesh, sample_mesh_names

from .frames import HEIGHT, RATE, WIDTH, Frame, frames_of

FEWEST = 4  # meshes on a table


def turned(mesh: Any, angle: float) -> Any:
    """A mesh after a turn by an angle (rad) about the vertical."""
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]],
        np.float32,
    )
    return Mesh(
        mesh.vertices @ turn.T,
        mesh.triangles,
        mesh.normals @ turn.T,
        mesh.colors,
        mesh.texture_coordinates,
        mesh.textures,
        mesh.triangle_textures,
        mesh.color,
    )


def table(rng: np.random.Generator) -> TabletopScene:
    """A table with some of the sample meshes, or all; where each stands follows from the order."""
    params = SceneParams()
    params.width, params.height, params.rate = WIDTH, HEIGHT, RATE
    params.seed, params.noise = int(rng.integers(2**31)), rng.uniform(0, 3)
    names = rng.permutation(sample_mesh_names())
    names = names[: int(rng.integers(FEWEST, len(names) + 1))]
    meshes = [(str(n), turned(sample_mesh(str(n)).mesh, rng.uniform(0, 2 * np.pi))) for n in names]
    return TabletopScene(params, meshes)


def table_album(seed: int, scenes: int, frames: int, held_out: bool) -> List[Frame]:
    """Frames of different tables."""
    result: List[Frame] = []
    for number in range(scenes):
        rng = np.random.default_rng([seed, number, 1])
        result.extend(frames_of(table(rng), frames, held_out, rng))
    return result
