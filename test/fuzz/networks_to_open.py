"""Files of networks: read, opened by each runtime that there is, and run once as nodes do."""

import os
import sys
import tempfile
from typing import Any, Iterator, List, Tuple

import numpy as np
import onnx
from target import Target

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(os.path.dirname(HERE), "support"))

import network_files  # noqa: E402
import networks  # noqa: E402

from robot_vision.dnn.cost import flop_of  # noqa: E402
from robot_vision.dnn.detector import NetworkDetector  # noqa: E402
from robot_vision.dnn.model_file import read_model  # noqa: E402
from robot_vision.dnn.network import NetworkSettings, open_network, output_text  # noqa: E402
from robot_vision.dnn.onnxruntime_folder import find_onnxruntime  # noqa: E402
from robot_vision.dnn.runtimes import NetworkError  # noqa: E402

IMAGE = networks.image_of([networks.Square(0, 2, 3), networks.Square(2, 5, 6)])
BETWEEN = b"\n# weights #\n"  # the two files of a model


class Networks(Target):
    """Models of which the first suffix is that of the file that is named to the node."""

    SUFFIXES: Tuple[str, ...] = ()
    BACKENDS: Tuple[str, ...] = ("opencv",)

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory()
        self._stem = os.path.join(self._folder.name, "model")

    def run(self, data: bytes) -> None:
        parts = data.split(BETWEEN, len(self.SUFFIXES) - 1)
        for suffix, part in zip(self.SUFFIXES, [*parts, b""]):
            with open(self._stem + suffix, "wb") as file:
                file.write(part)
        refused = None
        for backend in self.BACKENDS:
            try:
                self._use(backend)
            except ValueError as error:
                refused = error
        if refused is not None:
            raise refused

    def _use(self, backend: str) -> None:
        settings = NetworkSettings(self._stem + self.SUFFIXES[0], backend=backend)
        detector = NetworkDetector(settings)
        try:
            found = detector.detect(IMAGE)
        except NetworkError as error:  # A node drops the frame, and says this.
            raise ValueError(str(error)) from None
        for one in found:
            assert np.isfinite(one.box).all() and np.isfinite(one.score), (one.box, one.score)
            assert detector.name_of(one).isprintable()
        model = read_model(settings.model)
        network = open_network(settings, model)
        flop_of(model, network.input, network.runtime)
        assert f"{network} {output_text(network)}".isprintable()


def onnx_seeds() -> List[bytes]:
    pose = {**networks.ULTRALYTICS, "task": "pose", "kpt_shape": "[2, 3]"}
    half = networks.Graph((1, 3, networks.SIZE, networks.SIZE), onnx.TensorProto.FLOAT16)
    return [
        networks.yolov8(metadata=networks.ULTRALYTICS),
        networks.yolov8("segment", networks.ULTRALYTICS),
        networks.yolov8("pose", pose),
        networks.yolov5(),
        networks.yolov10(),
        networks.yolox(),
        networks.nanodet(),
        networks.ssd(),
        networks.ssd_rows(),
        networks.detr(),
        networks.rtdetr(2),
        networks.rtdetr(graph=half),
    ]


class OnnxModels(Networks):
    """ONNX files with any damage."""

    SUFFIXES = (".onnx",)
    BACKENDS = ("opencv", *(["onnxruntime"] if find_onnxruntime()[0] else []))

    def seeds(self) -> List[bytes]:
        return onnx_seeds()


class OnnxEdits(OnnxModels):
    """ONNX files that are sound protobuf: the first byte chooses one, and the others change it.

    Four bytes are a change: two of the place, then what is done, and with which value.
    """

    NUMBERS = (0, 1, -1, 2, 3, 7, 64, 255, 1 << 15, 1 << 20, (1 << 31) - 1, -(1 << 31))
    HUGE = ((1 << 40), (1 << 62), -(1 << 63), (1 << 63) - 1)
    TEXTS = (
        "",
        "x",
        "images",
        "output0",
        "Constant",
        "Reshape",
        "Identity",
        "a\x1b[2J\n",
        "é" * 999,
    )
    SIZE = 4

    def __init__(self) -> None:
        super().__init__()
        self._models = onnx_seeds()

    def seeds(self) -> List[bytes]:
        return [bytes([number] + [0] * 6 * self.SIZE) for number in range(len(self._models))]

    def run(self, data: bytes) -> None:
        model = onnx.ModelProto()
        model.ParseFromString(self._models[(data[0] if data else 0) % len(self._models)])
        for begin in range(1, min(len(data), 40) - self.SIZE + 1, self.SIZE):
            first, second, action, value = data[begin : begin + self.SIZE]
            places = list(places_in(model))
            self._change(*places[(first << 8 | second) % len(places)], action % 8, value)
        super().run(model.SerializeToString())

    def _change(self, owner: Any, field: Any, action: int, value: int) -> None:
        values = getattr(owner, field.name)
        many = hasattr(values, "append")
        if action == 1:
            owner.ClearField(field.name)
        elif action == 2 and many and values:
            del values[value % len(values)]
        elif action == 3 and many and values:
            values.extend([values[value % len(values)]] * (1 + value % 5))
        elif action > 3 and field.cpp_type != field.CPPTYPE_MESSAGE:
            new = self._value(field, value)
            if not many:
                setattr(owner, field.name, new)
            elif values:
                values[value % len(values)] = new

    def _value(self, field: Any, value: int) -> Any:
        if field.cpp_type == field.CPPTYPE_STRING:
            text = self.TEXTS[value % len(self.TEXTS)]
            return text.encode() if field.type == field.TYPE_BYTES else text
        if field.cpp_type in (field.CPPTYPE_FLOAT, field.CPPTYPE_DOUBLE):
            return (0.0, -1.0, float("nan"), float("inf"), 1e30)[value % 5]
        numbers = self.NUMBERS + (self.HUGE if field.cpp_type == field.CPPTYPE_INT64 else ())
        if field.cpp_type == field.CPPTYPE_ENUM:
            return value % 17
        return numbers[value % len(numbers)]


def places_in(message: Any) -> Iterator[Tuple[Any, Any]]:
    """Yields all messages in one, each with each of its fields that is set."""
    for field, value in message.ListFields():
        yield message, field
        if field.cpp_type == field.CPPTYPE_MESSAGE:
            for inner in value if hasattr(value, "append") else (value,):
                yield from places_in(inner)


class DarknetModels(Networks):
    """Text and weights of darknet."""

    SUFFIXES = (".cfg", ".weights")

    def seeds(self) -> List[bytes]:
        weights = network_files.darknet_weights()
        text = network_files.DARKNET.encode()
        pooled = text.replace(
            b"[yolo]", b"[maxpool]\nsize=1\nstride=1\n\n[route]\nlayers=-1\n\n[yolo]"
        )
        return [one + BETWEEN + weights for one in (text, pooled)]


class CaffeModels(Networks):
    """Text and weights of Caffe."""

    SUFFIXES = (".prototxt", ".caffemodel")

    def seeds(self) -> List[bytes]:
        return [network_files.CAFFE.encode() + BETWEEN + network_files.CAFFE_MODEL]
