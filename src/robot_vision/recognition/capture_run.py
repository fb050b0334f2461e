"""The capture of an object: frames come in, and the views that are kept go into the database."""

from collections import Counter
from typing import Counter as Counts
from typing import Dict, Iterable, Optional, Tuple

import numpy as np

from .. import CameraModel, to_gray
from ..common import opencv as cv2
from ..common.progress import Progress
from ..ros.camera_info import size_words
from .capture_mask import PixelRays, Space, metres_of, object_mask, sharpness, touches_border
from .capture_plate import Plate
from .capture_sources import Images, Shot
from .capture_views import View, ViewCollection
from .captured_mesh import forget_mesh
from .database import Database, Observation, Session
from .plate_finder import PlateFinder

MIN_PIXELS = 400  # of an object in an image
MAX_DEPTH = 65535  # mm
MAX_UNUSABLE = 30  # frames from the beginning on, after which those that follow are so, too


class CaptureRun:
    """Takes frames until there is a view from all directions.

    Each view is stored in a transaction of its own, so that what there is can always be used.

    Args:
        database: Where views are stored; None: nowhere, it is a trial.
        session: The session that they belong to, which is added with the first of them.
        plate: The plate.
        space: Where the object is above it.
        cameras: The cameras that the images may have, by their size; the first one tells which.
        views: Those that there are, which tell what is missing.
        replace: Whether earlier sessions, and the mesh that was made of them, are deleted when the
            first view is stored.
        progress: What tells how far it is.
    """

    def __init__(
        self,
        database: Optional[Database],
        session: Session,
        plate: Plate,
        space: Space,
        cameras: Dict[Tuple[int, int], CameraModel],
        views: ViewCollection,
        replace: bool,
        progress: Progress,
    ) -> None:
        self._database = database
        self._session = session
        self._finder = PlateFinder(plate)
        self._space = space
        self._cameras = cameras
        self._rays = PixelRays()
        self._views = views
        self._replace = replace
        self._progress = progress
        self._frames = 0
        self._usable = 0  # frames whose images could be read, and are of the camera's size
        self._problems: Counts[str] = Counter()

    def take(self, shots: Iterable[Shot]) -> None:
        """Takes frames until all directions have a view, or there are no more.

        Raises:
            OSError: A file cannot be read, or the database not be written.
            ValueError: There is not one view, or not one image can be used.
        """
        try:
            for shot in shots:
                view = self._view(shot)
                if view is not None:
                    self._store(self._views.add(view))
                self._progress.tell(self._views.summary())
                if self._views.full:
                    return
        finally:
            self._store(self._views.end())
        if not self._views.kept:
            raise ValueError(f"no view of the object in {self._frames} frames{self._worst()}")

    def result(self) -> str:
        """What there is in the end, for the user."""
        text = self._views.summary()
        if self._views.kept:
            text += ", stored" if self._database is not None else ", would be stored"
        return text if self._views.full else text + self._worst()

    def interrupted(self) -> str:
        """What there is after Ctrl-C, for the user."""
        text = f"interrupted; {self.result()}"
        if self._database is None or not self._views.kept:
            return text
        return (
            f"{text}. What is there can be learned as it is; --add takes the rest if the object "
            "stays where it is"
        )

    def _view(self, shot: Shot) -> Optional[View]:
        """Returns a frame as a view, or None if it cannot be one."""
        self._frames += 1
        try:
            image, depth = self._images_of(shot)
        except ValueError as error:
            self._problems[str(error)] += 1
            if not self._usable and self._frames >= MAX_UNUSABLE:
                raise ValueError(f"{shot.name}: {error}") from None
            return None
        self._usable += 1
        (camera,) = self._cameras.values()
        found = self._finder.find(image, depth, camera)
        if found.pose is None:
            self._problems[found.problem] += 1
            return None
        mask = object_mask(depth, self._rays.of(camera), found.pose, self._space)
        if np.count_nonzero(mask) < MIN_PIXELS:
            self._problems["there is nothing on the plate, or it has no depth"] += 1
            return None
        if touches_border(mask):
            self._problems["not all of the object is in the image"] += 1
            return None
        sharp = sharpness(to_gray(image, "bgr8"), mask)
        return View(shot.time, self._frames, image, depth, mask, camera, found.pose, sharp)

    def _images_of(self, shot: Shot) -> Images:
        """Returns the images of a frame; raises ValueError if they cannot be used."""
        image, depth = shot.read()
        for name, pixels in (("image", image), ("depth", depth)):
            size = pixels.shape[1::-1]
            if size not in self._cameras:
                sizes = size_words([size]), size_words(self._cameras)
                raise ValueError(f"its {name} is of {sizes[0]}, camera_info of {sizes[1]}")
            self._cameras = {size: self._cameras[size]}
        return image, depth

    def _store(self, view: Optional[View]) -> None:
        if view is None:
            return
        if self._database is not None:
            self._write(view, self._database)
        self._views.keep(view)

    def _write(self, view: View, database: Database) -> None:
        observations, session = database.observations, self._session
        with database.transaction():
            if not session.id:
                if self._replace:
                    for one in observations.sessions(session.object_id):
                        observations.delete_session(one.id)
                    forget_mesh(database, session.object_id)
                session = observations.add_session(session)
            observations.add(_observation(view, session.id))
        self._session = session  # which is there only now

    def _worst(self) -> str:
        """Why most frames that were not used were not."""
        if not self._problems:
            return ""
        problem, count = self._problems.most_common(1)[0]
        return f"; {sum(self._problems.values())} frames were not used, most ({count}): {problem}"


def _observation(view: View, session_id: str) -> Observation:
    metres = metres_of(view.depth)
    depth = np.clip(np.rint(1000.0 * np.nan_to_num(metres)), 0, MAX_DEPTH).astype(np.uint16)
    rgb, depth_file, mask = (
        cv2.imencode(".png", pixels)[1].tobytes() for pixels in (view.image, depth, view.mask)
    )
    camera = view.camera
    return Observation(
        session_id, view.number, rgb, depth_file, mask, camera.K, view.pose, list(camera.D)
    )
