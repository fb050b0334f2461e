"""The arguments of create_marker.py."""

import argparse
from typing import Sequence

from .._core import tag_families
from ..common.arguments import board_size, command_parser, number_within, parse_completely
from .board import BOARD_PAGES, BOARDS
from .marker import LEVELS
from .sheet import PAGES

FORMATS = ("png", "svg", "pdf")
SIZE = 10.0  # cm, of a tag or code; the same as apriltag_detector's tag_size
SQUARE = 25.0  # mm
LENGTH = number_within(float, 1.0, 300.0, unit="mm")

EXAMPLES = """examples:
  create_marker.py 0                              tag36h11_0.png, 10 cm
  create_marker.py -s 5 0                         the same, 5 cm
  create_marker.py -s 4 0-11                      tag36h11_0-11.pdf, twelve tags on an A4 sheet
  create_marker.py --page Letter 0,3,7            tag36h11_0_3_7.pdf, on Letter sheets
  create_marker.py --family tag16h5 -o five.svg 5
  create_marker.py -s 3 http://wiki.ros.org       qr_http---wiki-ros-org.png, a QR code
  create_marker.py --qr 1234                      a QR code of a number
  create_marker.py --checkerboard 8x6             checkerboard_8x6_25mm.pdf, to calibrate by, on A4
  create_marker.py --circles 7x6 --square 24      circles_7x6_24mm.pdf, 24 mm from circle to circle
  create_marker.py --acircles 4x11 --square 20    acircles_4x11_20mm.pdf, every other row shifted
  create_marker.py --charuco 8x6 --square 28      charuco_8x6_28mm.pdf, with markers of 19.6 mm

Print at 100 % ("actual size"), and measure: with a tag of another size every distance is wrong.
"""


def parse(command: Sequence[str]) -> argparse.Namespace:
    """Parses a command line. Exits on wrong arguments."""
    parser = command_parser(
        "create_marker.py",
        "Makes AprilTags, QR codes and calibration boards to print, exact to a tenth of a "
        "millimetre.",
        EXAMPLES,
    )
    families = [family.name for family in tag_families()]
    parser.add_argument(
        "what",
        nargs="*",
        help="ids of tags (0, 0-11 or 0,3,7), or a text or URL, which becomes a QR code; a text "
        "of several words needs quotes",
    )
    parser.add_argument(
        "-s",
        "--size",
        type=number_within(float, 0.5, 300.0),
        metavar="CM",
        help=f"side in cm (default: {SIZE:g}): of a tag between its corners, which is the black "
        "square of tag36h11, tag25h9 and tag16h5, and of the others the square inside the black "
        "frame; of a QR code without the white around it",
    )
    parser.add_argument(
        "--family",
        choices=families,
        default="tag36h11",
        metavar="NAME",
        help=f"of the tags, one of {', '.join(families)} (default: %(default)s)",
    )
    parser.add_argument("--qr", action="store_true", help="QR codes of numbers, too")
    parser.add_argument(
        "--level",
        choices=LEVELS,
        default="M",
        help="error correction of a QR code, from little to much (default: %(default)s)",
    )
    parser.add_argument(
        "--page",
        type=str.capitalize,
        choices=BOARD_PAGES,
        help="sheets with cut marks, labels and a ruler; A4 is taken for several markers, and for "
        f"a board. Tags and codes have {' and '.join(PAGES)}",
    )
    add_boards(parser)
    add_output(parser)
    return parse_completely(parser, command, complete)


def add_boards(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments about calibration boards."""
    group = parser.add_argument_group("instead of tags and codes, a board to calibrate by")
    kinds = group.add_mutually_exclusive_group()
    counted = {
        "checkerboard": "inner corners of a checkerboard, one less than squares: 8x6",
        "circles": "circles in rows and columns",
        "acircles": "circles of which every other row is shifted, in a row and rows: 4x11",
        "charuco": "squares of a checkerboard with ArUco markers in the white ones",
    }
    for kind in BOARDS:
        kinds.add_argument(f"--{kind}", type=board_size, metavar="WxH", help=counted[kind])
    group.add_argument(
        "--square",
        type=LENGTH,
        metavar="MM",
        help=f"mm (default: {SQUARE:g}): side of a square, or from circle to circle (acircles: "
        "from row to row)",
    )
    group.add_argument(
        "--marker",
        type=LENGTH,
        metavar="MM",
        help="mm, side of a ChArUco marker (default: seven tenths of a square)",
    )
    group.add_argument(
        "--dictionary", metavar="NAME", help="of the ChArUco markers (default: 4x4_50)"
    )


def complete(arguments: argparse.Namespace) -> None:
    """Adds `board`, (kind, columns, rows) or None, and checks what belongs to which."""
    given = {kind: getattr(arguments, kind) for kind in BOARDS if getattr(arguments, kind)}
    arguments.board = next(((kind, *size) for kind, size in given.items()), None)
    of_charuco = arguments.marker or arguments.dictionary
    if of_charuco and "charuco" not in given:
        raise ValueError("--marker and --dictionary are of --charuco")
    if arguments.board is None:
        complete_markers(arguments)
    elif arguments.what:
        raise ValueError(f"a board is made alone, without {arguments.what[0]}")
    elif arguments.size is not None:
        raise ValueError("argument -s/--size: is of tags and codes; a board has --square, in mm")
    arguments.size = arguments.size or SIZE
    arguments.square = arguments.square or SQUARE


def complete_markers(arguments: argparse.Namespace) -> None:
    if not arguments.what:
        raise ValueError("the following arguments are required: what, or a board")
    if arguments.square:
        raise ValueError("argument --square: is of boards; tags and codes have --size, in cm")
    if arguments.page and arguments.page not in PAGES:
        raise ValueError(
            f"argument --page: invalid choice: '{arguments.page}' (choose from "
            f"{', '.join(PAGES)}; boards have others, too)"
        )


def add_output(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments about the output file."""
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        help="ends in .png, .svg or .pdf (default: named after the markers, in this folder); PNG "
        "and SVG become one file per sheet",
    )
    parser.add_argument(
        "--format",
        choices=FORMATS,
        help="without --output (default: png for a marker, pdf for sheets)",
    )
    parser.add_argument(
        "--dpi",
        type=number_within(int, 150, 1200),
        default=300,
        help="of PNG and of the printer, 150 to 1200 (default: %(default)s); a QR code must "
        "have three dots for each of its cells",
    )
    parser.add_argument("--force", action="store_true", help="replace a file that is there already")
