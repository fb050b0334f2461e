"""Shared by the tests of stereo: pairs of images whose disparities are known exactly."""

from typing import NamedTuple, Tuple

import numpy as np

WIDTH, HEIGHT = 200, 120
WAVES = 60


class Plane(NamedTuple):
    """Disparities of the left image's pixels: px at its top left, and how they grow, px per px."""

    at_origin: float
    along_x: float = 0.0
    along_y: float = 0.0

    def disparity(self) -> np.ndarray:
        y, x = np.mgrid[:HEIGHT, :WIDTH]
        return self.at_origin + self.along_x * x + self.along_y * y


def texture(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Gray levels, uint8, at any places: a sum of waves, so that nothing is interpolated."""
    rng = np.random.default_rng(5)
    lengths, angles, phases = (rng.uniform(*ends, WAVES) for ends in ((5, 25), (0, 7), (0, 7)))
    level = np.zeros(np.broadcast(x, y).shape)
    for length, angle, phase in zip(lengths, angles, phases):
        along = np.cos(angle) * x + np.sin(angle) * y
        level += np.cos(2.0 * np.pi * along / length + phase)
    return np.clip(np.rint(128 + 8 * level), 0, 255).astype(np.uint8)


def pair_of(plane: Plane) -> Tuple[np.ndarray, np.ndarray]:
    """The left and the right image, gray, of a textured plane."""
    y, x = np.mgrid[:HEIGHT, :WIDTH].astype(float)
    # What the right camera sees at x the left one sees at x + disparity there.
    seen = (x + plane.at_origin + plane.along_y * y) / (1.0 - plane.along_x)
    return texture(x, y), texture(seen, y)
