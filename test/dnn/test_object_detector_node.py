"""The node object_detector: from an image to all its messages, by tiny networks of known results.

The box of a square in networks.py is twice as wide as the square, and as high.
"""

import concurrent.futures

import actionlib
import cv2
import networks
import numpy as np
import pytest
import rosgraph
import rospy
import support
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from foreign_messages import foreign_messages
from frames import Camera, message
from networks import Square
from runtime_cases import needs_newer_opencv
from sensor_msgs.msg import Image

from robot_vision.msg import (
    CheckForObjectsAction,
    CheckForObjectsGoal,
    Detection2DArray,
    DetectionArray,
)
from robot_vision.srv import DetectObjects

pytestmark = needs_newer_opencv
SQUARES = (Square(0, 2, 3), Square(2, 5, 6))
IMAGE = networks.image_of(SQUARES)
NAME = "/object_detector"
TIMEOUT = 30.0  # s


@pytest.fixture
def run(start, tmp_path):
    """Starts the node with a network; returns it, its camera, and the messages of topics."""

    def run(model=None, topics=(), **params):
        path = tmp_path / "network.onnx"
        path.write_bytes(model or networks.yolov8(metadata=networks.ULTRALYTICS))
        camera = Camera(30.0)
        params = {"model": str(path), "backend": "opencv", "score_threshold": 0.5, **params}
        words = [f"_{name}:={value}" for name, value in params.items()]
        node = start(
            "object_detector.py", "__name:=object_detector", f"image:={camera.topic}", *words
        )
        got = [
            support.Messages(rosgraph.names.ns_join(NAME, topic), kind) for topic, kind in topics
        ]
        if got:
            camera.wait_for()
            for messages in got:
                support.wait_for(messages.connected, "the node's topics")
        return (node, camera, *got)

    return run


def box_of(detection):
    box = detection.box
    return box.x_offset, box.y_offset, box.width, box.height


def expected_box(square):
    """The pixels of a square's box."""
    x, y = square.column * square.stride, square.row * square.stride
    return x - square.stride // 2, y, 2 * square.stride, square.stride


def test_all_that_is_published_of_a_frame(run):
    _, camera, detections, objects, overlays = run(
        topics=(
            ("detections", DetectionArray),
            ("objects", DetectionArray),
            ("processed_image", Image),
        ),
        track=False,
    )
    header = camera.show(IMAGE)
    found = detections.of(header.stamp)
    assert (found.header.frame_id, found.width, found.height) == ("eye", 64, 64)
    by_class = {one.class_id: one for one in found.detections}
    assert sorted(by_class) == [0, 2]
    for square in SQUARES:
        one = by_class[square.class_id]
        x, y, width, height = expected_box(square)
        assert one.label == networks.NAMES[square.class_id]
        assert box_of(one) == (x, y, width, height)
        assert (one.center.x, one.center.y) == (x + width / 2 - 0.5, y + height / 2 - 0.5)
        assert one.score == pytest.approx(1.0, abs=1e-3)
        assert (one.id, one.predicted, one.has_velocity) == (-1, False, False)
        assert one.area == width * height
        corners = [(x, y), (x + 15, y), (x + 15, y + 7), (x, y + 7)]
        assert [(p.x, p.y) for p in one.outline] == corners
        assert not one.mask and not one.keypoints
    assert objects.of(header.stamp).detections == found.detections
    drawn = np.frombuffer(overlays.of(header.stamp).data, np.uint8).reshape(IMAGE.shape)
    changed = np.argwhere((drawn != IMAGE).any(axis=2))
    x, y, width, height = expected_box(SQUARES[1])
    assert any((changed == (y + height - 1, x + 3)).all(axis=1))  # a side of the box


def test_things_are_followed(run):
    _, camera, objects = run(topics=(("objects", DetectionArray),), min_hits=1)
    square = Square(1, 4, 3)
    for seen in (True, True, False, True):
        header = camera.show(networks.image_of([square] if seen else []))
        # Told of when the network has looked at it, as no other frame comes before.
        (one,) = objects.of(header.stamp).detections
        assert (one.label, one.class_id, one.id) == ("green", 1, 1)
        assert one.predicted != seen
        assert one.has_velocity and abs(one.velocity.x) + abs(one.velocity.y) < 1.0
        assert box_of(one) == expected_box(square)
        assert one.score == pytest.approx(1.0, abs=1e-3)
    config = support.reconfigured(NAME, max_prediction=0.0)
    assert config["max_prediction"] == 0.0
    assert not objects.of(camera.show(networks.image_of([])).stamp).detections


def test_of_what_is_followed_the_surest_is_reported_whichever_it_is(run):
    _, camera, objects = run(topics=(("objects", DetectionArray),), min_hits=1, max_detections=1)
    darker = IMAGE // 4 * 3
    for first_is_surer in (True, False, True):
        image = IMAGE.copy()
        image[32:] = darker[32:]  # the second square
        if not first_is_surer:
            image[:32], image[32:] = darker[:32], IMAGE[32:]
        (one,) = objects.of(camera.show(image).stamp).detections
        assert (one.label, one.predicted) == ("red" if first_is_surer else "blue", False)


def test_a_threshold_of_a_class_and_classes_that_are_left_out(run):
    _, camera, detections = run(topics=(("detections", DetectionArray),), track=False)

    def classes():
        found = detections.of(camera.show(IMAGE // 2 + IMAGE // 8).stamp)
        return sorted(one.label for one in found.detections)

    assert classes() == ["blue", "red"]
    support.reconfigured(NAME, class_scores="red: 0.9, 1: 0.2")
    assert classes() == ["blue"]
    support.reconfigured(NAME, class_scores="", only="red, green")
    assert classes() == ["red"]
    support.reconfigured(NAME, only="", score_threshold=0.9)
    assert classes() == []
    for name, value in (
        ("class_scores", "purple: 0.5"),
        ("class_scores", "red: 1.5"),
        ("class_scores", "red: high"),
        ("class_scores", "red"),
        ("only", "purple"),
    ):
        config = support.reconfigured(NAME, **{name: value})
        assert config[name] == "", value


def test_the_region_that_is_searched(run):
    _, camera, detections = run(
        topics=(("detections", DetectionArray),), track=False, region_x=32, region_y=32
    )
    large = cv2.resize(IMAGE, None, fx=4.0, fy=4.0, interpolation=cv2.INTER_NEAREST)
    canvas = np.zeros((320, 320, 3), np.uint8)
    canvas[32:288, 32:288] = large
    support.reconfigured(NAME, region_width=256, region_height=256)
    found = detections.of(camera.show(canvas).stamp)
    boxes = sorted(box_of(one) for one in found.detections)
    expected = [
        [32 * (i < 2) + 4 * side for i, side in enumerate(expected_box(s))] for s in SQUARES
    ]
    assert np.allclose(boxes, expected, atol=1)
    support.reconfigured(NAME, region_x=1000)
    diagnostics = support.Diagnostics()
    camera.show(canvas)
    support.wait_for(
        lambda: "outside of an image of 320x320 px" in diagnostics.value(NAME[1:], "last error"),
        "the frame to be refused",
    )


def test_masks(run):
    metadata = {**networks.ULTRALYTICS, "task": "segment"}
    _, camera, detections = run(
        networks.yolov8("segment", metadata), (("detections", DetectionArray),), track=False
    )
    squares = [Square(0, 3, 3)]  # across the middle of the image, which is where the mask ends
    (one,) = detections.of(camera.show(networks.image_of(squares)).stamp).detections
    x, y, width, height = box_of(one)
    assert (x, y, width, height) == expected_box(squares[0])
    mask = np.frombuffer(one.mask, np.uint8).reshape(height, width)
    expected = np.zeros_like(mask)
    expected[:, : 32 - x] = 255
    assert np.array_equal(mask, expected)
    assert one.area == (32 - x) * height
    assert {(p.x, p.y) for p in one.outline} == {(x, y), (31, y), (31, y + 7), (x, y + 7)}


def test_keypoints(run):
    metadata = {**networks.ULTRALYTICS, "task": "pose", "kpt_shape": f"[{networks.KEYPOINTS}, 3]"}
    _, camera, detections = run(
        networks.yolov8("pose", metadata), (("detections", DetectionArray),), track=False
    )
    (one,) = detections.of(camera.show(networks.image_of([Square(1, 4, 2)])).stamp).detections
    points = [(p.x, p.y, p.z) for p in one.keypoints]
    assert points == [(31.5, 15.5, 0.75), (39.5, 23.5, 0.25)]  # from the centre of the first pixel


def test_the_outline_of_an_oriented_box(run):
    metadata = {**networks.ULTRALYTICS, "task": "obb"}
    _, camera, detections, boxes = run(
        networks.yolov8("oriented", metadata),
        (("detections", DetectionArray), ("detections_2d", Detection2DArray)),
        track=False,
    )
    header = camera.show(networks.image_of([Square(1, 4, 3)]))
    (one,) = detections.of(header.stamp).detections
    corners = {(round(p.x, 3), round(p.y, 3)) for p in one.outline}
    # 16 px wide and 8 px high, turned by a quarter around (36, 28), less the half of a pixel.
    assert corners == {(31.5, 19.5), (39.5, 19.5), (39.5, 35.5), (31.5, 35.5)}
    assert one.area == pytest.approx(128.0, abs=1e-3)
    (box,) = boxes.of(header.stamp).detections
    assert (box.bbox.center.x, box.bbox.center.y) == pytest.approx((35.5, 27.5), abs=1e-3)
    turned = sorted((box.bbox.size_x, box.bbox.size_y))
    assert turned == pytest.approx([8.0, 16.0], abs=1e-3)


def test_clients_of_other_packages(run, start, tmp_path):
    """Clients in Python and C++ that know only their own definitions."""
    darknet = foreign_messages("darknet_ros_msgs", tmp_path)
    vision = foreign_messages("vision_msgs", tmp_path)
    _, camera, boxes, counts, detections = run(
        topics=(
            ("/darknet_ros/bounding_boxes", darknet.msg.BoundingBoxes),
            ("found_object", darknet.msg.ObjectCount),
            ("detections_2d", vision.msg.Detection2DArray),
        ),
        track=False,
        darknet_names=True,
    )
    client = start(
        "test_detection_client",
        "bounding_boxes:=/darknet_ros/bounding_boxes",
        "found_object:=/darknet_ros/found_object",
        f"detections:={NAME}/detections_2d",
    )
    header = camera.show(IMAGE)
    message = boxes.of(header.stamp)
    assert (message.header, message.image_header) == (message.image_header, message.header)
    assert message.image_header.frame_id == "eye"
    found = {
        (one.Class, one.id, one.xmin, one.ymin, one.xmax, one.ymax)
        for one in message.bounding_boxes
    }
    expected = set()
    for square in SQUARES:
        x, y, width, height = expected_box(square)
        name = networks.NAMES[square.class_id]
        expected.add((name, square.class_id, x, y, x + width, y + height))
    assert found == expected
    assert counts.of(header.stamp).count == 2
    for one in detections.of(header.stamp).detections:
        (square,) = [square for square in SQUARES if square.class_id == one.results[0].id]
        x, y, width, height = expected_box(square)
        assert one.results[0].score == pytest.approx(1.0, abs=1e-3)
        center = one.bbox.center
        assert (center.x, center.y) == (x + width / 2 - 0.5, y + height / 2 - 0.5)
        assert (one.bbox.size_x, one.bbox.size_y, center.theta) == (width, height, 0.0)
        assert (one.header, one.source_img.data) == (message.header, b"")
    lines = [f"{name} {number} {' '.join(map(str, sides))}" for name, number, *sides in expected]
    for square in SQUARES:
        x, y, width, height = expected_box(square)
        center = f"{x + width / 2 - 0.5:g} {y + height / 2 - 0.5:g}"
        lines.append(f" {square.class_id} {center} {width} {height}\n")

    def told():
        """Shows frames until the client, which connects to one topic after the other, has all."""
        detections.of(camera.show(IMAGE).stamp)
        return all(line in client.output() for line in [*lines, " 2\n"])

    support.wait_for(told, "the client in C++ to print the boxes and their number")


def test_the_service_searches_a_file_and_the_next_frame(run, tmp_path):
    run()
    service = rospy.ServiceProxy(f"{NAME}/detect", DetectObjects)
    service.wait_for_service(TIMEOUT)
    path = tmp_path / "image.png"
    cv2.imwrite(str(path), IMAGE)
    answer = service(str(path))
    assert answer.success, answer.message
    assert sorted(one.label for one in answer.objects.detections) == ["blue", "red"]
    for name, text in (
        ("image.png", "file is 'image.png', must be an absolute path"),
        (str(tmp_path / "none.png"), "none.png"),
    ):
        answer = service(name)
        assert not answer.success and text in answer.message and not answer.objects.detections


def answer_to_call(service, camera):
    """The answer to a call for the next frame; frames are shown until it comes."""
    with concurrent.futures.ThreadPoolExecutor() as pool:
        call = pool.submit(service, "")

        def answered():
            camera.show(IMAGE)
            return call.done()

        support.wait_for(answered, "the answer")
        return call.result()


def test_a_call_for_a_frame_that_cannot_be_searched_says_why(run):
    _, camera, _ = run(topics=(("objects", DetectionArray),), region_x=1000, diagnostic_period=0.05)
    service = rospy.ServiceProxy(f"{NAME}/detect", DetectObjects)
    service.wait_for_service(TIMEOUT)
    answer = answer_to_call(service, camera)
    assert not answer.success and not answer.objects.detections
    assert "region_x and region_y are 1000 and 0, outside of an image of 64x64" in answer.message
    diagnostics = support.Messages("/diagnostics", DiagnosticArray)

    def told():
        """Whether what the network does is told, though it looks at no frame."""
        camera.show(IMAGE)
        statuses = [one for message in diagnostics.received for one in message.status]
        return any(one.name == "object_detector: network" for one in statuses)

    support.wait_for(told, "the status of the network")


@pytest.mark.parametrize("track", [True, False])
def test_a_call_gets_the_next_frame_however_few_are_looked_at(run, track):
    _, camera, objects = run(topics=(("objects", DetectionArray),), track=track, max_rate=0.001)
    objects.of(camera.show(IMAGE).stamp)
    service = rospy.ServiceProxy(f"{NAME}/detect", DetectObjects)
    service.wait_for_service(TIMEOUT)
    answer = answer_to_call(service, camera)
    assert answer.success, answer.message
    assert sorted(one.label for one in answer.objects.detections) == ["blue", "red"]


def answer_to(client, goal):
    """The result of a goal, when it has come.

    actionlib's own waiting never ends for a result that comes before send_goal() has returned.
    """
    client.send_goal(goal)
    return support.wait_for(client.get_result, "the result of the action")


def test_the_action_searches_the_image_of_its_goal(run):
    run(only="red")
    client = actionlib.SimpleActionClient(f"{NAME}/check_for_objects", CheckForObjectsAction)
    assert client.wait_for_server(rospy.Duration(TIMEOUT))
    image = message(IMAGE[..., ::-1].copy(), "rgb8", padding=5)
    image.header.frame_id = "sender"
    result = answer_to(client, CheckForObjectsGoal(7, image))
    (box,) = result.bounding_boxes.bounding_boxes
    assert (result.id, box.Class, box.id) == (7, "red", 0)
    assert result.bounding_boxes.image_header.frame_id == "sender"
    image.data = image.data[:-1]
    answer_to(client, CheckForObjectsGoal(8, image))
    assert client.get_state() == actionlib.GoalStatus.ABORTED
    assert "rgb8 of 64x64" in client.get_goal_status_text()


def test_diagnostics_say_what_runs(run):
    _, camera, detections = run(
        topics=(("detections", DetectionArray),), track=False, diagnostic_period=0.05
    )
    diagnostics = support.Messages("/diagnostics", DiagnosticArray)

    def told():
        """The values of a status after the first frame; another frame is shown to get one."""
        detections.of(camera.show(IMAGE).stamp)
        statuses = [one for message in diagnostics.received for one in message.status]
        about = [one for one in statuses if one.name == "object_detector: network"]
        values = [(one, {pair.key: pair.value for pair in one.values}) for one in about]
        return [one for one in values if one[1]["frames looked at"] != "0"]

    status, values = support.wait_for(told, "a frame in the diagnostics")[-1]
    assert status.level == DiagnosticStatus.OK
    assert (values["head"], values["backend"], values["input"]) == ("yolov8", "OpenCV", "64x64")
    assert values["failures"] == "0" and float(values["time of a frame (ms)"]) > 0.0
    assert values["model"].endswith("network.onnx")


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("backend", "cuda", "backend is 'cuda', must be auto, onnxruntime or opencv"),
        ("head", "yolo99", "head is 'yolo99', must be auto"),
        ("model", "scene.onnx", "model is 'scene.onnx', must be an absolute path"),
        ("model", "/nowhere/scene.onnx", "/nowhere/scene.onnx"),
        ("score_threshold", 2.0, "score_threshold is 2, must be from 0 to 1"),
        ("class_scores", "unicorn: 0.5", "class_scores names the class 'unicorn'"),
        ("mean", [1, 2], "mean is [1, 2], must be a list of three numbers, or empty"),
        ("affinity", [-1], "affinity is [-1], must be a list of some of ["),
        ("order", "grb", "order is 'grb', must be auto, rgb or bgr"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "object_detector.py", name, value, text)
