"""Shared by tests of nodes on depth: a depth camera and a color camera beside it that publish."""

import itertools
from typing import Any, List, Optional

import numpy as np
import rospy
import support
from frames import Source, message
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

import robot_vision as rv

SIZES = {"depth": (64, 48), "rgb": (96, 72)}  # px: width, height
BASELINE = 0.03  # m, from the depth camera to the color camera

numbers = itertools.count()


def info_of(camera: str) -> CameraInfo:
    """A calibration with distortion; P is that of images without."""
    width, height = SIZES[camera]
    matrix = [0.9 * width, 0.0, 0.5 * width, 0.0, 0.9 * width, 0.5 * height, 0.0, 0.0, 1.0]
    return CameraInfo(
        width=width,
        height=height,
        distortion_model="plumb_bob",
        D=[-0.1, 0.02, 0.0, 0.0, 0.0],
        K=matrix,
        R=np.eye(3).ravel().tolist(),
        P=[0.8 * width, 0, *matrix[2:3], 0, 0, 0.8 * width, matrix[5], 0, 0, 0, 1, 0],
    )


def model_of(info: CameraInfo, rectified: bool = False) -> rv.CameraModel:
    if rectified:
        return rv.CameraModel(info.width, info.height, np.reshape(info.P, (3, 4))[:, :3])
    return rv.CameraModel(info.width, info.height, info.K, info.D, info.distortion_model)


def depth_to_color() -> np.ndarray:
    """What takes points of the depth camera's frame to that of the color camera."""
    pose = np.eye(4)
    pose[0, 3] = -BASELINE
    return pose


class RgbdCameras:
    """Publishes what a test says; each object has topics and frames of its own."""

    def __init__(self) -> None:
        number = next(numbers)
        self.namespace = f"/rgbd_{number}"
        self.frames = {camera: f"{camera}_eye_{number}" for camera in SIZES}
        self.calibration = {camera: info_of(camera) for camera in SIZES}
        self.images = {camera: Source(self.topic(camera, "image_raw")) for camera in SIZES}
        self.infos = {
            camera: Source(self.topic(camera, "camera_info"), CameraInfo) for camera in SIZES
        }
        self._transforms: Optional[rospy.Publisher] = None
        self._stamps = (rospy.Time(100 + number) for number in itertools.count())

    def topic(self, camera: str, name: str) -> str:
        return f"{self.namespace}/{camera}/{name}"

    def output(self, name: str) -> str:
        return f"{self.namespace}/depth_registered/{name}"

    def arguments(self) -> List[str]:
        """What puts the node into the namespace of the cameras."""
        return [f"__ns:={self.namespace}"]

    def place(self, x: float = -BASELINE, w: float = 1.0) -> None:
        """Says on /tf_static where the depth camera is in the color camera's frame.

        Args:
            x: m, to the right.
            w: of the quaternion, whose x, y and z are 0.
        """
        transform = TransformStamped(child_frame_id=self.frames["depth"])
        transform.header.frame_id = self.frames["rgb"]
        transform.transform.translation.x = x
        transform.transform.rotation.w = w
        self.withdraw()
        support.open_messages.append(self)
        self._transforms = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        self._transforms.publish(TFMessage([transform]))

    def withdraw(self) -> None:
        """Says no longer where the depth camera is: not to those that come later."""
        if self._transforms is not None:
            support.open_messages.remove(self)
            self._transforms.unregister()
        self._transforms = None

    def close(self) -> None:
        self.withdraw()

    def wait_for(self) -> None:
        """Waits until somebody subscribes to the depth images and both camera_info."""
        for source in (self.images["depth"], *self.infos.values()):
            source.wait_for()

    def next_stamp(self) -> rospy.Time:
        return next(self._stamps)

    def send_infos(self) -> None:
        for camera, info in self.calibration.items():
            info.header = Header(frame_id=self.frames[camera])
            self.infos[camera].send(info)

    def send(self, camera: str, pixels: np.ndarray, encoding: str, stamp: Any) -> None:
        image = message(pixels, encoding)
        image.header = Header(stamp=stamp, frame_id=self.frames[camera])
        self.images[camera].send(image)
