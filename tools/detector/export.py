"""Writes the network as ONNX, with what those who run it need to know of it."""

import pathlib
from typing import Dict

import onnx
import torch

from .network import ExportedNetwork, SceneNetwork
from .targets import STRIDES
from .things import NAMES
from .views import INPUT

OPSET = 11  # the newest that OpenCV 4.2 reads completely


def facts(seed: int) -> Dict[str, str]:
    """The metadata: the keys that Ultralytics' exports have, and where the network comes from."""
    return {
        "names": str(dict(enumerate(NAMES))),
        "task": "detect",
        "stride": str(max(STRIDES)),
        "imgsz": str([INPUT[1], INPUT[0]]),
        "batch": "1",
        "license": "BSD-3-Clause",
        "author": "robot_vision",
        "description": "finds the things of robot_vision's synthetic scenes, and nothing else",
        "training_seed": str(seed),
    }


def save(network: SceneNetwork, path: pathlib.Path, metadata: Dict[str, str]) -> None:
    """Writes the network, in the layout of YOLOv8's output, and its metadata."""
    images = torch.zeros(1, 3, INPUT[1], INPUT[0])
    torch.onnx.export(
        ExportedNetwork(network).eval(),
        images,
        str(path),
        opset_version=OPSET,
        input_names=["images"],
        output_names=["output0"],
    )
    model = onnx.load(str(path))
    onnx.helper.set_model_props(model, metadata)
    onnx.checker.check_model(model)
    onnx.save(model, str(path))
