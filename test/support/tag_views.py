"""Images of tags, rendered through a lens, with blur and noise."""

import cv2
import numpy as np
from tags import (
    CAMERA,
    SIZE,
    corners_of,
    faces_camera,
    in_image,
    matrix,
    pose_in_view,
    turned,
)

import robot_vision as rv


def undistorted(pixels, camera):
    """x / z and y / z of the rays of pixels, (n, 2)."""
    lens = np.asarray(pixels, float)[:, None], camera.K, np.array(camera.D)
    if camera.distortion_model == "equidistant":
        return cv2.fisheye.undistortPoints(*lens)[:, 0]
    until = cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-9
    # cv2.undistortPoints alone stops too early.
    return cv2.undistortPointsIter(*lens, None, None, until)[:, 0]


def rays_of(camera):
    """x / z and y / z of the rays of all pixels, (height, width, 2)."""
    pixels = np.mgrid[: camera.height, : camera.width][::-1].reshape(2, -1).T
    return undistorted(pixels, camera).reshape(camera.height, camera.width, 2)


RAYS = rays_of(CAMERA)


def image_of(
    pose, camera, rays, number, rng, blur=None, noise=3.0, family="tag36h11", size=SIZE, onto=None
):
    """The camera's image of a tag on white paper in front of a gray wall.

    Args:
        blur: sigma in px; None: a random one from 0.3 to 1.
        noise: standard deviation in gray levels, around the tag.
        size: of the tag, m.
        onto: an image with other tags to draw into.
    """
    cells, width = rv.tag_cells(family, number), rv.tag_family(family).width_at_border
    cells = np.pad(cells, 0 if len(cells) == width + 2 else 1, constant_values=255)
    corners = corners_of(pose, camera, size)
    border = (0.6 * len(cells) / width - 0.35) * np.ptp(corners, axis=0).max() + 4
    left, top = np.maximum(corners.min(axis=0) - border, 0).astype(int)
    right, bottom = np.minimum(corners.max(axis=0) + border, (camera.width, camera.height)).astype(
        int
    )
    part = rays[top:bottom, left:right]
    rays_of_side = 6 if max(part.shape) < 250 else 3  # per pixel
    fine = cv2.resize(part, None, fx=rays_of_side, fy=rays_of_side, interpolation=cv2.INTER_LINEAR)
    axes, place = pose[:3, :3].T, pose[:3, 3]
    # Maps rays to metres on the tag's plane and to cells, where (0, 0) is the first one's middle.
    on_plane = (axes[2] @ place) * axes - np.outer(axes @ place, axes[2])
    on_plane[2] = axes[2]
    middle = (len(cells) - 1) / 2.0
    to_cells = np.array([[width / size, 0, middle], [0, -width / size, middle], [0, 0, 1]])
    where = cv2.perspectiveTransform(fine, to_cells @ on_plane).astype(np.float32)
    looks = (30.0 + 0.75 * cells).astype(np.float32)
    values = cv2.remap(looks, where, None, cv2.INTER_NEAREST, borderValue=140.0)
    near = cv2.resize(values, part.shape[1::-1], interpolation=cv2.INTER_AREA)
    near = cv2.GaussianBlur(near, (0, 0), blur or rng.uniform(0.3, 1.0))
    near += rng.normal(0.0, noise, near.shape)
    image = np.full((camera.height, camera.width), 140, np.uint8) if onto is None else onto
    image[top:bottom, left:right] = near.clip(0, 255).round()
    return image


def moving(rng, pixels, frames):
    """Poses, at 30 Hz, of a tag that moves and turns as long as it is in view."""
    pose = pose_in_view(rng, pixels, np.radians(rng.uniform(0, 50)))
    shift, turn = rng.uniform(-0.15, 0.15, 3) / 30.0, turned(rng.uniform(-0.7, 0.7, 3) / 30.0)
    for _ in range(frames):
        if not in_image(corners_of(pose, CAMERA), CAMERA) or not faces_camera(pose):
            return
        yield pose
        pose = matrix(pose[:3, :3] @ turn, pose[:3, 3] + shift)


def badly_calibrated(rng, error):
    """The camera with wrong parameters: a root mean square error of `error` px."""
    pixels = np.mgrid[20:640:60, 20:480:60].reshape(2, -1).T.astype(float)
    points = np.column_stack([undistorted(pixels, CAMERA), np.ones(len(pixels))])
    lens = rng.normal(0.0, [0.02, 0.05, 0.001, 0.001, 0.0])
    focus, middle = rng.normal(0.0, 2.0, 2), rng.normal(0.0, 2.0, 2)
    scale = 1.0
    for _ in range(5):
        matrix_off = CAMERA.K + scale * np.array(
            [[focus[0], 0.0, middle[0]], [0.0, focus[1], middle[1]], [0.0, 0.0, 0.0]]
        )
        camera = rv.CameraModel(640, 480, matrix_off, list(np.array(CAMERA.D) + scale * lens))
        off = camera.project(points)[0] - pixels
        scale *= error / np.sqrt(np.mean(np.sum(off**2, axis=1)))
    return camera
