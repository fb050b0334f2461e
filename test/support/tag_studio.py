"""Shared by the tests of tags: images of tags with known poses, and a detector for them."""

import cv2
import numpy as np
import support
from frames import Camera, Source
from sensor_msgs.msg import CameraInfo

import robot_vision as rv
from robot_vision.msg import TagDetectionArray

K = np.array([[500.0, 0.0, 319.5], [0.0, 500.0, 239.5], [0.0, 0.0, 1.0]])
SIZE = 0.2  # m
SQUARE = SIZE * np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]])


def facing(x, y, z, turn=(0.0, 0.0, 0.0)):
    """The pose (4x4) of a tag that faces the camera and is then turned by a rotation vector."""
    pose = np.eye(4)
    pose[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ cv2.Rodrigues(np.array(turn))[0]
    pose[:3, 3] = x, y, z
    return pose


def corners_of(pose):
    points = SQUARE @ pose[:3, :3].T + pose[:3, 3]
    return points[:, :2] / points[:, 2:] * [K[0, 0], K[1, 1]] + K[:2, 2]


def image_of(poses, family="tag36h11"):
    """A gray image of tags, [(id, pose), ...]."""
    image = np.full((480, 640), 150.0)
    for number, pose in poses:
        cells = rv.tag_cells(family, number)
        facts = rv.tag_family(family)
        margin = (facts.width - facts.width_at_border) / 2.0
        scale = 32
        large = np.kron(cells, np.ones((scale, scale), np.uint8))
        near, far = margin * scale - 0.5, (margin + facts.width_at_border) * scale - 0.5
        own = np.array([[near, far], [far, far], [far, near], [near, near]], np.float32)
        to_image = cv2.getPerspectiveTransform(own, corners_of(pose).astype(np.float32))
        seen = [
            cv2.warpPerspective(layer, to_image, (640, 480), flags=cv2.INTER_AREA)
            for layer in (large.astype(np.float32), np.ones(large.shape, np.float32))
        ]
        inside = seen[1] > 0.999
        image[inside] = seen[0][inside] * 0.8 + 25.0
    return cv2.GaussianBlur(image, (0, 0), 0.7).round().astype(np.uint8)


def matrix_of(pose):
    """A Pose or Transform as a 4x4 matrix."""
    place = getattr(pose, "position", None) or pose.translation
    turn = getattr(pose, "orientation", None) or pose.rotation
    x, y, z, w = turn.x, turn.y, turn.z, turn.w
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = place.x, place.y, place.z
    return matrix


def angle_between(a, b):
    """The angle between two rotations in degrees."""
    return np.degrees(np.linalg.norm(cv2.Rodrigues(a[:3, :3].T @ b[:3, :3])[0]))


def assert_near(pose, truth, metres=0.01, degrees=1.0):
    assert np.linalg.norm(pose[:3, 3] - truth[:3, 3]) < metres * np.linalg.norm(truth[:3, 3])
    assert angle_between(pose, truth) < degrees


def calibrated(width=640, height=480, matrix=K, model="plumb_bob"):
    return CameraInfo(
        width=width, height=height, K=np.ravel(matrix).tolist(), D=[0.0] * 5, distortion_model=model
    )


class Studio:
    """A camera with frames at `rate` (Hz) of simulated stamps, and the node's answers to them."""

    def __init__(self, start, *arguments, info=None, rate=10.0):
        self._camera = Camera(rate)
        self.topic = self._camera.topic
        self.infos = Source(self.topic.replace("image", "camera_info"), CameraInfo)
        self.info = info
        size = f"_tag_size:={SIZE}"
        self.process = start(
            "apriltag_detector.py", "__name:=tag", f"image:={self.topic}", size, *arguments
        )
        self.tags = support.subscribed("/tag/tags", TagDetectionArray)
        self._camera.wait_for()
        self.infos.wait_for()

    def show(self, image, encoding="mono8"):
        """Sends an image and waits for the tags that the node finds in it."""
        return self.tags.of(self.send(image, encoding))

    def send(self, image, encoding="mono8"):
        """Sends an image and returns its stamp."""
        if self.info is not None:
            self.infos.send(self.info)
        return self._camera.show(image, encoding).stamp

    def wait_for_subscribers(self, count):
        """Waits for this many subscribers of the images."""
        self._camera.wait_for(count)

    def show_until(self, condition, image):
        """Sends an image until the answer satisfies the condition; returns that answer."""

        def answer():
            one = self.show(image)
            return one if condition(one) else None

        return support.wait_for(answer, "such an answer")
