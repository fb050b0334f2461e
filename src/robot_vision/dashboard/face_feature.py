"""The operations on faces: who is known, and teaching and forgetting people."""

from typing import Any, Dict

from ..common.plain_text import printable
from ..faces.gallery_files import valid_name
from ..ros.graph_master import graph_name, server_param
from ..srv import EnrollFace, ForgetName, ListNames
from .face_folder import gallery_of, small_picture
from .fields import Number, Text
from .graph_calls import call_node
from .operations import Operation
from .sessions import Session
from .settings import Settings

NODE_TIMEOUT = 10.0  # s that a node takes for enrolling at most, if it does not say
MAX_NODE_TIMEOUT = 600.0  # s
ENROLL_MARGIN = 10.0  # s until the node has ended and learnt whom it has enrolled
FORGET_TIMEOUT = 10.0  # s, as the others are learnt anew
MAX_PEOPLE = 1000
MAX_PICTURES = 100  # that are taken of a person
MAX_MESSAGE = 1000  # characters


class FaceFeature:
    """Calls the services of face_recognizer, and shows small copies of its gallery's images."""

    def __init__(self, settings: Settings):
        node = {"node": Text()}
        named = {**node, "name": Text(max_length=60)}
        count = Number(0, MAX_PICTURES, integer=True, default=0)
        self.operations = [
            Operation("faces", self._on_faces, "view", node),
            Operation(
                "enroll", self._on_enroll, "control", {**named, "pictures": count}, beside=True
            ),
            Operation("forget_face", self._on_forget, "control", named),
            Operation(
                "face_picture",
                self._on_picture,
                "view",
                {**named, "index": Number(0, 100000, integer=True, default=0)},
            ),
        ]

    def close(self) -> None:
        """There is nothing to end."""

    def _on_faces(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        people = _pictures_by_name(request["node"])
        return {
            "people": [
                {"name": printable(name), "pictures": count}
                for name, count in sorted(people.items())
            ]
        }

    def _on_enroll(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        name = valid_name(request["name"])
        node, pictures = request["node"], request["pictures"]
        timeout = _node_timeout(node) + ENROLL_MARGIN
        return _done(call_node(node, "enroll", EnrollFace, name, pictures, timeout=timeout))

    def _on_forget(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        name = valid_name(request["name"])
        return _done(
            call_node(request["node"], "forget_name", ForgetName, name, timeout=FORGET_TIMEOUT)
        )

    def _on_picture(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        name, index = valid_name(request["name"]), request["index"]
        if name not in _pictures_by_name(request["node"]):
            raise ValueError(f"{request['node']} knows nobody called '{printable(name)}'")
        return {"jpeg": small_picture(gallery_of(request["node"]), name, index)}


def _pictures_by_name(node: str) -> Dict[str, int]:
    """Returns the number of images of each person that a node knows."""
    answer = call_node(node, "list_names", ListNames)
    return dict(list(zip(answer.names, answer.pictures))[:MAX_PEOPLE])


def _node_timeout(node: str) -> float:
    """Returns the s that a node takes for enrolling, as its live parameter says."""
    value = server_param(f"{graph_name(node)}/enroll_timeout")
    is_time = isinstance(value, (int, float)) and 0.0 < value <= MAX_NODE_TIMEOUT
    return float(value) if is_time else NODE_TIMEOUT


def _done(answer: Any) -> Dict[str, Any]:
    message = printable(answer.message, MAX_MESSAGE)
    if not answer.success:
        raise ValueError(message)
    return {"message": message, "pictures": answer.pictures}
