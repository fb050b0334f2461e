"""Boxes with labels all over, and images of them before things that are no less colorful."""

from typing import List, Sequence, Tuple

import cv2
import numpy as np

from robot_vision import CameraModel
from robot_vision.common.rotations import rotation_of
from robot_vision.meshes import Mesh, MeshRenderer, render_meshes

WIDTH, HEIGHT = 640, 480
CAMERA = CameraModel(WIDTH, HEIGHT, [525.0, 0.0, 319.5, 0.0, 525.0, 239.5, 0.0, 0.0, 1.0])
BACKGROUND = 1.6  # m
# The corners of the sides, counter-clockwise for who sees the outside.
SIDES = np.array(
    [
        [(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)],
        [(1, -1, -1), (-1, -1, -1), (-1, 1, -1), (1, 1, -1)],
        [(1, -1, 1), (1, -1, -1), (1, 1, -1), (1, 1, 1)],
        [(-1, -1, -1), (-1, -1, 1), (-1, 1, 1), (-1, 1, -1)],
        [(-1, 1, 1), (1, 1, 1), (1, 1, -1), (-1, 1, -1)],
        [(-1, -1, -1), (1, -1, -1), (1, -1, 1), (-1, -1, 1)],
    ]
)


def label(seed: int, size: int = 256) -> np.ndarray:
    """An image of shapes and letters, another one for each seed."""
    rng = np.random.RandomState(seed)
    image = np.full((size, size, 3), rng.randint(60, 220, 3), np.uint8)
    for _ in range(50):
        color = tuple(rng.randint(0, 256, 3).tolist())
        place, kind = rng.randint(0, size, 2), rng.randint(4)
        at, to = tuple(place.tolist()), tuple((place + rng.randint(5, 50, 2)).tolist())
        if kind == 0:
            cv2.circle(image, at, int(rng.randint(4, 30)), color, -1)
        elif kind == 1:
            cv2.rectangle(image, at, to, color, -1)
        elif kind == 2:
            cv2.line(image, at, tuple(rng.randint(0, size, 2).tolist()), color, rng.randint(1, 4))
        else:
            text = "".join(map(chr, rng.randint(65, 91, 5)))
            cv2.putText(image, text, at, cv2.FONT_HERSHEY_SIMPLEX, rng.uniform(0.4, 1.2), color, 2)
    return cv2.GaussianBlur(image, (3, 3), 0.8)


def box(size: Sequence[float], seed: int, plain: bool = False) -> Mesh:
    """A box with sides of `size` (m) around its origin, and a label on each unless it is plain."""
    corners = SIDES.reshape(-1, 3) * np.asarray(size) / 2.0
    firsts = 4 * np.arange(6)[:, None]
    halves = np.array([[0, 1, 2]]), np.array([[0, 2, 3]])
    triangles = np.concatenate([firsts + half for half in halves])
    if plain:
        return Mesh(corners, triangles)
    coordinates = np.tile([(0, 1), (1, 1), (1, 0), (0, 0)], (6, 1))
    labels = [label(10 * seed + side) for side in range(6)]
    return Mesh(
        corners,
        triangles,
        texture_coordinates=coordinates,
        textures=labels,
        triangle_textures=np.tile(np.arange(6), 2),
    )


def pose_at(rng: np.random.RandomState, place: Sequence[float]) -> np.ndarray:
    """A pose at a place (m) in the optical frame, turned by chance."""
    pose = np.eye(4)
    quaternion = rng.normal(size=4)
    pose[:3, :3] = rotation_of(quaternion / np.linalg.norm(quaternion))
    pose[:3, 3] = place
    return pose


def scene(
    rng: np.random.RandomState, renderers: List[MeshRenderer], poses: List[np.ndarray]
) -> Tuple[np.ndarray, np.ndarray]:
    """What the camera sees, with noise: BGR, and depths in m as of a good depth camera."""
    image = cv2.resize(label(rng.randint(1 << 20), 512), (WIDTH, HEIGHT))
    depth = np.full((HEIGHT, WIDTH), BACKGROUND)
    for _ in range(3):
        x, y = rng.randint(0, WIDTH - 128), rng.randint(0, HEIGHT - 128)
        image[y : y + 128, x : x + 128] = label(rng.randint(1 << 20), 128)
    if renderers:
        view = render_meshes(renderers, poses, CAMERA, (0, 0, WIDTH, HEIGHT), bgr=True)
        seen = np.isfinite(view.depth)
        image[seen], depth[seen] = view.bgr[seen], view.depth[seen]
    noisy = np.clip(image + rng.normal(0.0, 4.0, image.shape), 0, 255).astype(np.uint8)
    return noisy, (depth + rng.normal(0.0, 0.0015, depth.shape)).astype(np.float32)


def pose_error(found: np.ndarray, truth: np.ndarray) -> Tuple[float, float]:
    """How far a pose is from the truth: mm, and degrees."""
    turn = cv2.Rodrigues(found[:3, :3] @ truth[:3, :3].T)[0]
    shift = np.linalg.norm(found[:3, 3] - truth[:3, 3])
    return 1000.0 * float(shift), float(np.degrees(np.linalg.norm(turn)))
