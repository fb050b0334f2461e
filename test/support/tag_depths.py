"""Depth images of planes with tags on them, as sensors measure them."""

from typing import NamedTuple

import numpy as np
from tags import corners_of, matrix, turned

import robot_vision as rv

CORNER_NOISE = 0.3  # px, as libapriltag finds corners
FACING = np.diag([1.0, -1.0, -1.0])
BIAS = 0.005  # m, standard deviation of what all depths of a frame have in common


def errors_of(**values):
    """How wrong depths are: what the core takes them for by default, with these values."""
    params = rv.DepthErrorParams()
    for name, value in values.items():
        setattr(params, name, value)
    return params


# What rv.DepthNoise does with a focal length of 525 px, for the core.
SENSORS = {
    "none": errors_of(depth_noise=1e-4, depth_noise_growth=0.0, depth_step=0.0),
    "kinect": errors_of(depth_step=0.0032),
    "stereo": errors_of(
        depth_noise=0.0015, depth_noise_growth=0.0055, depth_step=0.0012, depth_correlation=25
    ),
    "tof": errors_of(depth_noise=0.0012, depth_noise_growth=0.0007, depth_step=0.0),
}
for _name, _params in SENSORS.items():
    if _name != "stereo":  # whose errors are alike in blocks of 5x5 px
        _params.depth_correlation = 1
    _params.depth_bias = BIAS


class DepthView(NamedTuple):
    """A camera, what it takes for a ray of each pixel, and how its depths are wrong."""

    camera: rv.CameraModel
    rays: np.ndarray  # (height, width, 3), the last 1
    noise: rv.DepthNoise

    def image(self, pose, frame, rng):
        """The depths, float32 in m, of the whole plane of a tag with this pose."""
        normal = pose[:3, 2]
        with np.errstate(divide="ignore"):
            exact = (normal @ pose[:3, 3]) / (self.rays @ normal)
        exact[(exact < 0.05) | (exact > 50.0)] = np.nan
        depth = self.noise.apply(frame, exact.astype(np.float32))
        return depth + np.float32(rng.normal(0.0, BIAS))


def view_of(camera, sensor="none"):
    pixels = np.mgrid[: camera.height, : camera.width][::-1].reshape(2, -1).T
    rays = np.column_stack([camera.rays(pixels), np.ones(len(pixels))])
    rays = rays.reshape(camera.height, camera.width, 3)
    return DepthView(camera, rays, rv.DepthNoise(sensor, camera))


def narrow_camera(width, height, focus=525.0):
    """A camera without distortion that sees little around its optical axis."""
    middle = (width - 1) / 2.0, (height - 1) / 2.0
    return rv.CameraModel(width, height, [[focus, 0, middle[0]], [0, focus, middle[1]], [0, 0, 1]])


def tilt_of(pose, truth):
    """The angle between the normals of two poses, in degrees."""
    return np.degrees(np.arccos(np.clip(pose[:3, 2] @ truth[:3, 2], -1.0, 1.0)))


def tilted(rng, tilt, place):
    """A pose that is tilted from the line of sight by `tilt` rad, in any direction."""
    ray = place / np.linalg.norm(place)
    across = np.cross([0.0, 0.0, 1.0], ray)
    side, spin = rng.uniform(-np.pi, np.pi, 2)
    away = turned([tilt * np.cos(side), tilt * np.sin(side), 0.0])
    return matrix(turned(across) @ away @ FACING @ turned([0.0, 0.0, spin]), place)


def shots(sensor, camera, size, distance, tilts, count, corner_noise=CORNER_NOISE):
    """(truth, poses by corners, poses by both) of single images of a tag; tilts in degrees."""
    rng = np.random.default_rng(3)
    view, params = view_of(camera, sensor), SENSORS[sensor]
    tag = rv.single_tag(0, size)
    for number in range(count):
        place = distance * np.array([*rng.uniform(-0.02, 0.02, 2), 1.0])
        truth = tilted(rng, np.radians(rng.choice(tilts)), place)
        corners = corners_of(truth, camera, size) + rng.normal(0.0, corner_noise, (4, 2))
        plane = rv.measure_tag_plane(view.image(truth, number, rng), corners, camera, params)
        seen = {0: corners}, {0: rv.MeasuredCorners(corners, plane=plane)}
        alone, fused = (rv.estimate_pose(tag, one, camera, corner_noise, 0.0) for one in seen)
        yield truth, alone, fused


def is_the_wrong_one(poses, truth):
    """Whether the better of two poses, if they are not nearly the same, is farther off."""
    best, other = poses.best, poses.other
    if other is None or tilt_of(best.pose, other.pose) < 20.0:
        return False
    return tilt_of(other.pose, truth) < tilt_of(best.pose, truth)
