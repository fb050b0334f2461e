"""Where the files of this package are."""

import functools
import os

import rospkg


def package_path(*names: str) -> str:
    """Returns the path of a file or folder of this package, by its names from the root on."""
    return os.path.join(_root(), *names)


@functools.lru_cache(maxsize=None)
def _root() -> str:
    """Looks through all packages that ROS knows, which takes as long as reading a network."""
    return rospkg.RosPack().get_path("robot_vision")
