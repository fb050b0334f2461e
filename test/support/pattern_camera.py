"""A camera whose images tell each pixel's place, for tests of pages that show them."""

import threading
from typing import Callable, Dict, List, Tuple

import cv2
import numpy as np
import rospy
import support
from browser_page import Page
from frames import message
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

PERIOD = 0.1  # s between two frames
MARK = 14  # px, side of a mark at 640x480; larger in larger images
COLORS = {"a": (0, 0, 255), "b": (255, 0, 0)}  # BGR of the marks
TILE = '[data-test="tile"][data-topic="%s"]'


def located(width: int, height: int) -> np.ndarray:
    """An image (height, width, 3) whose colour tells the place: blue by x, green by y."""
    x = np.linspace(0, 255, width)[None, :].repeat(height, 0)
    y = np.linspace(0, 255, height)[:, None].repeat(width, 1)
    return np.dstack([x, y, 255 - (x + y) / 2]).round().astype(np.uint8)


def marked(size: Tuple[int, int], places: Dict[str, Tuple[int, int]]) -> np.ndarray:
    """A dark image (width, height) with the marks "a" and "b", whose middles are at these px."""
    image = np.full((size[1], size[0], 3), 25, np.uint8)
    half = MARK * max(size) // 640 // 2
    for name, (x, y) in places.items():
        image[y - half : y + half + 1, x - half : x + half + 1] = COLORS[name]
    return image


def seen(page: Page, name: str, selector: str, scale: float = 1.0) -> Tuple[float, float]:
    """Where the middle of a mark is seen within an element, in CSS px of the window.

    Args:
        scale: px of the screen for one of CSS.
    """
    x, y, width, height = (round(value * scale) for value in page.box(selector))
    shot = page.screenshot()[max(y, 0) : y + height, max(x, 0) : x + width].astype(int)
    near = (np.abs(shot - COLORS[name]) < 90).all(axis=2).astype(np.uint8)
    count, _, boxes, middles = cv2.connectedComponentsWithStats(near)
    assert count > 1, f"mark {name} is not to be seen"
    largest = 1 + np.argmax(boxes[1:, cv2.CC_STAT_AREA])
    middle = middles[largest] + 0.5
    return (middle[0] + max(x, 0)) / scale, (middle[1] + max(y, 0)) / scale


class PatternCamera:
    """Publishes NAME/image_raw and NAME/camera_info, the image again and again."""

    def __init__(self, name: str, image: np.ndarray):
        self.topic = f"/{name}/image_raw"
        self.tile = TILE % self.topic
        self.canvas = f'{self.tile} [data-test="image"]'
        self.offset = 0.0  # s that stamps are from the time
        self.beside: List[Callable[[Header], None]] = []  # called with each frame's header
        self._images = rospy.Publisher(self.topic, Image, queue_size=2, tcp_nodelay=True)
        self._infos = rospy.Publisher(
            f"/{name}/camera_info", CameraInfo, queue_size=2, tcp_nodelay=True
        )
        self.show(image)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def show(self, image: np.ndarray, encoding: str = "bgr8") -> None:
        """What the camera sees from now on."""
        self._message = message(image, encoding)
        self._message.header.frame_id = "eye"

    def viewers(self) -> int:
        return self._images.get_num_connections()

    def _run(self) -> None:
        while not self._ended.wait(PERIOD):
            sent = self._message
            sent.header.stamp = rospy.Time.from_sec(rospy.get_time() + self.offset)
            info = CameraInfo(header=sent.header, height=sent.height, width=sent.width)
            self._infos.publish(info)
            for publish in self.beside:
                publish(sent.header)
            if self._images.get_num_connections():
                self._images.publish(sent)

    def close(self) -> None:
        self._ended.set()
        self._thread.join(support.DEADLINE)
        self._images.unregister()
        self._infos.unregister()
