"""The arguments of create_marker.py."""

import argparse
from typing import Sequence

from .._core import tag_families
from ..common.arguments import command_parser, number_within
from .marker import LEVELS
from .sheet import PAGES

FORMATS = ("png", "svg", "pdf")

EXAMPLES = """examples:
  create_marker.py 0                              tag36h11_0.png, 10 cm
  create_marker.py -s 5 0                         the same, 5 cm
  create_marker.py -s 4 0-11                      tag36h11_0-11.pdf, twelve tags on an A4 sheet
  create_marker.py --page Letter 0,3,7            tag36h11_0_3_7.pdf, on Letter sheets
  create_marker.py --family tag16h5 -o five.svg 5
  create_marker.py -s 3 http://wiki.ros.org       qr_http---wiki-ros-org.png, a QR code
  create_marker.py --qr 1234                      a QR code of a number

Print at 100 % ("actual size"), and measure: with a tag of another size every distance is wrong.
"""


def parse(command: Sequence[str]) -> argparse.Namespace:
    """Parses a command line. Exits on wrong arguments."""
    parser = command_parser(
        "create_marker.py",
        "Makes AprilTags and QR codes to print, exact to a tenth of a millimetre.",
        EXAMPLES,
    )
    families = [family.name for family in tag_families()]
    parser.add_argument(
        "what",
        nargs="+",
        help="ids of tags (0, 0-11 or 0,3,7), or a text or URL, which becomes a QR code; a text "
        "of several words needs quotes",
    )
    parser.add_argument(
        "-s",
        "--size",
        type=number_within(float, 0.5, 300.0),
        default=10.0,  # the same as apriltag_detector's tag_size
        metavar="CM",
        help="side in cm (default: %(default)g): of a tag between its corners, which is the black "
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
        choices=PAGES,
        help="sheets with cut marks, labels and a ruler; A4 is taken for several markers",
    )
    add_output(parser)
    return parser.parse_args(command)


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
