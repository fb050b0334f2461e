"""The command calibrate_headless.py, which calibrates cameras with images of a board."""

import argparse
import os
import sys
from typing import Iterator, Sequence

import cv2
import numpy as np
import rospy

from .. import CameraModel
from ..common.commands import run_command
from ..common.files import require_replaceable
from ..recordings.bag_images import NamedImage
from ..recordings.recorded_images import from_bag, from_files, from_topic
from ..ros.startup import become_node
from .boards import Observation
from .camera_file import as_yaml
from .coverage import coverage_image, seen_cells
from .headless_arguments import parse_arguments
from .headless_pair import calibrate_two_cameras
from .headless_steps import (
    UNSURE,
    collect,
    is_unsure,
    parameters_report,
    require_service,
    save,
    service_of,
    set_camera_info,
)
from .solving import Calibration, calibrate
from .views import ViewCollection

LARGE_ERROR = 2.0  # error of a view that is reported as large, as a multiple of the median


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(rospy.myargv(sys.argv)[1:])
    work = calibrate_two_cameras if arguments.stereo else _calibrate
    return run_command("calibrate_headless.py", lambda: work(arguments))


def _calibrate(arguments: argparse.Namespace) -> None:
    for path in (arguments.output, arguments.coverage):
        require_replaceable(path, arguments.force, new_folders=True)
    if arguments.topic or arguments.set:
        become_node("calibrate_headless")
    if arguments.set:
        require_service(service_of(arguments.set))
    views = ViewCollection(arguments.found, arguments.most, arguments.max_blur)
    collect(_images(arguments), views)
    print(views.summary(), flush=True)
    if views.offered == views.unusable:
        raise ValueError("there were no images" + " that can be used" * (views.unusable > 0))
    if not views.views:
        size = "{}x{}".format(*arguments.size)
        raise ValueError(f"no image shows the board well: is --size {size} right?")
    observations = [view.observation for view in views.views]
    found = calibrate(observations, views.size, arguments.model, arguments.k3)
    print(_report(found, views), flush=True)
    saved = _write(arguments, found, observations)  # even with --set, as the camera may refuse it
    if arguments.set:
        _set(arguments.set, found, saved)


def _images(arguments: argparse.Namespace) -> Iterator[NamedImage]:
    if arguments.topic:
        return from_topic(arguments.topic)
    if arguments.bag:
        return from_bag(arguments.bag, arguments.image)
    return from_files(arguments.files)


def _report(found: Calibration, views: ViewCollection) -> str:
    lines = [*parameters_report(found), f"reprojection error: {found.error:.3f} px"]
    limit = LARGE_ERROR * np.median(found.errors)
    for view, error in zip(views.views, found.errors):
        lines.append(f"  {view.name}: {error:.3f} px{'  LARGE' if error > limit else ''}")
    seen = seen_cells([view.observation for view in views.views], found.size).mean()
    lines.append(f"the board was seen in {seen:.0%} of the image")
    if is_unsure(found):
        lines.append(UNSURE)
    return "\n".join(lines)


def _write(
    arguments: argparse.Namespace, found: Calibration, observations: Sequence[Observation]
) -> str:
    """Writes the calibration and the coverage image; returns the path of the former."""
    text = as_yaml(found, arguments.camera_name)
    saved = save(arguments.output, text.encode(), arguments.force)
    print("saved in", saved, flush=True)
    image = coverage_image(observations, found.errors, found.size)
    png = cv2.imencode(".png", image)[1].tobytes()
    print("coverage in", save(arguments.coverage, png, arguments.force), flush=True)
    return saved


def _set(node: str, found: Calibration, path: str) -> None:
    """Gives the result to the camera; raises OSError, naming the file, if that refuses it."""
    camera = CameraModel(*found.size, found.K, found.D, found.model)
    try:
        set_camera_info(node, camera, np.eye(3), found.P)
    except OSError as error:
        raise OSError(
            f"{error}; to use the result nevertheless start the camera with "
            f"camera_info_url:=file://{os.path.abspath(path)}"
        ) from None
    print("set in", node)
