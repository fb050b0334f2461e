"""The command object_export.py, which writes objects of the database into a folder."""

import argparse
import sys
from typing import Sequence

from ..common.commands import run_command
from .bop_export import export_bop
from .database.folder_export import export_folder
from .database_arguments import database_parser, open_database

PROGRAM = "object_export.py"
EXAMPLES = """examples, all objects with what was learned, two without, and as a data set of BOP:
  object_export.py kitchen/
  object_export.py kitchen/ coke bottle --no-models
  object_export.py kitchen_bop/ --bop
"""


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(sys.argv[1:])
    return run_command(PROGRAM, lambda: export(arguments))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = database_parser(
        PROGRAM, "Writes objects of the database into a new folder, as JSON and files.", EXAMPLES
    )
    parser.add_argument("folder", metavar="FOLDER", help="it must not be there yet")
    parser.add_argument("objects", nargs="*", metavar="OBJECT", help="(default: all)")
    parser.add_argument("--bop", action="store_true", help="in the format of the BOP benchmark")
    parser.add_argument("--no-models", action="store_true", help="without what was learned")
    return parser.parse_args(command)


def export(arguments: argparse.Namespace) -> None:
    """Writes the folder.

    Raises:
        OSError: The folder is there already, or cannot be written.
        ValueError: An object is not there, or the database is damaged.
    """
    with open_database(arguments) as database:
        found = {one.id: one for one in map(database.objects.find, arguments.objects)}
        chosen = list(found.values()) if arguments.objects else database.objects.all()
        if not chosen:
            raise ValueError(f"no objects in {database.path}")
        if arguments.bop:
            for one in export_bop(database, chosen, arguments.folder):
                print(f"left out, as it has no mesh: {one.id} {one.name}", file=sys.stderr)
        else:
            export_folder(database, chosen, arguments.folder, not arguments.no_models, print)
    print("written:", arguments.folder)
