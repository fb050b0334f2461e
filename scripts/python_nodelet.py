#!/usr/bin/env python3
"""Loads nodes of this package into a manager, as `rosrun nodelet nodelet` does with nodelets.

usage: rosrun robot_vision python_nodelet.py COMMAND [TOPIC:=OTHER ...] [_PARAMETER:=VALUE ...]

  load TYPE MANAGER [--no-bond]  loads a node, and unloads it at the end of this process
  unload NAME MANAGER            unloads the node of that name
  standalone TYPE                runs a node in this process
  list MANAGER                   prints the names of a manager's nodes

TYPE is the name of a node or nodelet of this package, as hsv_tracker, or a nodelet of another one,
as image_proc/rectify. MANAGER is the name of a python_manager.py; nodelets can be loaded into a
manager of nodelet, too. To load and unload, this process becomes nodelet's own program.
"""

import os
import re
import shutil
import sys
from typing import Dict, List, NoReturn, Tuple

# Words that each command needs.
WORDS: Dict[str, Tuple[str, ...]] = {
    "load": ("TYPE", "MANAGER"),
    "unload": ("NAME", "MANAGER"),
    "standalone": ("TYPE",),
    "list": ("MANAGER",),
}
TYPE = r"[A-Za-z]\w*(/\w+)?"
NAME = r"[~/]?[A-Za-z]\w*(/\w+)*"
TIMEOUT = 5.0  # s for a manager to answer


def main(arguments: List[str]) -> int:
    """Runs the command and returns its exit code, 2 if the arguments are wrong."""
    given = [word for word in arguments if ":=" not in word]
    if {"-h", "--help"}.intersection(given):
        print(__doc__, end="")
        return 0
    try:
        command, words = checked(given)
    except ValueError as error:
        print(f"python_nodelet.py: {error}; see --help", file=sys.stderr)
        return 2
    named = [word for word in arguments if ":=" in word]
    if command == "list":
        return show(words[0], [sys.argv[0], *named])
    if command != "unload" and "/" not in words[0]:
        words[0] = "robot_vision/" + words[0]
    if command == "standalone":
        package, name = words[0].split("/")
        program = os.path.join(os.path.dirname(os.path.abspath(sys.argv[0])), name + ".py")
        if package == "robot_vision" and os.path.exists(program):
            become([program, *named])
    become([*nodelet_program(), command, *words, *named])


def checked(given: List[str]) -> Tuple[str, List[str]]:
    """Returns the command and its words; raises ValueError if they are not what it needs."""
    if not given or given[0] not in WORDS:
        what = repr(given[0][:100]) if given else "missing"
        raise ValueError(f"the command is {what}, must be one of {', '.join(WORDS)}")
    command, words = given[0], given[1:]
    options = [word for word in words if word == "--no-bond"] if command == "load" else []
    words = [word for word in words if word not in options]
    needed = WORDS[command]
    if len(words) != len(needed):
        raise ValueError(f"{command} has {len(words)} words, needs {' '.join(needed)}")
    for what, word in zip(needed, words):
        if len(word) > 255 or not re.fullmatch(TYPE if what == "TYPE" else NAME, word):
            example = "hsv_tracker or package/name" if what == "TYPE" else "a name of a node"
            raise ValueError(f"{what} is {word[:100]!r}, must be {example}")
    return command, words + options


def nodelet_program() -> List[str]:
    """Returns the words that start nodelet's own program."""
    prefixes = os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep)
    for prefix in [*filter(None, prefixes), "/usr"]:
        path = os.path.join(prefix, "lib", "nodelet", "nodelet")
        if os.access(path, os.X_OK):
            return [path]
    return [shutil.which("rosrun") or "rosrun", "nodelet", "nodelet"]


def become(words: List[str]) -> NoReturn:
    """Has a program take the place of this one."""
    try:
        os.execv(words[0], words)
    except OSError as error:
        print(f"python_nodelet.py: {words[0]}: {error.strerror}", file=sys.stderr)
        sys.exit(1)


def show(manager: str, argv: List[str]) -> int:
    """Prints the names of a manager's nodes."""
    import rospy
    from nodelet.srv import NodeletList

    rospy.names.reload_mappings(argv)
    name = rospy.names.resolve_name_without_node_name(manager) + "/list"
    try:
        rospy.wait_for_service(name, TIMEOUT)
        for node in rospy.ServiceProxy(name, NodeletList)().nodelets:
            print(node)
    except (OSError, rospy.ROSException, rospy.ServiceException) as error:
        print(f"python_nodelet.py: no answer of {name}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
