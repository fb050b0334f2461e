"""A network as people run it in Python: cv2 and NumPy around cv2.dnn or onnxruntime."""

from typing import Any, List, Tuple

import cv2
import numpy as np

from robot_vision.dnn.onnxruntime_folder import find_onnxruntime

PAD = 114  # gray around the image
SCORE, OVERLAP = 0.3, 0.45  # as the parameters of object_detector
APART = 4096.0  # px, from which boxes of different classes do not overlap

Box = Tuple[int, float, float, float, float, float]  # class, score, left, top, right, bottom


def planes_of(image: np.ndarray) -> np.ndarray:
    """(1, 3, height, width) of 0 to 1, red first, of a BGR image."""
    planes = np.ascontiguousarray(image[:, :, ::-1].transpose(2, 0, 1))
    return planes[np.newaxis].astype(np.float32) / 255


class OpenCv:
    """cv2.dnn, with its own function for the input."""

    def __init__(self, model: str, threads: int):
        cv2.setNumThreads(threads)
        self._net = cv2.dnn.readNetFromONNX(model)

    def input_of(self, image: np.ndarray) -> np.ndarray:
        return cv2.dnn.blobFromImage(image, 1 / 255, image.shape[1::-1], swapRB=True)

    def run(self, values: np.ndarray) -> np.ndarray:
        self._net.setInput(values)
        return self._net.forward()


class OnnxRuntime:
    """onnxruntime, with NumPy for the input."""

    def __init__(self, model: str, threads: int):
        cv2.setNumThreads(threads)
        module: Any = find_onnxruntime()[0]
        options = module.SessionOptions()
        options.intra_op_num_threads = threads
        self._session = module.InferenceSession(model, options, providers=["CPUExecutionProvider"])
        self._name = self._session.get_inputs()[0].name

    def input_of(self, image: np.ndarray) -> np.ndarray:
        return planes_of(image)

    def run(self, values: np.ndarray) -> np.ndarray:
        return self._session.run(None, {self._name: values})[0]


RUNTIMES = {"opencv": OpenCv, "onnxruntime": OnnxRuntime}


def letterbox(image: np.ndarray, side: int) -> Tuple[np.ndarray, float, int, int]:
    """The image in a square with gray around it; its scale, and how far it is from left and top."""
    height, width = image.shape[:2]
    scale = side / max(width, height)
    width, height = round(width * scale), round(height * scale)
    left, top = (side - width) // 2, (side - height) // 2
    small = cv2.resize(image, (width, height), interpolation=cv2.INTER_LINEAR)
    around = top, side - height - top, left, side - width - left
    gray = (PAD, PAD, PAD)
    return cv2.copyMakeBorder(small, *around, cv2.BORDER_CONSTANT, value=gray), scale, left, top


def decode(boxes: np.ndarray, scores: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Classes, scores and boxes (n, 4: left, top, width, height) that cv2.dnn.NMSBoxes leaves.

    boxes: (n, 4), centre and size; scores: (n, classes).
    """
    best = scores.max(axis=1)
    likely = best >= SCORE
    class_ids, best, centered = scores[likely].argmax(axis=1), best[likely], boxes[likely]
    corners = centered[:, :2] - centered[:, 2:] / 2
    found = np.concatenate([corners, centered[:, 2:]], axis=1)
    apart = found.copy()
    apart[:, :2] += class_ids[:, np.newaxis] * APART
    kept = cv2.dnn.NMSBoxes(apart.tolist(), best.tolist(), SCORE, OVERLAP)
    kept = np.array(kept, int).ravel()  # OpenCV 4.2 has a column
    return class_ids[kept], best[kept], found[kept]


class PlainDetector:
    """From an image to what YOLOv8's output says of it."""

    def __init__(self, runtime: str, model: str, threads: int, side: int):
        self._runtime = RUNTIMES[runtime](model, threads)
        self._side = side

    def input_of(self, bgr: np.ndarray) -> Tuple[np.ndarray, float, int, int]:
        """The network's input, and what letterbox() says of it."""
        square, *placement = letterbox(bgr, self._side)
        return (self._runtime.input_of(square), *placement)

    def detect(self, bgr: np.ndarray) -> List[Box]:
        """The boxes, in px of the image."""
        values, scale, left, top = self.input_of(bgr)
        rows = self._runtime.run(values)[0].T
        class_ids, scores, boxes = decode(rows[:, :4], rows[:, 4:])
        corners = np.concatenate([boxes[:, :2], boxes[:, :2] + boxes[:, 2:]], axis=1)
        corners = (corners - (left, top, left, top)) / scale
        height, width = bgr.shape[:2]
        corners = corners.clip(0, (width, height, width, height))
        return [
            (int(class_id), float(score), *box)
            for class_id, score, box in zip(class_ids, scores, corners.tolist())
        ]
