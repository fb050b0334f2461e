"""The command calibrate_headless.py, which calibrates a camera with images of a board."""

import argparse
import os
import sys
import time
from typing import Iterator, Sequence

import cv2
import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo
from sensor_msgs.srv import SetCameraInfo

from ..common.commands import run_command
from ..common.files import add_file, make_folder, reason, replace_file, require_replaceable
from ..recordings.bag_images import NamedImage
from ..recordings.recorded_images import from_bag, from_files, from_topic
from ..ros.startup import become_node
from .boards import Observation
from .camera_file import as_yaml
from .coverage import coverage_image, seen_cells
from .headless_arguments import parse_arguments
from .solving import COEFFICIENTS, PARAMETERS, Calibration, calibrate
from .views import ViewCollection

PROGRESS = 1.0  # s between lines of progress
SERVICE_TIMEOUT = 5.0  # s, longest wait for the camera's service
MAX_REPORTED = 10  # unusable images that are reported; further ones are only counted
LARGE_ERROR = 2.0  # error of a view that is reported as large, as a multiple of the median
MAX_FOCAL_DEVIATION = 0.005  # standard deviation of the focal length, as a share of it


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(rospy.myargv(sys.argv)[1:])
    return run_command("calibrate_headless.py", lambda: _calibrate(arguments))


def _calibrate(arguments: argparse.Namespace) -> None:
    for path in (arguments.output, arguments.coverage):
        require_replaceable(path, arguments.force, new_folders=True)
    if arguments.topic or arguments.set:
        become_node("calibrate_headless")
    if arguments.set:
        _require_service(_service_of(arguments.set))
    views = ViewCollection(arguments.found, arguments.most, arguments.max_blur)
    _collect(_images(arguments), views)
    print(views.summary(), flush=True)
    if views.size is None:
        raise ValueError("there were no images" + " that can be used" * (views.unusable > 0))
    if not views.views:
        raise ValueError(f"no image shows the board well: is --size {arguments.size} right?")
    observations = [view.observation for view in views.views]
    found = calibrate(observations, views.size, arguments.model, arguments.k3)
    print(_report(found, views), flush=True)
    saved = _write(arguments, found, observations)  # even with --set, as the camera may refuse it
    if arguments.set:
        _set_camera_info(arguments.set, found, saved)


def _service_of(node: str) -> str:
    return rospy.resolve_name(node) + "/set_camera_info"


def _require_service(name: str) -> None:
    """Raises OSError, before the work begins, if no camera offers the service for the result."""
    try:
        rospy.wait_for_service(name, SERVICE_TIMEOUT)
    except rospy.ROSException:
        raise OSError(f"there is no service {name}: does the camera run?") from None


def _images(arguments: argparse.Namespace) -> Iterator[NamedImage]:
    if arguments.topic:
        return from_topic(arguments.topic)
    if arguments.bag:
        return from_bag(arguments.bag, arguments.image)
    return from_files(arguments.files)


def _collect(images: Iterator[NamedImage], views: ViewCollection) -> None:
    """Processes images until there are enough of them, or no more, or the user presses Ctrl-C."""
    last_progress = time.monotonic()
    try:
        for name, read in images:
            try:
                views.offer(name, read())
            except (OSError, ValueError) as error:
                views.skip()
                if views.unusable <= MAX_REPORTED:
                    print(f"skipped {name}: {reason(error)}", flush=True)
            if views.full:
                return
            if time.monotonic() - last_progress > PROGRESS:
                last_progress = time.monotonic()
                print(views.summary(), flush=True)
    except KeyboardInterrupt:
        print(flush=True)  # ends the line in which the terminal shows ^C


def _report(found: Calibration, views: ViewCollection) -> str:
    names = (*PARAMETERS, *COEFFICIENTS[found.model])
    values = (*found.K[[0, 1, 0, 1], [0, 1, 2, 2]], *found.D)
    lines = [f"{found.model}, {found.size[0]}x{found.size[1]}"]
    for name, value, deviation in zip(names, values, found.deviations):
        unit = " px" if name in PARAMETERS else ""
        known = f"{value:.6g} +- {deviation:.2g}{unit}" if deviation else "0"
        lines.append(f"  {name} {known}")
    lines.append(f"reprojection error: {found.error:.3f} px")
    limit = LARGE_ERROR * np.median(found.errors)
    for view, error in zip(views.views, found.errors):
        lines.append(f"  {view.name}: {error:.3f} px{'  LARGE' if error > limit else ''}")
    seen = seen_cells([view.observation for view in views.views], found.size).mean()
    lines.append(f"the board was seen in {seen:.0%} of the image")
    if found.deviations[0] > MAX_FOCAL_DEVIATION * values[0]:
        lines.append("the focal length is not sure: show the board tilted, and near the borders")
    return "\n".join(lines)


def _write(
    arguments: argparse.Namespace, found: Calibration, observations: Sequence[Observation]
) -> str:
    """Writes the calibration and the coverage image; returns the path of the former."""
    text = as_yaml(found, arguments.camera_name)
    saved = _save(arguments.output, text.encode(), arguments.force)
    print("saved in", saved, flush=True)
    image = coverage_image(observations, found.errors, found.size)
    png = cv2.imencode(".png", image)[1].tobytes()
    print("coverage in", _save(arguments.coverage, png, arguments.force), flush=True)
    return saved


def _save(path: str, data: bytes, force: bool) -> str:
    """Writes a file and returns its path: a new one if another file took the name meanwhile."""
    make_folder(path)
    if force:
        replace_file(path, data)
        return path
    folder, name = os.path.split(path)
    saved = add_file(folder, *os.path.splitext(name), data)
    if os.path.basename(saved) != name:
        print(f"{path} has come meanwhile and is not replaced", flush=True)
    return saved


def _set_camera_info(node: str, found: Calibration, path: str) -> None:
    """Sends the result to the camera; raises OSError, naming the file, if that refuses it."""
    name = _service_of(node)
    info = CameraInfo(
        width=found.size[0],
        height=found.size[1],
        distortion_model=found.model,
        D=found.D.tolist(),
        K=found.K.ravel().tolist(),
        R=np.eye(3).ravel().tolist(),
        P=found.P.ravel().tolist(),
    )
    try:
        answer = rospy.ServiceProxy(name, SetCameraInfo)(info)
        problem = "" if answer.success else answer.status_message or "refused"
    except (rospy.ROSException, rospy.ServiceException) as error:
        problem = str(error)
    if problem:
        raise OSError(
            f"{name}: {problem}; to use the result nevertheless start the camera with "
            f"camera_info_url:=file://{os.path.abspath(path)}"
        )
    print("set in", node)
