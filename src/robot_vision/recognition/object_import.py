"""The command object_import.py, which adds objects of a folder to the database."""

import argparse
import os
import sys
from typing import Callable, List, Sequence

from ..common.commands import run_command
from .bop_import import MODELS, add_models, import_bop, is_bop
from .couch_import import import_couch
from .database import Database
from .database.folder_import import import_folder
from .database_arguments import COMMIT, add_commit, database_parser, database_path
from .mesh_data import unpack_mesh

PROGRAM = "object_import.py"
EXAMPLES = """examples, what object_export.py has written, a data set of BOP with observations, and
what object_recognition_core has in a CouchDB:
  object_import.py kitchen/ --commit
  object_import.py lm/ --split train --commit
  curl 'http://localhost:5984/object_recognition/_all_docs?include_docs=true&attachments=true' \\
      -o couch.json; object_import.py couch.json --commit
"""


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(sys.argv[1:])
    return run_command(PROGRAM, lambda: add(arguments))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = database_parser(PROGRAM, "Adds objects to the database.", EXAMPLES)
    parser.add_argument("source", metavar="SOURCE", help="a folder, or a file of CouchDB")
    parser.add_argument(
        "--split", default="", metavar="NAME", help="folder of the observations of a BOP data set"
    )
    add_models(parser)
    parser.add_argument("--replace", action="store_true", help="objects that are there, too")
    add_commit(parser)
    return parser.parse_args(command)


def add(arguments: argparse.Namespace) -> None:
    """Adds the objects, or tells which would be added."""
    path = database_path(arguments)
    option = "--split" if arguments.split else "--models"
    is_told = arguments.split or arguments.models != MODELS
    if is_told and not is_bop(arguments.source, arguments.models):
        raise ValueError(
            f"{option} is of BOP data sets, {arguments.source} is none: no {arguments.models}/"
            "obj_000001.ply or such"
        )
    if not arguments.commit and not os.path.lexists(path):
        raise ValueError(f"there is no database {path} yet: --commit makes it")
    lacks: List[str] = []
    with Database(path, write=True) as database, database.transaction(arguments.commit):
        count = _import(database, arguments, lacks.append)
    for lack in lacks:
        print(lack, file=sys.stderr)
    objects = f"{count} object{'s' * (count != 1)}"
    print(f"{objects} added" if arguments.commit else f"would add {objects}\n{COMMIT}")
    if lacks:
        raise ValueError(f"not all of {arguments.source} can be taken")


def _import(database: Database, arguments: argparse.Namespace, warn: Callable[[str], None]) -> int:
    source, replace = arguments.source, arguments.replace
    if not os.path.isdir(source):
        return import_couch(database, source, replace, print, warn)
    if is_bop(source, arguments.models):
        split, models = arguments.split, arguments.models
        return import_bop(database, source, split, replace, print, models)
    return import_folder(database, source, replace, unpack_mesh, print)
