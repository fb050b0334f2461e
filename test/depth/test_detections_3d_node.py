"""The node detections_3d: what it publishes of a frame, and what it cannot use."""

import itertools
import math
import re

import numpy as np
import pytest
import rosgraph
import rospy
import support
from diagnostic_msgs.msg import DiagnosticStatus
from frames import Source, message, new_topic, pixels
from geometry_msgs.msg import Point
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

import robot_vision as rv
from robot_vision.depth import detection_places
from robot_vision.depth.depth_overlay import depth_colors, draw_places
from robot_vision.msg import Detection, Detection3DArray, DetectionArray
from robot_vision.ros.messages import box_detection, corners, points

WIDTH, HEIGHT = 160, 120
K = [150.0, 0.0, 79.5, 0.0, 150.0, 59.5, 0.0, 0.0, 1.0]
D = [-0.1, 0.02, 0.0, 0.0, 0.0]
CAMERA = rv.CameraModel(WIDTH, HEIGHT, K, D, "plumb_bob")
FACE_BOX, HOLE_BOX = (40, 30, 24, 30), (100, 60, 20, 20)
METRES = np.full((HEIGHT, WIDTH), 2.5, np.float32)
METRES[30:60, 40:64] = 1.2
METRES[60:80, 100:120] = float("nan")
MILLIMETRES = (np.nan_to_num(METRES) * 1000).astype(np.uint16)
OUTPUTS = {
    "/places/detections": Detection3DArray,
    "/places/markers": MarkerArray,
    "/tf": TFMessage,
    "/places/processed_image": Image,
}


def face(number=3, box=FACE_BOX, **values):
    made = box_detection(box, "face", number, 0.75)
    for name, value in values.items():
        setattr(made, name, value)
    return made


def info_of_camera():
    return CameraInfo(width=WIDTH, height=HEIGHT, distortion_model="plumb_bob", D=D, K=K)


class Watched:
    """A depth camera and a detector, the node behind them, and what it publishes."""

    def __init__(self, start, *arguments, outputs=("/places/detections",)):
        topic = new_topic()
        self.depth, self.found = Source(topic), Source(topic + "/found", DetectionArray)
        self.infos = Source(topic.rpartition("/")[0] + "/camera_info", CameraInfo)
        self.info = info_of_camera()
        words = f"depth:={topic}", f"detections:={self.found.topic}", "_diagnostic_period:=0.02"
        self.process = start("detections_3d.py", "__name:=places", *words, *arguments)
        self.outputs = {}
        for name in outputs:
            self.listen(name)
        self._stamps = (rospy.Time(100 + number, 5) for number in itertools.count())
        if outputs:
            self.wait_for()

    def listen(self, name):
        self.outputs[name] = support.subscribed(name, OUTPUTS[name])

    def wait_for(self, connections=1):
        for source in (self.depth, self.found, self.infos):
            source.wait_for(connections)

    def show(self, found, depth=MILLIMETRES, encoding="16UC1", late=0.0, frames=("eye", "eye")):
        """Sends detections and their depth, which is this much later (s); their stamp."""
        stamp = next(self._stamps)
        self.infos.send(self.info)
        detections = DetectionArray(Header(0, stamp, frames[0]), WIDTH, HEIGHT, found)
        image = message(depth, encoding)
        image.header = Header(0, stamp + rospy.Duration.from_sec(late), frames[1])
        self.depth.send(image)
        self.found.send(detections)
        return stamp

    def stamps_of(self, name):
        """The stamps of what has come on an output."""
        received = list(self.outputs[name].received)
        if name == "/places/markers":
            return {one.markers[0].header.stamp for one in received if one.markers}
        return set(map(support.stamp_of, received))

    def answer(self, found, **options):
        """What the node says of a frame, shown until the calibration is there.

        On each output a result gives way to the next one: it is of a frame that came on all.
        """
        stamps = []

        def answered():
            stamps.append(self.show(found, **options))
            come = set.intersection(*map(self.stamps_of, self.outputs))
            return [stamp for stamp in stamps if stamp in come]

        array = self.outputs["/places/detections"].of(support.wait_for(answered, "places")[-1])
        assert array.header.frame_id == "eye"
        return array

    def shown_until(self, text, *found, **options):
        def told():
            self.show(list(found), **options)
            return text in self.process.output()

        support.wait_for(told, text)

    def refused_until(self, text, diagnostics, *found, **options):
        """Shows depth images until one is counted as refused for this."""

        def refused():
            self.show(list(found), **options)
            return text in diagnostics.value("places", "last error")

        support.wait_for(refused, "the frame to be refused")

    def require_refusal(self, diagnostics, depth_first=True, frames=("eye", "eye")):
        """Sends one frame, and requires that it counts as refused alone."""
        stamp = next(self._stamps)
        detections = DetectionArray(Header(0, stamp, frames[0]), WIDTH, HEIGHT, [face()])
        image = message(MILLIMETRES, "16UC1")
        image.header = Header(0, stamp, frames[1])
        received, published, refused = settled_counts(diagnostics)
        if depth_first:
            self.depth.send(image)
            alone = (received + 1, published, refused)
            support.wait_for(lambda: counts(diagnostics) == alone, "the depth alone")
            self.found.send(detections)
        else:
            self.found.send(detections)
            self.depth.send(image)
        after = (received + 1, published, refused + 1)
        assert settled_counts(diagnostics, lambda new: new[2] > refused) == after

    def topics(self):
        return f"{self.found.topic} and {self.depth.topic}"


def counts(diagnostics):
    """How many frames the node has received, published and refused."""
    values = {}
    while not values:  # The first status has none.
        values = {one.key: one.value for one in diagnostics.next("places").values}
    return tuple(int(values[f"frames {name}"]) for name in ("received", "published", "refused"))


def settled_counts(diagnostics, condition=lambda _: True):
    """The counts as soon as half a second of statuses has the same ones, which meet a condition.

    A frame may be under way for longer than a status: the node's timer needs no Python.
    """
    last = []

    def settled():
        last.append(counts(diagnostics))
        return last[-25:] == 25 * [last[-1]] and condition(last[-1])

    support.wait_for(settled, "counts that stay")
    return last[-1]


def located(depth, box, outline=None, center=None, radius=0.0, **values):
    params = rv.LocatorParams()
    for name, value in values.items():
        setattr(params, name, value)
    return rv.RegionLocator(CAMERA, params).locate(depth, box, outline, center, radius)


def assert_place(one, expected):
    place = one.pose.pose.position
    assert [place.x, place.y, place.z] == expected.position.tolist()
    turn = one.pose.pose.orientation
    assert (turn.x, turn.y, turn.z, turn.w) == (0, 0, 0, 1) and not one.has_orientation
    covariance = np.reshape(one.pose.covariance, (6, 6))
    assert np.array_equal(covariance[:3, :3], expected.covariance)
    assert np.array_equal(covariance[3:, 3:], np.eye(3) * (math.pi**2 / 3))
    assert not covariance[:3, 3:].any() and not covariance[3:, :3].any()
    assert [one.size.x, one.size.y, one.size.z] == expected.size.tolist()
    assert one.pixels == expected.pixels


@pytest.mark.parametrize(
    "depth, encoding", [(MILLIMETRES, "16UC1"), (MILLIMETRES, "mono16"), (METRES, "32FC1")]
)
def test_places_of_a_frame_field_by_field(start, depth, encoding):
    watched = Watched(start)
    outline = np.array([(44.0, 34.0), (60.0, 36.0), (52.0, 58.0)])
    named = face(-1, label="Zoë", center=Point(50.5, 44.25, 0.0), outline=points(outline))
    hidden = face(4, HOLE_BOX)
    array = watched.answer([face(), named, hidden], depth=depth, encoding=encoding)
    assert array.left_out == 1
    first, second = array.detections
    assert (first.label, first.id, first.score, first.frame_id) == ("face", 3, 0.75, "face_3")
    assert (second.label, second.id, second.frame_id) == ("Zoë", -1, "Zoe_0")
    box = first.box
    assert (box.x_offset, box.y_offset, box.width, box.height) == FACE_BOX
    assert_place(first, located(depth, FACE_BOX, corners(FACE_BOX), (51.5, 44.5)))
    assert_place(second, located(depth, FACE_BOX, outline, (50.5, 44.25)))
    assert first.pose.pose.position.z == pytest.approx(1.2, abs=1e-6)


def test_transforms_markers_and_overlay_are_of_the_same_places(start):
    watched = Watched(start, "_frame_prefix:=arm_", outputs=OUTPUTS)
    array = watched.answer([face(), face(5, (10, 80, 20, 20)), face(3, (70, 90, 20, 20))])
    stamp = array.header.stamp
    assert [one.frame_id for one in array.detections] == ["arm_face_3", "arm_face_5", ""]
    transforms = watched.outputs["/tf"].of(stamp).transforms
    assert [one.child_frame_id for one in transforms] == ["arm_face_3", "arm_face_5"]
    for transform, one in zip(transforms, array.detections):
        assert transform.header.frame_id == "eye"
        moved, place = transform.transform.translation, one.pose.pose.position
        assert (moved.x, moved.y, moved.z) == (place.x, place.y, place.z)
        assert transform.transform.rotation == one.pose.pose.orientation
    boxes = watched.outputs["/places/markers"].received
    (made,) = [one.markers for one in boxes if one.markers[0].header.stamp == stamp]
    assert [one.type for one in made] == [Marker.CUBE, Marker.TEXT_VIEW_FACING] * 3
    assert len({(one.ns, one.id) for one in made}) == 6
    for marker, one in zip(made[::2], array.detections):
        assert marker.pose == one.pose.pose and marker.header.frame_id == "eye"
        assert (marker.scale.x, marker.scale.y) == (one.size.x, one.size.y)
        assert marker.scale.z == 0.005 and one.size.z == 0.0
    distance = np.linalg.norm(located(MILLIMETRES, FACE_BOX).position)
    assert made[1].text == f"face 3: {distance:.2f} m"
    overlay = watched.outputs["/places/processed_image"].of(stamp)
    drawn = depth_colors(MILLIMETRES)
    draw_places(drawn, array.detections)
    assert overlay.encoding == "bgr8" and np.array_equal(pixels(overlay), drawn)


def test_parameters_change_live(start):
    watched = Watched(start)
    (one,) = watched.answer([face()]).detections
    assert_place(one, located(MILLIMETRES, FACE_BOX, corners(FACE_BOX)))
    support.reconfigured("/places", shape="sphere", min_share=0.5, depth_bias=0.001)
    circle = face(circle_center=Point(52.0, 45.0, 0.0), circle_radius=10.0)
    (one,) = watched.answer([circle]).detections
    values = {"shape": "sphere", "min_share": 0.5}
    outline = corners(FACE_BOX)
    expected = located(MILLIMETRES, FACE_BOX, outline, (52.0, 45.0), 10.0, **values)
    assert one.pose.pose.position.z == expected.position[2] > 1.2
    assert one.pose.covariance[14] < expected.covariance[2, 2]
    config = support.reconfigured("/places", shape="cube")
    assert config["shape"] == "sphere"
    watched.process.wait_for_output("stay as they are: shape is cube, must be surface or sphere")


def test_what_is_only_predicted_counts_if_asked_for(start):
    watched = Watched(start)
    found = [face(predicted=True), face(4)]
    array = watched.answer(found)
    assert ([one.id for one in array.detections], array.left_out) == ([4], 0)
    support.reconfigured("/places", predicted=True)
    assert [one.id for one in watched.answer(found).detections] == [3, 4]


def bad_ones():
    """Detections that cannot be used, and what is said of them."""
    none, far = float("nan"), float("inf")
    return [
        (face(7, (500, 2, 8, 8)), "the box is 8x8 at (500, 2), must be in the image of 160x120"),
        (face(7, (3, 3, 0, 0)), "the box is 0x0 at (3, 3), must be in the image of 160x120"),
        (face(7, center=Point(none, 40.0, 0.0)), "a point of the region is (nan, 40), must be"),
        (face(7, circle_radius=far), "the radius is inf, must be from 0 to 1e+07"),
        (face(7, score=none), "the score is nan, must be finite"),
        (face(7, outline=points(np.full((3, 2), far))), "a point of the region is (inf, inf)"),
        (Detection(), "the box is 0x0 at (0, 0), must be"),  # all of it at its default
    ]


@pytest.mark.parametrize("bad, said", bad_ones())
def test_what_cannot_be_used_is_named(bad, said):
    with pytest.raises(ValueError, match=re.escape(said)):
        detection_places.located(rv.RegionLocator(CAMERA), MILLIMETRES, bad)


def test_what_has_no_place_is_left_out_told_and_counted(start):
    watched = Watched(start)
    bad = [one for one, _ in bad_ones()]
    array = watched.answer([face(7, HOLE_BOX), *bad, face()])
    assert ([one.id for one in array.detections], array.left_out) == ([3], 1 + len(bad))
    assert np.isfinite(array.detections[0].pose.covariance).all()
    said = f"left out 'face' 7, 20x20 at (100, 60), of {watched.topics()}: too few depths there; "
    watched.process.wait_for_output(said + "1 since the start")


def test_depth_without_depths_is_told(start):
    watched = Watched(start)
    array = watched.answer([face(), face(4)], depth=0 * MILLIMETRES)
    assert (array.detections, array.left_out) == ([], 2)
    text = f"{watched.depth.topic}: none of the 160x120 pixels has a depth"
    watched.process.wait_for_output(text)


def test_nothing_found_is_published_too(start):
    array = Watched(start).answer([])
    assert (array.detections, array.left_out) == ([], 0)


def test_stamps_that_never_meet_are_told_with_both_topics(start, diagnostics):
    watched = Watched(start)
    said = f"the stamps on {watched.topics()} do not meet: the nearest are 0.25 s apart, must be"
    watched.shown_until(f"{said} at most slop, 0.02 s", face(), late=0.25)

    def is_state(late, text):
        watched.show([face()], late=late)
        status = diagnostics.next("places")
        return status.level == DiagnosticStatus.WARN and text in status.message

    support.wait_for(lambda: is_state(0.25, said), "a warning in the diagnostics")
    later = f"what comes on {watched.found.topic} is too late for {watched.depth.topic}: the last"
    support.wait_for(lambda: is_state(5.5, later), "another warning for what comes seconds late")
    assert counts(diagnostics)[1:] == (0, 0)
    assert not watched.outputs["/places/detections"].received
    assert watched.answer([face()], late=0.015).detections
    support.reconfigured("/places", slop=0.3)
    assert watched.answer([face()], late=0.25).detections

    def is_over():  # What is missing is looked at when a depth comes, before what belongs to it.
        watched.show([face()], late=0.25)
        return diagnostics.next("places").level == DiagnosticStatus.OK

    support.wait_for(is_over, "the end of the warning")


def test_a_detector_that_says_nothing_is_told(start, diagnostics):
    watched = Watched(start)
    said = f"no detections on {watched.found.topic} for "  # and how many seconds

    def is_state():
        image = message(MILLIMETRES, "16UC1")
        image.header = Header(0, rospy.Time.now(), "eye")
        watched.infos.send(watched.info)
        watched.depth.send(image)
        status = diagnostics.next("places")
        return status.level == DiagnosticStatus.WARN and said in status.message

    support.wait_for(is_state, "a warning in the diagnostics")
    assert f"no places of detections: {said}" in watched.process.output()
    assert counts(diagnostics)[1:] == (0, 0)
    assert watched.answer([face()]).detections


def test_depth_that_is_not_registered_is_told_with_both_topics(start, diagnostics):
    watched = Watched(start)
    small = np.ascontiguousarray(MILLIMETRES[:60, :80])
    watched.shown_until("do not fit", face(), depth=small)
    said = f"{watched.topics()} do not fit: the detections are of an image of 160x120, the depth of"
    assert f"{said} 80x60: the depth has to be registered" in watched.process.output()
    watched.refused_until(f"{said} 80x60", diagnostics, face(), depth=small)
    assert not watched.outputs["/places/detections"].received
    assert watched.answer([face()]).detections


def test_depth_of_another_frame_is_told_and_no_name_is_none(start):
    watched = Watched(start)
    watched.shown_until("do not fit", face(), frames=("eye", "other_eye"))
    text = "the detections are in the frame 'eye', the depth in 'other_eye', its camera_info in ''"
    assert text in watched.process.output()
    assert watched.answer([face()], frames=("", "eye")).detections
    assert watched.answer([face()], frames=("eye", "")).detections


@pytest.mark.parametrize("depth_first", [False, True])
def test_depth_that_does_not_fit_is_counted_whichever_comes_first(start, diagnostics, depth_first):
    watched = Watched(start)
    assert watched.answer([face()]).detections
    watched.outputs["/places/detections"].of(watched.show([face()]))  # None is under way then.
    watched.require_refusal(diagnostics, depth_first, frames=("eye", "other_eye"))


def test_rectified_images_have_the_camera_of_p(start):
    watched = Watched(start, "_rectified:=true")
    watched.info.P = [120.0, 0.0, 70.0, 0.0, 0.0, 120.0, 55.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    rectified = rv.CameraModel(WIDTH, HEIGHT, np.reshape(watched.info.P, (3, 4))[:, :3])
    (one,) = watched.answer([face()]).detections
    locator = rv.RegionLocator(rectified)
    assert_place(one, locator.locate(MILLIMETRES, FACE_BOX, corners(FACE_BOX)))
    support.reconfigured("/places", rectified=False)
    (one,) = watched.answer([face()]).detections
    assert_place(one, located(MILLIMETRES, FACE_BOX, corners(FACE_BOX)))


def spoil_size(info):
    info.width = 80


def spoil_k(info):
    info.K = [0.0] * 9


@pytest.mark.parametrize(
    "spoil, said",
    [
        (spoil_size, "camera_info is of 80x120, the image 160x120"),
        (spoil_k, "the camera is not calibrated"),
    ],
)
def test_a_calibration_that_does_not_fit_is_told(start, diagnostics, spoil, said):
    watched = Watched(start)
    spoil(watched.info)
    watched.shown_until(said, face())
    output = watched.process.output()
    assert f"no places of detections: camera_info on {watched.infos.topic}: {said}" in output
    watched.refused_until(said, diagnostics, face())
    watched.require_refusal(diagnostics)
    watched.info = info_of_camera()
    assert watched.answer([face()]).detections


@pytest.mark.parametrize(
    "depth, encoding",
    [
        (np.zeros((HEIGHT, WIDTH, 3), np.uint8), "bgr8"),
        (MILLIMETRES, "bayer_rggb16"),
    ],
)
def test_images_that_are_no_depths_are_refused_and_counted(start, depth, encoding):
    watched = Watched(start)
    said = f"the encoding of a depth image is '{encoding}', must be 16UC1 (mm) or 32FC1 (m)"
    watched.shown_until(said, face(), depth=depth, encoding=encoding)
    start_of_line = f"refused a frame on {watched.depth.topic} ({encoding}, 160x120): "
    assert start_of_line + said in watched.process.output()
    diagnostics = support.Diagnostics()
    support.wait_for(lambda: said in diagnostics.value("places", "last error"), "the last error")
    assert watched.answer([face()]).detections


def subscribed_topics():
    """The topics that the node subscribes to, and the one of roscpp in its process."""
    state = rosgraph.Master("/test").getSystemState()[1]
    return {topic for topic, nodes in state if any(name.startswith("/places") for name in nodes)}


def test_it_subscribes_while_somebody_wants_what_it_publishes(start):
    watched = Watched(start, "_publish_tf:=false", outputs=())
    inputs = {watched.depth.topic, watched.found.topic, watched.infos.topic}
    transforms = support.subscribed("/tf", TFMessage)  # which does not count
    assert not subscribed_topics() & inputs
    for name in ("/places/detections", "/places/markers", "/places/processed_image"):
        output = support.subscribed(name, OUTPUTS[name])
        watched.wait_for()
        assert inputs <= subscribed_topics()
        output.close()
        watched.wait_for(0)
    support.reconfigured("/places", publish_tf=True)
    watched.wait_for()
    watched.listen("/places/detections")
    watched.outputs["/tf"] = transforms
    stamp = watched.answer([face()]).header.stamp
    assert transforms.of(stamp).transforms[0].child_frame_id == "face_3"


def test_a_camera_info_of_another_name(start):
    other = Source("/elsewhere/info", CameraInfo)
    watched = Watched(start, f"camera_info:={other.topic}", outputs=())
    watched.listen("/places/detections")
    for source in (watched.depth, watched.found, other):
        source.wait_for()
    other.send(info_of_camera())
    watched.infos = other
    assert watched.answer([face()]).detections


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("shape", "cube", "shape is cube, must be surface or sphere"),
        ("slop", -1.0, "slop is -1, must be from 0 to 2"),
        ("min_pixels", 0, "min_pixels is 0, must be from 1 to 1e+06"),
        ("frame_prefix", 7, "frame_prefix is 7, must be a string"),
        ("frame_prefix", "a\nb", "frame_prefix is 'a\\nb', must be empty or a name of 1 to 255"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "detections_3d.py", name, value, text)
