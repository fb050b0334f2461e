"""The command object_search.py, which finds objects in the database."""

import argparse
import sys
from typing import List, Sequence

from ..common.commands import run_command
from ..common.plain_text import printable
from .database import Database, Object
from .database_arguments import database_parser, open_database

PROGRAM = "object_search.py"
EXAMPLES = """examples, all objects, those with a tag, and those with words in name or description:
  object_search.py
  object_search.py -t can
  object_search.py universal can
"""
MAX_LENGTH = 1000  # characters of a description


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(sys.argv[1:])
    return run_command(PROGRAM, lambda: search(arguments))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = database_parser(PROGRAM, "Finds objects in the database.", EXAMPLES)
    parser.add_argument("-t", "--tag", default="", help="that they must have")
    parser.add_argument("words", nargs="*", metavar="WORD", help="in their name or description")
    return parser.parse_args(command)


def search(arguments: argparse.Namespace) -> None:
    """Prints the objects, and all that is known of each.

    Raises:
        ValueError: There is none.
    """
    with open_database(arguments) as database:
        found = database.objects.tagged(arguments.tag) if arguments.tag else database.objects.all()
        found = [one for one in found if has_words(one, arguments.words)]
        if not found:
            raise ValueError(f"no such object in {database.path}")
        for one in found:
            print("\n".join(lines_of(database, one)))


def has_words(one: Object, words: Sequence[str]) -> bool:
    """Returns whether the name and description of an object have all words in them."""
    text = f"{one.name} {one.description}".casefold()
    return all(word.casefold() in text for word in words)


def lines_of(database: Database, one: Object) -> List[str]:
    """Returns what is known of an object, as object_recognition_core prints it."""
    mesh = database.meshes.entry(one.id)
    models = [printable(model.method) for model in database.models.entries_of(one.id)]
    sessions = [printable(session.id) for session in database.observations.sessions(one.id)]
    return [
        "*" * 30,
        f"Object Name: {one.name}",
        f"Description: {printable(one.description, MAX_LENGTH)}",
        f"Tags: {','.join(one.tags)}",
        f"Author: {printable(one.author)}",
        f"email: {printable(one.email)}",
        f"db id: {one.id}",
        f"added: {printable(one.added)}",
        f"mesh: {printable(mesh.file_name) if mesh else 'none'}",
        f"models: {', '.join(models) or 'none'}",
        f"session ids: {', '.join(sessions) or 'none'}",
    ]
