"""The command detection, which recognizes objects as an .ork file says, until Ctrl-C."""

import argparse
import contextlib
import sys
from typing import List, Optional, Sequence, Set

import rospy

from ..common.commands import run_command
from ..ros.params import read_param
from ..ros.startup import run_node
from .database import Database
from .database_arguments import database_parser
from .object_recognizer import ObjectRecognizer
from .ork_file import read_ork
from .ork_node import node_words, parameter_word, set_by, with_typed
from .ork_pipelines import (
    ALL,
    MISSING,
    TABLES,
    Pipeline,
    chosen_objects,
    pipelines_of,
    unknown_warnings,
)
from .ork_runs import add_choice, choose_objects, database_of, tell

PROGRAM = "detection"
NODE = "object_recognition"
EXAMPLES = """examples, of all objects, and of one of them on other topics:
  detection -c detection.ros.ork
  detection -c detection.ros.ork --object_names '[coke]' image:=/eye/rgb depth:=/eye/depth
It is the node object_recognizer, which has a launch file, too.
"""


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(rospy.myargv(sys.argv)[1:])
    words: List[str] = []
    code = run_command(PROGRAM, lambda: words.extend(words_of(arguments)))
    if code:
        return code
    typed = [word for word in sys.argv[1:] if ":=" in word]
    sys.argv[1:] = with_typed(words, typed)
    rospy.names.reload_mappings(sys.argv)  # rospy has read them when it was imported.

    def start() -> ObjectRecognizer:
        _forget_earlier(set_by(sys.argv[1:]), set_by(typed))
        return ObjectRecognizer()

    run_node(arguments.node_name, start)
    return 0


def _forget_earlier(given: Set[str], typed: Set[str]) -> None:
    """Deletes what the file of an earlier run has left on the parameter server.

    Args:
        given: The private parameters that this run sets.
        typed: Those of them that are not of its file.
    """
    earlier = set(read_param("set_by_file", "").split(",")) - {""}
    for name in earlier - given:
        with contextlib.suppress(KeyError):
            rospy.delete_param("~" + name)
    rospy.set_param("~set_by_file", ",".join(sorted(given - typed)))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = database_parser(PROGRAM, "Recognizes objects as an .ork file says.", EXAMPLES)
    add_choice(parser)
    parser.add_argument("--node_name", default=NODE, metavar="NAME", help="(default: %(default)s)")
    parser.add_argument("--visualize", action="store_true", help=argparse.SUPPRESS)
    return parser.parse_args(command)


def words_of(arguments: argparse.Namespace) -> List[str]:
    """Returns what the node is started with, and tells what is not used of the file.

    Raises:
        OSError: A file cannot be read.
        ValueError: A file is wrong, or an object is not there.
    """
    file = read_ork(arguments.config_file)
    pipelines = pipelines_of(file)
    words = node_words(file)
    learned = [one for one in pipelines if one.method != TABLES]
    for pipeline in pipelines:
        known = ["table_detector", "clusterer"] if pipeline.method == TABLES else []
        file.warnings += unknown_warnings(pipeline.name, pipeline.parameters, known)
    for pipeline in learned:
        choose_objects(pipeline, arguments)
    paths = [database_of(arguments, pipeline, file.path) for pipeline in learned]
    file.warnings += _shared_warnings(learned, paths)
    tell(file)
    words.append(parameter_word("methods", ",".join(dict.fromkeys(one.method for one in learned))))
    if learned:
        words.append(parameter_word("database", paths[0]))
        words.append(parameter_word("objects", _objects(learned, paths[0])))
        words.append(parameter_word("needs_models", True))
        words += (
            [parameter_word("on_tables", True)] if all(one.on_tables for one in learned) else []
        )
    return [*words, parameter_word("ork_names", True)]


def _shared_warnings(pipelines: Sequence[Pipeline], paths: Sequence[str]) -> List[str]:
    """Returns in what pipelines, with their databases, differ that one node has for all of them."""
    warnings = []
    for one, path in zip(pipelines, paths):
        if path != paths[0]:
            warnings.append(
                f"{one.name}: {path} is not used: the database is that of {pipelines[0].name}"
            )
        if one.on_tables and not all(other.on_tables for other in pipelines):
            warnings.append(f"{one.name}: not only tables are looked at, as for other pipelines")
    wanted = _wanted(pipelines)
    for method in dict.fromkeys(one.method for one in pipelines):
        own = [one for one in pipelines if one.method == method]
        if _wanted(own) != wanted:
            names = ", ".join(one.name for one in own)
            warnings.append(f"{names}: {method} looks for the objects of other pipelines, too")
    return warnings


def _wanted(pipelines: Sequence[Pipeline]) -> Optional[Set[str]]:
    """Returns what the pipelines name, ids and names, or None for all objects that there are."""
    if any(pipeline.objects in (ALL, MISSING) for pipeline in pipelines):
        return None
    return {name for pipeline in pipelines for name in pipeline.objects}


def _objects(pipelines: Sequence[Pipeline], path: str) -> str:
    """Returns the ids of all objects that the pipelines name, or "" for all that there are."""
    if _wanted(pipelines) is None:
        return ""
    with Database(path) as database:
        found = [one for pipeline in pipelines for one in chosen_objects(database, pipeline)]
    return ",".join(dict.fromkeys(one.id for one in found))
