"""The command object_delete.py, which deletes objects from the database."""

import argparse
import sys
from typing import Sequence

from ..common.commands import run_command
from ..common.plain_text import printable
from .database import Database, Object
from .database_arguments import COMMIT, add_commit, database_parser, open_database

PROGRAM = "object_delete.py"
EXAMPLES = """examples, by id, the first digits of one, and by name:
  object_delete.py 4680aac58c1d263b9449d57bd2000f27 --commit
  object_delete.py 4680a coke --commit
"""


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(sys.argv[1:])
    return run_command(PROGRAM, lambda: delete(arguments))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = database_parser(
        PROGRAM,
        "Deletes objects from the database, with their meshes, observations and models.",
        EXAMPLES,
    )
    parser.add_argument("objects", nargs="+", metavar="OBJECT", help="ids or names")
    add_commit(parser)
    return parser.parse_args(command)


def delete(arguments: argparse.Namespace) -> None:
    """Deletes the objects, or says what would be deleted; none if one of them is not there."""
    with open_database(arguments, write=arguments.commit) as database:
        if not arguments.commit:
            for text in arguments.objects:
                print("would delete", described(database, database.objects.find(text)))
            print(COMMIT)
            return
        with database.transaction():
            found = {one.id: one for one in map(database.objects.find, arguments.objects)}
            lines = [described(database, one) for one in found.values()]
            for object_id in found:
                database.objects.delete(object_id)
    for line in lines:
        print("Deleted", line)


def described(database: Database, one: Object) -> str:
    """Returns an object and what is of it, in a line."""
    mesh = database.meshes.entry(one.id)
    parts = [f"the mesh {printable(mesh.file_name)}"] if mesh else []
    models = database.models.entries_of(one.id)
    parts += [f"the model {printable(model.method)}" for model in models]
    count = database.observations.count(one.id)
    parts += [f"{count} observations"] if count else []
    return f"the object {one.id} '{one.name}'" + (f" with {', '.join(parts)}" if parts else "")
