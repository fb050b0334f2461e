"""The node tabletop: its topics field by field, what is up by tf, and what it cannot use."""

import io
import re
import struct

import cv2
import numpy as np
import pytest
import rosgraph
import rospy
import support
from calibrated_camera import CalibratedCamera, info_of, not_calibrated
from frames import Source, message, new_topic, pixels
from geometry_msgs.msg import Quaternion, TransformStamped
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from table_world import AXES, BOXES, TABLE, UP, Box, box_pose, camera_of, render_depth, table_pose
from tag_studio import angle_between, matrix_of
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

import robot_vision as rv
from robot_vision.common.rotations import quaternion_of
from robot_vision.depth.depth_overlay import depth_gray
from robot_vision.depth.depth_range import within
from robot_vision.depth.table_markers import markers
from robot_vision.depth.table_messages import object_array, table_array
from robot_vision.depth.table_overlay import draw_tables
from robot_vision.msg import Detection3DArray, TableArray

CAMERA = camera_of(160)
TOPICS = {
    "tables": TableArray,
    "objects": Detection3DArray,
    "markers": MarkerArray,
    "processed_image": Image,
}
SMALL = "_min_pixels:=30"  # of images that are small
METRES = render_depth(CAMERA, floor=None)
MILLIMETRES = np.rint(np.nan_to_num(METRES) * 1000.0).astype(np.uint16)


def found_by_core(depth, up=(0.0, 0.0, 0.0), camera=CAMERA, farthest=5.0):
    params = rv.TabletopParams()
    params.min_pixels = 30
    return rv.TabletopFinder(camera, rv.PlaneParams(), params).find(within(depth, farthest), up)


def raw(message):
    """The bytes of a message, by which lists are what tuples are."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


class Kitchen:
    """A depth camera above a table, and what the node says of its images."""

    def __init__(self, start, *arguments, info=None, topics=("tables",)):
        self.camera = CalibratedCamera(10.0, info or info_of(CAMERA))
        self.infos = self.camera.topic.replace("image", "camera_info")
        words = "__name:=tabletop", f"image:={self.camera.topic}", SMALL
        self.process = start("tabletop.py", *words, "_diagnostic_period:=0.02", *arguments)
        self.topics = {
            name: support.subscribed(f"/tabletop/{name}", TOPICS[name]) for name in topics
        }
        self.camera.wait_for()

    def answers(self, depth=METRES, encoding="32FC1"):
        """All that is said of an image; shown until camera_info is there, which may come later."""
        stamps = []

        def answered():
            stamps.append(self.camera.show(depth, encoding).stamp)
            said = [self.said(name) for name in self.topics]
            return [stamp for stamp in stamps if all(stamp in of_topic for of_topic in said)]

        stamp = support.wait_for(answered, "all that is said of an image")[-1]
        return {name: self.said(name)[stamp] for name in self.topics}

    def said(self, name):
        """The messages of a topic by their stamps; markers of nothing have none."""
        received = self.topics[name].received
        if name == "markers":
            return {one.markers[0].header.stamp: one for one in received if one.markers}
        return {support.stamp_of(one): one for one in received}

    def shown_until(self, text, depth=METRES, encoding="32FC1", level="WARN"):
        """Shows an image until something is told, and returns the line."""

        def told():
            self.camera.show(depth, encoding)
            return re.findall(f".*{level}.*{re.escape(text)}.*", self.process.output())

        return support.wait_for(told, text)[0]


def place_in_tf():
    """Says on /tf_static how the camera's frame `eye` is turned in the frame `base`."""
    transform = TransformStamped(child_frame_id="eye")
    transform.header.frame_id = "base"
    transform.transform.rotation = Quaternion(*quaternion_of(AXES.T).tolist())
    publisher = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
    publisher.publish(TFMessage([transform]))
    return publisher


@pytest.mark.parametrize(
    "depth, encoding", [(METRES, "32FC1"), (MILLIMETRES, "16UC1"), (MILLIMETRES, "mono16")]
)
def test_all_topics_of_an_image(start, depth, encoding):
    kitchen = Kitchen(start, topics=TOPICS)
    found = kitchen.answers(depth, encoding)
    tables, labels = found_by_core(depth)
    header = found["tables"].header
    for name in ("tables", "objects", "processed_image"):
        of = found[name].header
        assert (of.stamp, of.frame_id) == (header.stamp, "eye")
    (table,) = found["tables"].tables
    table.header.seq = header.seq = 0  # rospy counts in it
    assert raw(table) == raw(*table_array(header, tables).tables)
    pose = matrix_of(table.pose)
    assert np.linalg.norm(pose[:3, 3] - table_pose()[:3, 3]) < 0.02
    assert angle_between(pose, table_pose()) < 1.0
    assert len(table.convex_hull) >= 4 and all(corner.z == 0.0 for corner in table.convex_hull)
    things = found["objects"].detections
    of_core = object_array(header, tables, CAMERA, rv.PlaneParams()).detections
    assert list(map(raw, things)) == list(map(raw, of_core)) and len(things) == len(BOXES)
    for box in BOXES:
        places = [matrix_of(one.pose.pose)[:3, 3] for one in things]
        assert min(np.linalg.norm(place - box_pose(box)[:3, 3]) for place in places) < 0.02
    shown = {(one.ns, one.id): one for one in found["markers"].markers}
    for one in markers(header, tables).markers:
        same = shown.pop((one.ns, one.id))
        assert (same.header.stamp, same.header.frame_id) == (header.stamp, "eye")
        for field in ("type", "pose", "scale", "points", "text"):
            assert getattr(same, field) == getattr(one, field), field
    assert not shown
    overlay = depth_gray(depth, 5.0)
    draw_tables(overlay, tables, labels, CAMERA)
    assert np.array_equal(pixels(found["processed_image"]), overlay)


def test_a_vertical_frame_tells_what_is_up(start):
    depth = render_depth(CAMERA)  # above a floor, which has more pixels
    kitchen = Kitchen(start, "_vertical_frame:=base", "_publish_tf:=true", "_table_frame_id:=desk")
    transforms = support.subscribed("/tf", TFMessage)
    said = "no transform from the vertical_frame 'base' to its frame 'eye', expected on /tf_static"
    line = kitchen.shown_until(said, depth, level="ERROR")
    assert f"refused a frame on {kitchen.camera.topic} (32FC1, 160x120): " in line
    assert not kitchen.topics["tables"].received
    publisher = place_in_tf()

    def placed():  # Of a frame one of them may not come: it gives way to the next one.
        kitchen.answers(depth)
        said = kitchen.said("tables")
        came = ((support.stamp_of(one), one.transforms) for one in transforms.received)
        return [(said[stamp], frames) for stamp, frames in came if stamp in said]

    answer, frames = support.wait_for(placed, "tables and their transforms")[0]
    tables, _ = found_by_core(depth, UP)
    assert len(answer.tables) == len(tables) == 2
    pose = matrix_of(answer.tables[0].pose)
    assert np.linalg.norm(pose[:3, 3] - table_pose()[:3, 3]) < 0.02
    assert [one.child_frame_id for one in frames] == ["desk_0", "desk_1"]
    for one, table in zip(frames, answer.tables):
        assert one.header.frame_id == "eye"
        assert np.allclose(matrix_of(one.transform), matrix_of(table.pose))

    support.reconfigured("/tabletop", max_tables=1, publish_tf=False)
    (highest,) = kitchen.answers(depth)["tables"].tables
    assert np.allclose(matrix_of(highest.pose), pose)
    support.reconfigured("/tabletop", max_tables=4, max_distance=1.3)
    (near,) = kitchen.answers(depth)["tables"].tables  # the floor is farther
    assert np.linalg.norm(matrix_of(near.pose)[:3, 3] - pose[:3, 3]) < 0.05
    support.reconfigured("/tabletop", max_distance=5.0, vertical_frame="")
    (largest,) = kitchen.answers(depth)["tables"].tables
    assert (matrix_of(largest.pose)[:3, 3] - pose[:3, 3]) @ UP < -0.5
    silent = {one.header.stamp for one in (highest, near, largest)}
    assert not silent & set(map(support.stamp_of, transforms.received))
    config = support.reconfigured("/tabletop", max_height=0.005)
    assert config["max_height"] == 0.6
    kitchen.process.wait_for_output("max_height is 0.005, must be above min_height, 0.01")
    publisher.unregister()


def test_without_a_transform_all_frames_are_refused(start, diagnostics):
    kitchen = Kitchen(start, "_vertical_frame:=base")
    said = "no transform from the vertical_frame 'base' to its frame 'eye'"
    kitchen.shown_until(said, level="ERROR")

    def count(of):
        return int(diagnostics.value("tabletop", f"frames {of}"))

    refused_before = count("refused")

    def refused():
        kitchen.camera.show(METRES, "32FC1")
        return count("refused") > refused_before + 2

    support.wait_for(refused, "frames to be refused")
    assert count("published") == 0  # of those that waited for a transform, too
    assert said in diagnostics.value("tabletop", "last error")
    publisher = place_in_tf()
    assert kitchen.answers()["tables"].tables
    publisher.unregister()


def test_transforms_need_a_frame_id(start):
    kitchen = Kitchen(start, "_publish_tf:=true")
    transforms = support.subscribed("/tf", TFMessage)
    kitchen.answers()
    nameless = message(METRES, "32FC1")
    nameless.header.stamp = rospy.Time(5000)
    kitchen.camera.send(nameless)
    assert kitchen.topics["tables"].of(nameless.header.stamp).tables
    kitchen.process.wait_for_output(
        f"no transforms: the images of {kitchen.camera.topic} have no frame_id"
    )
    support.wait_for(lambda: transforms.received, "a transform")
    frames = [one for sent in transforms.received for one in sent.transforms]
    assert frames and all(one.header.frame_id == "eye" for one in frames)


def test_rectified_images_have_the_camera_of_p(start):
    matrix = np.diag([0.8, 0.8, 1.0]) @ CAMERA.K  # another one, of which planes are planes as well
    raw_camera = rv.CameraModel(CAMERA.width, CAMERA.height, matrix, [-0.01, 0.0, 0.0, 0.0])
    info = info_of(raw_camera)
    info.P = np.column_stack([CAMERA.K, np.zeros(3)]).ravel().tolist()
    kitchen = Kitchen(start, "_rectified:=true", info=info)
    (table,) = kitchen.answers()["tables"].tables
    assert np.linalg.norm(matrix_of(table.pose)[:3, 3] - table_pose()[:3, 3]) < 0.02
    kitchen.camera.info = info_of(raw_camera)
    kitchen.shown_until(f"camera_info on {kitchen.infos}: the camera is not calibrated for rect")
    support.reconfigured("/tabletop", rectified=False)
    (wrong,) = kitchen.answers()["tables"].tables
    assert np.linalg.norm(matrix_of(wrong.pose)[:3, 3] - table_pose()[:3, 3]) > 0.05


def test_compressed_depths_are_taken(start):
    topic = new_topic()
    images = Source(f"{topic}/compressedDepth", CompressedImage)
    infos = Source(topic.replace("image", "camera_info"), CameraInfo)
    words = f"image:={topic}", "_image_transport:=compressedDepth", SMALL
    start("tabletop.py", "__name:=tabletop", *words)
    tables = support.subscribed("/tabletop/tables", TableArray)
    images.wait_for()
    infos.wait_for()
    png = cv2.imencode(".png", MILLIMETRES)[1].tobytes()
    compressed = CompressedImage(format="16UC1; compressedDepth png")
    compressed.data = struct.pack("<iff", 0, 0.0, 0.0) + png

    def answered():
        infos.send(info_of(CAMERA))
        images.send(compressed)
        return tables.received

    (table,) = support.wait_for(answered, "tables")[0].tables
    assert np.linalg.norm(matrix_of(table.pose)[:3, 3] - table_pose()[:3, 3]) < 0.02


def spoil_size(info):
    info.width, info.height = 32, 24


def spoil_k(info):
    info.K = [0.0] * 9


def spoil_lens(info):
    info.distortion_model = "magic"


@pytest.mark.parametrize(
    "spoil, said",
    [
        (spoil_size, "camera_info is of 32x24, the image 160x120"),
        (spoil_k, "the camera is not calibrated"),
        (spoil_lens, "distortion_model is 'magic', must be plumb_bob"),
    ],
)
def test_calibrations_that_cannot_be_are_named(start, diagnostics, spoil, said):
    info = info_of(CAMERA)
    spoil(info)
    kitchen = Kitchen(start, info=info)
    shown = support.subscribed("/tabletop/processed_image", Image)
    line = kitchen.shown_until(said)
    assert f"no tables: camera_info on {kitchen.infos}: " in line
    header = kitchen.camera.show(METRES, "32FC1")
    expected = not_calibrated(depth_gray(METRES, 5.0))
    assert np.array_equal(pixels(shown.of(header.stamp)), expected)
    assert not kitchen.topics["tables"].received
    support.wait_for(
        lambda: said in diagnostics.value("tabletop", "last error"), "the frame to be refused"
    )
    assert int(diagnostics.value("tabletop", "frames refused")) > 0
    assert "ERROR" not in kitchen.process.output()
    kitchen.camera.info = info_of(CAMERA)
    assert len(kitchen.answers()["tables"].tables) == 1


def test_a_calibration_that_does_not_come_is_named(start):
    kitchen = Kitchen(start)
    kitchen.camera.show = super(CalibratedCamera, kitchen.camera).show
    kitchen.shown_until(f"no tables: camera_info on {kitchen.infos}: there is none")


@pytest.mark.parametrize(
    "image, encoding",
    [
        (np.zeros((120, 160, 3), np.uint8), "bgr8"),
        (np.zeros((120, 160), np.uint16), "bayer_rggb16"),
        (np.zeros((120, 160), np.float64), "64FC1"),
        (np.zeros((120, 160, 3), np.float32), "32FC3"),
    ],
)
def test_images_that_are_no_depths_are_refused_and_counted(start, diagnostics, image, encoding):
    kitchen = Kitchen(start)
    said = f"the encoding of a depth image is '{encoding}', must be 16UC1 (mm) or 32FC1 (m)"
    line = kitchen.shown_until(said, image, encoding, "ERROR")
    assert f"refused a frame on {kitchen.camera.topic} ({encoding}, 160x120): " in line
    support.wait_for(
        lambda: int(diagnostics.value("tabletop", "frames refused")) > 0, "the refusal"
    )
    assert len(kitchen.answers()["tables"].tables) == 1


@pytest.mark.parametrize(
    "depth, encoding, said",
    [
        (0 * MILLIMETRES, "16UC1", "none of the 160x120 pixels has a depth"),
        (np.full_like(METRES, np.nan), "32FC1", "none of the 160x120 pixels has a depth"),
        (np.full_like(METRES, np.inf), "32FC1", "none of the 160x120 pixels has a depth"),
        (1000 * METRES, "32FC1", "m by the encoding 32FC1, expected 0.05 to 200 m: are the"),
        (MILLIMETRES // 1000, "16UC1", "mm by the encoding 16UC1, expected 0.05 to 30 m: are the"),
    ],
)
def test_odd_depths_are_told_and_have_no_tables(start, depth, encoding, said):
    kitchen = Kitchen(start, topics=("tables", "objects"))
    line = kitchen.shown_until(said, depth, encoding)
    assert f"{kitchen.camera.topic}: " in line
    answer = kitchen.answers(depth, encoding)
    assert answer["tables"].tables == [] and answer["objects"].detections == []
    assert len(kitchen.answers()["tables"].tables) == 1


def test_images_with_holes_have_no_numbers_that_are_none(start):
    spoilt = METRES.copy()
    spoilt[::7] = np.nan
    spoilt[3::7] = -np.inf
    spoilt[:, ::11] = 1e30
    spoilt[:, 5::11] = -1.0
    kitchen = Kitchen(start, topics=TOPICS)
    found = kitchen.answers(spoilt)
    assert len(found["tables"].tables) == 1
    for name in ("tables", "objects", "markers"):
        assert not re.search(r"\b(nan|inf)\b", str(found[name])), name


@pytest.mark.parametrize("transforms", ["_publish_tf:=false", "_publish_tf:=true"])
def test_it_subscribes_while_somebody_subscribes(start, transforms):
    """What it hears of its own transforms does not count as somebody."""
    kitchen = Kitchen(start, "_vertical_frame:=base", transforms)
    publisher = place_in_tf()
    kitchen.answers(render_depth(CAMERA))
    own = {kitchen.camera.topic, kitchen.infos, "/tf", "/tf_static"}

    def subscriptions():
        state = rosgraph.Master("/test").getSystemState()[1]
        ours = {"/tabletop", "/tabletop_images"}
        return {topic for topic, nodes in state if ours & set(nodes)}

    assert subscriptions() >= own
    kitchen.topics.pop("tables").close()
    support.wait_for(lambda: not subscriptions() & own, "the end of the subscriptions")
    kitchen.topics["tables"] = support.subscribed("/tabletop/tables", TableArray)
    kitchen.camera.wait_for()
    assert kitchen.answers(render_depth(CAMERA))["tables"].tables
    publisher.unregister()


def test_what_is_too_small_is_left_out_live(start):
    kitchen = Kitchen(start, topics=("tables", "objects"))
    world = render_depth(CAMERA, [*BOXES, Box(0.0, -0.2, (0.05, 0.05, 0.04))], floor=None)
    assert len(kitchen.answers(world)["objects"].detections) == 3
    support.reconfigured("/tabletop", min_height=0.06)
    assert len(kitchen.answers(world)["objects"].detections) == 2
    support.reconfigured("/tabletop", min_table_area=0.9 * TABLE[0] * TABLE[1])
    assert len(kitchen.answers(world)["tables"].tables) == 1
    support.reconfigured("/tabletop", min_table_area=1.1 * TABLE[0] * TABLE[1])
    assert kitchen.answers(world)["tables"].tables == []


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("max_distance", 0.0, "max_distance is 0, must be from 0.1 to 100"),
        ("max_height", 0.005, "max_height is 0.005, must be above min_height, 0.01"),
        ("max_tables", 0, "max_tables is 0, must be from 1 to 100"),
        ("vertical_frame", "a\nb", "vertical_frame is 'a\\nb', must be empty or a name"),
        ("table_frame_id", "", "table_frame_id is '', must be a name"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "tabletop.py", name, value, text)


def test_ork_s_clients_can_subscribe(start):
    """A client that knows the messages by another package's name, and by their md5 sum."""

    class TheirTables(TableArray):
        _type = "object_recognition_msgs/TableArray"

    kitchen = Kitchen(start, topics=("objects",))
    theirs = support.Messages("/tabletop/tables", TheirTables)

    def came():
        kitchen.camera.show(METRES, "32FC1")
        return theirs.received and theirs.received[-1].tables

    assert support.wait_for(came, "tables of another name")[0].convex_hull
