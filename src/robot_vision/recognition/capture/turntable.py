"""What of a frame is an object that stands on a turntable with tags."""

import collections
from typing import Dict, List, NamedTuple, Optional

import numpy as np

from ... import CameraModel, TagDetector, TagDetectorParams, TagPoseParams
from ...common import opencv as cv2
from ...tags.tag_layout import TagLayout
from ...tags.tag_poses import TagLocator
from ..straight_images import StraightImages

MM = 0.001  # m
MIN_PROBABILITY = 0.9  # that the pose of the tags is right
MIN_PIXELS = 400  # of an object with depth
MAX_ERROR = 2.0  # px, root mean square, of the corners of the tags


class Space(NamedTuple):
    """Where the object is: an upright cylinder on the tags.

    Attributes:
        x, y: m, the middle of the turntable in the frame of its tags.
        radius: m, of the cylinder.
        height: m, of its upper end.
        floor: m, of its lower end: below, depths may be those of the table.
    """

    x: float
    y: float
    radius: float
    height: float
    floor: float

    def holds(self, points: np.ndarray) -> np.ndarray:
        """Returns which points, (..., 3), m, in the frame of the tags, are in it."""
        across = np.hypot(points[..., 0] - self.x, points[..., 1] - self.y)
        return (
            (across < self.radius) & (points[..., 2] > self.floor) & (points[..., 2] < self.height)
        )


class View(NamedTuple):
    """An object in an image without distortion.

    Attributes:
        bgr: (height, width, 3) uint8.
        depth: (height, width) float32, m; NaN: none.
        mask: (height, width) bool: where the object is, and has depth.
        matrix: (3, 3), K of the camera.
        pose: (4, 4), of the object's frame, that of the tags, in the camera's optical frame, m.
        points: (n, 3) float32, m, of the mask, in the object's frame.
    """

    bgr: np.ndarray
    depth: np.ndarray
    mask: np.ndarray
    matrix: np.ndarray
    pose: np.ndarray
    points: np.ndarray


class Turntable:
    """Keeps views of an object from directions that differ. For one thread at a time.

    Args:
        layout: The tags, with one bundle: z of its frame is up, and the object stands on z = 0.
        space: Where the object is.
        most: The largest number of views.
        angle: rad, least angle between two directions from which the object is kept.
    """

    def __init__(self, layout: TagLayout, space: Space, most: int, angle: float) -> None:
        params = TagDetectorParams()
        params.families = layout.families
        self._detector = TagDetector(params)
        self._locator = TagLocator(layout, TagPoseParams())
        self._space = space
        self._most = most
        self._least_cosine = float(np.cos(angle))
        self._straight: Optional[StraightImages] = None
        self._directions: List[np.ndarray] = []  # from the object to the camera, of length 1
        self._refused: Dict[str, int] = collections.Counter()
        self.views: List[View] = []
        self.offered = 0  # number of frames

    @property
    def full(self) -> bool:
        """Whether no more views are kept."""
        return len(self.views) >= self._most

    def add(
        self,
        bgr: np.ndarray,
        depth: np.ndarray,
        camera: CameraModel,
        depth_camera: Optional[CameraModel] = None,
    ) -> None:
        """Offers a frame.

        Args:
            bgr: (height, width, 3) uint8, as the camera has it.
            depth: uint16 in mm, or float32 in m, in the optical frame of the camera.
            camera: That of the image.
            depth_camera: That of the depth; None: that of the image.
        """
        self.offered += 1
        if self.full:
            return
        problem = self._keep(bgr, depth, camera, depth_camera)
        if problem:
            self._refused[problem] += 1

    def summary(self) -> str:
        """Returns what there is so far, and why other frames were of no use, in a line."""
        parts = [f"{len(self.views)} of {self._most} views, of {self.offered} frames"]
        parts += [f"{count}: {problem}" for problem, count in sorted(self._refused.items())]
        return "; ".join(parts)

    def _keep(
        self,
        bgr: np.ndarray,
        depth: np.ndarray,
        camera: CameraModel,
        depth_camera: Optional[CameraModel],
    ) -> str:
        """Keeps a view, or returns why not."""
        pose = self._pose(cv2.cvtColor(bgr, cv2.COLOR_BGR2GRAY), camera)
        if pose is None:
            return "the tags were not seen well enough"
        direction = _direction(pose, self._space)
        if any(direction @ other > self._least_cosine for other in self._directions):
            return "as those that are kept"
        if self._straight is None or self._straight.made_of != (camera, depth_camera):
            self._straight = StraightImages(camera, depth_camera)
        straight, depths = self._straight.apply(bgr, depth)
        view = _view(straight, metres(depths), self._straight.camera.K, pose, self._space)
        if len(view.points) < MIN_PIXELS:
            return f"less than {MIN_PIXELS} depths of an object on the turntable"
        self._directions.append(direction)
        self.views.append(view)
        return ""

    def _pose(self, gray: np.ndarray, camera: CameraModel) -> Optional[np.ndarray]:
        tags = self._detector.detect(gray, "mono8")
        _, bundles = self._locator.locate_at_once(tags, camera, gray)
        if not bundles or bundles[0].poses.probability < MIN_PROBABILITY:
            return None
        best = bundles[0].poses.best
        return np.asarray(best.pose) if best.error <= MAX_ERROR else None


def metres(depth: np.ndarray) -> np.ndarray:
    """Returns depths as float32 in m; NaN: none."""
    if depth.dtype == np.uint16:
        depth = np.where(depth > 0, depth, np.nan) * np.float32(MM)
    return np.asarray(depth, np.float32)


def _direction(pose: np.ndarray, space: Space) -> np.ndarray:
    """Returns the direction from the middle of a space to the camera, in the frame of the tags."""
    middle = np.array([space.x, space.y, 0.5 * (space.floor + space.height)])
    towards = -pose[:3, :3].T @ pose[:3, 3] - middle
    return towards / np.linalg.norm(towards)


def _view(
    bgr: np.ndarray, depth: np.ndarray, matrix: np.ndarray, pose: np.ndarray, space: Space
) -> View:
    matrix = np.asarray(matrix)
    rows, columns = np.indices(depth.shape, np.float32)
    rays = np.dstack(
        [
            (columns - matrix[0, 2]) / matrix[0, 0],
            (rows - matrix[1, 2]) / matrix[1, 1],
            np.ones_like(rows),
        ]
    )
    points = (rays * depth[..., None] - pose[:3, 3]) @ pose[:3, :3]
    with np.errstate(invalid="ignore"):
        mask = np.isfinite(depth) & space.holds(points)
    return View(bgr, depth, mask, matrix, pose, points[mask].astype(np.float32))
