"""The command mesh_view.py, which shows an object's mesh from all sides."""

import argparse
import os
import sys
from typing import Sequence

from ..common import opencv as cv2
from ..common.arguments import number_within
from ..common.commands import run_command
from ..common.files import make_folder, replace_file, require_replaceable
from ..common.plain_text import printable
from ..meshes import mesh_sheet, read_mesh
from .database_arguments import database_parser, open_database
from .mesh_data import unpack_mesh

PROGRAM = "mesh_view.py"
EXAMPLES = """examples, of an object of the database, and of a file:
  mesh_view.py coke --output coke.png
  mesh_view.py coke.stl --output coke.png
"""


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(sys.argv[1:])
    return run_command(PROGRAM, lambda: view(arguments))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = database_parser(
        PROGRAM, "Writes a sheet of views of a mesh, of an object or in a file, as PNG.", EXAMPLES
    )
    parser.add_argument("object", metavar="OBJECT", help="id, its first digits, name, or a file")
    parser.add_argument("--output", required=True, metavar="FILE", help="PNG to write")
    parser.add_argument("--force", action="store_true", help="replace FILE if it is there")
    parser.add_argument(
        "--side",
        type=number_within(int, 50, 1000),
        default=240,
        metavar="PX",
        help="of each view (default: %(default)s)",
    )
    return parser.parse_args(command)


def view(arguments: argparse.Namespace) -> None:
    """Writes the sheet.

    Raises:
        OSError: A file cannot be read or written.
        ValueError: There is no such object, or it has no mesh.
    """
    require_replaceable(arguments.output, arguments.force, new_folders=True)
    sheet = mesh_sheet(_mesh(arguments), side=arguments.side)
    make_folder(arguments.output)
    replace_file(arguments.output, cv2.imencode(".png", sheet)[1].tobytes())
    print("written:", printable(arguments.output, 300))


def _mesh(arguments: argparse.Namespace) -> object:
    if os.path.splitext(arguments.object)[1] and os.path.isfile(arguments.object):
        loaded = read_mesh(arguments.object)
        print(loaded.unit_reason)
        return loaded.mesh
    with open_database(arguments) as database:
        one = database.objects.find(arguments.object)
        if database.meshes.entry(one.id) is None:
            raise ValueError(f"'{one.name}' has no mesh: mesh_add.py adds it")
        return unpack_mesh(database.meshes.converted(one.id))
