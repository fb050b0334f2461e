"""Bundle adjustment: finds the layout of a bundle and all its poses that fit all corners best."""

from typing import NamedTuple, Tuple

import cv2
import numpy as np
from scipy.optimize import least_squares
from scipy.sparse import csr_matrix, identity
from scipy.sparse.linalg import splu

from .._core import CameraModel

OUTLIER_SCALE = 1.0  # px, residual above which the weight of a corner falls
BEHIND_CAMERA = 1000.0  # px, residual of corners that would be behind the camera
# px^2 / m^2 or px^2 / rad^2: this information is added, so that unobserved poses can be solved.
PRIOR_INFORMATION = 1e-6
MIN_INFORMATION = 1e-9  # on a tag, relative to that for known poses; less is a rounding error


class Observations(NamedTuple):
    """Observations of tags in frames, in any order."""

    frames: np.ndarray  # (m,), index of the frame
    tags: np.ndarray  # (m,), index of the tag; 0 is the master
    points: np.ndarray  # (m, 4, 3) m, corners in the tag's frame
    pixels: np.ndarray  # (m, 4, 2) px

    def where(self, chosen: np.ndarray) -> "Observations":
        """Returns the observations for which (m,) booleans are true."""
        return Observations(*(values[chosen] for values in self))


def adjust(
    observations: Observations, camera: CameraModel, layout: np.ndarray, poses: np.ndarray
) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Finds the layout and the poses that explain the corners best.

    It solves a robust nonlinear least squares problem of the distances in the image; see Triggs,
    McLauchlan, Hartley, Fitzgibbon: Bundle Adjustment, A Modern Synthesis, 1999.

    Args:
        observations: The observed tags.
        camera: The camera.
        layout: (n, 4, 4), a guess of the tags' poses in the master's frame; the first stays.
        poses: (f, 4, 4), a guess of the master's poses in the camera's frame.

    Returns:
        The layout, the poses, and the residuals, (m, 4, 2) px.
    """
    count = len(layout)

    def unpack(x: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        vectors = x.reshape(-1, 6)
        return np.vstack([np.zeros((1, 6)), vectors[: count - 1]]), vectors[count - 1 :]

    def residuals(x: np.ndarray) -> np.ndarray:
        pixels = _project(observations, camera, *unpack(x))[0]
        return np.nan_to_num(pixels - observations.pixels, nan=BEHIND_CAMERA)

    def jacobian(x: np.ndarray) -> csr_matrix:
        return _jacobian(observations, camera, *unpack(x))

    start = np.vstack([_to_vectors(layout[1:]), _to_vectors(poses)]).ravel()
    solution = least_squares(
        lambda x: residuals(x).ravel(),
        start,
        jacobian,
        x_scale="jac",
        loss="soft_l1",
        f_scale=OUTLIER_SCALE,
        max_nfev=100,
    )
    found, moved = (_to_matrices(vectors) for vectors in unpack(solution.x))
    return found, moved, residuals(solution.x)


def layout_covariance(
    observations: Observations,
    camera: CameraModel,
    layout: np.ndarray,
    poses: np.ndarray,
    residuals: np.ndarray,
) -> np.ndarray:
    """Estimates the accuracy of a layout that adjust() found, from the residuals.

    Returns:
        The covariance, (6n, 6n), of x, y, z (m) and of the rotations about x, y, z (rad) of each
        tag, along the axes of the master. It is 0 for the master, and infinite for tags that
        could be anywhere.
    """
    used, frames = np.unique(observations.frames, return_inverse=True)
    observations, vectors = observations._replace(frames=frames), _to_vectors(layout)
    jacobian = _jacobian(observations, camera, vectors, _to_vectors(poses[used]))
    size = 6 * (len(layout) - 1)
    normal = (jacobian.T @ jacobian + PRIOR_INFORMATION * identity(jacobian.shape[1])).tocsc()
    by_poses = normal[size:, :size]
    known_by_poses = by_poses.T @ splu(normal[size:, size:]).solve(by_poses.toarray())
    degrees_of_freedom = max(residuals.size - jacobian.shape[1], 1)
    of_vectors, undetermined = _inverse(normal[:size, :size].toarray(), known_by_poses)
    to_turns = np.eye(6 * len(layout))
    for index, turn in enumerate(_left_jacobians(vectors[:, 3:])):
        rows = slice(6 * index + 3, 6 * index + 6)
        to_turns[rows, rows] = turn
    covariance = np.zeros_like(to_turns)
    covariance[6:, 6:] = np.sum(residuals**2) / degrees_of_freedom * of_vectors
    covariance = to_turns @ covariance @ to_turns.T
    variables = _columns(undetermined + 1).ravel()
    covariance[variables, variables] = np.inf
    return covariance


def _inverse(known: np.ndarray, by_poses: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Inverts the information on tags, less what the poses use; also returns undetermined tags."""
    scale = 1.0 / np.sqrt(np.diag(known))
    values, vectors = np.linalg.eigh(scale[:, None] * (known - by_poses) * scale)
    null_space = vectors[:, values < MIN_INFORMATION]
    by_tag = null_space.reshape(len(known) // 6, 6, null_space.shape[1])
    shares = np.sum(by_tag**2, axis=1)
    inverse = (vectors / np.maximum(values, MIN_INFORMATION)) @ vectors.T
    return scale[:, None] * inverse * scale, np.unique(np.argmax(shares, axis=0))


def _to_vectors(poses: np.ndarray) -> np.ndarray:
    """Converts poses, (n, 4, 4), to translations (m) and rotation vectors (rad), (n, 6)."""
    vectors = [np.append(pose[:3, 3], cv2.Rodrigues(pose[:3, :3])[0]) for pose in poses]
    return np.reshape(vectors, (-1, 6))


def _to_matrices(vectors: np.ndarray) -> np.ndarray:
    poses = np.tile(np.eye(4), (len(vectors), 1, 1))
    angles, cross = _turns(vectors[:, 3:])
    # Rodrigues' formula.
    poses[:, :3, :3] += np.sin(angles) / angles * cross
    poses[:, :3, :3] += (1.0 - np.cos(angles)) / angles**2 * cross @ cross
    poses[:, :3, 3] = vectors[:, :3]
    return poses


def _turns(vectors: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Returns the lengths of rotation vectors (n, 3), (n, 1, 1) and never 0, and their _cross()."""
    angles = np.maximum(np.linalg.norm(vectors, axis=1), 1e-8)[:, None, None]
    return angles, _cross(vectors)


def _project(
    observations: Observations, camera: CameraModel, layout: np.ndarray, poses: np.ndarray
) -> Tuple[np.ndarray, np.ndarray]:
    """Projects corners to (m, 4, 2) px; also returns the derivatives by position, (m, 4, 2, 3)."""
    tags, bodies = _to_matrices(layout)[observations.tags], _to_matrices(poses)[observations.frames]
    chain = bodies @ tags
    points = observations.points @ chain[:, :3, :3].transpose(0, 2, 1) + chain[:, None, :3, 3]
    pixels, jacobians = camera.project(points.reshape(-1, 3))
    return pixels.reshape(-1, 4, 2), jacobians.reshape(-1, 4, 2, 3)


def _jacobian(
    observations: Observations, camera: CameraModel, layout: np.ndarray, poses: np.ndarray
) -> csr_matrix:
    count = len(layout)
    tags, bodies = _to_matrices(layout)[observations.tags], _to_matrices(poses)[observations.frames]
    by_point = np.nan_to_num(_project(observations, camera, layout, poses)[1])
    turned = observations.points @ tags[:, :3, :3].transpose(0, 2, 1)
    in_body = turned + tags[:, None, :3, 3]
    by_pose = _by_motion(
        by_point,
        in_body @ bodies[:, :3, :3].transpose(0, 2, 1),
        _left_jacobians(poses[:, 3:])[observations.frames],
    )
    by_layout = _by_motion(
        by_point @ bodies[:, None, :3, :3],
        turned,
        _left_jacobians(layout[:, 3:])[observations.tags],
    )
    columns = np.concatenate(
        [_columns(observations.tags - 1), _columns(observations.frames + count - 1)], axis=1
    )
    size = 6 * (count - 1 + len(poses))
    values = np.concatenate([by_layout, by_pose], axis=-1).reshape(-1, 8, 12)
    rows = np.arange(8 * len(values)).reshape(-1, 8, 1)
    rows, columns = (np.broadcast_to(a, values.shape) for a in (rows, columns[:, None, :]))
    free = columns >= 0  # Those of the master are fixed.
    return csr_matrix((values[free], (rows[free], columns[free])), (8 * len(values), size))


def _columns(index: np.ndarray) -> np.ndarray:
    """Returns the six columns of the poses with these indices, (m, 6)."""
    return 6 * index[:, None] + np.arange(6)


def _by_motion(by_point: np.ndarray, levers: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Returns derivatives by translation and rotation vector of points at levers, (m, 4, 2, 6)."""
    return np.concatenate([by_point, -by_point @ _cross(levers) @ turns[:, None]], axis=-1)


def _cross(vectors: np.ndarray) -> np.ndarray:
    """Returns the matrices of the cross products with vectors, (..., 3, 3)."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def _left_jacobians(vectors: np.ndarray) -> np.ndarray:
    """Returns the derivatives of rotations by their rotation vectors, (n, 3, 3)."""
    angles, cross = _turns(vectors)
    first, second = (1.0 - np.cos(angles)) / angles**2, (angles - np.sin(angles)) / angles**3
    return np.eye(3) + first * cross + second * cross @ cross
