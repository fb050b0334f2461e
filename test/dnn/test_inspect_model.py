"""inspect_model.py prints what a model is, and one line for what is none."""

import re
import subprocess

import numpy as np
import pytest
import roslib.packages
from network_files import DARKNET, darknet_weights
from network_graph import Graph
from networks import ULTRALYTICS, boxes_of, cells, rtdetr, ssd, yolov8
from onnx import TensorProto
from runtime_cases import needs_onnxruntime

from robot_vision.dnn import inspect_model


@pytest.fixture
def inspect(tmp_path, monkeypatch, capsys):
    """inspect("a.onnx", content, "--word", ...): exit code, lines by their names, and stderr."""

    def run(name, content, *words):
        if content is not None:
            (tmp_path / name).write_bytes(content)
        monkeypatch.setattr("sys.argv", ["inspect_model.py", str(tmp_path / name), *words])
        try:
            code = inspect_model.main()
        except SystemExit as error:
            code = error.code
        out, err = capsys.readouterr()
        text = re.sub(r"\n {11}", " ", out)
        lines = [re.fullmatch(r"(\S+) +(.*)", line).groups() for line in text.splitlines()]
        return code, lines, err

    return run


def test_all_that_is_known_of_a_model_is_printed(inspect):
    content = yolov8("pose", {**ULTRALYTICS, "task": "pose", "kpt_shape": "[2, 3]"})
    code, lines, err = inspect("a.onnx", content, "--no-time", "--backend", "opencv")
    assert (code, err) == (0, "")
    said = dict(lines)
    assert re.fullmatch(r"a.onnx: ONNX, 0.05 MB, opset 12, written by tests", said["file"])
    assert said["input"] == "images 1x3x64x64 float32"
    assert said["output"] == "output0 1x13x84 float32"
    assert said["operators"] == "3 Conv, 3 Reshape, 2 Concat, 1 Identity"
    assert (said["task"], said["stride"], said["imgsz"]) == ("pose", "32", "[64, 64]")
    assert said["gives"] == "output0 1x13x84"
    columns = "4 + 3 classes and 2 keypoints of 3 numbers"
    assert said["head"] == f"yolov8, pose: 1x13x84 has columns of {columns} for 84 cells"
    assert said["images"] == "64x64 px, nchw, letterbox with 114, rgb, (value - 0) / 255"
    assert said["classes"] == "3: red, green, blue"
    # Three convolutions: each pixel of each channel counts once for each of three classes.
    assert 2 * 3 * 3 * 3 * 64 * 64 == 221184
    assert said["cost"] == "221 kFLOP, 12.9 k parameters"
    assert "time" not in said


@needs_onnxruntime
def test_times_are_told_for_each_runtime_and_number_of_threads(inspect):
    code, lines, _ = inspect("a.onnx", yolov8(), "--threads", "1", "3", "--runs", "1")
    times = [re.sub(r"[0-9.]+ ms", "x ms", text) for name, text in lines if name == "time"]
    names = ["onnxruntime", "OpenCV"]
    assert times == [f"x ms with {name}, {n}" for name in names for n in ("1 thread", "3 threads")]
    assert code == 0 and "advice" not in dict(lines)


@needs_onnxruntime
def test_a_runtime_that_cannot_run_it_is_told(inspect):
    graph = Graph()
    surest = graph.node("Hardmax", graph.scores(), axis=1)
    boxes = graph.constant(boxes_of(cells()).T[None])
    graph.output(graph.node("Concat", boxes, surest, axis=1), "output0", [1, 7, 84])
    code, lines, _ = inspect("a.onnx", graph.bytes(), "--threads", "1", "2", "--runs", "1")
    assert (
        code == 0 and [text for name, text in lines if name == "time"][-1] == "OpenCV cannot run it"
    )


def yolov8_boxes():
    from networks import boxes_of, cells

    return boxes_of(cells()).T[None]


def test_darknet_says_what_it_has(inspect, tmp_path):
    (tmp_path / "a.weights").write_bytes(darknet_weights() + b"more")
    (tmp_path / "a.names").write_text("red\ngreen\nblue\n")
    code, lines, _ = inspect(
        "a.cfg", DARKNET.encode(), "--names", str(tmp_path / "a.names"), "--runs", "1"
    )
    said = dict(lines)
    assert code == 0 and said["gives"] == "yolo_1 64x8" and said["classes"] == "3: red, green, blue"
    assert said["head"] == "yolov3, detect: rows of 5 + 3 classes, as darknet's layers give them"
    assert "they may be another one's" in said["warning"] and said["time"].endswith("threads")
    assert said["cost"].endswith("FLOP, 1.54 k parameters")


def test_open_sizes_half_precision_and_uncounted_classes_are_said(inspect):
    graph = Graph(("batch", 3, "h", "w"), TensorProto.FLOAT16)
    words = ["--input-width", "64", "--input-height", "64", "--no-time"]
    code, lines, err = inspect("a.onnx", rtdetr(graph=graph), *words)
    assert (code, err) == (0, "")
    assert dict(lines)["file"].endswith("half precision, open sizes")
    # Convolutions to three classes and four numbers of boxes.
    assert 2 * (3 + 4) * 3 * 64 * 64 == 172032
    assert dict(lines)["cost"].startswith("172 kFLOP, ")
    _, lines, _ = inspect("a.onnx", ssd(), "--no-time")
    assert dict(lines)["classes"] == "as many as a file of names has (--names)"


@needs_onnxruntime
def test_products_of_matrices_count_even_where_shapes_are_computed_in_the_network(inspect):
    """What is in front of them is reshaped by numbers that only a run has."""
    graph = Graph()
    scores = graph.scores([8])  # 1x3x64
    ends = [graph.constant(np.array([end])) for end in (0, 3)]
    shape = graph.node("Slice", graph.node("Shape", scores), *ends)
    computed = graph.node("Reshape", scores, shape)
    products = graph.node("MatMul", graph.node("Transpose", computed, perm=[0, 2, 1]), computed)
    less = graph.node("ReduceMean", products, axes=[1], keepdims=1)  # 1x1x64
    boxes = graph.node("Concat", *[less] * 4, axis=1)
    graph.output(graph.node("Concat", boxes, scores, axis=1), "output0", [1, 7, 64])
    code, lines, _ = inspect("a.onnx", graph.bytes(), "--head", "yolov8", "--no-time")
    assert 2 * (3 * 3 * 64 * 64 + 64 * 64 * 3) == 98304
    assert code == 0 and dict(lines)["cost"].startswith("98.3 kFLOP, ")


def test_the_program_does_all_that_by_itself(tmp_path):
    """In a process in which nothing else has imported what it needs."""
    path = tmp_path / "a.onnx"
    path.write_bytes(yolov8(graph=Graph((1, 3, "h", 64), TensorProto.FLOAT16)))
    program = roslib.packages.find_node("robot_vision", "inspect_model.py")[0]
    words = [program, str(path), "--input-height", "64", "--runs", "1"]
    out = subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout
    assert "221 kFLOP" in out and " ms with OpenCV, 1 thread\n" in out


REFUSED = [
    ("none.onnx", None, [], "none.onnx cannot be read: No such file or directory"),
    ("a.onnx", b"nothing", [], "a.onnx: it is damaged, or no ONNX file: "),
    ("a.onnx", yolov8(), ["--head", "detr"], "a.onnx: head is detr, which gives logits"),
    ("a.onnx", yolov8(metadata={"names": "[a]"}), [], "metadata has 1 name, but the network has 3"),
    ("a.onnx", yolov8(), ["--input-width", "32"], "input_width is 32, must be 0 or 64"),
]


@pytest.mark.parametrize(
    "name, content, words, reason", REFUSED, ids=list(map(str, range(len(REFUSED))))
)
def test_what_cannot_be_read_is_one_line(inspect, name, content, words, reason):
    code, _, err = inspect(name, content, *words)
    assert code == 1 and err.startswith("inspect_model.py: ") and reason in err
    assert err.count("\n") == 1


def test_facts_of_a_model_that_nothing_can_run_are_printed_before_the_reason(inspect):
    graph = Graph()
    graph.output(graph.custom("Boxes", "their.domain", graph.scores()), "output", [1, 3, 84])
    code, lines, err = inspect("a.onnx", graph.bytes())
    assert code == 1 and "no runtime here has: their.domain.Boxes" in err
    assert dict(lines)["custom"] == "their.domain.Boxes"


@pytest.mark.parametrize(
    "words", [["--threads", "0"], ["--head", "yolo"], ["--input-width", "5000"]]
)
def test_wrong_words_are_usage_errors(inspect, words):
    code, _, err = inspect("a.onnx", b"", *words)
    assert code == 2 and "usage" in err
