"""The images of the pages that are about no single node."""

import contextlib
from typing import List, Sequence, Tuple

import cv2
import nodes
import numpy as np
import rospy
from canvas import RED, beside, captioned, fitted, joined, write
from sensor_msgs.msg import CompressedImage, Image
from stage import FRAME, IMAGE, Stage, listening, pixels, room, support

from robot_vision import (
    CalibrationScene,
    SceneParams,
    TabletopScene,
    find_edges,
    hsv_mask,
    range_around,
    to_hsv,
)
from robot_vision.depth.depth_overlay import depth_colors
from robot_vision.msg import Detection3DArray, DetectionArray

BLACK, YELLOW = (0, 0, 0), (0, 220, 255)  # BGR
BOARD = ("--size", "8x6", "--square", "0.05")
VIEWS = 40  # of the calibration scene, each in another pose
POSE_FRAMES = 15  # that it holds a pose for
TABLE_FRAME = 140  # of the table's scene


def demo(stage: Stage) -> np.ndarray:
    results = {
        "edge_detector": stage.drawn("edge_detector_node", room(), [FRAME]),
        "ball_tracker": nodes.ball_tracker(stage),
        "line_follower": nodes.line_follower(stage),
        "face_detector": nodes.face_detector(stage),
        "apriltag_detector": nodes.apriltag_detector(stage),
        "object_tracker": nodes.object_tracker(stage),
    }
    return beside(list(results.values()), list(results), columns=3)


def camera(stage: Stage) -> np.ndarray:
    board = CalibrationScene(SceneParams()).render(POSE_FRAMES * 3)
    shown = [room(portrait=False).render(FRAME), board]
    return beside(shown, ["source:=synthetic", "source:=synthetic scene:=calibration"])


def meshes(stage: Stage) -> np.ndarray:
    """The scene's table, and what its depth camera sees of it."""
    scene = TabletopScene(SceneParams())
    depths = depth_colors(scene.render_depth(TABLE_FRAME), nearest=0.6, farthest=1.4)
    return beside([scene.render(TABLE_FRAME), depths], ["~image_raw", "its depth"])


RGBD = "_source:=synthetic", "_views:=rgbd", "_depth_noise:=kinect", "_poster:=auto"


def colors_of(depth_image: Image) -> np.ndarray:
    """A depth image of 16UC1, in the colours of the depths of the room."""
    size = depth_image.height, depth_image.width
    millimetres = np.frombuffer(depth_image.data, np.uint16).reshape(size)
    return depth_colors(millimetres, nearest=1.0, farthest=3.5)


def depth(stage: Stage) -> np.ndarray:
    """Color and depth of the scene."""
    topics = "/camera/rgb/image_raw", "/camera/depth/image_raw"
    sent = listening(topics[0], Image), listening(topics[1], Image)
    with stage.node("camera_node", "camera", *RGBD), sent[0] as colors, sent[1] as depths:
        color, measured = support.same_frame(colors, depths)
    return beside([pixels(color), colors_of(measured)], topics)


def depth_registration(stage: Stage) -> np.ndarray:
    """Color and depth of the scene, and the depth of the color camera."""
    names = "rgb/image_raw", "depth/image_raw", "depth_registered/image_raw"
    with contextlib.ExitStack() as stack:
        stack.enter_context(stage.node("camera_node", "camera", *RGBD))
        words = "depth_registration_node", "depth_registration", "__ns:=/camera"
        stack.enter_context(stage.node(*words))
        sent = [stack.enter_context(listening(f"/camera/{name}", Image)) for name in names]
        color, *depths = support.same_frame(*sent)
    return beside([pixels(color), *map(colors_of, depths)], names)


def detections_3d(stage: Stage) -> np.ndarray:
    """A face in the color image, and the depth with its place."""
    color, faces = "/camera/rgb/image_raw", "/face_detector/faces"
    names = "/face_detector/processed_image", "/detections_3d/processed_image"
    nodes_behind = [
        ("depth_registration_node", "depth_registration", "__ns:=/camera"),
        ("face_detector.py", "face_detector", f"image:={color}", "_haar_maxSize:=0"),
        (
            "detections_3d.py",
            "detections_3d",
            "depth:=/camera/depth_registered/image_raw",
            f"detections:={faces}",
        ),
    ]
    with contextlib.ExitStack() as stack:
        stack.enter_context(stage.node("camera_node", "camera", *RGBD))
        for words in nodes_behind:
            stack.enter_context(stage.node(*words))
        places = stack.enter_context(listening("/detections_3d/detections", Detection3DArray))
        sent = [stack.enter_context(listening(name, Image)) for name in names]

        def complete() -> set:
            stamps = {support.stamp_of(one) for one in places.received if one.detections}
            return stamps.intersection(
                *({support.stamp_of(m) for m in one.received} for one in sent)
            )

        stamp = max(support.wait_for(complete, "a face with a place"))
        images = [pixels(one.of(stamp)) for one in sent]
    return beside(images, names)


def tabletop(stage: Stage) -> np.ndarray:
    """The scene, and its floor as a table in the depth image."""
    topics = "/camera/rgb/image_raw", "/tabletop/processed_image"
    words = "image:=/camera/depth/image_raw", "_vertical_frame:=scene/line"
    with contextlib.ExitStack() as stack:
        stack.enter_context(stage.node("camera_node", "camera", *RGBD))
        stack.enter_context(stage.node("tabletop.py", "tabletop", *words))
        sent = [stack.enter_context(listening(topic, Image)) for topic in topics]
        shown = support.same_frame(*sent)
    return beside([pixels(one) for one in shown], ["rgb/image_raw", "~processed_image"])


def several_machines(stage: Stage) -> np.ndarray:
    front, rear = room().render(FRAME), room(portrait=False).render(0)
    return beside([front, rear], ["/front/image_raw", "/rear/image_raw"])


def viewing(stage: Stage) -> np.ndarray:
    image = room().render(FRAME)
    shown = {
        "/usb_cam/image_raw": image,
        "/usb_cam/image_mono": cv2.cvtColor(image, cv2.COLOR_BGR2GRAY),
        "/edge_detector/processed_image": stage.drawn("edge_detector_node", room(), [FRAME]),
        "/apriltag_detector/processed_image": nodes.apriltag_detector(stage),
    }
    return beside(list(shown.values()), list(shown), columns=2, width=560)


def python(stage: Stage) -> np.ndarray:
    image = room(portrait=False).render(0)
    return beside([image, find_edges(image)], ["scene.render(0)", "find_edges(image)"])


def calibration(stage: Stage) -> np.ndarray:
    folder = stage.folder / "board"
    folder.mkdir()
    scene = CalibrationScene(SceneParams())
    for view in range(VIEWS):
        cv2.imwrite(str(folder / f"{view:02}.png"), scene.render(POSE_FRAMES * view))
    coverage = folder.parent / "coverage.png"
    results = "--output", folder.parent / "camera.yaml", "--coverage", coverage
    process = stage.start("calibrate_headless.py", *BOARD, *results, folder)
    assert process.exit_code() == 0, process.output()
    board = scene.render(POSE_FRAMES * 3)
    found, corners = cv2.findChessboardCorners(cv2.cvtColor(board, cv2.COLOR_BGR2GRAY), (8, 6))
    assert found
    cv2.drawChessboardCorners(board, (8, 6), corners, found)
    return beside([board, cv2.imread(str(coverage))], ["corners of a view", "coverage"])


def transports(stage: Stage) -> np.ndarray:
    """The same part of an image as it comes over several transports."""
    image = room().render(FRAME)
    path = stage.folder / "image.png"
    cv2.imwrite(str(path), image)
    shown, captions = [image], [f"raw: {image.nbytes / 1e3:.0f} kB"]
    for quality in (80, 10):
        rospy.set_param(f"{IMAGE}/compressed/jpeg_quality", quality)
        sent = listening(f"{IMAGE}/compressed", CompressedImage)
        with stage.node("camera_node", "usb_cam", f"_source:={path}"), sent as messages:
            (message,) = messages.wait()
        data = np.frombuffer(message.data, np.uint8)
        shown.append(cv2.imdecode(data, cv2.IMREAD_COLOR))
        captions.append(f"quality {quality}: {data.size / 1e3:.0f} kB")
        if quality == 80:
            eighth = cv2.imdecode(data, cv2.IMREAD_REDUCED_COLOR_8)
    shown.append(cv2.resize(eighth, image.shape[1::-1], interpolation=cv2.INTER_NEAREST))
    captions.append("reduction 8")
    parts = [one[50:170, 90:210] for one in shown]  # with the portrait's face
    return beside([enlarged(part, 2) for part in parts], captions)


def enlarged(image: np.ndarray, times: int) -> np.ndarray:
    return image.repeat(times, axis=0).repeat(times, axis=1)


def messages(stage: Stage) -> np.ndarray:
    """A detection of the ball tracker, with its fields."""
    frames = range(FRAME - 20, FRAME)
    with stage.watched("ball_tracker.py", room(), output="objects", kind=DetectionArray) as show:
        ball = [show(frame) for frame in frames][-1].detections[0]
    times, half = 4, 80
    left, top = round(ball.center.x) - half, round(ball.center.y) - 55
    part = room().render(frames[-1])[top : top + 100, left : left + 2 * half]
    image = enlarged(part, times)

    def place(x: float, y: float) -> Tuple[int, int]:
        return round((x - left + 0.5) * times), round((y - top + 0.5) * times)

    box = ball.box
    far = box.x_offset + box.width - 1, box.y_offset + box.height - 1
    cv2.rectangle(image, place(box.x_offset, box.y_offset), place(*far), RED, 2)
    middle, radius = place(ball.circle_center.x, ball.circle_center.y), ball.circle_radius * times
    cv2.circle(image, middle, round(radius), YELLOW, 2, cv2.LINE_AA)
    outline = np.array([place(point.x, point.y) for point in ball.outline], np.int32)
    cv2.polylines(image, [outline], True, nodes.GREEN, 2)
    end = ball.center.x + ball.velocity.x / 4.0, ball.center.y + ball.velocity.y / 4.0
    center = place(ball.center.x, ball.center.y)
    cv2.arrowedLine(image, center, place(*end), (255, 255, 255), 2, cv2.LINE_AA, 0, 0.15)
    cv2.circle(image, center, 5, (255, 255, 255), -1, cv2.LINE_AA)
    speed = np.hypot(ball.velocity.x, ball.velocity.y)
    legend = [
        (f"label: {ball.label}, id: {ball.id}, score: {ball.score:.2f}", BLACK),
        (f"box: {box.width}x{box.height} px", RED),
        (f"circle_center, circle_radius: {ball.circle_radius:.1f} px", (0, 120, 150)),
        (f"outline: {len(ball.outline)} points", (0, 130, 0)),
        (f"center; velocity: {speed:.0f} px/s, of which the arrow is a quarter of a second", BLACK),
    ]
    texts = np.full((20 * len(legend) + 8, image.shape[1], 3), 255, np.uint8)
    for row, (text, tone) in enumerate(legend):
        write(texts, text, (6, 20 * row + 18), tone)
    return np.vstack([image, texts])


def pick_color(stage: Stage) -> np.ndarray:
    image = room().render(FRAME)
    ball = next(one for one in room().truth(FRAME).objects if one.name == "ball")
    x, y = (round(value) for value in ball.center)
    hsv = to_hsv(tuple(image[y, x].tolist()))
    chosen = range_around(hsv)
    marked = image.copy()
    cv2.drawMarker(marked, (x, y), nodes.GREEN, cv2.MARKER_CROSS, 40, 2)
    captions = [f"--at {x} {y}: HSV {hsv}", f"low {chosen.low}, high {chosen.high}"]
    return beside([marked, hsv_mask(image, chosen)], captions)


def markers(stage: Stage) -> np.ndarray:
    made: List[np.ndarray] = []
    what: Sequence[Sequence[str]] = (
        ["-s", "4", "0-11"],
        ["-s", "3", "http://wiki.ros.org"],
        ["--charuco", "5x7"],
    )
    for number, words in enumerate(what):
        path = stage.folder / f"marker{number}.png"
        process = stage.start("create_marker.py", "--dpi", 300, "-o", path, *words)
        assert process.exit_code() == 0, process.output()
        made.append(cv2.imread(str(path)))
    gray = {"borderType": cv2.BORDER_CONSTANT, "value": (120, 120, 120)}
    sheet, board = (cv2.copyMakeBorder(page, 4, 4, 4, 4, **gray) for page in made[::2])
    cells = [fitted(sheet, 240, 340), fitted(made[1], 150, 340), fitted(board, 240, 340)]
    captions = ["create_marker.py -s 4 0-11", "-s 3 http://...", "--charuco 5x7"]
    return joined([captioned(cell, text) for cell, text in zip(cells, captions)], axis=1)


def parameters(stage: Stage) -> np.ndarray:
    """What one parameter does."""
    shown, captions = [], []
    for high in (30, 100, 300):
        setting = [f"_high_threshold:={high}.0", f"_low_threshold:={high / 2}"]
        shown.append(stage.drawn("edge_detector_node", room(), [FRAME], *setting))
        captions.append(f"high_threshold {high}")
    return beside(shown, captions)
