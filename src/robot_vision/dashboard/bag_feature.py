"""Recording of bags: what is recorded, and the bags that are there."""

from typing import Any, Dict

from .bag_download import BagHandler, Downloads
from .bag_files import BagFolder
from .bag_images import recorded_topics
from .bag_recorder import MAX_TOPICS, BagRecorder
from .bag_recording import MB
from .fields import Flag, Names, Number, Text
from .operations import Operation
from .settings import Settings
from .watchers import Watchers

MAX_SECONDS = 86400.0  # s, a day


class BagFeature:
    """Records topics into bags, lists, gives and deletes them.

    Args:
        settings: The node's parameters.
    """

    def __init__(self, settings: Settings):
        self._folder = BagFolder(settings.bag_folder)
        self._watchers = Watchers()
        self._recorder = BagRecorder(self._folder, self._on_status)
        self._max_megabytes = settings.max_bag_size
        size = Number(1, self._max_megabytes, integer=True, default=self._max_megabytes)
        self.operations = [
            Operation("bags", self._bags, "view"),
            Operation(
                "bag_record",
                self._record,
                fields={
                    "topics": Names(MAX_TOPICS, default=()),
                    "images": Names(MAX_TOPICS, default=()),
                    "name": Text(default=""),
                    "max_megabytes": size,
                    "max_seconds": Number(0.0, MAX_SECONDS, default=0.0),
                },
            ),
            Operation("bag_stop", self._stop),
            Operation(
                "bag_delete", self._delete, fields={"name": Text(), "unfinished": Flag(False)}
            ),
        ]
        self.routes = [
            ("/bags/([^/]*)", BagHandler, {"folder": self._folder, "downloads": Downloads()})
        ]

    def close(self) -> None:
        """Ends a recording; its bag is finished."""
        self._recorder.close()

    def _bags(self, session: Any, _fields: Dict[str, Any]) -> Dict[str, Any]:
        self._watchers.add(session)
        recording = self._recorder.status()
        own = recording["name"] if recording else ""
        return {
            "folder": self._folder.path,
            "free": self._folder.free_space(),
            "max_megabytes": self._max_megabytes,
            "bags": self._folder.bags(),
            "unfinished": [name for name in self._folder.unfinished() if name != own],
            "recording": recording,
        }

    def _record(self, _session: Any, fields: Dict[str, Any]) -> Dict[str, Any]:
        """Records topics as they are, and images in the form that suits them."""
        self._recorder.require_idle()
        topics = [*recorded_topics(fields["images"]), *fields["topics"]]
        max_bytes = fields["max_megabytes"] * MB
        return self._recorder.start(topics, fields["name"], max_bytes, fields["max_seconds"])

    def _stop(self, _session: Any, _fields: Dict[str, Any]) -> Dict[str, Any]:
        self._recorder.stop()
        return {}

    def _delete(self, _session: Any, fields: Dict[str, Any]) -> Dict[str, Any]:
        name = fields["name"]
        recording = self._recorder.status()
        if recording and recording["name"] == name:
            raise ValueError(f"{name} is being recorded: stop that first")
        self._folder.delete(name, fields["unfinished"])
        self._watchers.push("bags", {"deleted": name})
        return {}

    def _on_status(self, status: Dict[str, Any]) -> None:
        self._watchers.push("recording", status)
