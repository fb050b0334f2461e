"""The command learn_samples.py, which puts the things on the demo's table into a database."""

import argparse
import os
import sys
import tempfile
from typing import Sequence

import rospy

from .. import sample_mesh, sample_mesh_names
from ..common.commands import run_command
from ..meshes.mesh_files import write_mesh
from .database import Database, Object, Symmetry
from .database_arguments import database_parser, database_path
from .mesh_intake import take_mesh
from .training_run import task_of, train
from .view_method import VIEWS

PROGRAM = "learn_samples.py"
EXAMPLES = """examples, all things on the table of scene:=tabletop, and two of them:
  learn_samples.py
  learn_samples.py mug can --database /tmp/objects.db
What is there already stays as it is.
"""


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(rospy.myargv(sys.argv)[1:])
    return run_command(PROGRAM, lambda: learn(arguments))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = database_parser(
        PROGRAM,
        "Adds the things on the demo's table to the database, with their meshes, and learns them "
        "by the method LINEMOD.",
        EXAMPLES,
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="of things (default: all)")
    arguments = parser.parse_args(command)
    for name in arguments.names:
        if name not in sample_mesh_names():
            parser.error(f"there is no '{name}', only {', '.join(sample_mesh_names())}")
    return arguments


def learn(arguments: argparse.Namespace) -> None:
    """Adds what is not there by its name, and trains what has not been trained.

    Raises:
        OSError: The database cannot be written.
        ValueError: It is no database, or an object of such a name has no mesh.
    """
    with Database(database_path(arguments), write=True) as database:
        for name in arguments.names or sample_mesh_names():
            task = task_of(database, _object(database, name), VIEWS, {})
            if task is None:
                raise ValueError(f"'{name}' of {database.path} has no mesh")
            train(database, task, False)


def _object(database: Database, name: str) -> Object:
    """Returns the object of this name, which is added if it is not there."""
    with database.transaction():
        there = database.objects.named(name)
        if there:
            return there[0]
        sample = sample_mesh(name)
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, f"{name}.obj")
            write_mesh(file, sample.mesh)
            symmetries = [Symmetry(tuple(axis), fold) for axis, fold in sample.symmetries]
            stored = take_mesh(file, "m", symmetries).stored
        added = database.objects.add(Object(name, f"the {name} on the demo's table"))
        database.meshes.set(added.id, stored)
        return added
