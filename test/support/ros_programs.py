"""The programs of ROS and of its packages, wherever they are installed: below /usr, or /opt/ros."""

import functools
import shutil

import roslib.packages


def _command(name: str) -> str:
    return shutil.which(name) or name


ROSLAUNCH, ROSRUN = map(_command, ("roslaunch", "rosrun"))


@functools.lru_cache(maxsize=None)
def program_of(package: str, name: str) -> str:
    """Returns the path of a package's program, which must be there."""
    found = roslib.packages.find_node(package, name)
    assert found, f"{name} of the package {package} is not installed"
    return found[0]
