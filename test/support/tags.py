"""Views of tags by a camera, with known poses."""

import cv2
import numpy as np

import robot_vision as rv

SIZE = 0.2  # m
K = np.array([[600.0, 0.0, 320.0], [0.0, 600.0, 240.0], [0.0, 0.0, 1.0]])
CAMERAS = {
    "plumb_bob": rv.CameraModel(640, 480, K, [-0.25, 0.07, 0.001, -0.002, 0.0]),
    "rational_polynomial": rv.CameraModel(
        640, 480, K, [0.45, -0.3, 0.001, -0.002, -0.02, 0.8, -0.1, -0.07], "rational_polynomial"
    ),
    "equidistant": rv.CameraModel(640, 480, K, [0.05, -0.02, 0.006, -0.001], "equidistant"),
}
CAMERA = CAMERAS["plumb_bob"]
SQUARE = np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]])


def turned(vector):
    """The rotation (3, 3) of a rotation vector, rad."""
    return cv2.Rodrigues(np.asarray(vector, float))[0]


def matrix(rotation, place):
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, place
    return pose


def pose_in_view(rng, pixels, tilt):
    """A random pose of a tag whose sides have `pixels` px when it faces the camera; tilt in rad."""
    distance = K[0, 0] * SIZE / pixels
    reach = 0.3 if pixels < 200 else 0.1
    place = distance * np.array([rng.uniform(-reach, reach), rng.uniform(-reach, reach) * 0.7, 1.0])
    ray = place / np.linalg.norm(place)
    across = np.cross([0.0, 0.0, 1.0], ray)
    to_ray = turned(across / np.linalg.norm(across) * np.arcsin(np.linalg.norm(across)))
    side, spin = rng.uniform(-np.pi, np.pi, 2)
    away = turned([tilt * np.cos(side), tilt * np.sin(side), 0.0])
    return matrix(to_ray @ away @ np.diag([1.0, -1.0, -1.0]) @ turned([0.0, 0.0, spin]), place)


def corners_of(pose, camera, size=SIZE):
    """The corners of a tag in the image, (4, 2) px."""
    return camera.project(size * SQUARE @ pose[:3, :3].T + pose[:3, 3])[0]


def in_image(corners, camera):
    low, high = corners.min(axis=0), corners.max(axis=0)
    return bool((low > 0).all() and (high < [camera.width - 1, camera.height - 1]).all())


def faces_camera(pose):
    return pose[:3, 2] @ pose[:3, 3] < -0.2 * np.linalg.norm(pose[:3, 3])


def visible(body, places, camera, size=SIZE):
    """The corners of the tags that a camera sees, by id; `places` are their poses on a body."""
    poses = {tag: body @ place for tag, place in places.items()}
    seen = {tag: corners_of(pose, camera, size) for tag, pose in poses.items()}
    return {
        tag: corners
        for tag, corners in seen.items()
        if faces_camera(poses[tag]) and in_image(corners, camera)
    }


def random_places(rng, flat):
    """Poses of five tags on a body, by id."""
    return {
        tag: matrix(
            turned([0, 0, rng.uniform(-3, 3)] if flat else rng.uniform(-0.6, 0.6, 3)),
            rng.uniform(-0.4, 0.4, 3) * ([1, 1, 0] if flat else [1, 1, 0.5]),
        )
        for tag in range(5)
    }


def bundle_of(places, size, *noise):
    """The bundle `box` of tags at these places, of one size; noise of their shift and turn."""
    return rv.Bundle("box", [rv.BundleTag(tag, size, p, *noise) for tag, p in places.items()])


def error_of(pose, truth):
    """x, y, z (m) and rotations about x, y, z (rad) from a pose to the truth, in camera axes."""
    turn = cv2.Rodrigues(truth[:3, :3] @ pose[:3, :3].T)[0][:, 0]
    return np.concatenate([truth[:3, 3] - pose[:3, 3], turn])


def squared_error(estimate, truth):
    """The squared error divided by the covariance: 6 on average if the covariance is right."""
    error = error_of(estimate.pose, truth)
    return error @ np.linalg.solve(estimate.covariance, error)


def turn_of(error):
    """The angle in degrees of an error (x, y, z and rotations)."""
    return np.degrees(np.linalg.norm(error[3:]))
