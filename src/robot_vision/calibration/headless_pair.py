"""The part of calibrate_headless.py that calibrates a stereo pair."""

import argparse
from typing import Dict, Iterator, List, Sequence, Tuple

import cv2
import numpy as np

from .. import CameraModel, RectifiedCamera
from ..common.file_sets import add_files, replace_files
from ..common.files import make_folder, require_replaceable
from ..recordings.image_pairs import NamedPair, pairs_from_bag, pairs_from_files, pairs_from_topics
from ..ros.camera_info import size_words
from ..ros.startup import become_node
from .camera_file import camera_yaml
from .coverage import coverage_image, seen_cells
from .headless_steps import (
    UNSURE,
    collect,
    is_unsure,
    parameters_report,
    report_names,
    require_service,
    save,
    service_of,
    set_camera_info,
)
from .known_cameras import known_cameras
from .pair_solving import PairCalibration, calibrate_pair
from .pair_views import PairCollection
from .solving import calibrate

SIDES = ("left", "right")


def calibrate_two_cameras(arguments: argparse.Namespace) -> None:
    """Does the work of the command with --stereo.

    Raises:
        ValueError: There are no images of a pair, or no pair fits them.
        OSError: A file cannot be read or written, or a camera does not take the result.
    """
    for path in (*arguments.outputs, arguments.coverage):
        require_replaceable(path, arguments.force, new_folders=True)
    is_live = not (arguments.files or arguments.bag)
    if is_live or arguments.set:
        become_node("calibrate_headless")
    nodes = [f"{arguments.set}/{side}" for side in SIDES] if arguments.set else []
    for node in nodes:
        require_service(service_of(node))
    known = [known_cameras(source, arguments.bag) for source in arguments.keep or ()]
    pairs = PairCollection(arguments.found, arguments.turns, arguments.most, arguments.max_blur)
    collect(_images(arguments), pairs)
    print(pairs.summary(), flush=True)
    if pairs.offered == pairs.unusable:
        raise ValueError("there were no pairs" + " that can be used" * (pairs.unusable > 0))
    pairs.require_enough()
    cameras = _kept(arguments, known, pairs.size) if known else _found(arguments, pairs)
    found = calibrate_pair(pairs.pairs, cameras)
    print(_report(found, pairs), flush=True)
    saved = _write(arguments, found, pairs)
    for node, camera in zip(nodes, (found.pair.left, found.pair.right)):
        _set(node, camera, saved)


def _images(arguments: argparse.Namespace) -> Iterator[NamedPair]:
    topics = [arguments.left, arguments.right]
    if arguments.files:
        return pairs_from_files(arguments.files)
    if arguments.bag:
        return pairs_from_bag(arguments.bag, topics, arguments.slop)
    return pairs_from_topics(topics, arguments.slop)


def _kept(
    arguments: argparse.Namespace,
    known: Sequence[Dict[Tuple[int, int], CameraModel]],
    size: Tuple[int, int],
) -> List[CameraModel]:
    for source, cameras in zip(arguments.keep, known):
        if size not in cameras:
            sizes = size_words(cameras), size_words([size])
            raise ValueError(f"{source} is of images of {sizes[0]}, these have {sizes[1]}")
    return [cameras[size] for cameras in known]


def _found(arguments: argparse.Namespace, pairs: PairCollection) -> List[CameraModel]:
    """Computes each camera by all that it has seen, and prints it."""
    cameras = []
    for side, name in enumerate(SIDES):
        found = calibrate(pairs.of_camera(side), pairs.size, arguments.model, arguments.k3)
        lines = [f"{name}: {line}" if line[0] != " " else line for line in parameters_report(found)]
        lines.append(f"  reprojection error: {found.error:.3f} px")
        if is_unsure(found):
            lines.append("  " + UNSURE)
        print("\n".join(lines), flush=True)
        cameras.append(CameraModel(*found.size, found.K, found.D, found.model))
    return cameras


def _report(found: PairCalibration, pairs: PairCollection) -> str:
    turn = np.degrees(np.linalg.norm(cv2.Rodrigues(found.rotation)[0]))
    lines = [
        f"baseline: {found.pair.geometry.baseline:.6g} m, turned by {turn:.3g} degrees",
        f"epipolar error: {found.error:.3f} px",
    ]
    for view, error, is_used in zip(pairs.pairs, found.errors, found.used):
        lines.append(f"  {view.name}: {error:.3f} px{'' if is_used else '  REFUSED'}")
    for name, observations in zip(SIDES, _observations(found, pairs)):
        seen = seen_cells(observations, pairs.size).mean()
        lines.append(f"the board was seen in {seen:.0%} of the {name} image")
    return "\n".join(lines)


def _observations(found: PairCalibration, pairs: PairCollection) -> List[list]:
    """Returns what each camera has seen of the board in the pairs that are used."""
    used = [view for view, is_used in zip(pairs.pairs, found.used) if is_used]
    return [[view.left for view in used], [view.right for view in used]]


def _write(
    arguments: argparse.Namespace, found: PairCalibration, pairs: PairCollection
) -> List[str]:
    """Writes both calibrations, and the coverage image; returns the paths of the former."""
    files = {}
    for path, side, camera in zip(arguments.outputs, SIDES, (found.pair.left, found.pair.right)):
        name = f"{arguments.camera_name}_{side}"
        files[path] = camera_yaml(camera.model, camera.R, camera.P, name).encode()
        make_folder(path)
    if arguments.force:
        replace_files(files)
    saved = list(files) if arguments.force else add_files(files)
    report_names(arguments.outputs, saved)
    print("saved in", " and ".join(saved), flush=True)
    errors = found.errors[found.used]
    images = [coverage_image(seen, errors, pairs.size) for seen in _observations(found, pairs)]
    png = cv2.imencode(".png", np.hstack(images))[1].tobytes()
    print("coverage in", save(arguments.coverage, png, arguments.force), flush=True)
    return saved


def _set(node: str, camera: RectifiedCamera, saved: Sequence[str]) -> None:
    """Gives a camera its part; raises OSError, naming both files, if it refuses that."""
    try:
        set_camera_info(node, camera.model, camera.R, camera.P)
    except OSError as error:
        files = " and ".join(saved)
        raise OSError(f"{error}; the calibration of both cameras is in {files}") from None
    print("set in", node, flush=True)
