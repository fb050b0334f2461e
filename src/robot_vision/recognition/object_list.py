"""The command object_list.py, which lists the objects of the database, or writes a page of them."""

import argparse
import sys
from typing import List, Sequence

import numpy as np

from .. import mesh_extent
from ..common.commands import run_command
from ..common.files import make_folder, replace_file, require_replaceable
from ..common.plain_text import printable
from .database import Database, Object
from .database_arguments import database_parser, open_database
from .mesh_data import unpack_mesh
from .object_page import page_of
from .symmetries import symmetry_text

PROGRAM = "object_list.py"
EXAMPLES = """examples, on the terminal, and as a page for a browser with images of all meshes:
  object_list.py
  object_list.py --html objects.html
"""
HEAD = ("id", "name", "mesh", "size (mm)", "symmetries", "models", "frames")


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(sys.argv[1:])
    return run_command(PROGRAM, lambda: list_objects(arguments))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = database_parser(PROGRAM, "Lists the objects of the database.", EXAMPLES)
    parser.add_argument(
        "--html", metavar="FILE", help="write a page instead, with all images in it"
    )
    parser.add_argument("--force", action="store_true", help="replace FILE if it is there")
    return parser.parse_args(command)


def list_objects(arguments: argparse.Namespace) -> None:
    """Prints a table, or writes the page.

    Raises:
        OSError: The database cannot be read, or the page not be written.
        ValueError: Objects in it are damaged, which are told when all others are listed.
    """
    if arguments.html:
        require_replaceable(arguments.html, arguments.force, new_folders=True)
    damaged: List[str] = []
    with open_database(arguments) as database:
        if arguments.html:
            data = page_of(database, damaged).encode()
            make_folder(arguments.html)
            replace_file(arguments.html, data)
            print("written:", arguments.html)
        else:
            rows = [HEAD] + [row_of(database, one, damaged) for one in database.objects.all()]
            print("\n".join(table(rows)) if len(rows) > 1 else f"no objects in {database.path}")
    if damaged:
        raise ValueError("; ".join(damaged))


def row_of(database: Database, one: Object, damaged: List[str]) -> Sequence[str]:
    """Returns what the table says of an object, and adds to `damaged` what cannot be read of it."""
    try:
        return _row_of(database, one)
    except ValueError as error:
        damaged.append(f"'{printable(one.name)}' {one.id[:8]}: {error}")
        return one.id, printable(one.name, 30), "damaged", *"-" * (len(HEAD) - 3)


def _row_of(database: Database, one: Object) -> Sequence[str]:
    entry = database.meshes.entry(one.id)
    models = ", ".join(printable(model.method, 30) for model in database.models.entries_of(one.id))
    seen = database.observations.count(one.id)
    mesh, size, symmetries = "-", "-", "-"
    if entry is not None:
        extent = mesh_extent(unpack_mesh(database.meshes.converted(one.id)))
        mesh = printable(entry.file_name, 30)
        size = " x ".join(f"{1000.0 * side:.0f}" for side in np.asarray(extent.size))
        symmetries = ", ".join(map(symmetry_text, entry.symmetries)) or "-"
    return one.id, printable(one.name, 30), mesh, size, symmetries, models or "-", str(seen or "-")


def table(rows: Sequence[Sequence[str]]) -> List[str]:
    """Returns rows of cells as lines in which the columns stand below each other."""
    widths = [max(len(cell) for cell in column) for column in zip(*rows)]
    padded = ([cell.ljust(width) for cell, width in zip(row, widths)] for row in rows)
    return ["  ".join(cells).rstrip() for cells in padded]
