"""Every head from the model's files to the message of the running node."""

import networks
import pytest
import support
from frames import Camera
from network_files import CAFFE, CAFFE_MODEL, DARKNET, darknet_weights
from networks import NAMES, ULTRALYTICS, Square, image_of
from runtime_cases import needs_newer_opencv

from robot_vision.msg import DetectionArray

pytestmark = needs_newer_opencv
SQUARES = (Square(0, 2, 3), Square(1, 5, 1), Square(2, 4, 6))
WIDE, CENTERED = (-4, 0, 16, 8), (-8, -8, 16, 16)  # of a square of 8 px: its box
AROUND = (-4, -4, 16, 16)
CAFFE_PARAMS = {"mean": [0.0, 0.0, 0.0], "std": [255.0, 255.0, 255.0]}
# Files, where the boxes are, names, and parameters.
FAMILIES = {
    "yolov3": ({"a.cfg": DARKNET.encode(), "a.weights": darknet_weights()}, WIDE, NAMES, {}),
    "yolov5": ({"a.onnx": networks.yolov5()}, WIDE, NAMES, {}),
    "yolov8": ({"a.onnx": networks.yolov8()}, WIDE, NAMES, {}),
    "yolov10": ({"a.onnx": networks.yolov10(ULTRALYTICS)}, WIDE, NAMES, {}),
    "yolox": ({"a.onnx": networks.yolox()}, WIDE, NAMES, {}),
    "nanodet": ({"a.onnx": networks.nanodet()}, CENTERED, NAMES, {}),
    "ssd": ({"a.onnx": networks.ssd()}, WIDE, NAMES, {}),
    "ssd of Caffe": (
        {"a.prototxt": CAFFE.encode(), "a.caffemodel": CAFFE_MODEL},
        AROUND,
        ("green", "red"),
        CAFFE_PARAMS,
    ),
    "detr": ({"a.onnx": networks.detr()}, WIDE, NAMES, {}),
    "rtdetr": ({"a.onnx": networks.rtdetr()}, WIDE, NAMES, {}),
}


@pytest.mark.parametrize("family", FAMILIES)
def test_from_the_files_to_the_message(start, tmp_path, family):
    files, (left, top, width, height), names, params = FAMILIES[family]
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
    (tmp_path / "classes.txt").write_text("\n".join(names))
    camera = Camera(30.0)
    start(
        "object_detector.py",
        "__name:=object_detector",
        f"image:={camera.topic}",
        f"_model:={tmp_path / next(iter(files))}",
        f"_class_names:={tmp_path / 'classes.txt'}",
        "_backend:=opencv",
        "_track:=false",
        "_score_threshold:=0.8",
        *(f"_{name}:={value}" for name, value in params.items()),
    )
    detections = support.subscribed("/object_detector/detections", DetectionArray)
    camera.wait_for()
    message = detections.of(camera.show(image_of(SQUARES)).stamp)
    found = {}
    for one in message.detections:
        box = one.box
        found[one.label] = (box.x_offset, box.y_offset, box.width, box.height)
        assert names[one.class_id] == one.label
    assert found == {
        NAMES[square.class_id]: (8 * square.column + left, 8 * square.row + top, width, height)
        for square in SQUARES
        if NAMES[square.class_id] in names
    }
    assert not detections.of(camera.show(image_of([])).stamp).detections
