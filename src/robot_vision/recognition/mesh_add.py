"""The command mesh_add.py, which gives an object of the database its mesh."""

import argparse
import sys
from typing import Sequence

from ..common.arguments import number_within, parse_completely
from ..common.commands import run_command
from ..common.plain_text import printable
from .database_arguments import COMMIT, add_commit, database_parser, open_database
from .mesh_intake import UNITS, take_mesh
from .symmetries import FORM, parse_symmetries, symmetry_text

PROGRAM = "mesh_add.py"
EXAMPLES = """examples, with all that is guessed, and a bottle in millimetres that looks the same
after any turn about its z axis:
  mesh_add.py 4680aac58c1d263b9449d57bd2000f27 coke.stl --commit
  mesh_add.py bottle bottle.obj --unit mm --symmetry z --commit
"""


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(sys.argv[1:])
    return run_command(PROGRAM, lambda: add(arguments))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = database_parser(
        PROGRAM, "Gives an object of the database a mesh, in place of the one it has.", EXAMPLES
    )
    parser.add_argument("object", metavar="OBJECT", help="id, its first digits, or the name")
    parser.add_argument("mesh", metavar="FILE", help="stl, obj, dae, ply, gltf, ...; in any unit")
    parser.add_argument("--unit", choices=list(UNITS), help="of the file (default: it is guessed)")
    parser.add_argument(
        "--symmetry", default="none", metavar="TURNS", help=f"turns that nobody can see: {FORM}"
    )
    parser.add_argument(
        "--scale", type=number_within(float, 1e-6, 1e6), default=1.0, help="times the unit"
    )
    parser.add_argument(
        "--center", action="store_true", help="move its origin, which poses tell, into its middle"
    )
    add_commit(parser)
    return parse_completely(parser, command, _complete)


def _complete(arguments: argparse.Namespace) -> None:
    """Adds the symmetries as `symmetries`."""
    arguments.symmetries = parse_symmetries(arguments.symmetry)


def add(arguments: argparse.Namespace) -> None:
    """Reads the mesh and stores it, or says what would be stored."""
    with open_database(arguments, write=arguments.commit) as database:
        one = database.objects.find(arguments.object)
        taken = take_mesh(
            arguments.mesh,
            arguments.unit,
            arguments.symmetries,
            arguments.scale,
            arguments.center,
        )
        for note in taken.notes:
            print(note)
        for symmetry in arguments.symmetries:
            print("symmetry:", symmetry_text(symmetry))
        if not arguments.commit:
            file_name = printable(taken.stored.file_name)
            print(f"would give '{one.name}' the mesh {file_name}\n{COMMIT}")
            return
        with database.transaction():
            database.objects.find(one.id)  # which may have been deleted meanwhile
            database.meshes.set(one.id, taken.stored)
    print("Stored mesh for object id :", one.id)
