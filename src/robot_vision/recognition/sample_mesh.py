"""The command sample_mesh.py, which writes the meshes of the demo's table into files."""

import argparse
import sys

from .. import mesh_extent, sample_mesh, sample_mesh_names
from ..common.arguments import command_parser
from ..common.commands import run_command
from ..meshes import write_mesh

PROGRAM = "sample_mesh.py"
EXAMPLES = """examples:
  sample_mesh.py mug mug.stl
  sample_mesh.py box /tmp/box.obj       (with its textures, in files beside it)
"""


def main() -> int:
    """Runs the command and returns its exit code."""
    parser = command_parser(
        PROGRAM,
        "Writes a mesh of a thing on the demo's table (camera.launch scene:=tabletop) into a file, "
        "in m: .ply with colors, .stl with the shape alone, or .obj with textures.",
        EXAMPLES,
    )
    parser.add_argument("name", choices=sample_mesh_names(), help="the thing")
    parser.add_argument("file", metavar="FILE", help="NAME.ply, NAME.stl or NAME.obj")
    parser.add_argument("--force", action="store_true", help="replace files that are there already")
    arguments = parser.parse_args(sys.argv[1:])
    return run_command(PROGRAM, lambda: _write(arguments))


def _write(arguments: argparse.Namespace) -> None:
    mesh = sample_mesh(arguments.name).mesh
    write_mesh(arguments.file, mesh, replace=arguments.force)
    size = " x ".join(f"{length:.3f}" for length in mesh_extent(mesh).size)
    print(f"{arguments.file}: {size} m, {len(mesh.triangles)} triangles")
