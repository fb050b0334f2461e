"""What the commands training and detection have in common."""

import argparse
import sys

from ..common.errors import about
from .database_arguments import database_path
from .database_choice import chosen_database
from .ork_file import OrkFile
from .ork_pipelines import ALL, MISSING, Pipeline, object_choice


def add_choice(parser: argparse.ArgumentParser) -> None:
    """Adds the .ork file, and which objects are taken in place of those that it names."""
    parser.add_argument(
        "-c",
        "--config_file",
        required=True,
        metavar="FILE",
        help=".ork file; one without a folder may be in config of this package",
    )
    parser.add_argument("--object_ids", metavar="IDS", help="'[4680aac5, ...]', all or missing")
    parser.add_argument("--object_names", metavar="NAMES", help="'[coke, ...]'")


def choose_objects(pipeline: Pipeline, arguments: argparse.Namespace) -> None:
    """Puts the objects of the command line in place of those of the file.

    Raises:
        ValueError: They are not given as they must be.
    """
    given = [
        object_choice(value, f"argument --{name}")
        for name, value in (
            ("object_ids", arguments.object_ids),
            ("object_names", arguments.object_names),
        )
        if value
    ]
    special = [one for one in given if one in (ALL, MISSING)]
    if given:
        pipeline.objects = special[0] if special else [one for some in given for one in some]


def database_of(arguments: argparse.Namespace, pipeline: Pipeline, path: str) -> str:
    """Returns the path of the database: that of the command line, or of a pipeline of a file.

    What there is to be warned of is printed.

    Raises:
        ValueError: It cannot be told.
    """
    if arguments.database or arguments.db_type or arguments.db_root:
        return database_path(arguments)
    with about(f"{path}: {pipeline.name}"):
        found, warnings = chosen_database("", pipeline.db)
    for warning in warnings:
        print(f"warning: {path}: {pipeline.name}: {warning}", file=sys.stderr)
    return found


def tell(file: OrkFile) -> None:
    """Prints what there is to be warned of a file."""
    for warning in file.warnings:
        print(f"warning: {file.path}: {warning}", file=sys.stderr)
