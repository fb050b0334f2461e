"""Vision algorithms without ROS: NumPy in, NumPy out."""

from ._core import (
    BrightnessParams,
    CameraModel,
    CaptureParams,
    EdgeParams,
    Scene,
    SceneObject,
    SceneParams,
    SceneTruth,
    adjust_brightness,
    encodings,
    find_edges,
    validate,
)

__all__ = [
    "BrightnessParams",
    "CameraModel",
    "CaptureParams",
    "EdgeParams",
    "Scene",
    "SceneObject",
    "SceneParams",
    "SceneTruth",
    "adjust_brightness",
    "encodings",
    "find_edges",
    "validate",
]
