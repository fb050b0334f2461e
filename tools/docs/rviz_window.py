"""The image of rviz, which has to be installed: sudo apt install rviz."""

import contextlib
import os
from typing import Dict, Iterator

import cv2
import genpy
import numpy as np
import roslib.packages
import rospy
from canvas import beside
from pages import RGBD
from sensor_msgs.msg import CameraInfo, Image
from stage import ROOT, Stage, listening, support, x_server
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from robot_vision.msg import GroundTruth

SIZE = 1400, 900  # px, of the window, as config/rgbd.rviz has it
DOCKS = 490  # px, width of what stands to the left of the view
NAMES = "_camera_name:=camera", "_camera_frame_id:=camera_rgb_optical_frame"
COLOR, DEPTH = "/camera/rgb/image_raw", "/camera/depth/image_raw"
TOPICS = {  # of the camera, all with the same stamps
    COLOR: Image,
    "/camera/rgb/camera_info": CameraInfo,
    DEPTH: Image,
    "/camera/depth/camera_info": CameraInfo,
}
SEEN = {"ball", "box", "tag_0", "tag_1"}
UP = "scene/line"  # tf frame whose z axis points up
REGISTERED = "/camera/depth_registered/image_raw"
NODES = (  # as in demo.launch with depth:=true
    ("depth_registration_node", "depth_registration", "__ns:=/camera"),
    (
        *("apriltag_detector.py", "apriltag_detector", f"image:={COLOR}"),
        *(f"depth:={REGISTERED}", "_tag_size:=0.24"),
    ),
    ("tabletop.py", "tabletop", f"image:={DEPTH}", f"_vertical_frame:={UP}"),
    ("ball_tracker.py", "ball_tracker", f"image:={COLOR}"),
    (
        *("detections_3d.py", "detections_3d", "detections:=/ball_tracker/objects"),
        *(f"depth:={REGISTERED}", "_shape:=sphere"),
    ),
)
MARKERS = [f"/{name}/markers" for name in ("apriltag_detector", "tabletop", "detections_3d")]
RATE = 4.0  # Hz: markers stay for half a second
HULL = 255, 102, 26  # BGR, of the tables' outlines, which no light falls on
WAIT = 5 * support.DEADLINE  # s: all of it is drawn by software


def frame_of(stage: Stage) -> Dict[str, genpy.Message]:
    """A moment in which the camera sees all that is to be shown: messages by their topics."""
    topics = {**TOPICS, "/camera/ground_truth": GroundTruth, "/tf": TFMessage}
    with contextlib.ExitStack() as stack:
        stack.enter_context(stage.node("camera_node", "camera", *RGBD, *NAMES))
        static = stack.enter_context(listening("/tf_static", TFMessage))
        sent = [stack.enter_context(listening(topic, kind)) for topic, kind in topics.items()]

        def complete() -> Dict[str, genpy.Message]:
            *images, truth, tf = support.same_frame(*sent)
            seen = {one.name for one in truth.objects if one.visible}
            moments = dict(zip(topics, (*images, truth, tf)))
            return {**moments, "/tf_static": static.wait()[0]} if seen >= SEEN else {}

        return support.wait_for(complete, "a frame with all that is to be shown")


@contextlib.contextmanager
def shown_again(frame: Dict[str, genpy.Message]) -> Iterator[None]:
    """Publishes this frame again and again, so that all that is drawn is of the same moment."""
    topics = {**TOPICS, "/tf": TFMessage}
    publishers = {
        topic: rospy.Publisher(topic, kind, queue_size=1) for topic, kind in topics.items()
    }
    static = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
    static.publish(frame["/tf_static"])
    frame["/tf"].transforms = [one for one in frame["/tf"].transforms if one.child_frame_id == UP]

    def publish(_event: object) -> None:
        now = rospy.Time.now()
        for one in frame["/tf"].transforms:
            one.header.stamp = now
        for topic in TOPICS:
            frame[topic].header.stamp = now
        for topic, publisher in publishers.items():
            publisher.publish(frame[topic])

    timer = rospy.Timer(rospy.Duration(1.0 / RATE), publish)
    try:
        yield
    finally:
        timer.shutdown()
        timer.join()
        for publisher in (*publishers.values(), static):
            publisher.unregister()


class Window:
    """What the screen shows, and whether that is all and stays as it is."""

    def __init__(self, screen: object):
        self._screen = screen
        self._before, self._since = self.image(), rospy.Time.now()

    def image(self) -> np.ndarray:
        width, height = SIZE
        return support.screen(self._screen)[:height, :width].copy()

    def is_complete(self) -> bool:
        """With the outline of the table, for some seconds in which hardly anything changes."""
        now = self.image()
        hull = cv2.inRange(now, np.subtract(HULL, 25), np.add(HULL, 25))[:, DOCKS:]
        changed = (now != self._before).any(axis=2)[:, DOCKS:].mean()
        if cv2.countNonZero(hull) < 500 or changed > 0.002:
            self._before, self._since = now, rospy.Time.now()
        return rospy.Time.now() - self._since > rospy.Duration(5.0)


def rviz(stage: Stage) -> np.ndarray:
    """The demo with depth in space: points, the floor as a table, the box on it, ball and tags."""
    program = roslib.packages.find_node("rviz", "rviz")[0]
    os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
    with contextlib.ExitStack() as stack:
        screen = stack.enter_context(x_server(stage, SIZE))
        stack.enter_context(shown_again(frame_of(stage)))
        for words in NODES:
            stack.enter_context(stage.node(*words))
        sent = [stack.enter_context(listening(topic, MarkerArray)) for topic in MARKERS]
        stack.enter_context(stage.node(program, "rviz", "-d", str(ROOT / "config" / "rgbd.rviz")))
        support.wait_for(
            lambda: all(any(one.markers for one in topic.received) for topic in sent), "markers"
        )
        window = Window(screen)
        support.wait_for(window.is_complete, "all of it in rviz", WAIT)
        return beside([window.image()])
