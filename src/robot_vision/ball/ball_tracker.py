"""The node ball_tracker, which follows the largest round region of a colour."""

import collections
import math
from typing import Any, Deque, Dict, Optional, Tuple

import numpy as np
from geometry_msgs.msg import Point, PointStamped, Pose, Quaternion, Vector3
from tf2_msgs.msg import TFMessage

from .. import (
    BallMeasurement,
    BallPosition,
    BallState,
    BallTrackerParams,
    HsvMask,
    HsvRange,
    Region,
    RegionFinder,
    RegionParams,
    ball_position,
    choose_ball,
    draw_ball,
    draw_trail,
    validate,
)
from .. import BallTracker as Filter
from ..msg import Detection, DetectionArray
from ..ros.camera_info import CameraInfoListener
from ..ros.configs import BallTrackerConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import detection, detection_array
from ..ros.params import read_name, read_param
from ..ros.poses import transform_at
from ..ros.startup import run_node
from ..ros.transform_output import TransformOutput
from ..ros.transport import Frame, note_connections

MAX_DIAMETER = 100.0  # m, largest diameter


class BallTracker:
    """Publishes ~objects (one ball or none), ~mask, ~processed_image with the ball and its trail.

    Subscribes to image. If ~ball_diameter (m) is set, it also publishes ~position and, in /tf, the
    frame ~ball_frame_id, unless ~publish_tf is false. For these it needs camera_info, from the
    topic beside the image or from the one that this name is remapped to; all else goes on without.
    """

    def __init__(self) -> None:
        self._trail: Deque[Tuple[float, float]] = collections.deque()
        self._time = 0.0  # s, the last frame
        self._size: Tuple[int, ...] = ()  # of the last image, px
        self._filter_params: Optional[BallTrackerParams] = None  # of the filter
        self._diameter = read_param("ball_diameter", 0.0, 0.0, MAX_DIAMETER, zero="unknown")
        self._ball_frame = read_name("ball_frame_id", "ball")
        self._node = ImageNode(self._process, idle=self._trail.clear)
        self._params = LiveParams(BallTrackerConfig, self._configure)
        self._objects = self._node.publisher("~objects", DetectionArray)
        self._mask = self._node.image_publisher("~mask")
        self._processed = self._node.image_publisher("~processed_image")
        if self._diameter > 0.0:
            self._calibration = CameraInfoListener(self._node, "position of the ball")
            self._positions = self._node.publisher("~position", PointStamped)
            self._tf = TransformOutput(self._node, lambda: self._publish_tf)
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        mask = HsvMask(filled(HsvRange(), config))
        finder = RegionFinder(filled(RegionParams(), config))
        params = filled(BallTrackerParams(), config)
        validate(params)
        # Replaced in one step, because another thread may be processing a frame.
        self._tools = mask, finder, params, config["min_roundness"], config["trail"]
        self._publish_tf = config["publish_tf"]
        note_connections()  # because /tf may start or stop to count

    def _process(self, frame: Frame) -> None:
        mask_of, finder, params, min_roundness, trail = self._tools
        tracker = self._filter_for(frame, params)
        mask, regions = finder.apply(mask_of.apply(frame.image))
        time = frame.time
        expected = tracker.expected(time)
        region = choose_ball(regions, min_roundness, expected.center if expected else None)
        position = self._locate(frame, region)
        measured = None
        if region:
            center = position.center if position else region.center
            measured = BallMeasurement(center, region.circle_radius)
        state = tracker.update(time, measured)
        if state is None or state.predicted:
            region = position = None
        self._remember(time, state, trail)
        self._publish(frame, state, region, position)
        self._mask.publish(mask, "mono8", frame.header)

    def _filter_for(self, frame: Frame, params: BallTrackerParams) -> Filter:
        """Returns the filter; a new one has lost the ball, so it is made only when it has to be."""
        size = frame.image.shape[:2]
        if size != self._size:  # Places in images of another size say nothing of this one.
            self._trail.clear()
        if (size, params) != (self._size, self._filter_params):
            self._filter = Filter(params)
        self._size, self._filter_params = size, params
        return self._filter

    def _locate(self, frame: Frame, region: Optional[Region]) -> Optional[BallPosition]:
        """Returns the position of the ball, or None if its diameter or the camera is not known."""
        if self._diameter == 0.0:
            return None
        camera = self._calibration.camera(frame.image.shape[1::-1])  # It also says what is missing.
        if camera is None or region is None:
            return None
        return ball_position(camera, region.outline, self._diameter)

    def _remember(self, time: float, state: Optional[BallState], length: int) -> None:
        if time < self._time:  # For instance, a bag starts again.
            self._trail.clear()
        self._time = time
        self._trail.append(state.center if state else (math.nan, math.nan))
        while len(self._trail) > length:
            self._trail.popleft()

    def _publish(
        self,
        frame: Frame,
        state: Optional[BallState],
        region: Optional[Region],
        position: Optional[BallPosition],
    ) -> None:
        found = [ball_detection(state, region)] if state else []
        self._objects.publish(detection_array(frame, found))
        if position:
            self._publish_position(frame, position.position)
        if self._processed.get_num_connections():
            overlay = frame.image.copy()
            draw_trail(overlay, np.array(self._trail))
            if state:
                draw_ball(overlay, state.center, state.radius, state.predicted)
            self._processed.publish(overlay, "bgr8", frame.header)

    def _publish_position(self, frame: Frame, position: np.ndarray) -> None:
        self._positions.publish(PointStamped(frame.header, Point(*position)))
        if self._tf.is_wanted():
            # A ball looks the same from all sides.
            pose = Pose(Point(*position), Quaternion(w=1.0))
            self._tf.publish(TFMessage([transform_at(frame.header, self._ball_frame, pose)]))


def ball_detection(state: BallState, region: Optional[Region]) -> Detection:
    """Returns the ball as a Detection; `region` is None if the ball is predicted, not seen."""
    message = detection(region, "ball", region.roundness) if region else Detection(label="ball")
    message.id = 0
    message.center = Point(*state.center, 0.0)
    message.circle_center = message.center
    message.circle_radius = state.radius
    message.has_velocity = True
    message.velocity = Vector3(*state.velocity, 0.0)
    message.predicted = state.predicted
    return message


def main() -> None:
    run_node("ball_tracker", BallTracker)
