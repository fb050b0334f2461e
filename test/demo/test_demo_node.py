"""The demo on real input: a video of a photograph runs through its graph to the edges."""

import functools
import pathlib
import re

import cv2
import numpy as np
import pytest
import rospy
import support
from faces import PORTRAIT
from geometry_msgs.msg import PointStamped, Twist
from ros_programs import ROSLAUNCH, ROSRUN
from sensor_msgs.msg import Image
from tag_studio import matrix_of

from robot_vision import Scene, SceneParams
from robot_vision.msg import (
    Detection3DArray,
    DetectionArray,
    FaceIdentityArray,
    GroundTruth,
    Line,
    TableArray,
    TagDetectionArray,
)
from robot_vision.srv import EnrollFace

DEMO = pathlib.Path(__file__).resolve().parents[2] / "tools" / "demo"
WIDTH, HEIGHT, FRAMES = 320, 240, 30


@pytest.fixture(scope="module")
def video(tmp_path_factory):
    """A video of a window that wanders over a photograph."""
    path = str(tmp_path_factory.mktemp("video") / "astronaut.mp4")
    fourcc = cv2.VideoWriter_fourcc(*"mp4v")
    writer = cv2.VideoWriter(path, cv2.CAP_FFMPEG, fourcc, 30, (WIDTH, HEIGHT))
    for i in range(FRAMES):
        x, y = 2 * i, i
        writer.write(PORTRAIT[y : y + HEIGHT, x : x + WIDTH])
    writer.release()
    return path


def decoded(path):
    """The frames of a video as OpenCV decodes them."""
    capture = cv2.VideoCapture(path, cv2.CAP_FFMPEG)
    return [frame for _, frame in iter(capture.read, (False, None))]


def opencv_chain(frame):
    """What the demo's brightness and edge detector make of a frame with their defaults."""
    brighter = cv2.convertScaleAbs(frame, alpha=1.0, beta=50)
    smooth = cv2.blur(cv2.cvtColor(brighter, cv2.COLOR_BGR2GRAY), (7, 7))
    return cv2.Canny(smooth, 15, 30)


def test_edges_of_a_video_are_opencv_s(start, video):
    expected = {opencv_chain(frame).tobytes(): i for i, frame in enumerate(decoded(video))}
    assert len(expected) == FRAMES
    edges = support.Messages("/edge_detector/processed_image", Image)
    start(ROSLAUNCH, "robot_vision", "demo.launch", "source:=" + video)
    edges.wait()
    edges.wait(2 * FRAMES)
    several = FRAMES // 2
    support.wait_for(lambda: len({m.data for m in edges.received}) > several, "most frames")
    received = list(edges.received)
    assert {(m.encoding, m.width, m.height, m.step) for m in received} == {
        ("mono8", WIDTH, HEIGHT, WIDTH)
    }
    # Every image is one of the expected, to the bit; as many frames on as their stamps say, unless
    # the camera was busy: a frame that is late by more than a period moves all behind it.
    numbers = [expected[m.data] for m in received]
    stamps = np.array([m.header.stamp.to_sec() for m in received])
    assert np.all(np.diff(stamps) > 0)
    late = np.diff(stamps) * 30 - np.diff(numbers) % FRAMES
    assert late.min() > -1.1 and np.percentile(np.abs(late), 10) < 0.5


def test_make_demo_fails_when_its_source_is_wrong(start, tmp_path):
    path = tmp_path / "text.png"
    path.write_text("hello")
    process = start(str(DEMO), f"source:={path}", "view:=false")
    assert process.exit_code() == 1
    assert f"{path}: not an image or video" in process.output()
    assert "the demo ended by itself" in process.output()


def test_make_demo_ends_with_0_on_interrupt(start):
    process = start(str(DEMO), "view:=false")
    process.wait_for_output("running on /brightness/processed_image")
    process.interrupt()
    assert process.exit_code() == 0, process.output()
    assert "the demo ended by itself" not in process.output()


def test_the_help_of_the_status_printer_promises_no_file(start):
    nowhere = {"ROS_MASTER_URI": "http://127.0.0.1:1"}
    told = {}
    for name in ("demo_status.py", "code_reader.py"):
        process = start(name, "--help", env=nowhere)
        assert process.exit_code() == 0, process.output()
        told[name] = process.output()
    assert "/diagnostics" in told["demo_status.py"] and "~view" in told["demo_status.py"]
    assert [name for name, text in told.items() if "folder config" in text] == ["code_reader.py"]


def test_rosrun_finds_scripts_and_programs(start):
    """In a checkout with its own workspace rosrun must not find a script twice, and ask."""
    status = (ROSRUN, "robot_vision", "demo_status.py")
    process = start(*status, env={"DISPLAY": ""})
    process.wait_for_output("No display: look at")
    process = start(*status, env={"DISPLAY": ":7"})
    process.wait_for_output("No windows (view:=windows): look at")
    other = start(ROSRUN, "robot_vision", "camera_node", "_source:=synthetic")
    other.wait_for_output("synthetic scene (room) 640x480 at 30 Hz")


@pytest.fixture(scope="module")
def scene_demo(start_once):
    """The demo on the scene, with depth, for all the tests from here on; ends with 0."""
    process = start_once(ROSLAUNCH, "robot_vision", "demo.launch", "depth:=true")
    yield process
    process.interrupt()
    assert process.exit_code() == 0, process.output()


def test_demo_prints_a_line_per_node_now_and_then(scene_demo):
    process = scene_demo
    number = r"\s+[0-9.]+"
    line = f"^{{}}{number} Hz  age{number} ms  processing{number} ms  "
    for node in ("usb_cam", "brightness", "edge_detector"):
        support.wait_for(
            lambda: len(re.findall(line.format(node), process.output(), re.MULTILINE)) >= 2,  # noqa: B023
            f"two lines of {node} in\n{process.output()}",
            2 * support.DEADLINE,  # all nodes start before the first, and the next is 10 s behind
        )
    for topic in ("/usb_cam/image_raw", "/brightness/processed_image"):
        assert topic in process.output()
    lines = re.findall("^.* Hz  age .*$", process.output(), re.MULTILINE)
    assert {text.index(" Hz  age ") for text in lines} == {lines[0].index(" Hz  age ")}
    assert "rosdep view is empty" not in process.output()


def test_demo_prints_the_address_of_its_dashboard_at_start_and_when_all_is_up(scene_demo):
    address = r"^dashboard: (http://127\.0\.0\.1:\d+/\?token=[0-9a-f]{32})$"

    def printed():
        return re.findall(address, scene_demo.output(), re.MULTILINE)

    support.wait_for(lambda: len(printed()) == 2, "the address, twice")
    assert len(set(printed())) == 1
    before, between, _ = re.split(address, scene_demo.output(), maxsplit=2, flags=re.MULTILINE)[::2]
    assert " Hz  age " not in before and "code_reader " in between
    token = printed()[0].partition("?token=")[2]
    assert token not in str(rospy.get_param("/"))


def test_demo_shows_the_scene(scene_demo):
    truths = support.Messages("/usb_cam/ground_truth", GroundTruth)
    images = support.Messages("/usb_cam/image_raw", Image)
    edges = support.Messages("/edge_detector/processed_image", Image)
    truth, first, result = support.same_frame(truths, images, edges)
    image = Scene(SceneParams(), PORTRAIT).render(truth.frame)
    assert first.data == image.tobytes()
    assert result.header.frame_id == first.header.frame_id
    assert result.data == opencv_chain(image).tobytes()


def true_object(truth, name):
    return next(one for one in truth.objects if one.name == name)


def sees_the_portrait(truth, faces):
    """Whether a face is found where the poster's is, 0.44 by 0.21 of its size from the corner."""
    poster = true_object(truth, "poster")
    bottom_left, bottom_right, _, top_left = (np.array([p.x, p.y]) for p in poster.outline)
    across, down = bottom_right - bottom_left, bottom_left - top_left
    face = top_left + 0.44 * across + 0.21 * down
    near = 0.05 * np.hypot(*across)
    return any(
        np.hypot(d.center.x - face[0], d.center.y - face[1]) < near for d in faces.detections
    )


def sees_the_ball(truth, objects):
    ball = true_object(truth, "ball")
    return any(
        np.hypot(d.center.x - ball.center.x, d.center.y - ball.center.y) < 3.0
        for d in objects.detections
    )


def knows_the_ball_s_place(truth, position):
    point, found = true_object(truth, "ball").pose.position, position.point
    return (found.x, found.y, found.z) == pytest.approx(
        (point.x, point.y, point.z), rel=0.03, abs=0.02
    )


def test_demo_finds_what_is_in_the_scene(scene_demo):
    truths = support.Messages("/usb_cam/ground_truth", GroundTruth)
    objects = support.Messages("/hsv_tracker/objects", DetectionArray)
    positions = support.Messages("/ball_tracker/position", PointStamped)
    faces = support.Messages("/face_detector/faces", DetectionArray)
    tracked_objects = support.Messages("/object_tracker/object", DetectionArray)
    lines = support.Messages("/line_follower/line", Line)
    commands = support.Messages("/line_follower/cmd_vel", Twist)
    codes = support.Messages("/code_reader/codes", DetectionArray)
    # What is hidden in one frame is seen in another.
    support.wait_for(lambda: sees_the_ball(*support.same_frame(truths, objects)), "the ball")
    support.wait_for(
        lambda: knows_the_ball_s_place(*support.same_frame(truths, positions)), "the ball's place"
    )
    support.wait_for(lambda: sees_the_portrait(*support.same_frame(truths, faces)), "the face")
    support.wait_for(
        lambda: sees_the_portrait(*support.same_frame(truths, tracked_objects)), "the face followed"
    )
    support.wait_for(lambda: any(line.found for line in lines.received), "the line")
    support.wait_for(lambda: any(c.linear.x == 0.2 for c in commands.received), "driving")
    assert {code.label for m in codes.wait() for code in m.detections} == {"robot_vision"}
    assert "/cmd_vel" not in dict(rospy.get_published_topics())  # a demo drives no robot


def overlap(detection, thing):
    """Intersection over union of a detection's box and the box of a thing's true outline."""
    outline = np.array([(point.x, point.y) for point in thing.outline])
    left, top = np.array((detection.box.x_offset, detection.box.y_offset)) - 0.5
    right, bottom = left + detection.box.width, top + detection.box.height
    low = np.maximum(outline.min(axis=0), (left, top))
    high = np.minimum(outline.max(axis=0), (right, bottom))
    common = np.prod(np.maximum(high - low, 0.0))
    return common / (np.prod(np.ptp(outline, axis=0)) + (right - left) * (bottom - top) - common)


def test_the_network_of_the_package_finds_and_follows_what_is_in_the_scene(scene_demo):
    truths = support.Messages("/usb_cam/ground_truth", GroundTruth)
    objects = support.Messages("/object_detector/objects", DetectionArray)

    def is_found(name, label, predicted):
        truth, found = support.same_frame(truths, objects)
        thing = true_object(truth, name)
        return thing.visible and any(
            one.label == label
            and one.id > 0
            and one.predicted == predicted
            and overlap(one, thing) > 0.5
            for one in found.detections
        )

    for name in ("ball", "tag_0", "tag_1", "qr_code", "checkerboard", "box", "poster"):
        label = "tag" if name.startswith("tag") else name
        for predicted, when in ((False, "seen"), (True, "in a frame between")):
            support.wait_for(
                functools.partial(is_found, name, label, predicted), f"the {name}, {when}"
            )


def distance(pose, truth, name):
    """How far (m) a pose is from the middle of the object of this name."""
    places = [matrix_of(one)[:3, 3] for one in (pose, true_object(truth, name).pose)]
    return np.linalg.norm(np.subtract(*places))


def test_demo_finds_by_depth_where_things_are(scene_demo):
    truths = support.Messages("/usb_cam/ground_truth", GroundTruth)
    tables = support.Messages("/tabletop/tables", TableArray)
    standing = support.Messages("/tabletop/objects", Detection3DArray)
    things = support.Messages("/detections_3d/detections", Detection3DArray)
    tags = support.Messages("/apriltag_detector/tags", TagDetectionArray)

    def the_floor_is_the_table():
        truth, found = support.same_frame(truths, tables)
        camera = matrix_of(truth.camera)
        poses = [matrix_of(table.pose) for table in found.tables]
        return any(
            np.degrees(np.arccos(min(1.0, pose[:3, 2] @ camera[2, :3]))) < 0.5
            and abs(camera[2, 3] + pose[:3, 2] @ pose[:3, 3]) < 0.01
            for pose in poses
        )

    def is_found(name, topic, limit):
        truth, found = support.same_frame(truths, topic)
        return any(distance(one.pose.pose, truth, name) < limit for one in found.detections)

    def tags_have_poses():
        truth, found = support.same_frame(truths, tags)
        seen = [tag for tag in found.detections if tag.has_pose]
        return seen and all(distance(tag.pose.pose, truth, f"tag_{tag.id}") < 0.03 for tag in seen)

    support.wait_for(the_floor_is_the_table, "the plane of the floor")
    support.wait_for(lambda: is_found("box", standing, 0.1), "the box on the floor")
    support.wait_for(lambda: is_found("ball", things, 0.03), "the ball in space")
    support.wait_for(tags_have_poses, "the tags by their depth")


def test_what_the_network_finds_has_its_place_in_space(scene_demo, start):
    depth = "/usb_cam/depth_registered/image_raw"
    remapped = "detections:=/object_detector/objects", f"depth:={depth}"
    start("detections_3d.py", "__name:=objects_3d", *remapped, "_frame_prefix:=network_")
    truths = support.Messages("/usb_cam/ground_truth", GroundTruth)
    things = support.subscribed("/objects_3d/detections", Detection3DArray)

    def is_found(name, label, limit):
        truth, found = support.same_frame(truths, things)
        return any(
            one.label == label and distance(one.pose.pose, truth, name) < limit
            for one in found.detections
        )

    for name, label, limit in (
        ("tag_0", "tag", 0.05),
        ("qr_code", "qr_code", 0.08),
        ("poster", "poster", 0.15),
        ("ball", "ball", 0.15),  # its surface is located, which is 0.1 m before its middle
    ):
        support.wait_for(functools.partial(is_found, name, label, limit), f"the {name} in space")


def test_the_portrait_is_enrolled_and_recognised(scene_demo, start, tmp_path):
    remapped = "image:=/usb_cam/image_raw", "faces:=/face_detector/faces"
    gallery = f"_gallery:={tmp_path / 'gallery'}"
    start("face_recognizer.py", *remapped, gallery, f"_enroll_timeout:={support.DEADLINE}")
    rospy.wait_for_service("/face_recognizer/enroll", support.DEADLINE)
    answer = rospy.ServiceProxy("/face_recognizer/enroll", EnrollFace)("Eileen", 5)
    assert answer.success, answer.message
    identities = support.Messages("/face_recognizer/identities", FaceIdentityArray)
    support.wait_for(
        lambda: any(one.name == "Eileen" for m in identities.received for one in m.identities),
        "the name",
    )
    assert len(list((tmp_path / "gallery" / "Eileen").glob("*.png"))) == 5
