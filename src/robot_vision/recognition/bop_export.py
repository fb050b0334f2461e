"""The database in the format of BOP, the benchmark of object poses.

models/obj_000001.ply, in mm, with models_info.json
objects.json, which object of the database each number is
train_real/000001/, the observations of an object, as scenes of BOP
"""

import os
from typing import Any, Dict, List, Sequence

import numpy as np

from .. import Mesh, mesh_extent
from ..common import opencv as cv2
from ..common.errors import about
from ..meshes.mesh_files import ply_of
from .database import Database, Object, Observation
from .database.folder_files import new_folder, write_data, write_json
from .mesh_data import unpack_mesh
from .observed_views import seen_by
from .straight_images import StraightImages
from .symmetries import MM, to_bop

SPLIT = "train_real"
OBJECTS = "objects.json"
MODELS_INFO = "models_info.json"
SCENE_TRUTHS = "scene_gt.json"


def export_bop(database: Database, objects: Sequence[Object], folder: str) -> List[Object]:
    """Writes objects into a new folder, and returns those that were left out: without a mesh.

    Raises:
        OSError: The folder is there already, or cannot be written.
        ValueError: The database is damaged.
    """
    with new_folder(folder) as made:
        infos: Dict[str, Any] = {}
        names: Dict[str, Any] = {}
        for one in objects:
            entry = database.meshes.entry(one.id)
            if entry is None:
                continue
            number = len(names) + 1
            mesh = unpack_mesh(database.meshes.converted(one.id))
            _write_model(mesh, os.path.join(made, "models"), number)
            with about(one.name):
                infos[str(number)] = _info(mesh, entry.symmetries)
            names[str(number)] = {"id": one.id, "name": one.name, "description": one.description}
            _write_scene(database, one.id, os.path.join(made, SPLIT, f"{number:06d}"), number)
        write_json(infos, made, "models", MODELS_INFO)
        write_json(names, made, OBJECTS)
        written = {name["id"] for name in names.values()}
    return [one for one in objects if one.id not in written]


def _write_model(mesh: Mesh, folder: str, number: int) -> None:
    write_data(ply_of(mesh, 1.0 / MM), folder, f"obj_{number:06d}.ply")


def _info(mesh: Mesh, symmetries: Any) -> Dict[str, Any]:
    extent = mesh_extent(mesh)
    center, size = np.asarray(extent.center), np.asarray(extent.size)
    low = (center - size / 2.0) / MM
    info: Dict[str, Any] = {"diameter": extent.diameter / MM}
    info.update({f"min_{axis}": value for axis, value in zip("xyz", low.tolist())})
    info.update({f"size_{axis}": value for axis, value in zip("xyz", (size / MM).tolist())})
    return {**info, **to_bop(symmetries, center)}


def _write_scene(database: Database, object_id: str, folder: str, number: int) -> None:
    cameras: Dict[str, Any] = {}
    truths: Dict[str, Any] = {}
    for session in database.observations.sessions(object_id):
        for one in database.observations.of(session.id):
            frame = len(cameras)
            rgb, depth, mask = _straight(one)
            write_data(rgb, folder, "rgb", f"{frame:06d}.png")
            write_data(depth, folder, "depth", f"{frame:06d}.png")
            write_data(mask, folder, "mask_visib", f"{frame:06d}_000000.png")
            cameras[str(frame)] = {"cam_K": one.matrix.ravel().tolist(), "depth_scale": 1.0}
            truths[str(frame)] = [_truth(one, number)]
    if cameras:
        write_json(cameras, folder, "scene_camera.json")
        write_json(truths, folder, SCENE_TRUTHS)


def _straight(one: Observation) -> Sequence[bytes]:
    """Returns the image, depth and mask without the distortion of the lens, which BOP lacks."""
    if not any(one.distortion):
        return [one.rgb, one.depth, one.mask]
    seen = seen_by(one)
    straight = StraightImages(seen.camera, None)
    bgr, depth = straight.apply(seen.image, seen.depth)
    mask, _ = straight.apply(np.dstack([seen.mask] * 3), None)
    images = bgr, depth, (mask[:, :, 0] > 127) * np.uint8(255)
    return [cv2.imencode(".png", pixels)[1].tobytes() for pixels in images]


def _truth(one: Observation, number: int) -> Dict[str, Any]:
    return {
        "cam_R_m2c": one.pose[:3, :3].ravel().tolist(),
        "cam_t_m2c": (one.pose[:3, 3] / MM).tolist(),
        "obj_id": number,
    }
