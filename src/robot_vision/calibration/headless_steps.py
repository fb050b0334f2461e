"""What calibrate_headless.py does alike with one camera and with two."""

import os
import time
from typing import Any, Callable, Iterator, List, Sequence, Tuple

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo
from sensor_msgs.srv import SetCameraInfo

from .. import CameraModel
from ..common.files import add_file, make_folder, reason, replace_file
from ..common.plain_text import printable
from .solving import COEFFICIENTS, PARAMETERS, Calibration

PROGRESS = 1.0  # s between lines of progress
SERVICE_TIMEOUT = 5.0  # s, longest wait for the camera's service
MAX_PROBLEM = 500  # characters of what the service says that are shown
MAX_REPORTED = 10  # unusable images that are reported; further ones are only counted
MAX_FOCAL_DEVIATION = 0.005  # standard deviation of the focal length, as a share of it
UNSURE = "the focal length is not sure: show the board tilted, and near the borders"


def collect(images: Iterator[Tuple[str, Callable[[], Any]]], views: Any) -> None:
    """Processes images until there are enough of them, or no more, or the user presses Ctrl-C.

    Args:
        images: The names of images, or of pairs of them, and functions that read them.
        views: The ViewCollection or PairCollection that they are offered to.
    """
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


def parameters_report(found: Calibration) -> List[str]:
    """Returns the parameters of a camera as lines of text."""
    names = (*PARAMETERS, *COEFFICIENTS[found.model])
    values = (*found.K[[0, 1, 0, 1], [0, 1, 2, 2]], *found.D)
    lines = [f"{found.model}, {found.size[0]}x{found.size[1]}"]
    for name, value, deviation in zip(names, values, found.deviations):
        unit = " px" if name in PARAMETERS else ""
        lines.append(f"  {name} {_known(value, deviation, unit)}")
    return lines


def _known(value: float, deviation: float, unit: str) -> str:
    if deviation == 0.0:
        return "0"
    if np.isinf(deviation):
        return f"{value:.6g}{unit}, which the views do not determine"
    return f"{value:.6g} +- {deviation:.2g}{unit}"


def is_unsure(found: Calibration) -> bool:
    """Whether the views do not tell the focal length well."""
    focal_lengths = found.K[[0, 1], [0, 1]]
    return not (found.deviations[:2] <= MAX_FOCAL_DEVIATION * focal_lengths).all()


def save(path: str, data: bytes, force: bool) -> str:
    """Writes a file and returns its path: a new one if another file took the name meanwhile."""
    make_folder(path)
    if force:
        replace_file(path, data)
        return path
    folder, name = os.path.split(path)
    saved = add_file(folder, *os.path.splitext(name), data)
    report_names([path], [saved])
    return saved


def report_names(wanted: Sequence[str], saved: Sequence[str]) -> None:
    """Tells of files that have other names, because these were taken during the work."""
    for path, other in zip(wanted, saved):
        if os.path.basename(path) != os.path.basename(other):
            print(f"{path} has come meanwhile and is not replaced", flush=True)


def service_of(node: str) -> str:
    """Returns the service that gives a node of this name a calibration."""
    return rospy.resolve_name(node) + "/set_camera_info"


def require_service(name: str) -> None:
    """Raises OSError, before the work begins, if no camera offers the service for the result."""
    try:
        rospy.wait_for_service(name, SERVICE_TIMEOUT)
    except rospy.ROSException:
        raise OSError(f"there is no service {name}: does the camera run?") from None


def set_camera_info(
    node: str, camera: CameraModel, rotation: np.ndarray, projection: np.ndarray
) -> None:
    """Sends a calibration with its R and P to the camera.

    Raises:
        OSError: The camera does not take it.
    """
    name = service_of(node)
    info = camera_info(camera, rotation, projection)
    try:
        answer = rospy.ServiceProxy(name, SetCameraInfo)(info)
        problem = "" if answer.success else answer.status_message or "refused"
    except (rospy.ROSException, rospy.ServiceException) as error:
        problem = str(error)
    if problem:
        raise OSError(f"{name}: {printable(problem, MAX_PROBLEM)}")


def camera_info(camera: CameraModel, rotation: np.ndarray, projection: np.ndarray) -> CameraInfo:
    """Returns a calibration with the R, 3x3, and P, 3x4, of its rectified images as a message."""
    return CameraInfo(
        width=camera.width,
        height=camera.height,
        distortion_model=camera.distortion_model,
        D=list(camera.D),
        K=np.ravel(camera.K).tolist(),
        R=np.ravel(rotation).tolist(),
        P=np.ravel(projection).tolist(),
    )
