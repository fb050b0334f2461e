"""Depth images of planes with tags on them, as sensors measure them."""

from typing import NamedTuple

import numpy as np

import robot_vision as rv

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
