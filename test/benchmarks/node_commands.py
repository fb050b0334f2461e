"""The commands that start the nodes that are measured."""

import roslib.packages
import rospkg
from measuring import HERE, Command

TOPIC = "/camera/image"  # of the frames that all of them see
IMAGE = f"image:={TOPIC}"


def installed(package: str, kind: str) -> bool:
    """Whether a package has a program of this name."""
    try:
        return bool(roslib.packages.find_node(package, kind))
    except rospkg.ResourceNotFound:
        return False


def node(package: str, kind: str, name: str, *args: str) -> Command:
    found = roslib.packages.find_node(package, kind)
    if not found:
        raise RuntimeError(f"{kind} of the package {package} is not installed")
    return [found[0], *args, "__name:=" + name]


def course(kind: str) -> Command:
    """A node as courses teach it."""
    return [str(HERE / "course_node"), kind, IMAGE, "__name:=course_" + kind]
