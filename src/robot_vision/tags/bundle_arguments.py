"""The arguments of calibrate_bundle.py."""

import argparse
from typing import Dict, List, Optional, Sequence, Tuple

from .. import tag_family
from ..common.arguments import command_parser, number_within, parse_completely
from ..common.errors import about
from ..common.plain_text import NAME, brief, is_name
from .bundle_files import MAX_TAG_SIZE
from .tag_ids import parse_ids
from .tag_layout import TagLayout

EXAMPLES = """examples, with a running apriltag_detector and from a bag:
  calibrate_bundle.py --name box --ids 0-5 --size 0.1 --output box.yaml \\
      tags:=/apriltag_detector/tags
  calibrate_bundle.py --name box --ids 0-5 --size 0.1 --output box.yaml \\
      --bag box.bag --image /usb_cam/image_raw
  calibrate_bundle.py --name desk --ids 3,4,7-9 --master 7 --size 0.1,3:0.2,4:0.2 \\
      --output desk.yaml --force tags:=/apriltag_detector/tags camera_info:=/usb_cam/camera_info

Show the body from all sides, so that each tag is seen together with others, and move slowly. Ctrl-C
ends the recording, and the layout is computed. A launch file loads it for the detector:
  <rosparam command="load" file="box.yaml" ns="apriltag_detector"/>
"""
MAX_FRAMES = 10000


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line, and adds `sizes` in m by tag. Exits on wrong arguments."""
    parser = command_parser(
        "calibrate_bundle.py",
        "Learns where AprilTags sit on a rigid body from frames that show several of them at once, "
        "and writes the tag_bundles of apriltag_detector.",
        EXAMPLES,
    )
    parser.add_argument("--name", required=True, help="of the bundle, and of its transform")
    parser.add_argument("--ids", required=True, help="of its tags: 0-5, or 0,2,7-9")
    parser.add_argument(
        "--size", required=True, help="m, between the corners: 0.1 of all, 0.1,3:0.2 of tag 3 0.2"
    )
    parser.add_argument(
        "--master", type=int, help="the tag whose frame is the bundle's (default: the lowest id)"
    )
    parser.add_argument("--family", default="tag36h11", help="of the tags (default: %(default)s)")
    parser.add_argument("--output", required=True, metavar="FILE", help="YAML file to write")
    parser.add_argument("--force", action="store_true", help="replace FILE if it is there")
    parser.add_argument(
        "--frames",
        type=number_within(int, 1, MAX_FRAMES),
        default=300,
        help="most that are collected (default: %(default)s)",
    )
    parser.add_argument("--bag", metavar="FILE", help="take images from a bag; with --image")
    parser.add_argument("--image", metavar="TOPIC", help="of the images in the bag")
    parser.add_argument(
        "--camera-info", default="", metavar="TOPIC", help="in the bag (default: beside the image)"
    )
    return parse_completely(parser, command, _complete)


def _complete(arguments: argparse.Namespace) -> None:
    """Checks what argparse cannot check, and adds the sizes by tag."""
    ids = _ids_of(arguments.ids, arguments.family)
    with about("argument --size"):
        arguments.sizes = _sizes_of(arguments.size, ids)
    arguments.master = ids[0] if arguments.master is None else arguments.master
    if arguments.master not in ids:
        raise ValueError(f"argument --master: tag {arguments.master} is not one of --ids")
    with about("argument --name"):
        _require_name(arguments.name, arguments.family, arguments.sizes)
    if bool(arguments.bag) != bool(arguments.image) or (
        arguments.camera_info and not arguments.bag
    ):
        raise ValueError(
            "--bag needs --image, and only with it there are --image and --camera-info"
        )


def _require_name(name: str, family: str, sizes: Dict[int, float]) -> None:
    """Raises ValueError for a name with which no detector would take the bundle."""
    if not is_name(name):
        raise ValueError(f"is {brief(name)}, must be {NAME}")
    layout = [{"id": tag, "size": size} for tag, size in sizes.items()]
    TagLayout(family, tag_size=1.0, tag_bundles=[{"name": name, "layout": layout}])


def _ids_of(text: str, family: str) -> List[int]:
    tag_family(family)  # An error about the family must not be reported for --ids.
    with about("argument --ids"):
        ids = parse_ids(text, family)
        if len(set(ids)) != len(ids) or len(ids) < 2:
            raise ValueError(f"ids is '{text}', must be two or more different tags")
    return sorted(ids)


def _sizes_of(text: str, ids: Sequence[int]) -> Dict[int, float]:
    sizes: Dict[int, float] = {}
    default: Dict[int, float] = {}
    for part in text.split(","):
        try:
            tag, size = _size_of(part)
        except ValueError:
            raise ValueError(
                f"'{part}' must be 0.1 or 3:0.1, above 0 and at most {MAX_TAG_SIZE:g} m"
            ) from None
        if tag is None:
            if default:
                raise ValueError(f"is '{text}', must have one size for all others")
            default = {number: size for number in ids}
        elif tag not in ids or tag in sizes:
            raise ValueError(f"tag {tag} is not one of --ids, or is there twice")
        else:
            sizes[tag] = size
    sizes = {**default, **sizes}
    missing = [str(tag) for tag in ids if tag not in sizes]
    if missing:
        raise ValueError(f"there is none of the tags {', '.join(missing)}")
    return sizes


def _size_of(text: str) -> Tuple[Optional[int], float]:
    """Parses a tag, or None for all other tags, and its size in m."""
    tag, colon, size = text.rpartition(":")
    value = float(size)
    if not 0.0 < value <= MAX_TAG_SIZE:
        raise ValueError
    return (int(tag) if colon else None), value
