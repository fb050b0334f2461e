"""The node tabletop, which finds tables in depth images, and what stands on them."""

from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np
from visualization_msgs.msg import MarkerArray

from .. import (
    CameraModel,
    PlaneParams,
    Table,
    TabletopFinder,
    TabletopParams,
    draw_text,
    validate,
)
from ..common.plain_text import NAME, brief, is_name
from ..msg import Detection3DArray, TableArray
from ..ros.camera_info import NOT_CALIBRATED, CameraInfoListener
from ..ros.configs import TabletopConfig
from ..ros.depth_frames import DepthLook
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.params import read_name
from ..ros.startup import run_node
from ..ros.transform_output import TransformOutput
from ..ros.transport import KEPT, Frame, note_connections
from .depth_overlay import depth_gray
from .depth_range import within
from .table_markers import markers
from .table_messages import object_array, table_array, transforms
from .table_overlay import draw_tables
from .vertical_axis import VerticalAxis


class Settings(NamedTuple):
    """The live parameters."""

    planes: PlaneParams
    tables: TabletopParams
    max_tables: int
    max_distance: float  # m
    vertical_frame: str
    rectified: bool
    publish_tf: bool


class Tabletop:
    """Publishes ~tables, ~objects (which stand on them), ~markers, /tf and ~processed_image.

    Subscribes to image, of depths, and to camera_info beside it, or where that name is remapped to.
    With ~vertical_frame it also listens to /tf and /tf_static.
    """

    def __init__(self) -> None:
        self._table_frame = read_name("table_frame_id", "table")
        self._finder: Optional[TabletopFinder] = None
        self._made_of: Tuple[Any, ...] = ()  # what the finder was made of
        self._vertical = VerticalAxis()
        self._node = ImageNode(self._process, encoding="", idle=self._vertical.forget)
        self._look = DepthLook(self._node.topic)
        self._params = LiveParams(TabletopConfig, self._configure)
        self._calibration = CameraInfoListener(self._node, "tables")
        self._tables = self._node.publisher("~tables", TableArray)
        self._objects = self._node.publisher("~objects", Detection3DArray)
        self._markers = self._node.publisher("~markers", MarkerArray)
        self._tf = TransformOutput(self._node, lambda: self._settings.publish_tf, listens=True)
        self._processed = self._node.image_publisher("~processed_image")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        frame = config["vertical_frame"]
        if frame and not is_name(frame):
            raise ValueError(f"vertical_frame is {brief(frame)}, must be empty or {NAME}")
        planes, tables = filled(PlaneParams(), config), filled(TabletopParams(), config)
        validate(planes)
        validate(tables)
        own = (config[name] for name in Settings._fields[2:])
        self._settings = Settings(planes, tables, *own)  # replaced in one step
        note_connections()  # because /tf may start or stop to count

    def _process(self, frame: Frame) -> Any:
        settings = self._settings
        self._look.check(frame)
        camera = self._calibration.camera(frame.image.shape[1::-1], settings.rectified)
        if camera is None:
            if self._processed.get_num_connections():
                overlay = depth_gray(frame.image, settings.max_distance)
                draw_text(overlay, NOT_CALIBRATED, (10, 20))
                self._processed.publish(overlay, "bgr8", frame.header)
            self._calibration.refuse()
            return KEPT
        up = self._vertical.of(frame, settings.vertical_frame)
        if up is None:
            return KEPT
        self._publish(frame, camera, settings, *self._find(frame, camera, settings, up))
        return None

    def _find(
        self, frame: Frame, camera: CameraModel, settings: Settings, up: Tuple[float, ...]
    ) -> Tuple[List[Table], np.ndarray]:
        """Returns the tables, the highest first, and which pixel is of which object."""
        made_of = camera, settings.planes, settings.tables
        if made_of != self._made_of:
            self._finder = TabletopFinder(*made_of)
            self._made_of = made_of
        tables, labels = self._finder.find(within(frame.image, settings.max_distance), up)
        return tables[: settings.max_tables], labels

    def _publish(
        self,
        frame: Frame,
        camera: CameraModel,
        settings: Settings,
        tables: List[Table],
        labels: np.ndarray,
    ) -> None:
        if self._tables.get_num_connections():
            self._tables.publish(table_array(frame.header, tables))
        if self._objects.get_num_connections():
            self._objects.publish(object_array(frame.header, tables, camera, settings.planes))
        if self._markers.get_num_connections():
            self._markers.publish(markers(frame.header, tables))
        if self._tf.is_wanted():
            self._tf.publish(transforms(frame.header, self._table_frame, tables))
        if self._processed.get_num_connections():
            overlay = depth_gray(frame.image, settings.max_distance)
            draw_tables(overlay, tables, labels, camera)
            self._processed.publish(overlay, "bgr8", frame.header)


def main() -> None:
    run_node("tabletop", Tabletop)
