"""Who is compared with whom: our nodes, what people use today, and the bare work."""

import json
import os
from typing import List, Tuple

import depth_contenders
import detection_contenders
import filter_contenders
import process_contenders
import stereo_contenders
import stream_contenders
from measuring import HERE, RATE, Bench, Command, Contender, Contenders
from node_commands import IMAGE, course, node
from results import Parts, Size, Target

SIZES = ((640, 480), (1920, 1080))
FACE_SIZES = ((640, 480), (1280, 720))
TAG_SIZES = ((640, 480), (1280, 720), (1920, 1080))

Sizes = Tuple[Size, ...]


def edge_detectors(bench: Bench, size: Size) -> List[Contender]:
    ours = node("robot_vision", "edge_detector_node", "edge_detector", IMAGE)
    opencv_apps = node("opencv_apps", "edge_detection", "opencv_apps", IMAGE)
    opencv_apps += ["_edge_type:=2", "_canny_threshold1:=15", "_canny_threshold2:=30"]
    opencv_apps += ["_apertureSize:=7", "_L2gradient:=false", "_debug_view:=false"]
    plain = bench.program("plain_edges_node", IMAGE)
    return [
        Contender("edge_detector_node", [ours], "/edge_detector/processed_image", "opencv"),
        Contender("opencv_apps edge_detection", [opencv_apps], "/opencv_apps/image", "opencv_apps"),
        Contender("plain roscpp + OpenCV", [plain], "/plain_edges/edges", "opencv"),
        Contender("bare OpenCV chain, no ROS", alone=bench.chain(size, 0)),
        Contender("the same, 1 OpenCV thread", alone=bench.chain(size, 1)),
    ]


STEPS = (  # kind, name, input
    ("camera", "usb_cam", ""),
    ("brightness", "brightness", "image:=/usb_cam/image_raw"),
    ("edge_detector", "edge_detector", "image:=/brightness/processed_image"),
)


def chains(bench: Bench, size: Size) -> List[Contender]:
    source = [f"_source:={bench.image(size)}", f"_framerate:={float(RATE)}"]
    manager = [node("nodelet", "nodelet", "vision", "manager")]
    processes = []
    for kind, name, image in STEPS:
        args = [image] if image else source
        nodelet = "robot_vision/" + kind
        manager.append(node("nodelet", "nodelet", name, "load", nodelet, "vision", *args))
        processes.append(node("robot_vision", kind + "_node", name, *args))
    result = "/edge_detector/processed_image"
    return [
        Contender("one manager", manager, result, own_camera=True),
        Contender("three processes", processes, result, own_camera=True),
    ]


def edges_of_a_camera(bench: Bench, size: Size) -> List[Contender]:
    source = [f"_source:={bench.image(size)}", f"_framerate:={float(RATE)}"]
    camera = node("robot_vision", "camera_node", "usb_cam", *source)
    edges = node("robot_vision", "edge_detector_node", "edge_detector", "image:=/usb_cam/image_raw")
    result = "/edge_detector/processed_image"
    return [
        Contender(
            f"over {way}", [[*edges, f"_image_transport:={way}"], camera], result, own_camera=True
        )
        for way in ("shm", "raw")
    ]


def receivers(bench: Bench, size: Size) -> List[Contender]:
    python = [str(HERE / "python_receiver"), IMAGE]
    return [
        Contender("robot_vision.transport, a view", [[*python, "transport"]]),
        Contender("roscpp, does nothing", [bench.program("plain_receiver", IMAGE)]),
        Contender("rospy + cv_bridge", [[*python, "rospy"]]),
        Contender("the same, large buff_size", [[*python, "rospy-buffered"]]),
    ]


def masks(_bench: Bench, _size: Size) -> List[Contender]:
    python = [str(HERE / "python_receiver"), IMAGE, "--mask"]
    return [
        Contender("robot_vision.transport and our mask", [[*python, "transport"]]),
        Contender("rospy + cv_bridge + cv2", [[*python, "rospy"]]),
        Contender("the same, large buff_size", [[*python, "rospy-buffered"]]),
    ]


def hsv_nodes(_bench: Bench, _size: Size) -> List[Contender]:
    colors = "_colors:={suit: {low: [5, 80, 80], high: [25, 255, 255]}}"  # as python_receiver
    ours = node("robot_vision", "hsv_tracker.py", "hsv_tracker", IMAGE, colors)
    theirs = course("hsv")
    return [
        Contender("hsv_tracker.py", [ours], "/hsv_tracker/mask"),
        Contender("rospy + cv_bridge + cv2", [theirs], "/course_hsv/mask"),
    ]


def box_listener(topic: str, kind: str, size: Size) -> Command:
    return [str(HERE / "box_listener"), topic, kind, *map(str, size)]


def motion_nodes(still: bool, mask: bool = False) -> Contenders:
    """What moves as boxes, or with `mask` as an image."""

    def nodes(_bench: Bench, size: Size) -> List[Contender]:
        ours = node("robot_vision", "motion_detector.py", "motion_detector", IMAGE)
        ours.append("_max_changed:=1.0")  # the course's node does not look at that
        theirs = course("motion")

        def contender(name: str, command: Command, of: str) -> Contender:
            if mask:
                return Contender(name, [command], of + "/mask", still=still)
            return Contender(
                name, [command], listener=box_listener(of + "/motion", "motion", size), still=still
            )

        return [
            contender("motion_detector.py", ours, "/motion_detector"),
            contender("rospy + cv_bridge + cv2", theirs, "/course_motion"),
        ]

    return nodes


def tracker_nodes(_bench: Bench, size: Tuple[int, int]) -> List[Contender]:
    ours = node("robot_vision", "object_tracker.py", "object_tracker", IMAGE)
    theirs = course("tracker")
    # The same region as the course's node has.
    numbers = (int(value * size[0] / 640) for value in (260, 180, 120, 120))
    region = json.dumps(dict(zip(("x_offset", "y_offset", "width", "height"), numbers)))
    kind = "sensor_msgs/RegionOfInterest"
    select = ["rostopic", "pub", "--latch", "/object_tracker/select", kind, region]
    return [
        Contender("object_tracker.py", [ours], "/object_tracker/processed_image", beside=[select]),
        Contender("rospy + cv_bridge + cv2", [theirs], "/course_tracker/processed_image"),
    ]


def face_nodes(_bench: Bench, size: Size) -> List[Contender]:
    ours = node("robot_vision", "face_detector.py", "face_detector", IMAGE, "_haar_maxSize:=0")
    theirs = course("face")
    opencv_apps = node("opencv_apps", "face_detection", "opencv_apps", IMAGE, "_debug_view:=false")
    opencv_apps += [
        f"_{name}:=/usr/share/opencv4/haarcascades/haarcascade_{cascade}.xml"
        for name, cascade in (
            ("face_cascade_name", "frontalface_alt"),
            ("eyes_cascade_name", "eye_tree_eyeglasses"),
        )
    ]

    def contender(name: str, command: Command, topic: str, kind: str = "faces") -> Contender:
        listener = box_listener(topic, kind, size)
        return Contender(name, [command], listener=listener, image="portrait")

    return [
        contender("face_detector.py", ours, "/face_detector/faces"),
        contender("rospy + cv_bridge + cv2", theirs, "/course_face/faces"),
        contender("opencv_apps face_detection", opencv_apps, "/opencv_apps/faces", "opencv_apps"),
    ]


def tag_nodes(bench: Bench, size: Size) -> List[Contender]:
    ours = node("robot_vision", "apriltag_detector.py", "apriltag_detector", IMAGE)
    theirs = bench.program("plain_tags_node", IMAGE)

    def contender(name: str, command: Command, of: str) -> Contender:
        listener = box_listener(of + "/tags", "tags", size)
        return Contender(name, [command], listener=listener, image="tags")

    return [
        contender("apriltag_detector.py", ours, "/apriltag_detector"),
        contender("roscpp + cv_bridge + libapriltag + solvePnP", theirs, "/plain_tags"),
    ]


_EDGES = "Edge detector, a process of its own"
_FACES = "Faces"
_BOX = "Motion: a box before a still photograph"
_ALL_MOVES = "Motion: the whole photograph moves"
_TAGS = "AprilTag nodes: two tags, with poses"
_OF_A_CAMERA = "Edges of a camera's images, two processes"
COMPARISONS: Tuple[Tuple[str, Contenders, Sizes], ...] = (
    (_EDGES, edge_detectors, SIZES),
    ("Camera, brightness, edges", chains, SIZES),
    (_OF_A_CAMERA, edges_of_a_camera, SIZES),
    ("Receiving in Python", receivers, SIZES),
    ("HSV mask in Python", masks, SIZES),
    ("HSV tracker: mask, regions, and the mask published", hsv_nodes, SIZES),
    (_FACES, face_nodes, FACE_SIZES),
    (_BOX, motion_nodes(still=True), SIZES),
    ("Motion: the same, and the mask published", motion_nodes(still=True, mask=True), SIZES),
    (_ALL_MOVES, motion_nodes(still=False), SIZES),
    ("Object tracker: the photograph moves, an overlay is published", tracker_nodes, SIZES),
    (_TAGS, tag_nodes, TAG_SIZES),
    (depth_contenders.IMAGE, depth_contenders.registrations(points=False), SIZES),
    (depth_contenders.POINTS, depth_contenders.registrations(points=True), SIZES),
    *(
        (detection_contenders.title(cores), detection_contenders.nodes(cores), SIZES[:1])
        for cores in (1, 2)[: os.cpu_count()]
    ),
    (stereo_contenders.TITLE, stereo_contenders.nodes, SIZES[:1]),
    (process_contenders.TITLE, process_contenders.nodes, SIZES),
    (process_contenders.DRAWN, process_contenders.drawn, SIZES),
    (stream_contenders.TITLE, stream_contenders.streams, SIZES),
    (stream_contenders.PASSED, stream_contenders.passed_on, SIZES),
    *(
        (filter_contenders.title(name), filter_contenders.contenders(pair), SIZES)
        for name, pair in filter_contenders.PAIRS.items()
    ),
)

# The figures to beat; apriltag_ros is no package of Debian, what it does is done beside.
_PLAIN_TAGS = "roscpp + cv_bridge + libapriltag + solvePnP"
TARGETS = (
    Target(_EDGES, (1920, 1080), "opencv_apps edge_detection", "cpu_ms", 1 / 3),
    Target(_EDGES, (1920, 1080), "opencv_apps edge_detection", "median", 1 / 3),
    Target(_EDGES, (1920, 1080), "plain roscpp + OpenCV", "cpu_ms", 1 / 2),
    Target(_EDGES, (1920, 1080), "plain roscpp + OpenCV", "median", 1 / 2),
    Target(_OF_A_CAMERA, (1920, 1080), "", "median", 4.5),
    Target("HSV mask in Python", (1920, 1080), "rospy + cv_bridge + cv2", "cpu_ms", 1 / 3),
    Target("HSV mask in Python", (1920, 1080), "rospy + cv_bridge + cv2", "median", 1 / 3),
    Target("Receiving in Python", (1920, 1080), "roscpp, does nothing", "cpu_ms", 1.2),
    Target("Receiving in Python", (1920, 1080), "roscpp, does nothing", "median", 1.2),
    Target(_FACES, (640, 480), "opencv_apps face_detection", "cpu_ms", 1 / 4),
    Target(_FACES, (640, 480), "opencv_apps face_detection", "found", 1.0),
    Target(_FACES, (640, 480), "", "arrived", 0.98),
    *(Target(_TAGS, size, _PLAIN_TAGS, "cpu_ms", 1 / 2) for size in reversed(TAG_SIZES)),
    *(Target(_TAGS, size, _PLAIN_TAGS, "found", 1.0) for size in reversed(TAG_SIZES)),
    *detection_contenders.targets(),
    *stereo_contenders.targets(SIZES[:1]),
    *stream_contenders.targets(),
    *filter_contenders.targets(),
    *process_contenders.targets(),
)
PARTS = (
    *(Parts(_EDGES, size, "edges of bgr8") for size in SIZES),
    *(Parts("HSV mask in Python", size, "HSV mask, skin") for size in SIZES),
    *(Parts(_BOX, size, "motion, a box moves") for size in SIZES),
    *(Parts(_ALL_MOVES, size, "motion, all of the image moves") for size in SIZES),
)
