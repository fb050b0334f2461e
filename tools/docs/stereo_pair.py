"""The image of the page about stereo: a real pair, and what the node makes of it."""

import contextlib
import pathlib
from typing import Iterator

import cv2
import numpy as np
import rospy
import skimage.data
from canvas import beside, joined
from sensor_msgs.msg import CameraInfo, Image
from stage import BEGIN, Stage, listening, pixels, support

NAMESPACE = "/eyes"
WIDTH = 480  # px, of the image: a wider one of so many details would take too large a file
OUTPUTS = ("left/image_rect_color", "disparity_image", "epipolar")
# Of the Middlebury pair Motorcycle, at a quarter of its size.
FOCAL, CX, CX_OF_RIGHT, CY, BASELINE = 994.978, 311.193, 342.279, 254.877, 0.193  # px, m


class Pair:
    """Two cameras that show the pair."""

    def __init__(self) -> None:
        folder = pathlib.Path(skimage.data.__file__).parent
        sides = ("left", "right")
        self._images = [cv2.imread(str(folder / f"motorcycle_{side}.png")) for side in sides]
        self._publishers = [
            rospy.Publisher(f"{NAMESPACE}/{side}/{name}", kind, queue_size=10, tcp_nodelay=True)
            for side in sides
            for name, kind in (("camera_info", CameraInfo), ("image_raw", Image))
        ]

    def show(self) -> rospy.Time:
        """Publishes it once; returns its stamp."""
        for publisher in self._publishers:
            support.wait_for(publisher.get_num_connections, "subscribers to the pair")
        infos, images = self._publishers[::2], self._publishers[1::2]
        stamp = rospy.Time(BEGIN)
        for number, image in enumerate(self._images):
            height, width = image.shape[:2]
            matrix = [FOCAL, 0, CX_OF_RIGHT if number else CX, 0, FOCAL, CY, 0, 0, 1]
            info = CameraInfo(height=height, width=width, distortion_model="plumb_bob", K=matrix)
            info.D, info.R = [0.0] * 5, np.eye(3).ravel().tolist()
            tx = -FOCAL * BASELINE if number else 0.0
            info.P = [*matrix[:3], tx, *matrix[3:6], 0, *matrix[6:], 0]
            message = Image(encoding="bgr8", height=height, width=width, step=3 * width)
            message.data = image.tobytes()
            info.header.stamp = message.header.stamp = stamp
            infos[number].publish(info)
            images[number].publish(message)
        return stamp

    def close(self) -> None:
        for publisher in self._publishers:
            publisher.unregister()


@contextlib.contextmanager
def shown() -> Iterator[Pair]:
    pair = Pair()
    try:
        yield pair
    finally:
        pair.close()


def stereo_matcher(stage: Stage) -> np.ndarray:
    """The pair with lines along its rows, and its disparities."""
    words = [f"{side}/image_raw:={NAMESPACE}/{side}/image_raw" for side in ("left", "right")]
    settings = "_disparities:=80", "_epipolar_lines:=12", "_epipolar_features:=300"
    with contextlib.ExitStack() as stack:
        pair = stack.enter_context(shown())
        stack.enter_context(stage.node("stereo_matcher_node", "stereo_matcher", *words, *settings))
        topics = [
            stack.enter_context(listening(f"/stereo_matcher/{name}", Image)) for name in OUTPUTS
        ]
        stamp = pair.show()
        left, disparity, rows = (pixels(topic.of(stamp)) for topic in topics)
    names = ["~left/image_rect_color", "~disparity_image"]
    below = beside([left, disparity], names, width=WIDTH)
    return joined([beside([rows], ["~epipolar"], width=WIDTH), below], axis=0)
