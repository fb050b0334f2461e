"""The image of the page about tags: the axes of one."""

from typing import Any

import cv2
import numpy as np
from canvas import BLUE, RED
from nodes import SEARCH_ALL, SETTLED
from stage import Stage

from robot_vision import CameraModel, tag_cells, tag_family
from robot_vision.msg import TagDetectionArray


class TiltedTag:
    """A scene of one tag, which is turned away from the camera."""

    size = 0.2  # m
    camera = CameraModel(640, 480, [[620.0, 0.0, 319.5], [0.0, 620.0, 249.5], [0.0, 0.0, 1.0]])

    def render(self, _frame: int) -> np.ndarray:
        family, cell = tag_family("tag36h11"), 32  # px
        board = np.kron(tag_cells(family.name, 0), np.ones((cell, cell), np.uint8))
        side = self.size * family.width / family.width_at_border / 2.0
        corners = side * np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]], float)
        turned_away = cv2.Rodrigues(np.array([-0.55, 0.65, 0.1]))[0]
        points = corners @ (np.diag([1.0, -1.0, -1.0]) @ turned_away).T + (0.0, 0.0, 0.5)
        own = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32) * len(board) - 0.5
        seen = self.camera.project(points)[0].astype(np.float32)
        to_image = cv2.getPerspectiveTransform(own.astype(np.float32), seen)
        # Three times as large at first, so that edges are smooth.
        to_image = np.diag([3.0, 3.0, 1.0]) @ to_image
        gray = cv2.warpPerspective(board // 5 * 4 + 25, to_image, (1920, 1440), borderValue=165)
        return cv2.cvtColor(
            cv2.resize(gray, (640, 480), interpolation=cv2.INTER_AREA), cv2.COLOR_GRAY2BGR
        )


def tags(stage: Stage) -> np.ndarray:
    """A tag with the axes of the pose that the node tells."""
    scene = TiltedTag()
    arguments = [f"_tag_size:={scene.size}", SEARCH_ALL]
    options = {"output": "tags", "kind": TagDetectionArray, "infos": 1}
    with stage.watched("apriltag_detector.py", scene, *arguments, **options) as show:
        (tag,) = [show(frame) for frame in range(SETTLED)][-1].detections
    image = scene.render(0)
    axes = 0.65 * tag.size * np.vstack([np.zeros(3), np.eye(3)])
    ends = np.rint(scene.camera.project(axes @ turned(tag).T + translated(tag))[0]).astype(int)
    for name, end, tone in zip("xyz", ends[1:].tolist(), (RED, (0, 150, 0), BLUE)):
        cv2.arrowedLine(image, tuple(ends[0].tolist()), tuple(end), tone, 4, cv2.LINE_AA)
        place = end[0] + 12, end[1] + 8
        cv2.putText(image, name, place, cv2.FONT_HERSHEY_DUPLEX, 0.9, tone, 2, cv2.LINE_AA)
    return image


def turned(tag: Any) -> np.ndarray:
    """The rotation of a tag's pose, 3x3."""
    q = tag.pose.pose.orientation
    angle = 2.0 * np.arctan2(np.linalg.norm([q.x, q.y, q.z]), q.w)
    axis = np.array([q.x, q.y, q.z]) / max(np.sin(angle / 2.0), 1e-9)
    return cv2.Rodrigues(angle * axis)[0]


def translated(tag: Any) -> np.ndarray:
    """Where a tag is, m."""
    place = tag.pose.pose.position
    return np.array([place.x, place.y, place.z])
