"""The arguments of calibrate_headless.py."""

import argparse
import itertools
import os
import re
from typing import Callable, Sequence

from ..common.arguments import board_size, command_parser, number_within, parse_completely
from .board_pose import quarter_turns
from .boards import BOARDS, Board
from .camera_file import default_path
from .pair_arguments import EXAMPLES as PAIR_EXAMPLES
from .pair_arguments import add_pair, complete_pair, sides_of
from .solving import MIN_VIEWS, MODELS

EXAMPLES = f"""examples, from images, a video, a bag, and a running camera:
  calibrate_headless.py --size 8x6 --square 0.025 images/
  calibrate_headless.py --size 8x6 --square 0.025 --output $PWD/eye.yaml '*.png' more.mp4
  calibrate_headless.py --size 8x6 --square 0.025 --bag eye.bag --image /usb_cam/image_raw
  calibrate_headless.py --size 8x6 --square 0.025 --topic /usb_cam/image_raw --set /usb_cam
other boards, and a fisheye lens:
  calibrate_headless.py --board charuco --size 11x8 --square 0.025 --marker 0.018 \\
      --dictionary 5x5_100 images/
  calibrate_headless.py --board acircles --size 4x11 --square 0.02 --model equidistant images/
{PAIR_EXAMPLES}
Show the board all over the image, near and far, and tilted to all sides, and hold it still. With
--topic, Ctrl-C ends the recording, and the camera is computed. The colours in the image of the
coverage: red cells have never seen the board; green views fit, red ones do not.
"""
MAX_IMAGES = 1000
LENGTH = number_within(float, 0.0, 10.0, above_low=True, unit="m")


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line, and adds what is made of it. Exits on wrong arguments.

    That is the board as `found`, with `turns`, the numbers of quarter turns after which it looks
    the same; and with --stereo `outputs`, the files of the left and the right camera.
    """
    parser = command_parser(
        "calibrate_headless.py",
        "Calibrates a camera, or a stereo pair, without a screen, by images of a board, and writes "
        "the file that the camera loads at its next start.",
        EXAMPLES,
    )
    _add_sources(parser)
    add_pair(parser)
    _add_board(parser)
    _add_results(parser)
    return parse_completely(parser, command, _complete)


def _add_sources(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("the images, from one of")
    group.add_argument("files", nargs="*", metavar="FILE", help="folder, glob, images, videos")
    group.add_argument("--bag", metavar="FILE", help="a bag; with --image")
    group.add_argument("--image", metavar="TOPIC", help="of the images in the bag")
    group.add_argument("--topic", help="of a running camera")
    parser.add_argument(
        "--most",
        type=number_within(int, MIN_VIEWS, MAX_IMAGES),
        default=60,
        metavar="N",
        help="images that are used; what is like others is not (default: %(default)s)",
    )
    parser.add_argument(
        "--max-blur",
        type=number_within(float, 1.0, 1000.0),
        default=6.0,
        metavar="PX",
        help="width of an edge above which an image is too blurred (default: %(default)g)",
    )


def _add_board(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("the board")
    group.add_argument("--board", choices=sorted(BOARDS), default="chessboard")
    group.add_argument(
        "--size",
        required=True,
        type=board_size,
        metavar="WxH",
        help="inner corners of a chessboard (one less than squares), circles, or squares of a "
        "ChArUco board",
    )
    group.add_argument(
        "--square",
        required=True,
        type=LENGTH,
        metavar="M",
        help="m, side of a square, or from circle to circle (acircles: from row to row)",
    )
    group.add_argument("--marker", type=LENGTH, metavar="M", help="m, side of a ChArUco marker")
    group.add_argument("--dictionary", help="of the ChArUco markers: 4x4_50, 5x5_100, ...")


def _add_results(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("the camera")
    group.add_argument("--model", choices=MODELS, default=MODELS[0], help="of the distortion")
    group.add_argument(
        "--k3", action="store_true", help="plumb_bob with k3; without it k3 is 0, as most want it"
    )
    group.add_argument("--camera-name", default="head_camera", metavar="NAME")
    group.add_argument(
        "--output",
        metavar="FILE",
        help="YAML file to write (default: the one that a camera node of this name loads; with "
        "--set, which has the node write that one, a new one beside it); --stereo writes two, and "
        "adds _left and _right to the name",
    )
    group.add_argument("--force", action="store_true", help="replace files that are there")
    group.add_argument(
        "--set",
        metavar="NODE",
        help="give it to this camera node, which keeps it; with --stereo to NODE/left and "
        "NODE/right",
    )
    group.add_argument(
        "--coverage",
        metavar="FILE",
        help="image of where the board was seen (default: beside the YAML file, .png)",
    )


def _complete(arguments: argparse.Namespace) -> None:
    """Checks what argparse cannot check, and adds the board and the paths of the output files."""
    complete_pair(arguments)
    if not arguments.stereo:
        _check_sources(arguments)
    if arguments.k3 and arguments.model != "plumb_bob":
        raise ValueError(f"--k3 is of plumb_bob, the model is {arguments.model}")
    if not re.fullmatch("[A-Za-z0-9_]+", arguments.camera_name):
        raise ValueError(
            f"argument --camera-name: is '{arguments.camera_name}', must be letters, digits and _"
        )
    arguments.found = _board(arguments)
    arguments.turns = quarter_turns(arguments.board, *arguments.size, arguments.found)
    _complete_outputs(arguments)


def _check_sources(arguments: argparse.Namespace) -> None:
    sources = (arguments.files, arguments.bag, arguments.topic)
    if sum(map(bool, sources)) != 1:
        raise ValueError("the images are from FILE..., --bag or --topic: one of them")
    if bool(arguments.bag) != bool(arguments.image):
        raise ValueError("--bag and --image belong together")


def _complete_outputs(arguments: argparse.Namespace) -> None:
    if arguments.output is None:
        name, sides = arguments.camera_name, sides_of if arguments.stereo else _itself
        calibrated = _unused(name + "-calibrated", sides) if arguments.set else None
        arguments.output = calibrated or default_path(name)
    if arguments.stereo:
        arguments.outputs = sides_of(arguments.output)
    if arguments.coverage is None:
        arguments.coverage = re.sub(r"\.ya?ml$", "", arguments.output) + ".png"


def _itself(path: str) -> Sequence[str]:
    return [path]


def _unused(stem: str, files: Callable[[str], Sequence[str]]) -> str:
    """Returns a path beside the files that cameras load, whose names have no hyphen.

    None of the files that are made of it is there.
    """
    names = (stem + (f"-{number}" if number else "") for number in itertools.count())
    return next(
        path for path in map(default_path, names) if not any(map(os.path.lexists, files(path)))
    )


def _board(arguments: argparse.Namespace) -> Board:
    of_charuco = (arguments.marker, arguments.dictionary)
    if arguments.board != "charuco":
        if any(of_charuco):
            raise ValueError(f"--marker and --dictionary are of charuco, not of {arguments.board}")
        return BOARDS[arguments.board](*arguments.size, arguments.square)
    if not all(of_charuco):
        raise ValueError("a ChArUco board has --marker and --dictionary")
    if arguments.marker >= arguments.square:
        raise ValueError(
            f"argument --marker: is {arguments.marker:g}, must be less than --square, "
            f"{arguments.square:g}"
        )
    return BOARDS["charuco"](*arguments.size, arguments.square, *of_charuco)
