"""The operation capture, which lets go of a camera and takes it again."""

from typing import Any, Dict

from std_srvs.srv import Empty

from .fields import Flag, Text
from .graph_calls import call_node
from .operations import Operation
from .sessions import Session
from .settings import Settings

TIMEOUT = 10.0  # s, as a device may take long to close


class CaptureFeature:
    """Calls a camera's ~start_capture or ~stop_capture (std_srvs/Empty)."""

    def __init__(self, settings: Settings):
        fields = {"node": Text(), "start": Flag()}
        self.operations = [Operation("capture", self._on_capture, "control", fields)]

    def close(self) -> None:
        """There is nothing to end."""

    def _on_capture(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        service = "start_capture" if request["start"] else "stop_capture"
        call_node(request["node"], service, Empty, timeout=TIMEOUT)
        done = "goes on" if request["start"] else "has stopped"
        return {"message": f"the capture of {request['node']} {done}"}
