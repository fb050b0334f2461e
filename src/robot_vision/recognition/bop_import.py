"""Objects from a folder in the format of BOP, with their meshes and, if wanted, observations."""

import argparse
import hashlib
import os
import re
from typing import Any, Callable, Dict, List, NamedTuple

import numpy as np

from ..common import opencv as cv2
from ..common.errors import about
from ..common.image_files import load_image, sensor_pixels
from ..common.plain_text import brief, printable
from ..meshes import mesh_extent
from .bop_export import MODELS_INFO, OBJECTS, SCENE_TRUTHS
from .database import Database, Mesh, Object, Observation, Session
from .database.folder_files import entries_of, read_data, read_json
from .database.json_values import integer, matrix, number, numbers, text
from .database.objects import ID_LENGTH, is_id
from .mesh_data import unpack_mesh
from .mesh_intake import take_mesh
from .symmetries import MM, from_bop

MODEL = re.compile(r"obj_(\d{6})\.ply")
MODELS = "models"
MAX_DEPTH = 65535  # mm


class _Model(NamedTuple):
    """A model of a data set: its number, and the object that it becomes."""

    number: int
    object: Object


class _Camera(NamedTuple):
    matrix: np.ndarray
    depth_scale: float  # mm, by which the numbers of depth images are to be multiplied


def add_models(parser: argparse.ArgumentParser) -> None:
    """Adds the argument --models, as some data sets have several folders of them."""
    parser.add_argument(
        "--models",
        default=MODELS,
        metavar="NAME",
        help="folder of the models of a BOP data set (default: %(default)s)",
    )


def is_bop(folder: str, models: str = MODELS) -> bool:
    """Returns whether a folder has models as BOP's have them, in a folder of this name."""
    models = os.path.join(folder, models)
    return os.path.isdir(models) and any(map(MODEL.fullmatch, os.listdir(models)))


def import_bop(
    database: Database,
    folder: str,
    split: str,
    replace: bool,
    tell: Callable[[str], None] = lambda line: None,
    models: str = MODELS,
) -> int:
    """Adds the objects of a data set, within a transaction, and returns how many.

    Args:
        database: The database.
        folder: That of the data set.
        split: The folder of the observations in it, as train_real; "": none are taken.
        replace: Whether objects that are there are replaced; else they stay as they are.
        tell: A function that is told in lines what becomes of the objects.
        models: The folder of the models in it.

    Raises:
        OSError: A file cannot be read, or the database not be written.
        ValueError: A file is not what it must be, or there are no observations of this split.
    """
    scenes = _scenes_of(os.path.join(folder, split)) if split else []
    models = os.path.join(folder, models)
    infos = optional_json(models, MODELS_INFO)
    names = optional_json(folder, OBJECTS)
    taken: Dict[int, str] = {}
    numbers_there = [match[1] for match in map(MODEL.fullmatch, entries_of(models)) if match]
    there = {one.id for one in database.objects.all()}
    for digits in numbers_there:
        model = _Model(int(digits), _object(models, names, int(digits)))
        if model.object.id in there and not replace:
            left_out = ", its observations are left out" if scenes else ""
            tell(f"{model.object.id} is there already, and stays as it is{left_out}")
            continue
        if model.object.id in there:
            database.objects.delete(model.object.id)
        added = database.objects.add(model.object)
        taken[model.number] = added.id
        database.meshes.set(added.id, stored_model(models, model.number, infos, tell))
        tell(f"{added.id} added: '{added.name}'")
    _import_scenes(database, scenes, taken, tell)
    return len(taken)


def _scenes_of(folder: str) -> List[str]:
    """Returns the folders of the scenes of a split.

    Raises:
        OSError: The folder cannot be read.
        ValueError: There are none.
    """
    scenes = [os.path.join(folder, scene) for scene in entries_of(folder)]
    if not any(os.path.lexists(os.path.join(scene, SCENE_TRUTHS)) for scene in scenes):
        raise ValueError(f"{folder} has no scenes, which have a {SCENE_TRUTHS} each")
    return scenes


def optional_json(*path: str) -> Dict[str, Any]:
    return read_json(*path) if os.path.lexists(os.path.join(*path)) else {}


def _object(models: str, names: Dict[str, Any], model: int) -> Object:
    """Returns the object that a number is, by our own file of names if there is one.

    Without one it gets the same id each time, by its model.
    """
    known = names.get(str(model), {})
    with about(f"{OBJECTS}: {model}"):
        if not isinstance(known, dict):
            raise ValueError(f"it is {brief(known)}, must have id and name")
        object_id = text(known, "id", "")
        if object_id and not is_id(object_id):
            raise ValueError(f"id is {brief(object_id)}, must have 32 hexadecimal digits")
        name = text(known, "name", f"obj_{model:06d}")
        description = text(known, "description", "")
    return Object(name, description, id=object_id or _id_by_model(models, model))


def _id_by_model(models: str, model: int) -> str:
    made_of = hashlib.sha256(_file_of(model).encode())
    made_of.update(read_data(models, _file_of(model)))
    return made_of.hexdigest()[:ID_LENGTH]


def _file_of(model: int) -> str:
    return f"obj_{model:06d}.ply"


def stored_model(
    models: str,
    model: int,
    infos: Dict[str, Any],
    tell: Callable[[str], None],
) -> Mesh:
    """Returns a model with its symmetries, as the database has meshes."""
    stored = take_mesh(os.path.join(models, _file_of(model)), "mm").stored
    info = infos.get(str(model), {})
    extent = mesh_extent(unpack_mesh(stored.converted))
    with about(f"{MODELS_INFO}: {model}"):
        if not isinstance(info, dict):
            raise ValueError(f"it is {brief(info)}, must be an object of JSON")
        try:
            stored.symmetries = from_bop(info, np.asarray(extent.center), extent.diameter)
        except ValueError as error:
            tell(f"object {model} has no symmetries here: {error}")
    return stored


def _import_scenes(
    database: Database, scenes: List[str], taken: Dict[int, str], tell: Callable[[str], None]
) -> None:
    for path in scenes:
        folder, scene = os.path.split(path)
        cameras, truths = read_json(path, "scene_camera.json"), read_json(path, SCENE_TRUTHS)
        sessions: Dict[int, str] = {}
        count = 0
        for frame in sorted(truths, key=frame_number):
            with about(f"{path}: frame {frame}"):
                for index, truth in enumerate(truths_of(truths[frame])):
                    model = integer(truth, "obj_id")
                    if model not in taken:
                        continue
                    if model not in sessions:
                        new = Session(taken[model], f"{os.path.basename(folder)}/{scene}")
                        sessions[model] = database.observations.add_session(new).id
                    camera = camera_of(cameras, frame)
                    seen = _observation(path, int(frame), index, truth, camera, sessions[model])
                    database.observations.add(seen)
                    count += 1
        tell(f"{count} observations of {printable(path, 300)}")


def frame_number(frame: str) -> int:
    if not frame.isdecimal() or len(frame) > 9:
        raise ValueError(f"a frame is {brief(frame)}, must be a number")
    return int(frame)


def truths_of(value: Any) -> List[Dict[str, Any]]:
    if not isinstance(value, list) or not all(isinstance(one, dict) for one in value):
        raise ValueError(f"it is {brief(value)}, must be a list of poses")
    return value


def _observation(
    path: str, frame: int, index: int, truth: Dict[str, Any], camera: _Camera, session: str
) -> Observation:
    pose = pose_of(truth)
    rgb = load_image(rgb_path(path, frame), _color)
    depth = depth_in_mm(read_data(path, "depth", f"{frame:06d}.png"), camera.depth_scale)
    mask = read_data(path, "mask_visib", f"{frame:06d}_{index:06d}.png")
    return Observation(session, frame, rgb, depth, mask, camera.matrix, pose)


def pose_of(truth: Dict[str, Any]) -> np.ndarray:
    """Returns the pose, 4x4, m, of an entry of scene_gt.json."""
    pose = np.eye(4)
    pose[:3, :3] = matrix(truth, "cam_R_m2c", 3)
    pose[:3, 3] = MM * np.array(numbers(truth, "cam_t_m2c", 3))
    return pose


def camera_of(cameras: Dict[str, Any], frame: str) -> _Camera:
    """Returns the camera of a frame, by scene_camera.json."""
    camera = cameras.get(frame)
    if not isinstance(camera, dict):
        raise ValueError("scene_camera.json has no camera of it")
    camera_matrix, scale = matrix(camera, "cam_K", 3), number(camera, "depth_scale")
    if scale <= 0.0:
        raise ValueError(f"depth_scale is {scale:g}, must be positive")
    return _Camera(camera_matrix, scale)


def rgb_path(scene: str, frame: int) -> str:
    """Returns the path of an image, which is a PNG or JPEG file."""
    stem = os.path.join(scene, "rgb", f"{frame:06d}")
    return next(
        (stem + one for one in (".png", ".jpg") if os.path.exists(stem + one)), stem + ".png"
    )


def _color(data: bytes) -> Any:
    return cv2.imencode(".png", sensor_pixels(data))[1].tobytes()


def depth_in_mm(data: bytes, scale: float) -> bytes:
    """Returns a PNG file in mm; `scale` is what its numbers have to be multiplied by for that."""
    if scale == 1.0:
        return data
    depths = sensor_pixels(data, cv2.IMREAD_UNCHANGED)
    scaled = np.clip(np.rint(depths.astype(float) * scale), 0, MAX_DEPTH)
    return cv2.imencode(".png", scaled.astype(np.uint16))[1].tobytes()
