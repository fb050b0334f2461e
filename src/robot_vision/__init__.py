"""Vision algorithms without ROS: NumPy in, NumPy out."""

from . import _core
from ._core import *  # noqa: F403

__all__ = [name for name in dir(_core) if not name.startswith("_")]
