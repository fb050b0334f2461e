"""The command create_marker.py, which makes files with markers to print."""

import argparse
import os
import re
import sys
from typing import Iterator, List, Sequence, Tuple

from ..common.commands import run_command
from ..common.files import create_file, replace_file
from ..tags.tag_ids import parse_ids
from .advice import cell_advice, require_board_dots, require_dots, tag_size_line, words_advice
from .arguments import FORMATS, parse
from .board import board_sheet, make_board
from .drawing import Drawing
from .marker import Marker, qr_marker, tag_marker
from .sheet import sheets
from .writers import to_pdf, to_png, to_svg

PROGRAM = "create_marker.py"
MAX_LABEL_LENGTH = 40  # characters of a text in a label


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse(sys.argv[1:])
    return run_command(PROGRAM, lambda: make(arguments))


def make(arguments: argparse.Namespace) -> None:
    """Writes the files, and prints hints about what is in them.

    Raises:
        ValueError: A marker does not exist, does not fit on the page, or could not be read.
        OSError: A file exists already, or cannot be written.
    """
    (make_markers if arguments.board is None else make_calibration_board)(arguments)


def make_calibration_board(arguments: argparse.Namespace) -> None:
    """Writes the files of a board, and prints how to calibrate by it."""
    board = make_board(*arguments.board, arguments.square, arguments.marker, arguments.dictionary)
    require_board_dots(board, arguments.dpi)
    for path in write([board_sheet(board, arguments.page or "A4")], "pdf", arguments):
        print("written:", path)
    print(f"to calibrate: rosrun robot_vision calibrate_headless.py {board.words} IMAGES")


def make_markers(arguments: argparse.Namespace) -> None:
    """Writes the files of tags and QR codes, and prints hints about them."""
    markers = [marker for text in arguments.what for marker in markers_of(text, arguments)]
    for marker in markers:
        require_dots(marker, arguments.dpi)
    page = arguments.page or ("A4" if len(markers) > 1 else None)
    pages = sheets(markers, page) if page else [markers[0].drawing()]
    for path in write(pages, "pdf" if page else "png", arguments):
        print("written:", path)
    tags = [text for text in arguments.what if means_tags(text, arguments)]
    if tags:
        print(tag_size_line(arguments.family, 10.0 * arguments.size))
    advice = [cell_advice(marker) for marker in markers]
    if len(tags) < len(arguments.what):
        advice.append(words_advice(arguments.what))
    for line in filter(None, advice):
        print(f"{PROGRAM}: {line}", file=sys.stderr)


def write(pages: Sequence[Drawing], default: str, arguments: argparse.Namespace) -> Iterator[str]:
    """Writes the files, and yields the path of each as soon as it is written.

    Args:
        pages: What is drawn.
        default: The suffix where the arguments name no format.
        arguments: Those of the command.

    Raises:
        ValueError: The suffix is not that of a known format.
        OSError: A file exists already, or cannot be written.
    """
    stem, kind = target(arguments, default)
    files = rendered(pages, stem, kind, arguments.dpi)
    taken = [path for path, _ in files if os.path.lexists(path)]
    if taken and not arguments.force:
        raise FileExistsError(f"{taken[0]} is there already; --force replaces it")
    put = replace_file if arguments.force else create_file
    for path, data in files:
        put(path, data)
        yield path


def markers_of(text: str, arguments: argparse.Namespace) -> Iterator[Marker]:
    """Yields the markers that an argument stands for."""
    size = 10.0 * arguments.size
    if means_tags(text, arguments):
        for id in ids(text, arguments.family):
            yield tag_marker(arguments.family, id, size)
    elif text:
        yield qr_marker(os.fsencode(text), label(text), size, arguments.level)
    else:
        raise ValueError("an empty text needs no QR code")


def means_tags(text: str, arguments: argparse.Namespace) -> bool:
    """Returns whether an argument is meant as a list of ids, even if it is not a correct one."""
    return not arguments.qr and re.fullmatch("[-0-9, ]*[0-9][-0-9, ]*", text) is not None


def ids(text: str, family: str) -> List[int]:
    """Returns the ids in a list such as 0,3,7-9.

    Raises:
        ValueError: The text is not such a list, or the family does not have all of the ids.
    """
    try:
        return parse_ids(text, family)
    except ValueError as error:
        raise ValueError(f"{error}; --qr makes a QR code of it") from None


def label(text: str) -> str:
    """Returns a text for a label on a sheet: printable and not too long."""
    shown = "".join(letter if letter.isprintable() else "?" for letter in text)
    return shown if len(shown) <= MAX_LABEL_LENGTH else shown[: MAX_LABEL_LENGTH - 1] + "…"


def target(arguments: argparse.Namespace, default: str) -> Tuple[str, str]:
    """Returns the path of the file without its suffix, and the suffix.

    Raises:
        ValueError: The suffix is not that of a known format.
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
    """Returns a file name made of the arguments, without characters special to shells."""
    if arguments.board:
        kind, columns, rows = arguments.board
        return f"{kind}_{columns}x{rows}_{arguments.square:g}mm"
    names = []
    for text in arguments.what:
        tags = means_tags(text, arguments)
        kind = arguments.family if tags else "qr"
        names.append(kind + "_" + re.sub("[^a-z0-9-]", "_" if tags else "-", text.lower()))
    return "_".join(names)[:100]


def rendered(pages: Sequence[Drawing], stem: str, kind: str, dpi: int) -> List[Tuple[str, bytes]]:
    """Returns the paths and contents of the files."""
    if kind.lower() == "pdf":
        return [(f"{stem}.{kind}", to_pdf(pages))]
    made = [to_svg(page) if kind.lower() == "svg" else to_png(page, dpi) for page in pages]
    if len(made) == 1:
        return [(f"{stem}.{kind}", made[0])]
    return [(f"{stem}-{number}.{kind}", data) for number, data in enumerate(made, 1)]
