"""The arguments that all commands on the database have."""

import argparse
import sys

from ..common.arguments import command_parser
from .database import Database, default_path
from .database_choice import chosen_database

COMMIT = "Use the --commit option to commit the proposed change."


def database_parser(program: str, description: str, examples: str) -> argparse.ArgumentParser:
    """Returns a parser with the arguments that say which database is meant."""
    parser = command_parser(program, description, examples)
    group = parser.add_argument_group("the database")
    group.add_argument(
        "--database", metavar="FILE", default="", help=f"(default: {_escaped(default_path())})"
    )
    server = "as object_recognition_core has it; servers are not used"
    group.add_argument("--db_type", metavar="TYPE", default="", help=server)
    group.add_argument("--db_root", metavar="URL", default="", help="likewise")
    group.add_argument("--db_collection", metavar="NAME", default="", help="likewise")
    return parser


def add_commit(parser: argparse.ArgumentParser) -> None:
    """Adds --commit, without which a command only says what it would do."""
    parser.add_argument("--commit", action="store_true", help="make the change; else it is told")


def database_path(arguments: argparse.Namespace) -> str:
    """Returns the path of the database, and prints what there is to be warned of.

    Raises:
        ValueError: It cannot be told.
    """
    db = {
        "type": arguments.db_type,
        "root": arguments.db_root,
        "collection": arguments.db_collection,
    }
    path, warnings = chosen_database(arguments.database, db)
    for warning in warnings:
        print(f"warning: {warning}", file=sys.stderr)
    return path


def open_database(arguments: argparse.Namespace, write: bool = False) -> Database:
    """Opens the database that the arguments name, which must be there.

    Raises:
        OSError: It is not there, or cannot be opened.
        ValueError: It is no database.
    """
    return Database(database_path(arguments), write, make=False)


def _escaped(text: str) -> str:
    return text.replace("%", "%%")  # as argparse wants it
