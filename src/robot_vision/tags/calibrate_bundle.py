"""The command calibrate_bundle.py, which learns the layout of the tags on a rigid body."""

import argparse
import math
import sys
from statistics import median
from typing import Mapping, Sequence

import rospy

from .. import CameraModel, without_bent_edges
from ..common.commands import run_command
from ..common.files import require_replaceable
from ..common.progress import Progress
from ..ros.startup import become_node
from .bundle_arguments import parse_arguments
from .bundle_bag import collect_from_bag
from .bundle_calibration import BundleCalibration, calibrate
from .bundle_files import write_bundles
from .bundle_recorder import BundleRecorder
from .frame_collection import FrameCollection

LARGE_RESIDUAL = 2.0  # residual of a tag that is reported as large, as a multiple of the median
MIN_INLIERS = 0.5  # least share of a tag's observations that must fit the layout
SMALL_RESIDUAL = 0.3  # px, residual that is never reported as large


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(rospy.myargv(sys.argv)[1:])
    return run_command("calibrate_bundle.py", lambda: _learn(arguments))


def _learn(arguments: argparse.Namespace) -> None:
    collection = FrameCollection(arguments.sizes, arguments.master, arguments.frames)
    require_replaceable(arguments.output, arguments.force)
    progress = Progress()
    camera = _collect(arguments, collection, progress)
    progress.tell(collection.summary())
    if not collection.frames():
        raise ValueError(f"none of the tags was seen in {collection.offered} frames")
    frames = [
        {tag: without_bent_edges(corners, camera) for tag, corners in frame.items()}
        for frame in collection.frames()
    ]
    found = calibrate(arguments.name, frames, arguments.sizes, camera, arguments.master)
    print(_report(found), flush=True)
    _require_fit(found, frames, arguments.sizes)
    write_bundles(arguments.output, [found.bundle], arguments.family, replace=arguments.force)
    print("saved in", arguments.output)


def _collect(
    arguments: argparse.Namespace, collection: FrameCollection, progress: Progress
) -> CameraModel:
    if arguments.bag:
        return collect_from_bag(arguments, collection, progress)
    become_node("calibrate_bundle")
    return BundleRecorder(arguments.family, collection, progress).run()


def _report(found: BundleCalibration) -> str:
    limit = max(SMALL_RESIDUAL, LARGE_RESIDUAL * median(found.residuals.values()))
    master, *_ = found.bundle.tags
    lines = [
        f"{found.bundle.name}: {len(found.bundle.tags)} tags from {found.frames} frames, "
        f"in the frame of tag {master.id}"
    ]
    known = {tag.id: tag for tag in found.bundle.tags}
    for tag, residual in sorted(found.residuals.items()):
        shift, turn = 1000.0 * known[tag].shift_noise, math.degrees(known[tag].turn_noise)
        large = "  LARGE: is it flat, of this size, and fixed?" if residual > limit else ""
        lines.append(
            f"  tag {tag}: {residual:.2f} px in {found.observations[tag]} sightings, "
            f"known to {shift:.2f} mm and {turn:.2f} degrees{large}"
        )
    if found.rejected:
        lines.append(f"  left out: {found.rejected} sightings of tags that were somewhere else")
    return "\n".join(lines)


def _require_fit(
    found: BundleCalibration, frames: Sequence[Mapping[int, object]], sizes: Mapping[int, float]
) -> None:
    """Raises ValueError for a tag that does not fit the layout in most of its frames."""
    for tag, kept in sorted(found.observations.items()):
        seen = sum(tag in frame for frame in frames)
        if kept < MIN_INLIERS * seen:
            raise ValueError(
                f"tag {tag} fits in only {kept} of the {seen} frames that show it with others: "
                f"is its size {sizes[tag]:g} m, and is it fixed?"
            )
