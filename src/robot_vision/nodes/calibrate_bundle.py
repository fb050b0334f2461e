"""The command calibrate_bundle.py: from pictures of a rigid body to the layout of its tags."""

import argparse
import os
import sys
from statistics import median
from typing import Dict, List, Mapping, Sequence, Tuple

import rosgraph
import rospy

from .. import CameraModel, tag_family
from ..bundle_calibration import Calibration, calibrate
from ..bundle_files import write_bundles
from ..frame_collection import FrameCollection
from .bundle_bag import collect_from_bag
from .bundle_recorder import BundleRecorder

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
LARGEST = 100.0  # m, of a tag
MOST_FRAMES = 10000
LARGE = 2.0  # times the median of the tags' residuals
MOSTLY = 0.5  # of a tag's sightings are where the layout has it
SURELY_SMALL = 0.3  # px, a residual that needs no warning


def main() -> int:
    """Runs the command; its exit code."""
    arguments = _parse(rospy.myargv(sys.argv)[1:])
    collection = FrameCollection(arguments.sizes, arguments.master, arguments.frames)
    try:
        _require_output(arguments)
        camera = _collect(arguments, collection)
        print(collection.summary(), flush=True)
        frames = collection.frames()
        if not frames:
            raise ValueError(f"none of the tags was seen in {collection.offered} frames")
        found = calibrate(arguments.name, frames, arguments.sizes, camera, arguments.master)
        print(_report(found), flush=True)
        _require_fit(found, frames, arguments.sizes)
        _require_output(arguments)  # it may have come meanwhile
        write_bundles(arguments.output, [found.bundle], arguments.family)
        print("saved in", arguments.output)
    except (OSError, ValueError) as error:
        print(f"calibrate_bundle.py: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0


def _parse(command: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="calibrate_bundle.py",
        description="Learns where AprilTags sit on a rigid body from frames that show several of "
        "them at once, and writes the tag_bundles of apriltag_detector.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
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
        "--frames", type=int, default=300, help="most that are collected (default: %(default)s)"
    )
    parser.add_argument("--bag", metavar="FILE", help="take pictures from a bag; with --image")
    parser.add_argument("--image", metavar="TOPIC", help="of the pictures in the bag")
    parser.add_argument(
        "--camera-info", default="", metavar="TOPIC", help="in the bag (default: beside the image)"
    )
    arguments = parser.parse_args(command)
    try:
        _complete(arguments)
    except ValueError as error:
        parser.error(str(error))
    return arguments


def _complete(arguments: argparse.Namespace) -> None:
    """Checks what argparse does not, and adds the sizes by tag."""
    ids = _ids_of(arguments.ids, tag_family(arguments.family).ids)
    arguments.sizes = _sizes_of(arguments.size, ids)
    arguments.master = ids[0] if arguments.master is None else arguments.master
    if arguments.master not in ids:
        raise ValueError(f"argument --master: tag {arguments.master} is not one of --ids")
    if not arguments.name:
        raise ValueError("argument --name: is empty")
    if not 1 <= arguments.frames <= MOST_FRAMES:
        raise ValueError(
            f"argument --frames: is {arguments.frames}, must be from 1 to {MOST_FRAMES}"
        )
    if bool(arguments.bag) != bool(arguments.image) or (
        arguments.camera_info and not arguments.bag
    ):
        raise ValueError(
            "--bag needs --image, and only with it there are --image and --camera-info"
        )


def _ids_of(text: str, count: int) -> List[int]:
    ids: List[int] = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        try:
            low, high = int(first), int(last or first)
        except ValueError:
            raise ValueError(f"argument --ids: is '{text}', must be as 0-5 or 0,2,7-9") from None
        if not low <= high < count:
            raise ValueError(f"argument --ids: {part} must be from 0 to {count - 1}, lowest first")
        ids += range(low, high + 1)
    if len(set(ids)) != len(ids) or len(ids) < 2:
        raise ValueError(f"argument --ids: is '{text}', must be two or more different tags")
    return sorted(ids)


def _sizes_of(text: str, ids: Sequence[int]) -> Dict[int, float]:
    sizes: Dict[int, float] = {}
    default: Dict[int, float] = {}
    for part in text.split(","):
        try:
            tag, size = _size_of(part)
        except ValueError:
            raise ValueError(
                f"argument --size: '{part}' must be 0.1 or 3:0.1, above 0 and at most {LARGEST:g} m"
            ) from None
        if tag is None:
            default = {number: size for number in ids}
        elif tag not in ids or tag in sizes:
            raise ValueError(f"argument --size: tag {tag} is not one of --ids, or is there twice")
        else:
            sizes[tag] = size
    sizes = {**default, **sizes}
    missing = [str(tag) for tag in ids if tag not in sizes]
    if missing:
        raise ValueError(f"argument --size: there is none of the tags {', '.join(missing)}")
    return sizes


def _size_of(text: str) -> Tuple[object, float]:
    tag, colon, size = text.rpartition(":")
    value = float(size)
    if not 0.0 < value <= LARGEST:
        raise ValueError
    return (int(tag) if colon else None), value


def _require_output(arguments: argparse.Namespace) -> None:
    path = arguments.output
    folder = os.path.dirname(os.path.realpath(path))
    if os.path.isdir(path) or not os.access(folder, os.W_OK | os.X_OK):
        raise OSError(f"{path} cannot be written")
    if os.path.lexists(path) and not arguments.force:
        raise OSError(f"{path} is there already; --force replaces it")


def _collect(arguments: argparse.Namespace, collection: FrameCollection) -> CameraModel:
    if arguments.bag:
        return collect_from_bag(
            arguments.bag, arguments.image, arguments.camera_info, arguments.family, collection
        )
    if not rosgraph.is_master_online():
        raise OSError(f"no ROS master answers at {rosgraph.get_master_uri()}")
    rospy.init_node("calibrate_bundle", anonymous=True, disable_signals=True)
    return BundleRecorder(arguments.family, collection).run()


def _report(found: Calibration) -> str:
    limit = max(SURELY_SMALL, LARGE * median(found.residuals.values()))
    master, *_ = found.bundle.tags
    lines = [
        f"{found.bundle.name}: {len(found.bundle.tags)} tags from {found.frames} frames, "
        f"in the frame of tag {master.id}"
    ]
    for tag, residual in sorted(found.residuals.items()):
        large = "  LARGE: is it flat, of this size, and fixed?" if residual > limit else ""
        lines.append(f"  tag {tag}: {residual:.2f} px in {found.sightings[tag]} sightings{large}")
    if found.rejected:
        lines.append(f"  left out: {found.rejected} sightings of tags that were somewhere else")
    return "\n".join(lines)


def _require_fit(
    found: Calibration, frames: Sequence[Mapping[int, object]], sizes: Mapping[int, float]
) -> None:
    """Raises ValueError for a tag that is somewhere else more often than not."""
    for tag, kept in sorted(found.sightings.items()):
        seen = sum(tag in frame for frame in frames)
        if kept < MOSTLY * seen:
            raise ValueError(
                f"tag {tag} fits in only {kept} of the {seen} frames that show it with others: "
                f"is its size {sizes[tag]:g} m, and is it fixed?"
            )
