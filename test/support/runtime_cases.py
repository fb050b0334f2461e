"""The runtimes that tests run networks with; onnxruntime only where it is installed."""

import cv2
import pytest

from robot_vision.dnn.onnxruntime_folder import find_onnxruntime

HAS_ONNXRUNTIME = find_onnxruntime()[0] is not None
OLD_OPENCV = tuple(map(int, cv2.__version__.split(".")[:2])) < (4, 5)

needs_onnxruntime = pytest.mark.skipif(not HAS_ONNXRUNTIME, reason="onnxruntime is not installed")
needs_newer_opencv = pytest.mark.skipif(OLD_OPENCV, reason="OpenCV is older than 4.5")
BACKENDS = [pytest.param("onnxruntime", marks=needs_onnxruntime), "opencv"]
# Of networks in which constants are concatenated, as those of networks.py.
BACKENDS_OF_HEADS = [BACKENDS[0], pytest.param("opencv", marks=needs_newer_opencv)]
needs_any = pytest.mark.skipif(
    OLD_OPENCV and not HAS_ONNXRUNTIME, reason="neither onnxruntime nor OpenCV 4.5"
)
