"""The operations select_object and forget_object: what nodes are to follow, or to look at."""

from typing import Any, Dict

from ..common.plain_text import printable
from ..ros.graph_master import graph_name, has_service
from ..ros.messages import region_of
from ..srv import ForgetObject, SelectObject
from .fields import Number, Region, Text
from .graph_calls import call_node
from .operations import Operation
from .select_topics import NodeTopics
from .sessions import Session
from .settings import Settings

SELECT = "select_object"
SELECT_TIMEOUT = 13.0  # s; the node itself waits up to 10 s for a frame
MAX_ID = 2**31 - 1
MAX_MESSAGE = 1000  # characters


class SelectFeature:
    """Selects regions by a node's ~select_object, or by its topic ~select if it has none.

    The answer has the id of the object; -1 if the node gives none.
    """

    def __init__(self, settings: Settings):
        select = {"node": Text(), "region": Region(), "label": Text(max_length=100, default="")}
        forget = {"node": Text(), "object": Number(-1, MAX_ID, integer=True)}  # -1: all
        self.operations = [
            Operation(SELECT, self._on_select, "control", select),
            Operation("forget_object", self._on_forget, "control", forget),
        ]
        self._topics = NodeTopics()

    def close(self) -> None:
        self._topics.close()

    def _on_select(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        node, box = graph_name(request["node"]), request["region"]
        if not (box["width"] and box["height"]):
            raise ValueError(f"a region of {box['width']}x{box['height']}, must have pixels")
        region = region_of((box["x"], box["y"], box["width"], box["height"]))
        if not has_service(f"{node}/{SELECT}"):
            return {"message": self._topics.send(node, "select", region), "id": -1}
        answer = call_node(
            node, SELECT, SelectObject, region, request["label"], timeout=SELECT_TIMEOUT
        )
        if not answer.success:
            raise ValueError(f"nothing selected: {printable(answer.message, MAX_MESSAGE)}")
        return {"message": f"object {answer.id} of {node} is selected", "id": answer.id}

    def _on_forget(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        number = request["object"]
        answer = call_node(request["node"], "forget", ForgetObject, number)
        if not answer.success:
            raise ValueError(printable(answer.message, MAX_MESSAGE))
        what = "all objects are" if number == -1 else f"object {number} is"
        return {"message": f"{what} forgotten"}
