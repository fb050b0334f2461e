"""The arguments of calibrate_headless.py that are of stereo pairs only."""

import argparse
import os
from typing import Tuple

from ..common.arguments import number_within
from .known_cameras import is_camera_file

EXAMPLES = """a stereo pair, from two folders, and from a camera that publishes both images:
  calibrate_headless.py --stereo --size 8x6 --square 0.025 left/ right/
  calibrate_headless.py --stereo --size 8x6 --square 0.025 --left /usb_cam/left/image_raw \\
      --right /usb_cam/right/image_raw --set /usb_cam
"""
MAX_SLOP = 10.0  # s


def add_pair(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments to those of the command."""
    group = parser.add_argument_group("a stereo pair")
    group.add_argument(
        "--stereo",
        action="store_true",
        help="calibrate two cameras together; FILE... are then those of the left one, and as many "
        "of the right one, or --left and --right are topics, with --bag in that bag",
    )
    group.add_argument("--left", metavar="TOPIC", help="of the left images")
    group.add_argument("--right", metavar="TOPIC", help="of the right images")
    group.add_argument(
        "--slop",
        type=number_within(float, 0.0, MAX_SLOP),
        metavar="S",
        help="s, between the stamps of two cameras that are not in step (default: 0, they are "
        "equal); the board has to be held still then",
    )
    group.add_argument(
        "--keep",
        nargs=2,
        metavar=("LEFT", "RIGHT"),
        help="keep K and D of cameras that are calibrated already: .yaml files, or topics of "
        "camera_info",
    )


def complete_pair(arguments: argparse.Namespace) -> None:
    """Checks what argparse cannot check. Raises ValueError for a usage error."""
    topics = (arguments.left, arguments.right)
    if not arguments.stereo:
        if any(topics) or arguments.slop is not None or arguments.keep:
            raise ValueError("--left, --right, --slop and --keep are of --stereo")
        return
    if arguments.topic or arguments.image:
        raise ValueError("--topic and --image are of one camera, --left and --right of --stereo")
    if bool(arguments.files) == any(topics):
        raise ValueError("the pairs are from two FILEs or from --left and --right")
    if arguments.files and (len(arguments.files) != 2 or arguments.bag):
        raise ValueError(
            "--stereo has two FILEs, of the left camera and of the right one, or --bag"
        )
    if any(topics) and not (all(topics) and arguments.left != arguments.right):
        raise ValueError("--left and --right are two topics")
    if arguments.files and arguments.slop is not None:
        raise ValueError("--slop is of images with stamps, not of files")
    arguments.slop = arguments.slop or 0.0
    if arguments.files and arguments.keep and not all(map(is_camera_file, arguments.keep)):
        raise ValueError("with FILEs, --keep has two .yaml files")


def sides_of(path: str) -> Tuple[str, str]:
    """Returns the paths of the left and the right camera: a.yaml becomes a_left.yaml, ..."""
    stem, suffix = os.path.splitext(path)
    return f"{stem}_left{suffix}", f"{stem}_right{suffix}"
