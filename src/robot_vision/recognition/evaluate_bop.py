"""The command evaluate_bop.py: recognizes the objects of a BOP data set and compares poses."""

import argparse
import os
import sys
import time
from typing import Dict, Iterator, List, NamedTuple, Sequence, Set, Tuple

import numpy as np

from .. import CameraModel, ObjectShape, ViewParams
from ..common import opencv as cv2
from ..common.arguments import command_parser
from ..common.commands import run_command
from ..common.errors import about
from ..common.files import make_folder, replace_file, require_replaceable
from ..common.image_files import load_image, sensor_pixels
from ..meshes import mesh_extent
from .bop_export import MODELS_INFO, SCENE_TRUTHS
from .bop_import import (
    MODEL,
    add_models,
    camera_of,
    frame_number,
    is_bop,
    optional_json,
    pose_of,
    rgb_path,
    stored_model,
    truths_of,
)
from .database.folder_files import entries_of, read_data, read_json
from .database.json_values import integer
from .found import Found, KnownObject
from .known_objects import corners_of
from .mesh_data import unpack_mesh
from .recognizer import RecognitionParams, Recognizer
from .symmetries import MM
from .view_method import VIEWS, ViewTraining

PROGRAM = "evaluate_bop.py"
EXAMPLES = """examples, the objects of a data set in its test images, with BOP's file of results:
  evaluate_bop.py lm/
  evaluate_bop.py lm/ --split test --output views_lm-test.csv
"""
RIGHT = 0.1  # of the diameter, the mean distance below which a pose is right
POINTS = 500  # of a mesh that are compared


class _Model(NamedTuple):
    known: KnownObject
    points: np.ndarray
    diameter: float
    is_symmetric: bool


class _Frame(NamedTuple):
    folder: str  # of its scene
    scene: int
    number: int
    camera_matrix: np.ndarray
    depth_scale: float  # mm
    truths: List[Tuple[int, np.ndarray]]  # numbers and poses of the objects in it


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(sys.argv[1:])
    return run_command(PROGRAM, lambda: evaluate(arguments))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = command_parser(PROGRAM, "Recognizes the objects of a BOP data set.", EXAMPLES)
    parser.add_argument("folder", metavar="FOLDER", help="the data set")
    parser.add_argument("--split", default="test", metavar="NAME", help="(default: %(default)s)")
    add_models(parser)
    parser.add_argument("--output", default="", metavar="FILE", help="BOP's results, as CSV")
    parser.add_argument("--force", action="store_true", help="replace FILE if it is there")
    return parser.parse_args(command)


def evaluate(arguments: argparse.Namespace) -> None:
    """Prints what is recognized.

    Raises:
        OSError: A file cannot be read or written.
        ValueError: A file is not what it must be.
    """
    if arguments.output:
        require_replaceable(arguments.output, arguments.force, new_folders=True)
    if not is_bop(arguments.folder, arguments.models):
        first = f"{arguments.models}/obj_000001.ply"
        raise ValueError(f"{arguments.folder} is no BOP data set: no {first} or such")
    split = os.path.join(arguments.folder, arguments.split)
    frames = [frame for scene in entries_of(split) for frame in _frames(split, scene)]
    if not frames:
        raise ValueError(f"no frames in {split}")
    named = _named_in_scenes(frames)
    models = _models(os.path.join(arguments.folder, arguments.models))
    numbers = list(models)
    recognizer = Recognizer([models[one].known for one in numbers], RecognitionParams.defaults())
    counts = {one: [0, 0, 0] for one in numbers}  # there, right, false
    besides = 0
    rows, times = ["scene_id,im_id,obj_id,score,R,t,time"], []
    for frame in frames:
        with about(f"{frame.folder}: frame {frame.number}"):
            seen = _seen(frame)
        begin = time.monotonic()
        found, _ = recognizer.recognize(*seen)
        times.append(time.monotonic() - begin)
        by_object = [(int(one.object.id), one) for one in found]
        rows += [_row(frame, *one, times[-1]) for one in by_object]
        known = named[frame.scene]
        besides += sum(index not in known for index, _ in by_object)
        for index in known.intersection(numbers):
            there = [pose for of, pose in frame.truths if of == index]
            own = [one.pose for of, one in by_object if of == index]
            _count(models[index], there, own, counts[index])
    _print(counts, besides)
    print(f"{len(times)} images, {np.mean(times):.3f} s each")
    if arguments.output:
        make_folder(arguments.output)
        replace_file(arguments.output, ("\n".join(rows) + "\n").encode())


def _print(counts: Dict[int, List[int]], besides: int) -> None:
    for index, (all_, right, wrong) in counts.items():
        recall = f"{right / all_:.1%}" if all_ else "-"
        print(f"object {index}: {right} of {all_} found, {recall}; {wrong} false")
    if besides:
        print(f"{besides} found of objects that the truth of their scenes does not name")


def _named_in_scenes(frames: Sequence[_Frame]) -> Dict[int, Set[int]]:
    """Returns the objects whose poses are known in each scene: others may be there, too."""
    named: Dict[int, Set[int]] = {}
    for frame in frames:
        named.setdefault(frame.scene, set()).update(index for index, _ in frame.truths)
    return named


def _models(folder: str) -> Dict[int, _Model]:
    infos, models = optional_json(folder, MODELS_INFO), {}
    for match in filter(None, map(MODEL.fullmatch, entries_of(folder))):
        index = int(match[1])
        stored = stored_model(folder, index, infos, lambda line: print(line, file=sys.stderr))
        mesh = unpack_mesh(stored.converted)
        training = ViewTraining(stored, ViewParams(), None)
        while training.done < training.total:
            training.step()
        symmetries = [(tuple(one.axis), one.fold) for one in stored.symmetries]
        made = (mesh, ObjectShape(mesh, symmetries), corners_of(mesh))
        known = KnownObject(str(index), str(index), *made, {VIEWS.name: training.model()})
        points = np.asarray(mesh.vertices, float)
        points = points[:: max(1, len(points) // POINTS)]
        info = infos.get(str(index), {})  # It may have symmetries that cannot be used.
        is_symmetric = any(info.get(f"symmetries_{kind}") for kind in ("discrete", "continuous"))
        models[index] = _Model(known, points, mesh_extent(mesh).diameter, is_symmetric)
    return models


def _frames(split: str, scene: str) -> Iterator[_Frame]:
    folder = os.path.join(split, scene)
    cameras, truths = read_json(folder, "scene_camera.json"), read_json(folder, SCENE_TRUTHS)
    for frame in sorted(truths, key=frame_number):
        with about(f"{folder}: frame {frame}"):
            there = [(integer(one, "obj_id"), pose_of(one)) for one in truths_of(truths[frame])]
            camera = camera_of(cameras, frame)
            yield _Frame(folder, frame_number(scene), int(frame), *camera, there)


def _seen(frame: _Frame) -> Tuple[np.ndarray, np.ndarray, CameraModel]:
    bgr = load_image(rgb_path(frame.folder, frame.number), sensor_pixels)
    data = read_data(frame.folder, "depth", f"{frame.number:06d}.png")
    depth = sensor_pixels(data, cv2.IMREAD_UNCHANGED).astype(np.float32)
    depth = np.where(depth > 0.0, np.float32(MM * frame.depth_scale) * depth, np.float32(np.nan))
    height, width = bgr.shape[:2]
    return bgr, depth, CameraModel(width, height, frame.camera_matrix, [])


def _count(
    model: _Model, truths: List[np.ndarray], found: List[np.ndarray], counts: List[int]
) -> None:
    """Gives each truth the first pose that is right, and counts those that are left as false."""
    left = list(found)
    for truth in truths:
        right = [i for i, one in enumerate(left) if _distance(model, one, truth) < RIGHT]
        counts[1] += bool(right)
        if right:
            del left[right[0]]
    counts[0] += len(truths)
    counts[2] += len(left)


def _distance(model: _Model, found: np.ndarray, truth: np.ndarray) -> float:
    """Returns ADD, or ADD-S of an object with symmetries, as a share of the diameter."""
    here, there = (model.points @ pose[:3, :3].T + pose[:3, 3] for pose in (found, truth))
    if not model.is_symmetric:
        return float(np.linalg.norm(here - there, axis=1).mean() / model.diameter)
    apart = np.linalg.norm(here[:, None] - there[None], axis=2)
    return float(apart.min(axis=1).mean() / model.diameter)


def _row(frame: _Frame, index: int, one: Found, seconds: float) -> str:
    turn = " ".join(f"{value:.8f}" for value in one.pose[:3, :3].ravel())
    place = " ".join(f"{value:.4f}" for value in one.pose[:3, 3] / MM)
    return (
        f"{frame.scene},{frame.number},{index},{one.probability:.4f},{turn},{place},{seconds:.4f}"
    )
