"""The node python_manager, which holds nodes of this package and nodelets in one process."""

from typing import Any

import rospy
from nodelet.srv import (
    NodeletList,
    NodeletListResponse,
    NodeletLoad,
    NodeletLoadResponse,
    NodeletUnload,
    NodeletUnloadResponse,
)

from ..common.plain_text import printable
from ..ros.context import current
from ..ros.startup import run_node
from .held_nodes import HeldNodes
from .load_requests import checked, resolved_name
from .log_names import log_by_node

MAX_ERROR_LENGTH = 4000  # letters; an unknown type is told with all that are known


class PythonManager:
    """Loads nodes, as a nodelet manager does, and passes images on to them without a copy.

    ~load_nodelet loads a nodelet of any package, or one of this package's nodes in Python, for
    which a name such as robot_vision/hsv_tracker stands; ~unload_nodelet ends it, ~list names all.
    So `rosrun nodelet nodelet load TYPE MANAGER` works, and `rosrun robot_vision python_nodelet.py`
    does the same.
    """

    def __init__(self) -> None:
        log_by_node()
        self._nodes = HeldNodes()
        context = current()
        context.on_end(self._nodes.finish)
        context.service("~load_nodelet", NodeletLoad, self._on_load)
        context.service("~unload_nodelet", NodeletUnload, self._on_unload)
        context.service("~list", NodeletList, self._on_list)

    def _on_load(self, request: Any) -> NodeletLoadResponse:
        try:
            self._nodes.load(checked(request, current().name))
        except (RuntimeError, ValueError) as error:
            raise _refusal("not loaded", error) from None
        return NodeletLoadResponse(True)

    def _on_unload(self, request: Any) -> NodeletUnloadResponse:
        try:
            self._nodes.unload(resolved_name(request.name, current().name))
        except (RuntimeError, ValueError) as error:
            if not current().is_ending():  # It ends all nodes, whoever was faster.
                raise _refusal("not unloaded", error) from None
        return NodeletUnloadResponse(True)

    def _on_list(self, _request: Any) -> NodeletListResponse:
        return NodeletListResponse(self._nodes.names())


def _refusal(what: str, error: Exception) -> rospy.ServiceException:
    """Logs an error and returns it as the answer, by which clients in C++ know that it failed."""
    text = f"{what}: {printable(str(error), MAX_ERROR_LENGTH)}"
    if not current().is_ending():
        rospy.logerr("%s", text)
    return rospy.ServiceException(text)


def main() -> None:
    run_node("python_manager", PythonManager, has_file=False)
