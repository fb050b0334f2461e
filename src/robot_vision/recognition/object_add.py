"""The command object_add.py, which adds an object to the database."""

import argparse
import os
import sys
from typing import List, Sequence

from ..common.arguments import parse_completely
from ..common.commands import run_command
from ..common.plain_text import printable
from .database import Database, Object
from .database.objects import checked_object
from .database_arguments import COMMIT, add_commit, database_parser, database_path

PROGRAM = "object_add.py"
EXAMPLES = """examples:
  object_add.py -n coke -d "A universal can of coke" --commit
  object_add.py -n coke -d "A universal can of coke" -t can,red -a Ada -e ada@example.com --commit
"""


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(sys.argv[1:])
    return run_command(PROGRAM, lambda: add(arguments))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = database_parser(
        PROGRAM, "Adds an object to the database, and prints its id.", EXAMPLES
    )
    parser.add_argument("-n", "--object_name", required=True, metavar="NAME", help="its name")
    parser.add_argument("-d", "--description", default="", help="what it is")
    parser.add_argument("-a", "--author", default="", metavar="NAME", help="who has added it")
    parser.add_argument("-e", "--email", default="", metavar="ADDRESS", help="of the author")
    parser.add_argument(
        "-t", "--tag", action="append", default=[], metavar="TAGS", help="words between commas"
    )
    parser.add_argument("tags", nargs="*", metavar="TAG", help="likewise, one at a time")
    parser.add_argument(
        "--another", action="store_true", help="add it even if there is one of this name"
    )
    add_commit(parser)
    return parse_completely(parser, command, _complete)


def add(arguments: argparse.Namespace) -> None:
    """Adds the object, or says what would be added."""
    path = database_path(arguments)
    new = arguments.object
    if not arguments.commit and not os.path.lexists(path):
        print(f"would make the database {printable(path, 300)}")
        _tell_proposal(new)
        return
    with Database(path, write=arguments.commit) as database:
        if not arguments.commit:
            _require_new_name(database, new, arguments.another)
            _tell_proposal(new)
            return
        with database.transaction():
            _require_new_name(database, new, arguments.another)
            new = database.objects.add(new)
    print("Stored new object with id:", new.id)


def _complete(arguments: argparse.Namespace) -> None:
    """Adds the object as `object`."""
    tags = [tag for text in arguments.tag for tag in text.split(",")] + arguments.tags
    arguments.object = checked_object(
        Object(
            arguments.object_name, arguments.description, tags, arguments.author, arguments.email
        )
    )


def _tell_proposal(new: Object) -> None:
    tags = f", tags: {', '.join(map(printable, new.tags))}" if new.tags else ""
    print(f"would add the object '{new.name}'{tags}\n{COMMIT}")


def _require_new_name(database: Database, new: Object, another: bool) -> None:
    """Raises ValueError if there is an object of this name, which is probably meant."""
    ids: List[str] = [] if another else [one.id for one in database.objects.named(new.name)]
    if ids:
        raise ValueError(
            f"there is an object '{new.name}' already, {ids[0]}; --another adds one more of this "
            "name"
        )
