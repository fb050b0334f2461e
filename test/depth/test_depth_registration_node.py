"""The node depth_registration: its topics field by field, and what it cannot use."""

import copy
import itertools

import numpy as np
import pytest
import rosgraph
import rospy
import support
from calibrated_camera import of_whole_sensor
from geometry_msgs.msg import TransformStamped
from rgbd_cameras import BASELINE, SIZES, RgbdCameras, depth_to_color, info_of, model_of
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, PointCloud2, PointField
from tf2_msgs.msg import TFMessage

import robot_vision as rv

TOPICS = {"image_raw": Image, "camera_info": CameraInfo, "points": PointCloud2}
WIDTH, HEIGHT = SIZES["rgb"]
COLORS = np.random.default_rng(2).integers(0, 256, (HEIGHT, WIDTH, 3), np.uint8)
METRES = np.full(SIZES["depth"][::-1], 2.0, np.float32)
METRES[10:30, 20:40] = 1.2
METRES[5, 5] = float("nan")
MILLIMETRES = (np.nan_to_num(METRES) * 1000).astype(np.uint16)


def pixels(message):
    kind = {"32FC1": "<f4", "16UC1": "<u2"}[message.encoding]
    assert message.step == message.width * np.dtype(kind).itemsize
    return np.frombuffer(message.data, kind).reshape(message.height, message.width)


def same(a, b):
    """Whether two arrays are equal, and NaN where the other one is."""
    return np.array_equal(np.nan_to_num(a, nan=-1.0), np.nan_to_num(b, nan=-1.0))


def expected_of(depth, rectified=(), **values):
    """What the core makes of a depth image."""
    cameras = [model_of(info_of(camera), camera in rectified) for camera in SIZES]
    params = rv.RegistrationParams()
    for name, value in values.items():
        setattr(params, name, value)
    return rv.DepthRegistration(*cameras, depth_to_color(), params).apply(depth)


class Watched:
    """The cameras, the node behind them, and its topics."""

    def __init__(self, start, *arguments, topics=("image_raw",), placed=True):
        self.cameras = RgbdCameras()
        words = "__name:=registration", *self.cameras.arguments(), "_diagnostic_period:=0.02"
        self.node = f"{self.cameras.namespace}/registration".lstrip("/")  # on /diagnostics
        self.process = start("depth_registration_node", *words, *arguments)
        self.topics = {
            name: support.subscribed(self.cameras.output(name), TOPICS[name]) for name in topics
        }
        if placed:
            self.cameras.place()
        self.cameras.wait_for()

    def show(self, depth, encoding):
        """Sends a depth image after the calibrations; returns its stamp."""
        stamp = self.cameras.next_stamp()
        self.cameras.send_infos()
        self.cameras.send("depth", depth, encoding, stamp)
        return stamp

    def answers(self, depth=MILLIMETRES, encoding="16UC1", color=COLORS):
        """What the node says of a frame, by topics; shown until the calibrations are there."""
        stamps = []

        def answered():
            stamp = self.show(depth, encoding)
            if color is not None:
                self.cameras.send("rgb", color, "bgr8", stamp)
            stamps.append(stamp)
            return any(self.complete(one) for one in stamps)

        support.wait_for(answered, "the answers")
        (stamp,) = [one for one in stamps if self.complete(one)][-1:]
        found = {name: topic.of(stamp) for name, topic in self.topics.items()}
        for message in found.values():
            assert message.header.frame_id == self.cameras.frames["rgb"]
        return found

    def complete(self, stamp):
        return all(stamp in map(support.stamp_of, topic.received) for topic in self.topics.values())


def assert_cloud(cloud, depth, colors=None):
    names = ("x", "y", "z", "rgb") if colors is not None else ("x", "y", "z")
    assert (cloud.width, cloud.height) == (WIDTH, HEIGHT)
    assert (cloud.point_step, cloud.row_step) == (16, 16 * WIDTH)
    assert not cloud.is_bigendian and not cloud.is_dense
    fields = [(field.name, field.offset, field.datatype, field.count) for field in cloud.fields]
    assert fields == [(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate(names)]
    words = np.frombuffer(cloud.data, "<f4").reshape(HEIGHT, WIDTH, 4)
    maker = rv.DepthPoints(model_of(info_of("rgb")))
    assert same(words[:, :, :3], maker.points(depth))
    if colors is not None:
        packed = np.frombuffer(cloud.data, "<u4").reshape(HEIGHT, WIDTH, 4)[:, :, 3]
        blue, green, red = np.moveaxis(colors.astype(np.uint32), 2, 0)
        assert np.array_equal(packed, red << 16 | green << 8 | blue)


@pytest.mark.parametrize(
    "depth, encoding, published",
    [(MILLIMETRES, "16UC1", "16UC1"), (METRES, "32FC1", "32FC1"), (MILLIMETRES, "mono16", "16UC1")],
)
def test_all_topics_of_a_frame(start, depth, encoding, published):
    watched = Watched(start, topics=TOPICS)
    found = watched.answers(depth, encoding)
    expected = expected_of(depth)
    assert (expected > 0).mean() > 0.9
    image = found["image_raw"]
    assert image.encoding == published and same(pixels(image), expected)
    registered, given = found["camera_info"], info_of("rgb")
    for name in ("width", "height", "distortion_model", "D", "K", "R", "P"):
        assert np.array_equal(getattr(registered, name), getattr(given, name)), name
    assert_cloud(found["points"], expected, COLORS)


def assert_same_camera(registered, given):
    for name in ("width", "height", "binning_x", "binning_y", "D", "K", "P"):
        assert np.array_equal(getattr(registered, name), getattr(given, name)), name


@pytest.mark.parametrize("color", [COLORS, None])
def test_of_binned_pixels_the_camera_info_of_the_whole_sensor_is_known(start, color):
    watched = Watched(start, topics=("image_raw", "camera_info"))
    given = watched.cameras.calibration
    watched.cameras.calibration = {name: of_whole_sensor(info) for name, info in given.items()}
    found = watched.answers(color=color)
    assert same(pixels(found["image_raw"]), expected_of(MILLIMETRES))
    for name in ("width", "height", "binning_x", "binning_y", "D", "K", "P"):
        assert getattr(found["camera_info"], name) == pytest.approx(getattr(given["rgb"], name))


def test_of_binned_pixels_the_camera_info_of_the_images_is_known(start):
    """Also when the camera is set to another binning."""
    watched = Watched(start, topics=("image_raw", "camera_info"))
    cameras = watched.cameras
    given = cameras.calibration["rgb"]
    given.binning_x = given.binning_y = 2

    def known():
        found = watched.answers()
        return same(pixels(found["image_raw"]), expected_of(MILLIMETRES)) and found["camera_info"]

    registered = support.wait_for(known, "the size of the color images")
    assert_same_camera(registered, given)

    coarse = copy.deepcopy(given)
    coarse.width, coarse.height = given.width // 2, given.height // 2
    coarse.binning_x = coarse.binning_y = 4
    coarse.K = (np.diag([0.5, 0.5, 1.0]) @ np.reshape(given.K, (3, 3))).ravel().tolist()
    coarse.P = (np.diag([0.5, 0.5, 1.0]) @ np.reshape(given.P, (3, 4))).ravel().tolist()
    cameras.calibration["rgb"] = coarse

    def known_again():
        registered = watched.answers(color=COLORS[::2, ::2].copy())["camera_info"]
        return registered.binning_x == 4 and tuple(coarse.K) == registered.K and registered

    assert_same_camera(support.wait_for(known_again, "the other size"), coarse)
    node, color = f"{cameras.namespace}/registration", cameras.topic("rgb", "image_raw")
    support.wait_for(lambda: node not in subscriptions(cameras).get(color, []), "its end")


def test_points_without_colors_do_not_wait_for_any(start):
    watched = Watched(start, "_color:=false", topics=("points",))
    assert_cloud(watched.answers(color=None)["points"], expected_of(MILLIMETRES))
    topic = watched.cameras.topic("rgb", "image_raw")
    assert "/registration" not in str(dict(rosgraph.Master("/t").getSystemState()[1]).get(topic))


def test_rectified_images_have_the_camera_of_p(start):
    watched = Watched(start, "_depth_rectified:=true", "_color_rectified:=true")
    found = pixels(watched.answers()["image_raw"])
    assert same(found, expected_of(MILLIMETRES, rectified=SIZES))
    assert not same(found, expected_of(MILLIMETRES))


def test_parameters_and_places_change_live(start):
    watched = Watched(start)
    node = f"{watched.cameras.namespace}/registration"
    watched.answers()
    support.reconfigured(node, max_jump=0.8, threads=3)
    found = pixels(watched.answers()["image_raw"])
    assert same(found, expected_of(MILLIMETRES, max_jump=0.8))
    assert not same(found, expected_of(MILLIMETRES))
    assert support.reconfigured(node, max_jump=2.0)["max_jump"] == 0.8
    watched.process.wait_for_output("stay as they are: max_jump is 2, must be from 0.001 to 1")
    watched.cameras.place(0.0)

    def moved():
        return not same(pixels(watched.answers()["image_raw"]), found)

    support.wait_for(moved, "the other place")


@pytest.fixture
def clock():
    """clock(s) sets the simulated time."""
    rospy.set_param("/use_sim_time", True)
    publisher = rospy.Publisher("/clock", Clock, queue_size=1, latch=True)
    yield lambda seconds: publisher.publish(Clock(clock=rospy.Time(seconds)))
    publisher.unregister()
    rospy.delete_param("/use_sim_time")


def test_what_was_said_before_the_time_went_back_is_forgotten(start, clock):
    watched = Watched(start, placed=False)
    moving = rospy.Publisher("/tf", TFMessage, queue_size=10)

    def placed(seconds, x):
        """Says that the depth camera is at x at a time."""
        transform = TransformStamped(child_frame_id=watched.cameras.frames["depth"])
        transform.header.frame_id = watched.cameras.frames["rgb"]
        transform.header.stamp = rospy.Time(seconds)
        transform.transform.translation.x = x
        transform.transform.rotation.w = 1.0
        moving.publish([transform])

    def shown(seconds, x):
        """What the node makes of a frame at a time when the depth camera is at x."""
        clock(seconds)
        placed(1000, -BASELINE)  # which may come late, when the time has gone back
        placed(seconds, x)
        watched.show(MILLIMETRES, "16UC1")
        received = watched.topics["image_raw"].received
        return pixels(received[-1]) if received else np.zeros(0)

    def expects(depth, *situation):
        support.wait_for(lambda: same(shown(*situation), depth), f"depth of {situation}")

    expects(expected_of(MILLIMETRES), 1000, -BASELINE)
    cameras = [model_of(info_of(camera)) for camera in SIZES]
    expects(rv.DepthRegistration(*cameras, np.eye(4)).apply(MILLIMETRES), 500, 0.0)
    moving.unregister()


def test_cameras_without_frames_are_not_taken_for_one(start):
    watched = Watched(start, placed=False)
    watched.cameras.frames = dict.fromkeys(SIZES, "")
    shown_until(watched, "no transform from its frame '' to '' of ")
    assert not watched.topics["image_raw"].received


def test_a_missing_transform_names_both_frames(start):
    watched = Watched(start, placed=False)
    frames = watched.cameras.frames

    def told():
        watched.show(MILLIMETRES, "16UC1")
        return "no transform" in watched.process.output()

    support.wait_for(told, "what is missing")
    said = f"no transform from its frame '{frames['depth']}' to '{frames['rgb']}' of "
    topic = watched.cameras.topic("rgb", "camera_info")
    assert f"{said}{topic}, expected on /tf_static or /tf" in watched.process.output()
    assert not watched.topics["image_raw"].received
    watched.cameras.place()
    watched.answers()


def without_subscribers(watched):
    """Has nobody subscribe for a while."""
    watched.topics.pop("image_raw").close()
    cameras = watched.cameras
    node = f"{cameras.namespace}/registration"
    support.wait_for(
        lambda: not any(node in nodes for nodes in subscriptions(cameras).values()), "idleness"
    )


def subscribed_again(watched):
    watched.topics["image_raw"] = support.subscribed(watched.cameras.output("image_raw"), Image)
    watched.cameras.wait_for()


def test_what_was_said_of_places_before_is_forgotten(start):
    watched = Watched(start)
    watched.answers()
    without_subscribers(watched)
    watched.cameras.withdraw()
    subscribed_again(watched)
    shown_until(watched, "no transform")
    assert not watched.topics["image_raw"].received


@pytest.mark.parametrize(
    "x, w, said",
    [
        (float("nan"), 1.0, "has a number that is not finite"),
        (float("inf"), 1.0, "has a number that is not finite"),
        (0.0, 0.0, "has a rotation of length 0, must be 1"),
        (0.0, 2.0, "has a rotation of length 2, must be 1"),
    ],
)
def test_a_transform_that_is_none_is_left_out(start, x, w, said):
    watched = Watched(start, placed=False)
    frames = watched.cameras.frames
    watched.cameras.place(x, w)
    shown_until(watched, "no transform from its frame")
    text = f"left out: the transform from '{frames['depth']}' to '{frames['rgb']}' {said}"
    watched.process.wait_for_output(f"/tf_static: {text}")
    assert not watched.topics["image_raw"].received
    watched.cameras.place()
    found = pixels(watched.answers()["image_raw"])
    assert same(found, expected_of(MILLIMETRES))


def shown_until(watched, text, depth=MILLIMETRES, encoding="16UC1"):
    def told():
        watched.show(depth, encoding)
        return text in watched.process.output()

    support.wait_for(told, text)


def spoil_size(info):
    info.width, info.height = 32, 24


def spoil_k(info):
    info.K = [0.0] * 9


def spoil_d(info):
    info.D = [float("inf"), *info.D[1:]]


def spoil_lens(info):
    info.distortion_model = "magic"


@pytest.mark.parametrize(
    "camera, spoil, said",
    [
        ("depth", spoil_size, "the size of the depth image is 64x48, must be 32x24 as of its"),
        ("depth", spoil_k, "K is 0 everywhere, must be that of a calibrated camera"),
        ("rgb", spoil_k, "K is 0 everywhere, must be that of a calibrated camera"),
        ("rgb", spoil_d, "D is inf, must be finite"),
        ("rgb", spoil_lens, "distortion_model is 'magic', must be plumb_bob"),
    ],
)
def test_calibrations_that_cannot_be_are_refused(start, camera, spoil, said):
    watched = Watched(start)
    spoil(watched.cameras.calibration[camera])
    shown_until(watched, said)
    output = watched.process.output()
    image = watched.cameras.topic("depth", "image_raw")
    assert f"refused a frame on {image} (16UC1, 64x48): " in output
    if spoil is not spoil_size:
        assert f"camera_info on {watched.cameras.topic(camera, 'camera_info')}: " in output
    watched.cameras.calibration[camera] = info_of(camera)
    watched.answers()


def test_a_calibration_that_does_not_come_is_named(start):
    watched = Watched(start)
    cameras = watched.cameras
    without_subscribers(watched)
    subscribed_again(watched)
    times, topic = itertools.count(5000), cameras.topic("rgb", "camera_info")

    def told():
        cameras.infos["depth"].send(cameras.calibration["depth"])
        cameras.send("depth", MILLIMETRES, "16UC1", rospy.Time(next(times)))
        return f"nothing has come on {topic}" in watched.process.output()

    support.wait_for(told, "what is missing")


def subscriptions(cameras):
    """The nodes that subscribe to topics of the cameras, by topic."""
    state = rosgraph.Master("/test").getSystemState()[1]
    return {topic: nodes for topic, nodes in state if topic.startswith(cameras.namespace)}


def test_colors_whose_stamps_never_meet_are_told(start, diagnostics):
    watched = Watched(start, "_slop:=0.01", topics=("points",))

    def told():
        stamp = watched.show(MILLIMETRES, "16UC1")
        watched.cameras.send("rgb", COLORS, "bgr8", stamp + rospy.Duration(0.02))
        return "do not meet" in watched.process.output()

    support.wait_for(told, "what is wrong")
    depth, color = (watched.cameras.topic(camera, "image_raw") for camera in SIZES)
    output = watched.process.output()
    assert f" images: the stamps on {depth} and {color} do not meet: " in output
    assert " s, must be at most slop, 0.01 s, apart" in output
    assert not watched.topics["points"].received
    support.wait_for(
        lambda: "do not meet" in diagnostics.value(watched.node, "last error"), "the last error"
    )
    assert diagnostics.value(watched.node, "frames published") == "0"
    stamp = watched.show(MILLIMETRES, "16UC1")
    watched.cameras.send("rgb", COLORS, "bgr8", stamp + rospy.Duration(0.005))
    assert_cloud(watched.topics["points"].of(stamp), expected_of(MILLIMETRES), COLORS)
    support.wait_for(
        lambda: diagnostics.value(watched.node, "frames published") == "1", "the count"
    )


def test_colors_of_another_size_are_refused(start, diagnostics):
    watched = Watched(start, topics=("points",))

    def told():
        stamp = watched.show(MILLIMETRES, "16UC1")
        watched.cameras.send("rgb", np.ascontiguousarray(COLORS[:, 1:]), "bgr8", stamp)
        return "its size is" in watched.process.output()

    support.wait_for(told, "what is wrong")
    color, of_info = (watched.cameras.topic("rgb", name) for name in ("image_raw", "camera_info"))
    said = f"{color} (bgr8, 95x72): its size is 95x72, must be 96x72 as on {of_info}"
    assert said in watched.process.output()
    support.wait_for(
        lambda: int(diagnostics.value(watched.node, "frames refused")) > 0, "the refused ones"
    )
    assert diagnostics.value(watched.node, "frames published") == "0"
    watched.answers()


def test_it_subscribes_while_somebody_subscribes(start):
    watched = Watched(start, topics=("image_raw",))
    cameras = watched.cameras
    watched.answers()
    own = {cameras.topic(camera, "camera_info") for camera in SIZES}
    own.add(cameras.topic("depth", "image_raw"))
    node = f"{cameras.namespace}/registration"
    wanted = {topic for topic, nodes in subscriptions(cameras).items() if node in nodes}
    assert wanted >= own and cameras.topic("rgb", "image_raw") not in wanted
    without_subscribers(watched)


def test_it_is_a_nodelet_in_the_manager_of_the_cameras(start):
    manager = support.NodeletManager(start)
    for name, value in {"source": "synthetic", "views": "rgbd", "camera_name": "rig"}.items():
        rospy.set_param(f"/rig/{name}", value)
    rospy.set_param("/rig/camera_frame_id", "rig_rgb_optical_frame")
    assert manager.load("/rig", "camera")
    topics = ("depth/image_raw", "rgb/image_raw", "depth_registered/points")
    remapped = {f"/{name}": f"/rig/{name}" for name in topics}
    assert manager.load("/registration", "depth_registration", remapped)
    (cloud,) = support.Messages("/rig/depth_registered/points", PointCloud2).wait()
    assert (cloud.header.frame_id, cloud.width, cloud.height) == ("rig_rgb_optical_frame", 640, 480)
    z = np.frombuffer(cloud.data, "<f4").reshape(480, 640, 4)[:, :, 2]
    assert np.isfinite(z).mean() > 0.8
    assert manager.unload("/registration") and manager.process.running()


def test_images_come_over_other_transports(start):
    words = "_camera_name:=far", "_camera_frame_id:=far_rgb_optical_frame"
    size = "_image_width:=160", "_image_height:=120"
    start("camera_node", "__name:=far", "_source:=synthetic", "_views:=rgbd", *words, *size)
    transports = "_depth_image_transport:=compressedDepth", "_image_transport:=compressed"
    start("depth_registration_node", "__name:=registration", "__ns:=/far", *transports)
    (cloud,) = support.Messages("/far/depth_registered/points", PointCloud2).wait()
    z = np.frombuffer(cloud.data, "<f4").reshape(120, 160, 4)[:, :, 2]
    assert np.isfinite(z).mean() > 0.8
    subscribed = dict(rosgraph.Master("/test").getSystemState()[1])
    for topic in ("depth/image_raw/compressedDepth", "rgb/image_raw/compressed"):
        assert "/far/registration" in subscribed[f"/far/{topic}"]
    for camera in SIZES:
        assert "/far/registration" not in subscribed.get(f"/far/{camera}/image_raw", [])


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("max_jump", 0.0, "max_jump is 0, must be from 0.001 to 1"),
        ("threads", 0, "threads is 0, must be from 1 to 64"),
        ("slop", -1.0, "slop is -1, must be from 0 to 10"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "depth_registration_node", name, value, text)
