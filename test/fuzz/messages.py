"""Good inputs for the targets in C++."""

import struct
from typing import Callable, Dict, List

import cv2
import numpy as np
from sensor_msgs.msg import CompressedImage, Image
from targets import IMAGE, CameraInfos, encoded, serialized

from robot_vision.calibration.camera_file import as_yaml
from robot_vision.calibration.solving import Calibration

DEPTH = IMAGE[:, :, 0].astype(np.uint16) * 100


def raw() -> List[bytes]:
    layouts = (
        ("bgr8", 3),
        ("mono8", 1),
        ("mono16", 2),
        ("yuv422", 2),
        ("bayer_rggb8", 1),
    )
    return [
        serialized(
            Image(encoding=name, width=16, height=12, step=16 * size, data=bytes(range(192)) * size)
        )
        for name, size in layouts
    ]


def compressed() -> List[bytes]:
    progressive = cv2.imencode(".jpg", IMAGE, [cv2.IMWRITE_JPEG_PROGRESSIVE, 1])[1].tobytes()
    wide = cv2.imencode(".png", DEPTH)[1].tobytes()
    labelled = (
        *zip(("bgr8; png compressed bgr8", "rgb8; jpeg compressed bgr8"), encoded(".png", ".jpg")),
        ("jpeg", progressive),
        ("mono16; png compressed ", wide),
    )
    return [serialized(CompressedImage(format=label, data=data)) for label, data in labelled]


def compressed_depth() -> List[bytes]:
    png = cv2.imencode(".png", DEPTH)[1].tobytes()
    rvl = struct.pack("<4I", 3, 2, 0x238AF323, 0x10000000)  # test_rvl.cpp says of what
    heads = {"16UC1": (0, 0.0, 0.0), "32FC1": (0, 100.0, 0.1)}
    return [
        serialized(CompressedImage(format=label, data=struct.pack("<Iff", *head) + stream))
        for kind, head in heads.items()
        for label, stream in (
            (f"{kind}; compressedDepth png", png),
            (f"{kind}; compressedDepth rvl", rvl),
        )
    ]


def files() -> List[bytes]:
    return encoded(".png", ".jpg", ".bmp", ".ppm", ".webp", ".tiff", ".ras", ".pam")


def calibrations() -> List[bytes]:
    found = Calibration(
        model="plumb_bob",
        size=(16, 12),
        K=np.diag([20.0, 20.0, 1.0]),
        D=np.zeros(5),
        P=np.eye(3, 4),
        error=0.1,
        errors=np.array([0.1]),
        deviations=np.zeros(9),
    )
    return [as_yaml(found, "eye").encode()]


SEEDS: Dict[str, Callable[[], List[bytes]]] = {
    "calibrations": calibrations,
    "raw": raw,
    "compressed": compressed,
    "compressed_depth": compressed_depth,
    "files": files,
    "received_infos": CameraInfos().seeds,
}
