"""The arguments of object_capture.py."""

import argparse
from typing import Sequence

from .. import tag_family
from ..calibration.known_cameras import is_camera_file
from ..common.arguments import number_within, parse_completely
from ..common.errors import about
from ..ros.transport import camera_info_beside
from .database_arguments import add_commit, database_parser

PROGRAM = "object_capture.py"
EXAMPLES = """examples, from a running depth camera, from a bag, and from a folder:
  object_capture.py mug plate.yaml --commit \\
      --image /camera/rgb/image_raw --depth /camera/depth_registered/image_raw
  object_capture.py mug plate.yaml --commit --bag mug.bag \\
      --image /camera/rgb/image_raw --depth /camera/depth_registered/image_raw
  object_capture.py mug plate.yaml --commit --folder mug/

Around the object, on the plate that it stands on and turns with, there are tags whose places
calibrate_bundle.py has learned. Turn the plate slowly, once around. A folder has rgb/NAME.png,
depth/NAME.png (16 bits, mm) and camera.yaml.
"""
MAX_VIEWS = 360
MAX_SLOP = 10.0  # s
MAX_PLACE = 3.0  # m, of what is on the plate


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = database_parser(
        PROGRAM,
        "Takes images of an object on a turntable with tags, from all sides, with masks, depths "
        "and poses, from which its texture is learned, and a mesh is made.",
        EXAMPLES,
    )
    parser.add_argument("object", metavar="OBJECT", help="its id, the first digits of it, or name")
    parser.add_argument("bundle", metavar="BUNDLE", help="YAML file of calibrate_bundle.py")
    add_commit(parser)
    _add_source(parser.add_argument_group("the images"))
    _add_plate(parser.add_argument_group("the plate"))
    parser.add_argument(
        "--views",
        type=number_within(int, 4, MAX_VIEWS),
        default=36,
        help="directions around the object from which one is kept (default: %(default)s)",
    )
    more = parser.add_mutually_exclusive_group()
    more.add_argument(
        "--add",
        action="store_true",
        help="add what is missing from this height of the camera to those that there are, of the "
        "object in the same place on the plate",
    )
    more.add_argument("--replace", action="store_true", help="replace those that there are")
    parser.add_argument("--no-mesh", action="store_true", help="make no mesh in the end")
    return parse_completely(parser, command, _complete)


def _add_source(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--image", metavar="TOPIC", default="", help="of the color images")
    group.add_argument("--depth", metavar="TOPIC", default="", help="of depths of their pixels")
    group.add_argument(
        "--camera-info",
        metavar="TOPIC",
        default="",
        help="or a .yaml file, as --folder needs it (default: beside the images)",
    )
    group.add_argument("--bag", metavar="FILE", default="", help="with the topics in it")
    group.add_argument("--folder", metavar="FOLDER", default="", help="of image files")
    group.add_argument(
        "--slop",
        type=number_within(float, 0.0, MAX_SLOP),
        default=0.02,
        metavar="S",
        help="s, between the stamps of an image and its depths, at most (default: %(default)s)",
    )


def _add_plate(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--bundle-name", default="", metavar="NAME", help="of several in the file")
    group.add_argument(
        "--family", default="tag36h11", help="of tags, if BUNDLE has none (default: %(default)s)"
    )
    group.add_argument(
        "--center",
        nargs=2,
        type=number_within(float, -MAX_PLACE, MAX_PLACE, unit="m"),
        metavar=("X", "Y"),
        help="m, of the middle of the plate in the bundle's frame (default: between the tags)",
    )
    length = {
        "type": number_within(float, 0.0, MAX_PLACE, above_low=True, unit="m"),
        "metavar": "M",
    }
    group.add_argument(
        "--radius", help="m, of the place for the object (default: up to the nearest tag)", **length
    )
    group.add_argument(
        "--height",
        default=0.4,
        help="m, above which nothing is it (default: %(default)s)",
        **length,
    )
    group.add_argument(
        "--floor",
        default=0.005,
        help="m, below which all is plate (default: %(default)s)",
        **length,
    )


def _complete(arguments: argparse.Namespace) -> None:
    """Checks what argparse cannot check, and adds camera_info if it is beside the images."""
    topics = (arguments.image, arguments.depth)
    if arguments.folder and (arguments.bag or any(topics)):
        raise ValueError("the images are of --folder, or of --image and --depth")
    if arguments.folder and arguments.camera_info and not is_camera_file(arguments.camera_info):
        raise ValueError("--camera-info must be a .yaml file: nobody publishes with --folder")
    if not arguments.folder and not arguments.image:
        raise ValueError("the images are missing: --image and --depth, or --folder")
    if arguments.image and not arguments.depth:
        raise ValueError(
            "--depth is missing: only depths tell what of an image is the object, and what is "
            "behind it"
        )
    if arguments.depth == arguments.image and arguments.image:
        raise ValueError("--image and --depth are the same topic")
    if arguments.floor >= arguments.height:
        raise ValueError(f"argument --floor: {arguments.floor:g} must be below --height")
    with about("argument --family"):
        tag_family(arguments.family)
    if arguments.image and not arguments.camera_info:
        arguments.camera_info = camera_info_beside(arguments.image)
