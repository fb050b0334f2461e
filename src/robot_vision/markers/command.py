"""The command create_marker.py: from ids and texts to files to print."""

import argparse
import os
import re
import sys
from typing import Callable, Iterator, List, Sequence, Tuple

from .._core import tag_families, tag_family
from ..files import create_file, replace_file
from .drawing import Drawing
from .marker import LEVELS, Marker, qr_marker, tag_marker
from .sheet import PAGES, sheets
from .writers import to_pdf, to_png, to_svg

FORMATS = ("png", "svg", "pdf")
LONGEST = 40  # letters of a text in a label or in the name of a file

EXAMPLES = """examples:
  create_marker.py 0                              tag36h11_0.png, 9 cm
  create_marker.py -s 5 0                         the same, 5 cm
  create_marker.py -s 4 0-11                      tag36h11_0-11.pdf, twelve tags on an A4 sheet
  create_marker.py --page Letter 0,3,7            tag36h11_0_3_7.pdf, on Letter sheets
  create_marker.py --family tag16h5 -o five.svg 5
  create_marker.py -s 3 http://wiki.ros.org       qr_http---wiki-ros-org.png, a QR code
  create_marker.py --qr 1234                      a QR code of a number

Print at 100 % ("actual size"), and measure: with a tag of another size every distance is wrong.
"""


def main() -> int:
    """Runs the command; its exit code."""
    arguments = parse(sys.argv[1:])
    try:
        for path in create(arguments):
            print("written:", path)
    except (OSError, ValueError) as error:
        print(f"create_marker.py: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0


def parse(command: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="create_marker.py",
        description="Makes AprilTags and QR codes to print, exact to a tenth of a millimetre.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    families = [family.name for family in tag_families()]
    parser.add_argument(
        "what",
        nargs="+",
        help="ids of tags (0, 0-11 or 0,3,7), or a text or URL, which becomes a QR code",
    )
    parser.add_argument(
        "-s",
        "--size",
        type=number(float, 0.5, 300.0),
        default=9.0,
        metavar="CM",
        help="side in cm (default: %(default)g): of a tag between its corners, which is the black "
        "square of tag36h11, tag25h9 and tag16h5; of a QR code without the white around it",
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
    """Adds the arguments about the file."""
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
        type=number(int, 150, 1200),
        default=300,
        help="of PNG, 150 to 1200 (default: %(default)s)",
    )
    parser.add_argument("--force", action="store_true", help="replace a file that is there already")


def number(kind: Callable[[str], float], low: float, high: float) -> Callable[[str], float]:
    """What argparse makes a number in this range with."""

    def checked(text: str) -> float:
        value = kind(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text} must be from {low:g} to {high:g}")
        return value

    checked.__name__ = "number"  # as argparse calls it in its message
    return checked


def create(arguments: argparse.Namespace) -> List[str]:
    """Writes the files asked for, and returns their paths.

    Raises:
        ValueError: there are no such markers, or they do not fit.
        OSError: a file is there already, or cannot be written.
    """
    markers = [marker for text in arguments.what for marker in made_of(text, arguments)]
    page = arguments.page or ("A4" if len(markers) > 1 else None)
    pages = sheets(markers, page) if page else [markers[0].drawing()]
    stem, kind = target(arguments, "pdf" if page else "png")
    files = rendered(pages, stem, kind, arguments.dpi)
    taken = [path for path, _ in files if os.path.lexists(path)]
    if taken and not arguments.force:
        raise FileExistsError(f"{taken[0]} is there already; --force replaces it")
    write = replace_file if arguments.force else create_file
    for path, data in files:
        write(path, data)
    return [path for path, _ in files]


def made_of(text: str, arguments: argparse.Namespace) -> Iterator[Marker]:
    """The markers that an argument means."""
    size = 10.0 * arguments.size
    if re.fullmatch(r"[-\d,]+", text) and not arguments.qr:
        for id in ids(text, arguments.family):
            yield tag_marker(arguments.family, id, size)
    elif text:
        yield qr_marker(os.fsencode(text), label(text), size, arguments.level)
    else:
        raise ValueError("an empty text needs no QR code")


def ids(text: str, family: str) -> Iterator[int]:
    """The ids in a list such as 0,3,7-9.

    Raises:
        ValueError: it is no such list, or the family has not all of them.
    """
    if not re.fullmatch(r"\d+(-\d+)?(,\d+(-\d+)?)*", text):
        raise ValueError(f"'{text}' is no list of ids such as 0,3,7-9; --qr makes a QR code of it")
    last_of_family = tag_family(family).ids - 1
    for part in text.split(","):
        first, last = int(part.split("-")[0]), int(part.split("-")[-1])
        if first > last:
            raise ValueError(f"ids {part}: the first must not be above the last")
        if last > last_of_family:
            raise ValueError(f"id {last}: {family} has the ids 0 to {last_of_family}")
        yield from range(first, last + 1)


def label(text: str) -> str:
    """A text as people can read it on a sheet."""
    shown = "".join(letter if letter.isprintable() else "?" for letter in text)
    return shown if len(shown) <= LONGEST else shown[: LONGEST - 1] + "…"


def target(arguments: argparse.Namespace, default: str) -> Tuple[str, str]:
    """The file's path without its ending, and what kind of file it is.

    Raises:
        ValueError: its name ends in something else.
    """
    if not arguments.output:
        return default_name(arguments), arguments.format or default
    stem, ending = os.path.splitext(arguments.output)
    kind = ending[1:].lower()
    if kind not in FORMATS:
        raise ValueError(f"{arguments.output} must end in .png, .svg or .pdf")
    if arguments.format not in (None, kind):
        raise ValueError(
            f"{arguments.output} is no name of a file of the format {arguments.format}"
        )
    return stem, ending[1:]


def default_name(arguments: argparse.Namespace) -> str:
    """After the markers; it has no letter that a shell or a file system minds."""
    names = []
    for text in arguments.what:
        tags = re.fullmatch(r"[-\d,]+", text) and not arguments.qr
        kind = arguments.family if tags else "qr"
        names.append(kind + "_" + re.sub(r"[^a-z0-9-]", "_" if tags else "-", text.lower()))
    return "_".join(names)[:100]


def rendered(pages: Sequence[Drawing], stem: str, kind: str, dpi: int) -> List[Tuple[str, bytes]]:
    """Paths and contents of the files."""
    if kind.lower() == "pdf":
        return [(f"{stem}.{kind}", to_pdf(pages))]
    made = [to_svg(page) if kind.lower() == "svg" else to_png(page, dpi) for page in pages]
    if len(made) == 1:
        return [(f"{stem}.{kind}", made[0])]
    return [(f"{stem}-{number}.{kind}", data) for number, data in enumerate(made, 1)]
