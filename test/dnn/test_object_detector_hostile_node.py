"""What others do to the node object_detector: it stays, and is right about the next frame."""

import os
import threading

import cv2
import networks
import numpy as np
import pytest
import rospy
import support
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from dynamic_reconfigure.msg import BoolParameter, DoubleParameter, IntParameter, StrParameter
from dynamic_reconfigure.srv import Reconfigure, ReconfigureRequest
from frames import Camera, damaged, message
from network_graph import Graph
from networks import Square
from onnx import TensorProto
from runtime_cases import needs_onnxruntime
from sensor_msgs.msg import Image

from robot_vision.msg import DetectionArray
from robot_vision.srv import DetectObjects

IMAGE = networks.image_of((Square(0, 2, 3), Square(2, 5, 6)))
WHITE = np.full_like(IMAGE, 255)
NAME = "/object_detector"
TIMEOUT = 30.0  # s


@pytest.fixture
def run(start, tmp_path):
    """Starts the node with a network; returns it, its camera, and the messages of one topic."""

    def run(content, topic="detections", **params):
        path = tmp_path / "network.onnx"
        path.write_bytes(content)
        camera = Camera(30.0)
        params = {"model": str(path), "backend": "opencv", **params}
        words = [f"_{name}:={value}" for name, value in params.items()]
        node = start(
            "object_detector.py", "__name:=object_detector", f"image:={camera.topic}", *words
        )
        found = support.Messages(f"{NAME}/{topic}", DetectionArray)
        camera.wait_for()
        support.wait_for(found.connected, "the node's topic")
        return node, camera, found

    return run


def require_right(camera, found):
    """Shows an image until the network has looked at it; requires that what is in it is found."""
    shown = []

    def results():
        shown.append(camera.show(IMAGE).stamp)
        return [one for one in found.received if one.header.stamp in shown]

    result = support.wait_for(results, "a result")[0]
    assert {one.class_id for one in result.detections} == {0, 2}


def tiny():
    return networks.yolov8(metadata=networks.ULTRALYTICS)


def scaled(factor):
    """A network whose scores are so many times as high."""
    graph = Graph()
    boxes = graph.constant(networks.boxes_of(networks.cells()).T[None])
    scores = graph.node("Mul", graph.scores(), graph.constant(np.array(factor)))
    graph.output(graph.node("Concat", boxes, scores, axis=1), "output0", [1, 7, 84])
    return graph.bytes(networks.ULTRALYTICS)


def moody(throws):
    """A network that gives only the boxes of a white image, or throws."""
    graph = Graph()
    boxes = graph.constant(networks.boxes_of(networks.cells()).T[None])
    values = graph.node("Concat", boxes, graph.scores(), axis=1)
    darkest = graph.node("ReduceMin", "images", axes=[0, 1, 2, 3], keepdims=0)
    white = graph.node("Greater", darkest, graph.constant(np.array(0.5)))
    white = graph.shaped(graph.node("Cast", white, to=TensorProto.INT64), 1)
    if throws:  # as it is looked up in a table of one
        nothing = graph.node("Gather", graph.constant(np.zeros(1, np.float32)), white)
        values = graph.node("Add", values, nothing)
    else:
        less = graph.node("Mul", white, graph.constant(np.array([3])))
        rows = graph.node("Sub", graph.constant(np.array([7])), less)
        begin, axis = graph.constant(np.array([0])), graph.constant(np.array([1]))
        values = graph.node("Slice", values, begin, rows, axis)
    graph.output(values, "output0", [1, "rows", 84])
    return graph.bytes(networks.ULTRALYTICS)


def test_scores_above_one_are_followed_like_others(run):
    _, camera, objects = run(scaled(100.0), "objects", min_hits=1)
    for _ in range(3):
        require_right(camera, objects)


def test_images_that_are_none_and_of_any_size(run):
    node, camera, found = run(tiny(), track=False)
    for _, image in damaged(message(IMAGE, "bgr8")):
        camera.send(image)
    for shape in ((1, 1, 3), (1, 700, 3), (700, 1, 3), (1080, 1920, 3)):
        header = camera.show(np.zeros(shape, np.uint8))
        found_in = found.of(header.stamp)
        assert (found_in.height, found_in.width) == shape[:2]
    require_right(camera, found)
    assert "Traceback" not in node.output()


WRONG = [
    ("strs", StrParameter("score_threshold", "high")),
    ("strs", StrParameter("track", "yes")),
    ("ints", IntParameter("class_scores", 3)),
    ("bools", BoolParameter("only", True)),
    ("doubles", DoubleParameter("tile_rows", 1.5)),
    ("doubles", DoubleParameter("unsure_score", float("nan"))),
]


def test_values_of_another_type_are_refused_in_a_line(run):
    node, camera, found = run(tiny(), track=False)
    service = rospy.ServiceProxy(f"{NAME}/set_parameters", Reconfigure)
    before = service(ReconfigureRequest()).config
    for kind, parameter in WRONG:
        request = ReconfigureRequest()
        getattr(request.config, kind).append(parameter)
        assert service(request).config == before
        assert f"{parameter.name} is " in node.output()
    assert "Traceback" not in node.output()
    require_right(camera, found)


def test_many_clients_at_once_with_files_that_are_none(run, tmp_path):
    _, camera, found = run(tiny(), track=False)
    cv2.imwrite(str(tmp_path / "good.png"), IMAGE)
    good = (tmp_path / "good.png").read_bytes()
    (tmp_path / "cut.png").write_bytes(good[: len(good) // 2])
    os.mkfifo(tmp_path / "pipe.png")
    names = [str(tmp_path / name) for name in ("good.png", "cut.png", "pipe.png")]
    names += ["/dev/zero", "/proc/self/mem", str(tmp_path), "/" + "a" * 100000]
    answers = []

    def call():
        service = rospy.ServiceProxy(f"{NAME}/detect", DetectObjects)
        answers.extend((name, service(name)) for name in names)

    rospy.wait_for_service(f"{NAME}/detect", TIMEOUT)
    threads = [threading.Thread(target=call, daemon=True) for _ in range(10)]
    for thread in threads:
        thread.start()
    require_right(camera, found)
    for thread in threads:
        thread.join(TIMEOUT)
    assert len(answers) == 10 * len(names)
    for name, answer in answers:
        assert answer.success == (name == names[0]), answer.message
        assert answer.success or 0 < len(answer.message) <= 1000


@needs_onnxruntime
@pytest.mark.parametrize("throws", [False, True], ids=["shape", "throws"])
@pytest.mark.parametrize("track", [True, False], ids=["tracked", "single"])
def test_a_network_that_fails_at_an_image_looks_at_the_next(run, throws, track):
    params = {"track": track, "backend": "onnxruntime", "diagnostic_period": 0.05}
    node, camera, found = run(moody(throws), **params)
    diagnostics = support.Messages("/diagnostics", DiagnosticArray)
    require_right(camera, found)

    def failure():
        camera.show(WHITE)
        statuses = [one for message in diagnostics.received for one in message.status]
        about = [one for one in statuses if one.name == "object_detector: network"]
        return next((one.message for one in about if one.level == DiagnosticStatus.ERROR), None)

    reason = "onnxruntime failed: " if throws else "the network gave something else than at start"
    assert reason in support.wait_for(failure, "the failure in the diagnostics")
    require_right(camera, found)
    assert "Traceback" not in node.output()


def test_a_signal_ends_the_node_whatever_others_do(run):
    node, camera, found = run(tiny())
    require_right(camera, found)
    for _ in range(20):
        camera.send(Image(encoding="bgr8", width=1, height=1))
    node.interrupt()
    assert node.prompt_exit_code() == 0
