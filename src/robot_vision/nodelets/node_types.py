"""Which nodes of this package can be loaded into a manager: those whose main() only runs a class.

The dashboard is none of them: it subscribes to topics of any type as bytes, and rospy has one class
for each topic of a process, also for nodes that need the messages.

What main() says is the one place where a node's class is declared, for all ways to run it.
"""

import glob
import importlib
import os
import re
from typing import Any, Callable, List, NamedTuple

import robot_vision

PACKAGE = "robot_vision/"
_MAIN = re.compile(
    r'^def main\(\) -> None:\n    run_node\("(\w+)", (\w+)(?:, has_file=False)?\)$', re.MULTILINE
)


class NodeType(NamedTuple):
    """A node that can be loaded.

    Attributes:
        name: What follows the package's name in its type.
        module: The module.
        class_name: Its class there.
    """

    name: str
    module: str
    class_name: str

    def load(self) -> Callable[[], Any]:
        """Returns the class; raises ImportError if something is missing that it needs."""
        return getattr(importlib.import_module(self.module), self.class_name)


def find_type(name: str) -> NodeType:
    """Returns the node of a type such as robot_vision/hsv_tracker; raises KeyError if none is."""
    if name.startswith(PACKAGE) and re.fullmatch(r"\w{1,100}", name[len(PACKAGE) :]):
        for found in _declared(name[len(PACKAGE) :]):
            return found
    raise KeyError(name)


def type_names() -> List[str]:
    """Returns the types of all nodes that can be loaded, in the order of the alphabet."""
    return sorted(PACKAGE + found.name for found in _declared("*"))


def _declared(file_name: str) -> List[NodeType]:
    found = []
    for folder in robot_vision.__path__:
        for path in glob.glob(os.path.join(folder, "*", file_name + ".py")):
            with open(path, encoding="utf-8") as file:
                declared = _MAIN.search(file.read())
            if declared and declared[1] != "python_manager":  # which holds the others
                room = os.path.basename(os.path.dirname(path))
                file_stem = os.path.basename(path)[: -len(".py")]
                found.append(NodeType(declared[1], f"robot_vision.{room}.{file_stem}", declared[2]))
    return found
