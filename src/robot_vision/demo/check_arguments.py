"""Checks that roslaunch was only given arguments which the launch file declares."""

import difflib
import os
import pathlib
import sys
import xml.etree.ElementTree
from typing import Dict, List

PACKAGE = "robot_vision"
LAUNCH_FILES = (".launch", ".xml", ".test")


def main() -> int:
    """Runs for launch/arguments.xml; roslaunch ends if the exit code is not 0."""
    words = pathlib.Path(f"/proc/{os.getppid()}/cmdline").read_text(errors="replace").split("\0")
    complaint = unknown_arguments(sys.argv[1], words)
    print(complaint, end="", file=sys.stderr)
    return 1 if complaint else 0


def unknown_arguments(path: str, command: List[str]) -> str:
    """Returns an error message about undeclared arguments, or "" if there are none.

    Args:
        path: The path of the launch file.
        command: The command line of roslaunch. If it starts another launch file, which includes
            this one, or several files, the arguments are not checked here.
    """
    given = [word.partition(":=")[0] for word in command if ":=" in word]
    if not _starts(path, command):
        return ""
    known = declared_arguments(path)
    unknown = [name for name in given if name not in known and not name.startswith("_")]
    if not unknown:
        return ""
    name = os.path.basename(path)
    lines = [_sentence(name, argument, list(known)) for argument in unknown]
    lines.append(f"{name} has the arguments")
    lines += [f"  {argument}: {text}" for argument, text in known.items()]
    return "\n".join(lines) + "\n"


def declared_arguments(path: str) -> Dict[str, str]:
    """Returns the arguments of a launch file with their descriptions, and defaults in brackets."""
    known = {}
    for arg in xml.etree.ElementTree.parse(path).getroot().findall("arg"):
        if "value" in arg.attrib:  # Its value is fixed.
            continue
        default = arg.get("default", "")
        shown = f" [{default}]" if default and "$(" not in default else ""
        known[arg.attrib["name"]] = arg.get("doc", "") + shown
    return known


def _starts(path: str, command: List[str]) -> bool:
    """Returns whether a command of roslaunch starts this launch file and no other."""
    words = [word for word in command[1:] if ":=" not in word and not word.startswith("-")]
    if sum(word.endswith(LAUNCH_FILES) for word in words) != 1:
        return False
    name = os.path.basename(path)
    of_package = PACKAGE in words and name in words
    return of_package or os.path.realpath(path) in map(os.path.realpath, words)


def _sentence(name: str, argument: str, known: List[str]) -> str:
    near = difflib.get_close_matches(argument, known, 1)
    return f"{name} has no argument {argument}" + (f", is {near[0]} meant?" if near else "")
