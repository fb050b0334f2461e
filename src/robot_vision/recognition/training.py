"""The command training, which learns the objects of the database as an .ork file says."""

import argparse
import sys
from typing import List, Sequence

from ..common.commands import run_command
from ..common.errors import about
from . import all_methods  # noqa: F401  (makes them known)
from .database import Database
from .database_arguments import database_parser
from .methods import method_of
from .ork_file import read_ork
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
from .training_run import Task, task_of, title_of, train

PROGRAM = "training"
EXAMPLES = """examples, all objects that need it, some of them, and all anew:
  training -c training.ork
  training -c training.ork --object_names '[coke, bottle]'
  training -c training.ork --force
Ctrl-C stores what was done; the next training goes on from there.
"""


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(sys.argv[1:])
    return run_command(PROGRAM, lambda: run(arguments))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = database_parser(
        PROGRAM,
        "Learns the objects of the database by their meshes, as an .ork file says.",
        EXAMPLES,
    )
    add_choice(parser)
    parser.add_argument("--force", action="store_true", help="train what has not changed, too")
    for theirs in ("--commit", "--visualize"):
        parser.add_argument(theirs, action="store_true", help=argparse.SUPPRESS)
    return parser.parse_args(command)


def run(arguments: argparse.Namespace) -> None:
    """Trains all objects of all pipelines.

    Raises:
        OSError: A file cannot be read, or the database not be written.
        ValueError: A file is wrong, there is nothing that can be learned, or some objects could not
            be, which the others are learned in spite of.
    """
    file = read_ork(arguments.config_file)
    pipelines = [one for one in pipelines_of(file) if one.method != TABLES]
    for pipeline in pipelines:
        choose_objects(pipeline, arguments)
        known = list(method_of(pipeline.method).parameters)
        file.warnings += unknown_warnings(pipeline.name, pipeline.parameters, known)
    tell(file)
    if not pipelines:
        raise ValueError(f"{file.path}: no pipeline in it learns anything")
    failures = _Failures()
    empty = []  # databases in which a pipeline has found nothing to learn
    for pipeline in pipelines:
        path = database_of(arguments, pipeline, file.path)
        with Database(path, True, make=False) as database:
            tasks = _tasks(database, pipeline, failures)
            if not tasks and pipeline.objects != MISSING:
                empty.append(database.path)
            for task in tasks:
                try:
                    train(database, task, arguments.force)
                except ValueError as error:
                    failures.tell(error)
    if failures.count:
        raise ValueError("not all objects were learned")
    if len(empty) == len(pipelines):
        raise ValueError(f"no object in {empty[0]} has a mesh that could be learned")


class _Failures:
    """Why objects cannot be learned: the others are learned all the same."""

    def __init__(self) -> None:
        self.count = 0

    def tell(self, error: ValueError) -> None:
        print(f"not learned: {error}", file=sys.stderr)
        self.count += 1


def _tasks(database: Database, pipeline: Pipeline, failures: _Failures) -> List[Task]:
    """Returns what is to be trained, after telling which objects have no mesh.

    One that was named, and has none, is a failure.

    Raises:
        ValueError: A parameter cannot be, or an object that was named is not there.
    """
    method = method_of(pipeline.method)
    known = {key: one for key, one in pipeline.parameters.items() if key in method.parameters}
    with about(pipeline.name):
        parameters = method.complete(known)
    tasks = []
    for one in chosen_objects(database, pipeline):
        try:
            with about(title_of(one, method)):
                task = task_of(database, one, method, parameters)
        except ValueError as error:
            failures.tell(error)
            continue
        lack = f"'{one.name}' has no mesh: mesh_add.py {one.id[:8]} FILE --commit adds it"
        if task is not None:
            tasks.append(task)
        elif pipeline.objects in (ALL, MISSING):
            print(f"left out: {lack}", file=sys.stderr)
        else:
            failures.tell(ValueError(lack))
    return tasks
