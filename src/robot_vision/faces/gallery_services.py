"""The services that tell a face recogniser which people it knows."""

import os
import threading
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple

import numpy as np
import rospkg
import rospy

from ..common.plain_text import printable
from ..ros.context import current
from ..ros.image_node import INPUT_TIMEOUT
from ..ros.params import read_param
from ..srv import EnrollFace, EnrollFolder, ForgetName, ListNames
from .enrollment import Enrollment, OfferedFace
from .gallery import Added, Gallery
from .gallery_files import shown, valid_name

DEFAULT_COUNT = 10  # portraits that are taken by default
MAX_COUNT = 100
END_TIMEOUT = 3.0  # s, longer than the time that run_node() gives a node to end


class GalleryServices:
    """~enroll, ~enroll_folder, ~list_names and ~forget_name for the gallery that ~gallery names.

    Args:
        changed: A function that is called with the gallery when it is loaded and when it changed.
        keep_working: A function that is called with True when images are needed, and with False
            afterwards.
        missing: A function that returns which inputs had no message for a number of s, in words.

    Raises:
        ValueError: ~gallery is not a folder.
    """

    def __init__(
        self,
        changed: Callable[[Gallery], Any],
        keep_working: Callable[[bool], Any],
        missing: Callable[[float], str],
    ) -> None:
        self.timeout = 10.0  # s of the wall clock in which ~enroll needs its images; may be changed
        self._changed = changed
        self._keep_working = keep_working
        self._missing = missing
        self._enrollment: Optional[Enrollment] = None
        self._enrolling = threading.Lock()  # held while portraits are taken of one person
        self._learning = threading.Lock()  # held during training, so that the last change wins
        self._working = 0  # number of calls in progress
        self._ended = threading.Condition()  # notified when a call ends
        default = os.path.join(rospkg.get_ros_home(), "robot_vision", "faces")
        self._gallery = Gallery(read_param("gallery", "") or default)
        _report(self._gallery.load())
        changed(self._gallery)
        people = self._gallery.names()
        count = sum(people.values())
        folder = shown(self._gallery.folder)
        rospy.loginfo("%d people by %d images in %s", len(people), count, folder)

    def advertise(self) -> None:
        """Advertises the services."""
        current().on_end(self._finish)
        self._service("~enroll", EnrollFace, self._on_enroll)
        self._service("~enroll_folder", EnrollFolder, self._on_enroll_folder)
        self._service("~list_names", ListNames, self._on_list_names)
        self._service("~forget_name", ForgetName, self._on_forget_name)

    def offer(self, image: np.ndarray, faces: Sequence[OfferedFace], now: float) -> None:
        """Offers an image and its faces to ~enroll: see Enrollment.offer()."""
        enrollment = self._enrollment
        if enrollment:
            enrollment.offer(image, faces, now)

    def begin_anew(self) -> None:
        """Has ~enroll take no more portraits of the face before: see Enrollment.begin_anew()."""
        enrollment = self._enrollment
        if enrollment:
            enrollment.begin_anew()

    def _service(self, name: str, kind: Any, handler: Callable[[Any], Any]) -> None:
        def handle(request: Any) -> Any:
            with self._ended:
                self._working += 1
            try:
                return handler(request)
            finally:
                with self._ended:
                    self._working -= 1
                    self._ended.notify_all()

        current().service(name, kind, handle)

    def _finish(self) -> None:
        """Waits for running calls, because the process would abort if one of them were in C++."""
        with self._ended:
            self._ended.wait_for(lambda: not self._working, END_TIMEOUT)

    def _learn(self) -> None:
        with self._learning:
            if not current().is_ending():
                self._changed(self._gallery)

    def _on_enroll(self, request: Any) -> Tuple[bool, str, int]:
        try:
            added = self._enroll(request.name, request.pictures or DEFAULT_COUNT)
        except (OSError, RuntimeError, ValueError) as error:
            rospy.logerr("nobody enrolled: %s", error)
            return False, str(error), 0
        return True, _summary(added, request.name), added.pictures

    def _enroll(self, name: str, pictures: int) -> Added:
        name = valid_name(name)
        if pictures > MAX_COUNT:
            raise ValueError(f"pictures is {pictures}, must be from 1 to {MAX_COUNT}")
        if not self._enrolling.acquire(blocking=False):
            raise RuntimeError("somebody else is being enrolled")
        try:
            portraits = self._take(Enrollment(pictures))
        finally:
            self._enrolling.release()
        added = self._gallery.add(name, portraits)
        self._learn()
        _report(added.problems)
        return added

    def _take(self, enrollment: Enrollment) -> Dict[str, np.ndarray]:
        timeout = self.timeout
        self._enrollment = enrollment
        self._keep_working(True)
        try:
            if not enrollment.wait(timeout, current().is_ending):
                # Half of the timeout is enough, as the node has not been working all the time.
                missing = self._missing(min(INPUT_TIMEOUT, timeout / 2))
                reason = f": {missing}" if missing else ""
                raise RuntimeError(f"{enrollment.outcome()}, within {timeout:g} s{reason}")
        finally:
            self._enrollment = None
            self._keep_working(False)
        return enrollment.portraits

    def _on_enroll_folder(self, request: Any) -> Tuple[bool, str, int, List[str]]:
        try:
            if not os.path.isabs(request.folder):  # A node and its caller run in different folders.
                raise ValueError(
                    f"folder is '{printable(request.folder)}', must be an absolute path"
                )
            try:
                added = self._gallery.import_folder(
                    request.folder, request.name, current().is_ending
                )
            finally:
                self._learn()
        except (OSError, ValueError) as error:
            rospy.logerr("no folder enrolled: %s", error)
            return False, str(error), 0, []
        _report(added.problems)
        some = added.pictures + added.present > 0
        text = _summary(added, request.name or "people")
        if not some:
            text += ": " + added.problems[0]
        return some, text, added.pictures, added.problems

    def _on_list_names(self, _request: Any) -> Tuple[List[str], List[int]]:
        names = self._gallery.names()
        return list(names), list(names.values())

    def _on_forget_name(self, request: Any) -> Tuple[bool, str, int]:
        try:
            removed = self._gallery.forget(request.name)
            self._learn()
        except (OSError, ValueError) as error:
            rospy.logerr("nobody forgotten: %s", error)
            return False, str(error), 0
        _report(removed.problems)
        known = valid_name(request.name) in self._gallery.names()
        text = "; ".join(
            [f"{request.name} is {'still known' if known else 'forgotten'}", *removed.problems]
        )
        return not removed.problems, text, removed.pictures


def _summary(added: Added, who: str) -> str:
    present = f", {added.present} were there already" if added.present else ""
    refused = f", {len(added.problems)} problems" if added.problems else ""
    return f"{added.pictures} images of {who} added{present}{refused}"


def _report(problems: List[str]) -> None:
    for problem in problems:
        rospy.logwarn("%s", problem)
