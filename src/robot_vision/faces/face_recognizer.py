"""The node face_recognizer, which recognises the faces that another node detects."""

import copy
import threading
import time
from typing import Any, Dict, List, Tuple

import numpy as np
import rospy

from .. import draw_outline, draw_text
from ..common.plain_text import to_ascii
from ..msg import Detection, DetectionArray, FaceIdentity, FaceIdentityArray
from ..ros.configs import FaceRecognizerConfig
from ..ros.context import current
from ..ros.detection_limit import best_detections
from ..ros.frame_pairs import FramePairs
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import box_of, corners
from ..ros.startup import run_node
from ..ros.transport import KEPT, Frame, FrameError
from .enrollment import OfferedFace
from .face_images import check_box, normalized
from .gallery import Gallery
from .gallery_services import GalleryServices
from .identities import Identities, Identity, VoteParams
from .recognition import LbphRecognizer

GREEN, RED = (0.0, 255.0, 0.0), (0.0, 0.0, 255.0)


class FaceRecognizer:
    """Publishes ~faces (the received ones with names), ~identities and ~processed_image.

    Subscribes to image, and to the faces that a detector finds in it. The services ~enroll,
    ~enroll_folder, ~list_names and ~forget_name manage the people that are known.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards all attributes below, which services change
        self._recognizer = LbphRecognizer()
        self._names: List[str] = []  # in the order of the recogniser's labels
        self._identities = Identities()
        self._connection: Any = None  # the connection by which the newest faces came
        self._stamp = rospy.Time()  # the stamp of the newest faces
        self._pairs = FramePairs()
        self._faces_topic = current().resolve("faces")
        self._node = ImageNode(self._on_frame, idle=self._pairs.clear)
        self._node.subscriber("faces", DetectionArray, self._on_faces)
        self._faces = self._node.publisher("~faces", DetectionArray)
        self._whose = self._node.publisher("~identities", FaceIdentityArray)
        self._processed = self._node.image_publisher("~processed_image")
        self._services = GalleryServices(self._learn, self._node.keep_working, self._lack)
        self._params = LiveParams(FaceRecognizerConfig, self._configure)
        self._services.advertise()
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        self._identities.params = filled(VoteParams(), config)
        self._services.timeout = config["enroll_timeout"]

    def _learn(self, gallery: Gallery) -> None:
        """Trains a new recogniser, while the old one still recognises faces."""
        faces, whose = gallery.training()
        names = sorted(set(whose))
        labels = {name: label for label, name in enumerate(names)}
        recognizer = LbphRecognizer()
        recognizer.train(faces, [labels[name] for name in whose])
        with self._lock:
            self._recognizer = recognizer
            self._names = names
            self._identities.clear()

    def _on_frame(self, frame: Frame) -> Any:
        missing = self._node.missing()
        lack = missing or self._misfit()
        self._node.set_lack(lack)
        if missing:
            rospy.logwarn_throttle(10.0, f"{missing}: is there a face detector?")
        elif lack:
            rospy.logwarn_throttle(10.0, lack)
        if lack:
            self._show_note(frame, lack)
        faces = self._pairs.message_of(frame)
        return self._process(frame, faces) if faces else KEPT

    def _on_faces(self, faces: DetectionArray) -> None:
        frame = self._pairs.frame_of(faces)
        if frame:
            self._node.go_on(frame, lambda: self._process(frame, faces))

    def _lack(self, seconds: float) -> str:
        """Returns why no faces are recognised, in words; empty if they are. Thread-safe.

        Args:
            seconds: How long an input may be silent.
        """
        return self._node.missing(seconds) or self._misfit()

    def _misfit(self) -> str:
        """Returns, in words, that no images have the stamps of the faces; empty if some have."""
        if not self._pairs.apart():
            return ""
        image, faces = self._node.topic, self._faces_topic
        late = self._pairs.late_text(faces, image)
        return late or f"no images on {image} have the stamps of {faces}: is it another camera's?"

    def _process(self, frame: Frame, faces: DetectionArray) -> None:
        """Recognises the faces in a frame; raises FrameError if they do not fit it."""
        best = DetectionArray(
            faces.header, faces.width, faces.height, best_detections(faces.detections)
        )
        _check(frame, best)
        now = time.monotonic()
        with self._lock:
            self._notice_other_ids(faces)
            self._identities.see((face.id for face in best.detections), now)
            found = [self._identify(frame.image, face, now) for face in best.detections]
            self._publish(frame, best, found)
            offered = [
                OfferedFace(box_of(face.box), face.id, face.predicted) for face in best.detections
            ]
            self._services.offer(frame.image, offered, now)

    def _notice_other_ids(self, faces: DetectionArray) -> None:
        """Forgets whose the ids are when the detector was restarted, because they start anew."""
        connection = getattr(faces, "_connection_header", None)  # one object per connection
        if connection is not self._connection or faces.header.stamp < self._stamp:
            self._identities.clear()
            self._services.begin_anew()
        self._connection, self._stamp = connection, faces.header.stamp

    def _identify(self, image: np.ndarray, face: Detection, now: float) -> Identity:
        if face.predicted:  # Something else may be in its place.
            return self._identities.of(face.id)
        if face.id < 0:
            return self._identities.at_once(*self._look(image, face))
        if self._identities.due(face.id, now):
            self._identities.vote(face.id, *self._look(image, face), now)
        return self._identities.of(face.id)

    def _look(self, image: np.ndarray, face: Detection) -> Tuple[str, float]:
        """Returns the name of the most similar person ("" if nobody is known), and the distance."""
        label, distance = self._recognizer.predict(normalized(image, box_of(face.box)))
        return self._names[label] if label >= 0 else "", distance

    def _publish(self, frame: Frame, faces: DetectionArray, found: List[Identity]) -> None:
        named, whose = messages_of(faces, found)
        self._faces.publish(named)
        self._whose.publish(whose)
        if self._processed.get_num_connections():
            overlay = frame.image.copy()
            for face, identity in zip(faces.detections, found):
                label = to_ascii(f"{identity.name} {identity.distance:.0f}")
                color = GREEN if identity.known else RED
                draw_outline(overlay, corners(box_of(face.box)), label, color)
            self._processed.publish(overlay, "bgr8", frame.header)

    def _show_note(self, frame: Frame, text: str) -> None:
        if self._processed.get_num_connections():
            overlay = frame.image.copy()
            draw_text(overlay, to_ascii(text), (10, 20), RED)
            self._processed.publish(overlay, "bgr8", frame.header)


def _check(frame: Frame, faces: DetectionArray) -> None:
    """Raises FrameError unless the faces may be in the frame's image."""
    height, width = frame.image.shape[:2]
    if (faces.width, faces.height) != (width, height):
        raise FrameError(f"faces of an image of {faces.width}x{faces.height}, not {width}x{height}")
    try:
        for face in faces.detections:
            check_box(frame.image, box_of(face.box))
    except ValueError as error:
        raise FrameError(f"faces that cannot be used: {error}") from None


def messages_of(
    faces: DetectionArray, found: List[Identity]
) -> Tuple[DetectionArray, FaceIdentityArray]:
    """Returns the faces with their names, and the identities.

    The message that came in stays as it is, because other nodes of the process look at it, too.
    """
    header = copy.copy(faces.header)  # rospy numbers what it publishes.
    named = DetectionArray(header, faces.width, faces.height, [])
    whose = FaceIdentityArray(header, [])
    for face, identity in zip(faces.detections, found):
        named.detections.append(copy.copy(face))
        named.detections[-1].label, named.detections[-1].score = identity.name, identity.score
        whose.identities.append(
            FaceIdentity(face.id, identity.name, identity.distance, identity.known)
        )
    return named, whose


def main() -> None:
    run_node("face_recognizer", FaceRecognizer)
