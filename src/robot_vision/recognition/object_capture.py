"""The command object_capture.py, which takes images of an object on a turntable with tags."""

import argparse
import sys
from typing import Iterator, Optional, Sequence

import rospy

from ..common.commands import run_command
from ..common.plain_text import printable
from ..common.progress import Progress
from ..ros.startup import become_node
from .capture_arguments import PROGRAM, parse_arguments
from .capture_mask import Space
from .capture_plate import Plate, plate_of, read_plate_bundle
from .capture_run import CaptureRun
from .capture_sources import (
    Shot,
    capture_cameras,
    shots_from_bag,
    shots_from_folder,
    shots_from_topics,
)
from .capture_views import ViewCollection
from .captured_mesh import make_mesh, wants_mesh
from .database import Database, Object, Session
from .database_arguments import COMMIT, open_database


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(rospy.myargv(sys.argv)[1:])
    return run_command(PROGRAM, lambda: capture(arguments))


def capture(arguments: argparse.Namespace) -> None:
    """Takes the images, and makes a mesh of them.

    Raises:
        OSError: The database cannot be written, or a file not be read.
        ValueError: There is no such object, plate or camera, or there are no images.
    """
    tags = read_plate_bundle(arguments.bundle, arguments.bundle_name, arguments.family)
    plate = plate_of(tags, arguments.center, arguments.radius)
    with open_database(arguments, write=arguments.commit) as database:
        one = database.objects.find(arguments.object)
        _require_room(database, one, arguments)
        print(_introduction(one, plate, arguments.center), flush=True)
        run = _run(database, one, plate, arguments)
        try:
            run.take(_shots(arguments))
        except KeyboardInterrupt:
            print(run.interrupted(), flush=True)
            raise
        print(run.result(), flush=True)
        if not arguments.commit:
            print(COMMIT)
        elif not arguments.no_mesh and wants_mesh(database, one.id):
            print(make_mesh(database, one, arguments.floor), flush=True)


def _require_room(database: Database, one: Object, arguments: argparse.Namespace) -> None:
    """Raises ValueError if the object has observations, and nobody said what becomes of them."""
    count = database.observations.count(one.id)
    if count and not arguments.add and not arguments.replace:
        raise ValueError(
            f"'{one.name}' has {count} observations already: --replace replaces them, --add adds "
            "to them if the object stands as it did then"
        )


def _introduction(one: Object, plate: Plate, center: Optional[Sequence[float]]) -> str:
    where = f"x {center[0]:g} and y {center[1]:g} m" if center else "the middle of the tags"
    return (
        f"'{one.name}' is what stands within {1000.0 * plate.radius:.0f} mm of {where} of "
        f"'{printable(plate.tags.bundle.name)}'"
    )


def _run(
    database: Database, one: Object, plate: Plate, arguments: argparse.Namespace
) -> CaptureRun:
    """Returns the run, whose camera is known once there is a node, if there has to be one."""
    if not arguments.folder and not arguments.bag:
        become_node("object_capture")
    cameras = capture_cameras(arguments.camera_info, arguments.bag, arguments.folder)
    space = Space(plate.radius, arguments.floor, arguments.height)
    store: Optional[Database] = database if arguments.commit else None
    session = Session(one.id, arguments.folder or arguments.bag or arguments.image)
    earlier = [pose for _, pose in database.observations.poses(one.id)] if arguments.add else []
    views = ViewCollection(arguments.views, earlier)
    return CaptureRun(store, session, plate, space, cameras, views, arguments.replace, Progress())


def _shots(arguments: argparse.Namespace) -> Iterator[Shot]:
    topics = (arguments.image, arguments.depth)
    if arguments.folder:
        return shots_from_folder(arguments.folder)
    if arguments.bag:
        return shots_from_bag(arguments.bag, topics, arguments.slop)
    return shots_from_topics(topics, arguments.slop)
