"""What the dashboard takes from topics and clients: compressed images, clouds, and requests."""

import io
from typing import List

import cv2
import genpy
import numpy as np
from sensor_msgs.msg import CompressedImage, PointCloud2
from sensor_msgs.point_cloud2 import create_cloud_xyz32
from std_msgs.msg import Header
from target import Target

from robot_vision.dashboard.cloud_points import points_of
from robot_vision.dashboard.compressed_message import picture_of
from robot_vision.dashboard.foxglove_protocol import parse_client_text
from robot_vision.dashboard.message_topics import RawMessage
from robot_vision.dashboard.web_video_request import parse_image_request

MANY = 100


def serialized(message: genpy.Message) -> bytes:
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


class CompressedStreams(Target):
    """Messages of sensor_msgs/CompressedImage, which are passed on."""

    def seeds(self) -> List[bytes]:
        image = np.arange(12 * 16 * 3, dtype=np.uint8).reshape(12, 16, 3)
        return [
            serialized(CompressedImage(Header(), name, cv2.imencode(name, image)[1].tobytes()))
            for name in (".jpeg", ".png")
        ]

    def run(self, data: bytes) -> None:
        picture = picture_of(RawMessage("sensor_msgs/CompressedImage", "", data, 0.0, "/node"))
        if picture.width < 1 or picture.height < 1 or not picture.data:
            raise AssertionError("a picture without pixels")


class Clouds(Target):
    """Messages of sensor_msgs/PointCloud2."""

    def seeds(self) -> List[bytes]:
        return [serialized(create_cloud_xyz32(Header(), np.ones((20, 3), np.float32)))]

    def run(self, data: bytes) -> None:
        points = points_of(PointCloud2().deserialize(data), MANY)
        if len(points.xyz) > MANY or not np.isfinite(points.xyz).all():
            raise AssertionError("too many points, or some that are not finite")
        points.payload()


class Requests(Target):
    """Texts of Foxglove's clients, and topics of web_video_server's URLs."""

    def seeds(self) -> List[bytes]:
        return [
            b'{"op":"subscribe","subscriptions":[{"id":0,"channelId":3}]}',
            b'{"op":"unsubscribe","subscriptionIds":[0,1]}',
        ]

    def run(self, data: bytes) -> None:
        text = data.decode("utf-8", "replace")
        for name in ("topic", "type", "width", "quality"):
            try:
                parse_image_request({"topic": "/a", name: text}, 80)
            except ValueError:
                continue
        parse_client_text(text)
