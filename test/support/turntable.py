"""A turntable with tags around an object, and a depth camera that looks at it, by exact rays."""

from typing import Dict, List, NamedTuple, Tuple

import cv2
import numpy as np

from robot_vision import Bundle, BundleTag, CameraModel, tag_cells, tag_family
from robot_vision.meshes import Mesh, MeshRenderer, render_meshes
from robot_vision.tags.bundle_files import write_bundles

FAMILY = "tag36h11"
TAG = 0.05  # m, side
RING = 0.17  # m, from the middle of the plate to the middles of tags
SIDE = 0.44  # m, of the plate
TEXEL = 0.0004  # m
COUNT = 8  # tags
FIRST = 20  # the id of the first one, whose frame is the bundle's
NOISE = 0.001  # m, standard deviation of depths
FAR = 1.8  # m, of what is behind the plate; beyond the reach of its depths
LENS = (0.05, -0.1, 0.001, -0.001)
CAMERA = CameraModel(640, 480, [560.0, 0.0, 322.3, 0.0, 560.0, 238.4, 0.0, 0.0, 1.0], LENS)


class Frame(NamedTuple):
    """What the camera sees: BGR, depths in mm, where the object is, and the plate's true pose."""

    image: np.ndarray
    depth: np.ndarray
    mask: np.ndarray
    pose: np.ndarray


def tag_poses() -> Dict[int, np.ndarray]:
    """The poses of the tags in the plate's frame: z up, the origin in its middle."""
    poses = {}
    for index in range(COUNT):
        angle = 2.0 * np.pi * index / COUNT
        pose = np.eye(4)
        pose[:3, :3] = cv2.Rodrigues(np.array([0.0, 0.0, angle + 0.3]))[0]
        pose[:2, 3] = RING * np.cos(angle), RING * np.sin(angle)
        poses[FIRST + index] = pose
    return poses


def bundle() -> Bundle:
    """The tags in the frame of the first one."""
    poses = tag_poses()
    to_first = np.linalg.inv(poses[FIRST])
    tags = [BundleTag(number, TAG, to_first @ pose, 0.0, 0.0) for number, pose in poses.items()]
    return Bundle("plate", tags)


def write_bundle(path) -> str:
    write_bundles(str(path), [bundle()], FAMILY)
    return str(path)


def plate_frame() -> np.ndarray:
    """The frame that observations are in, in the plate's: its x axis is that of the first tag."""
    frame = np.eye(4)
    frame[:3, :3] = tag_poses()[FIRST][:3, :3]
    return frame


def _plate() -> Mesh:
    pixels = round(SIDE / TEXEL)
    paper = np.full((pixels, pixels), 230, np.uint8)
    facts = tag_family(FAMILY)
    for number, pose in tag_poses().items():
        cells = tag_cells(FAMILY, number)
        scale = 32
        large = np.kron(cells, np.ones((scale, scale), np.uint8))
        margin = scale * (facts.width - facts.width_at_border) / 2.0
        near, far = margin - 0.5, margin + scale * facts.width_at_border - 0.5
        own = np.array([[near, far], [far, far], [far, near], [near, near]], np.float32)
        square = TAG * np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
        places = square @ pose[:2, :2].T + pose[:2, 3]
        to = np.column_stack([places[:, 0] + SIDE / 2.0, SIDE / 2.0 - places[:, 1]]) / TEXEL - 0.5
        turn = cv2.getPerspectiveTransform(own, to.astype(np.float32))
        size = (pixels, pixels)
        layers = [
            cv2.warpPerspective(layer, turn, size, flags=cv2.INTER_AREA)
            for layer in (large.astype(np.float32), np.ones(large.shape, np.float32))
        ]
        inside = layers[1] > 0.999
        paper[inside] = np.clip(layers[0][inside] * 0.8 + 25.0, 0, 255)
    half = SIDE / 2.0
    corners = [(-half, -half, 0.0), (half, -half, 0.0), (half, half, 0.0), (-half, half, 0.0)]
    return Mesh(
        np.array(corners),
        np.array([(0, 1, 2), (0, 2, 3)]),
        texture_coordinates=np.array([(0, 1), (1, 1), (1, 0), (0, 0)]),
        textures=[cv2.cvtColor(paper, cv2.COLOR_GRAY2BGR)],
        triangle_textures=np.zeros(2, int),
    )


class Turntable:
    """An object that stands on the plate: its frame is the plate's.

    Args:
        mesh: The object, whose lowest points have z 0.
        seed: Of the noise.
    """

    def __init__(self, mesh: Mesh, seed: int = 1) -> None:
        self._renderers = [MeshRenderer(_plate()), MeshRenderer(mesh)]
        self._rng = np.random.RandomState(seed)

    def frame(self, angle: float, elevation: float = 0.7, distance: float = 0.65) -> Frame:
        """What is seen when the plate has turned by `angle` (rad), from above by `elevation`."""
        pose = self.pose(angle, elevation, distance)
        region = (0, 0, CAMERA.width, CAMERA.height)
        view = render_meshes(self._renderers, [pose, pose], CAMERA, region, bgr=True, ids=True)
        seen = np.isfinite(view.depth)
        image = np.where(seen[..., None], view.bgr, 90).astype(float)
        image = cv2.GaussianBlur(image, (0, 0), 0.6) + self._rng.normal(0.0, 2.0, image.shape)
        depth = np.where(seen, view.depth, FAR) + self._rng.normal(0.0, NOISE, seen.shape)
        depth[~seen] = 0.0
        millimetres = np.rint(1000.0 * depth).astype(np.uint16)
        return Frame(np.clip(image, 0, 255).astype(np.uint8), millimetres, view.ids == 2, pose)

    def pose(self, angle: float, elevation: float, distance: float) -> np.ndarray:
        """The plate in the camera's optical frame."""
        place = distance * np.array([np.cos(elevation), 0.0, np.sin(elevation)])
        away = -place / distance
        right = np.array([0.0, 1.0, 0.0])
        looks = np.column_stack([right, np.cross(away, right), away])  # the camera's axes
        pose = np.eye(4)
        pose[:3, :3] = looks.T @ cv2.Rodrigues(np.array([0.0, 0.0, angle]))[0]
        pose[:3, 3] = -looks.T @ (place - [0.0, 0.0, 0.04])
        return pose

    def turn(self, count: int, elevation: float = 0.7) -> List[Frame]:
        """Frames of a whole turn."""
        return [self.frame(2.0 * np.pi * one / count, elevation) for one in range(count)]


def write_frames(folder, frames) -> str:
    """Writes frames as object_capture.py reads them."""
    from robot_vision.calibration.camera_file import camera_yaml

    (folder / "rgb").mkdir(parents=True)
    (folder / "depth").mkdir()
    for number, frame in enumerate(frames):
        cv2.imwrite(str(folder / "rgb" / f"{number:04d}.png"), frame.image)
        cv2.imwrite(str(folder / "depth" / f"{number:04d}.png"), frame.depth)
    projection = np.column_stack([np.asarray(CAMERA.K), np.zeros(3)])
    text = camera_yaml(CAMERA, np.eye(3), projection, "camera")
    (folder / "camera.yaml").write_text(text)
    return str(folder)


def overlap(one: np.ndarray, other: np.ndarray) -> Tuple[float, float]:
    """The share of two masks that both have, and the pixels of the second."""
    one, other = one > 0, other > 0
    return float((one & other).sum() / max((one | other).sum(), 1)), float(other.sum())
