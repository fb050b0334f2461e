"""What nodes draw on frames of the scene: the images of their pages."""

import concurrent.futures
import subprocess
from typing import Any, Callable, List, Tuple

import cv2
import numpy as np
import rospy
import skimage.data
from canvas import beside
from sensor_msgs.msg import Image, RegionOfInterest
from stage import (
    FRAME,
    IMAGE,
    NOISE,
    Stage,
    color,
    figures,
    listening,
    pixels,
    room,
    support,
    x_server,
)

from robot_vision import CalibrationScene, RoadScene, SceneParams, flow_to_colors
from robot_vision.ros.messages import Box, region_of
from robot_vision.srv import SelectObject
from robot_vision.viewer.channel_view import ChannelView

SEARCH_ALL = "_max_search_period:=0.0"  # each frame, and not in the background
SETTLED = 15  # frames, after which the same frame has the same answer
GREEN = (0, 255, 0)  # BGR, of what is seen
ROAD_FRAME = 250  # in a curve
BOARD_FRAME = 60  # of the calibration scene, with a tilted board


def plain(name: str, stage: Stage) -> np.ndarray:
    """What a Python node draws with its defaults."""
    return stage.drawn(f"{name}.py", room(), [FRAME])


def brightness(stage: Stage) -> np.ndarray:
    shown = [room().render(FRAME)]
    for settings in (["_offset:=50.0"], ["_offset:=0.0", "_gamma:=0.5"]):
        shown.append(stage.drawn("brightness_node", room(), [FRAME], *settings))
    return beside(shown, ["image", "offset 50", "gamma 0.5"])


def edge_detector(stage: Stage) -> np.ndarray:
    edges = stage.drawn("edge_detector_node", room(), [FRAME])
    return beside([room().render(FRAME), edges], ["image", "~processed_image"])


def filter_chain(stage: Stage) -> np.ndarray:
    """What a chain makes of a frame, step by step."""
    shown = [room().render(FRAME)]
    names = ["median", "gray", "clahe", "threshold", "open"]
    for count in range(1, len(names) + 1):
        words = [
            f"_chain:={', '.join(names[:count])}",
            "_threshold_method:=otsu",
            "_median_size:=9",
        ]
        shown.append(stage.drawn("filter_node", room(), [FRAME], *words))
    return beside(shown, ["image", *names], columns=3, width=600)


def contours(stage: Stage) -> np.ndarray:
    dark = "_invert:=true", "_min_area:=500.0"
    edges = "_method:=canny", "_mode:=external", "_min_area:=300.0"
    shown = [stage.drawn("contours.py", room(), [FRAME], *words) for words in (dark, edges)]
    return beside(shown, ["otsu, invert", "canny, external"])


def hough(stage: Stage) -> np.ndarray:
    shown = [stage.drawn("hough.py", room(), [FRAME], "_method:=segments")]
    shown.append(stage.drawn("hough.py", room(), [FRAME], "_max_results:=12"))
    circles = "_circle_method:=gradient_alt", "_canny_high:=300.0", "_dp:=1.5"
    shown.append(stage.drawn("hough.py", room(), [FRAME], "_method:=circles", *circles))
    return beside(shown, ["segments", "lines", "circles (gradient_alt)"])


def dense_flow(stage: Stage) -> np.ndarray:
    arrows = "_draw:=arrows", "_arrow_spacing:=24", "_arrow_scale:=8.0"
    drawn = [second_drawn(stage, *settings) for settings in ((), arrows)]
    y, x = np.mgrid[-240:240, -320:320]
    colors = flow_to_colors(np.dstack([x, y]) / 240, 1.0)
    colors[np.hypot(x, y) > 240] = 255
    captions = ["image", "~processed_image, wheel", "the same, arrows", "directions"]
    return beside([room().render(FRAME), *drawn, colors], captions, columns=2)


def second_drawn(stage: Stage, *settings: str) -> np.ndarray:
    """What dense_flow draws on the second frame, as it says nothing of the first."""
    words = f"image:={IMAGE}", "_diagnostic_period:=0.05", *settings
    node = stage.node("dense_flow_node", "dense_flow", *words)
    answers = listening("/dense_flow/processed_image", Image)
    diagnostics = support.Diagnostics()
    with stage.shown(room()) as camera, node, answers as results:
        camera.wait_for(1)
        camera.show(FRAME - 1)
        support.wait_for(
            lambda: diagnostics.value("dense_flow", "frames received") == "1", "the first frame"
        )
        return pixels(results.of(camera.show(FRAME)))


def spectrum(stage: Stage) -> np.ndarray:
    shown = [room().render(FRAME)]
    for kind, output in (("low", "processed_image"), ("low", "filtered"), ("high", "filtered")):
        words = [f"_filter:={kind}_pass", "_radius:=0.15"]
        shown.append(stage.drawn("spectrum_node", room(), [FRAME], *words, output=output))
    captions = ["image", "~processed_image, low_pass", "~filtered, low_pass", "high_pass"]
    return beside(shown, captions, columns=2)


def hsv_tracker(stage: Stage) -> np.ndarray:
    found = stage.drawn("hsv_tracker.py", room(), [FRAME])
    return beside([room().render(FRAME), found], ["image", "~processed_image"])


def ball_tracker(stage: Stage) -> np.ndarray:
    return stage.drawn("ball_tracker.py", room(), range(FRAME - 85, FRAME - 40))  # one bounce


def line_follower(stage: Stage, width: int = 640, height: int = 480) -> np.ndarray:
    return stage.drawn("line_follower.py", room(width, height), [FRAME], *color("black"))


def small_line_follower(stage: Stage) -> np.ndarray:
    return line_follower(stage, 320, 240)


def lane_detector(stage: Stage) -> np.ndarray:
    road, frames = RoadScene(quiet()), [ROAD_FRAME] * SETTLED
    drawn = [
        stage.drawn("lane_detector.py", road, frames, output=output, infos=1)
        for output in ("processed_image", "birds_eye")
    ]
    return beside(drawn, ["~processed_image", "~birds_eye"])


def cube_overlay(stage: Stage) -> np.ndarray:
    scene, frames = CalibrationScene(quiet()), [BOARD_FRAME] * SETTLED
    drawn = [
        stage.drawn("cube_overlay.py", scene, frames, "_square:=0.05", f"_draw:={kind}", infos=1)
        for kind in ("cube", "axes")
    ]
    return beside(drawn, ["draw:=cube", "draw:=axes"])


def quiet() -> SceneParams:
    """Of a scene with little noise, which takes small files."""
    params = SceneParams()
    params.noise = NOISE
    return params


def motion_detector(stage: Stage) -> np.ndarray:
    return stage.drawn("motion_detector.py", room(still=True), [0, 255])


def code_reader(stage: Stage) -> np.ndarray:
    return stage.drawn("code_reader.py", room(), [FRAME], SEARCH_ALL)


def apriltag_detector(stage: Stage) -> np.ndarray:
    tags = "apriltag_detector.py", room(), [FRAME] * SETTLED, "_tag_size:=0.24", SEARCH_ALL
    return stage.drawn(*tags, infos=1)


def face_detector(stage: Stage) -> np.ndarray:
    with stage.watched("face_detector.py", room(), "_haar_maxSize:=0") as show:
        return when_green(show)


def face_recognizer(stage: Stage) -> np.ndarray:
    person = stage.folder / "gallery" / "Eileen"
    person.mkdir(parents=True)
    for frame in (FRAME - 20, FRAME + 20, FRAME + 40):
        cv2.imwrite(str(person / f"{frame}.png"), room().render(frame))
    words = "face_detector.py", "face_detector", f"image:={IMAGE}", "_haar_maxSize:=0"
    detector = stage.node(*words)
    arguments = f"_gallery:={person.parent}", "faces:=/face_detector/faces"
    recognizer = stage.watched("face_recognizer.py", room(), *arguments, images=2)
    with detector, recognizer as show:
        return when_green(show)


def when_green(show: Callable[[int], Any]) -> np.ndarray:
    """What is drawn when something was found, which the node looks for in the background."""
    support.wait_for(
        lambda: (pixels(show(FRAME)) == GREEN).all(axis=2).any(), "something that is found"
    )
    return [pixels(show(FRAME)) for _ in range(SETTLED)][-1]


def object_tracker(stage: Stage) -> np.ndarray:
    scene, first = room(), FRAME - 60
    poster = next(one for one in scene.truth(first).objects if one.name == "poster")
    x, y, width, height = cv2.boundingRect(np.int32(poster.outline))
    region = region_of((x + 20, y, width - 40, height // 2))
    with stage.watched("object_tracker.py", scene) as show:
        show(first)
        select = rospy.ServiceProxy("/object_tracker/select_object", SelectObject)
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            answer = pool.submit(select, region=region, label="portrait")
            while not answer.done():
                show(first)  # an object is selected in the frame that comes next
        assert answer.result().success, answer.result().message
        return [pixels(show(frame)) for frame in range(first, FRAME, 2)][-1]


def window_tracker(stage: Stage) -> np.ndarray:
    scene, frames = room(400, 300), range(FRAME - 40, FRAME + 1, 2)
    ball = next(one for one in scene.truth(frames[0]).objects if one.name == "ball")
    where = zip(("x", "y", "width", "height"), cv2.boundingRect(np.int32(ball.outline)))
    arguments = [f"_{name}:={value}" for name, value in where]
    with stage.watched("window_tracker.py", scene, *arguments) as show, listening(
        "/window_tracker/back_projection", Image
    ) as projections:
        drawn = [show(frame) for frame in frames][-1]
        projection = projections.of(drawn.header.stamp)
    gray = cv2.cvtColor(pixels(projection), cv2.COLOR_GRAY2BGR)
    return beside([pixels(drawn), gray], ["~processed_image", "~back_projection"])


def segmenter(stage: Stage) -> np.ndarray:
    flat = "_opacity:=1.0", "_paint:=mean", "_outlines:=false"
    outlines = {one.name: np.int32(one.outline) for one in room().truth(FRAME).objects}
    boxes = {name: cv2.boundingRect(outline) for name, outline in outlines.items()}
    seeds = [grown(boxes[name], -0.2) for name in ("ball", "poster", "qr_code", "box", "tag_0")]
    seeds += [(296, 60, 24, 200), (60, 420, 200, 40)]  # on the wall and the floor
    shown = [
        segmented(stage, seeds, "_border:=0"),
        segmented(stage, [grown(boxes["ball"], 0.2)], "_method:=grab_cut"),
        stage.drawn("segmenter_node", room(), [FRAME], "_method:=k_means", "_clusters:=6", *flat),
        stage.drawn(
            "segmenter_node", room(), [FRAME], "_method:=mean_shift", "_color_radius:=30.0", *flat
        ),
    ]
    titles = ["watershed, dragged seeds", "grab_cut, a rectangle"]
    return beside(shown, [*titles, "k_means, 6 clusters", "mean_shift"], columns=2, width=540)


def grown(box: Box, share: float) -> Box:
    """A box with so much of its sides added on each side."""
    x, y, width, height = box
    by_x, by_y = round(share * width), round(share * height)
    return x - by_x, y - by_y, width + 2 * by_x, height + 2 * by_y


def segmented(stage: Stage, boxes: List[Box], *arguments: str) -> np.ndarray:
    """What the segmenter draws with these seeds."""
    seeds = rospy.Publisher("/seeds", RegionOfInterest, queue_size=10)
    with stage.watched("segmenter_node", room(), "~select:=/seeds", *arguments) as show:
        support.wait_for(seeds.get_num_connections, "the node's subscription")
        for box in boxes:
            seeds.publish(region_of(box))
        x, y, width, _ = boxes[-1]
        support.wait_for(
            lambda: (pixels(show(FRAME))[y, x : x + width] == 255).all(), "the last seed"
        )
        seeds.unregister()
        return pixels(show(FRAME))


class Walkers:
    """The room with figures that are taken for people."""

    def __init__(self) -> None:
        self._room = room(portrait=False)
        self.camera = self._room.camera

    def render(self, frame: int) -> np.ndarray:
        image = self._room.render(frame)
        for box in ((185, 105, 160, 320), (375, 185, 120, 240)):
            figures.draw_figure(image, box)
        return image


def people_detector(stage: Stage) -> np.ndarray:
    return stage.drawn("people_detector.py", Walkers(), [FRAME])


def object_detector(stage: Stage) -> np.ndarray:
    """The room when each thing has been found for the second time."""
    return stage.drawn("object_detector.py", room(), [FRAME - 2, FRAME], "_score_threshold:=0.5")


def features(stage: Stage) -> np.ndarray:
    path = stage.folder / "portrait.png"
    cv2.imwrite(str(path), cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2BGR))
    found = ("_match:=reference", f"_reference:={path}", "_detector:=akaze")
    few, many = "_max_features:=150", "_max_features:=2000"
    shown = [
        stage.drawn("features.py", room(), [FRAME], *settings)
        for settings in (["_detector:=orb", few], [*found, many])
    ]
    return beside(shown, ["detector orb", "match reference"])


def template_matcher(stage: Stage) -> np.ndarray:
    """Parts of an earlier frame, found in this one."""
    folder = stage.folder / "templates"
    folder.mkdir()
    early, truth = room().render(FRAME - 10), room().truth(FRAME - 10)
    for name in ("tag_0", "qr_code"):
        outline = next(one.outline for one in truth.objects if one.name == name)
        x, y, width, height = cv2.boundingRect(np.int32(outline))
        cv2.imwrite(str(folder / f"{name}.png"), early[y : y + height, x : x + width])
    words = "template_matcher.py", room(), [FRAME], f"_templates:={folder}", "_threshold:=0.6"
    shown = [stage.drawn(*words, output=output) for output in ("processed_image", "response")]
    return beside(shown, ["~processed_image", "~response"])


def simple_camera_view(stage: Stage) -> np.ndarray:
    scene = room(480, 360)
    image = scene.render(FRAME)
    height, width = image.shape[:2]
    ball = next(one for one in scene.truth(FRAME).objects if one.name == "ball")
    x, y, side_x, side_y = cv2.boundingRect(np.int32(ball.outline))

    def shown() -> np.ndarray:
        return support.screen(screen)[:height, :width]

    viewer = stage.node("simple_camera_view_node.py", "simple_camera_view", f"image:={IMAGE}")
    with x_server(stage) as screen, stage.shown(scene) as camera, viewer:
        camera.wait_for(1)
        xdotool("mousemove", 790, 590)  # or the pointer would be in the image
        camera.show(FRAME)
        support.wait_for(lambda: np.array_equal(shown(), image), "the window")
        number = support.wait_for(lambda: list(support.windows().values()), "its number")[0]
        drag(number, (x - 8, y - 8), (x + side_x + 8, y + side_y + 8))
        support.wait_for(lambda: (shown() == GREEN).all(axis=2).sum() > side_x, "the rectangle")
        return shown().copy()


def color_spaces(_stage: Stage) -> np.ndarray:
    """What the viewer shows with the parameter show at lab."""
    image = room(480, 360).render(FRAME)
    return ChannelView("lab", image.shape[1::-1]).of(image)


def drag(window: str, begin: Tuple[int, int], end: Tuple[int, int]) -> None:
    """Draws a rectangle with the left button, which stays pressed."""
    xdotool("mousemove", "--window", window, *begin)
    xdotool("mousedown", 1)
    for share in (2, 1):
        place = [a + (b - a) // share for a, b in zip(begin, end)]
        xdotool("mousemove", "--window", window, *place)


def xdotool(*words: Any) -> None:
    subprocess.run(["xdotool", *map(str, words)], check=True, stdout=subprocess.DEVNULL)
