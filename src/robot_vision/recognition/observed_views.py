"""Observations of an object in the database, as what a camera has seen."""

from typing import Iterable, List, NamedTuple, Tuple

import numpy as np

from .. import CameraModel
from ..common import opencv as cv2
from ..common.errors import about
from ..common.image_files import sensor_pixels
from .database import Database, Observation

SHARE_OUTSIDE = 0.005  # of the points along each axis, that are taken for errors of the depths
MARGIN = 1.05  # times the size that the others have
MAX_POINTS = 20000  # of an observation, that are looked at
MM = 0.001  # m


class Seen(NamedTuple):
    """An observation, decoded.

    Attributes:
        image: (height, width, 3) uint8, BGR.
        depth: (height, width) uint16, mm; 0: none.
        mask: (height, width) uint8, 255 where the object is.
        camera: Its camera.
        pose: (4, 4), of the object's frame in the camera's optical frame, m.
    """

    image: np.ndarray
    depth: np.ndarray
    mask: np.ndarray
    camera: CameraModel
    pose: np.ndarray


class ObservationSource:
    """The observations of an object, which are read one at a time.

    Args:
        database: The database.
        object_id: The object.
    """

    def __init__(self, database: Database, object_id: str) -> None:
        self._observations = database.observations
        self._poses = self._observations.poses(object_id)

    def spread(self, count: int) -> List[str]:
        """Returns the ids of so many of them, at most, whose directions are far from each other."""
        ids = [one for one, _ in self._poses]
        if len(ids) <= count:
            return ids
        places = np.array([-pose[:3, :3].T @ pose[:3, 3] for _, pose in self._poses])
        directions = places / np.maximum(np.linalg.norm(places, axis=1), 1e-9)[:, None]
        chosen = [0]
        nearest = directions @ directions[0]  # cosines of the angle to the nearest one chosen
        while len(chosen) < count:
            chosen.append(int(np.argmin(nearest)))
            nearest = np.maximum(nearest, directions @ directions[chosen[-1]])
            nearest[chosen] = np.inf
        return [ids[index] for index in sorted(chosen)]

    def of(self, number: str) -> Observation:
        """Returns an observation by its id.

        Raises:
            ValueError: It is not there any more, or is damaged.
        """
        return self._observations.one(number)


def seen_by(observation: Observation) -> Seen:
    """Decodes an observation.

    Raises:
        ValueError: It has no images that belong together.
    """
    with about(f"observation {observation.id[:8]}"):
        image = sensor_pixels(observation.rgb)
        depth = sensor_pixels(observation.depth, cv2.IMREAD_UNCHANGED)
        mask = sensor_pixels(observation.mask, cv2.IMREAD_GRAYSCALE)
        size = image.shape[:2]
        if depth.dtype != np.uint16 or depth.shape != size or mask.shape != size:
            raise ValueError("its depth must have 16 bits, and all its images the same size")
        lens = list(observation.distortion)
        camera = CameraModel(size[1], size[0], observation.matrix, lens)
        return Seen(image, depth, (mask > 0) * np.uint8(255), camera, observation.pose)


def points_of(seen: Seen) -> np.ndarray:
    """Returns points of the object that are seen, (n, 3), m, in its frame."""
    rows, columns = np.nonzero((seen.mask > 0) & (seen.depth > 0))
    step = max(len(rows) // MAX_POINTS, 1)
    rows, columns = rows[::step], columns[::step]
    depths = MM * seen.depth[rows, columns].astype(float)
    rays = seen.camera.rays(np.column_stack([columns, rows]).astype(float))
    points = depths[:, None] * np.column_stack([rays, np.ones(len(rays))])
    points = points[np.isfinite(points).all(axis=1)]
    return (points - seen.pose[:3, 3]) @ seen.pose[:3, :3]


def extent_of(observations: Iterable[Observation]) -> Tuple[np.ndarray, np.ndarray]:
    """Returns the center and the size, m, of the box around the object, along its frame's axes.

    Raises:
        ValueError: Nothing of it is seen, or an observation is damaged.
    """
    found = [points_of(seen_by(one)) for one in observations]
    points = np.concatenate([np.zeros((0, 3)), *found])
    if not len(points):
        raise ValueError("no depth of the object is in its observations")
    low, high = np.quantile(points, [SHARE_OUTSIDE, 1.0 - SHARE_OUTSIDE], axis=0)
    return (low + high) / 2.0, MARGIN * np.maximum(high - low, 1e-4)
