"""The node stereo_matcher: its topics field by field, and pairs that cannot be used."""

import itertools

import cv2
import numpy as np
import pytest
import rosgraph
import rospy
import stereo_images
import support
from calibrated_camera import of_whole_sensor
from frames import Source
from ros_programs import ROSLAUNCH
from sensor_msgs.msg import CameraInfo, Image, PointCloud2, PointField
from stereo_cameras import BASELINE, CX, CY, FOCAL, SIDES, StereoCameras, info_of
from stereo_images import HEIGHT, WIDTH, Plane
from stereo_msgs.msg import DisparityImage

import robot_vision as rv
from robot_vision.msg import GroundTruth

LEFT, RIGHT = stereo_images.pair_of(Plane(10.0))
TOPICS = {
    "disparity": DisparityImage,
    "disparity_image": Image,
    "depth": Image,
    "camera_info": CameraInfo,
    "points": PointCloud2,
    "left/image_rect_color": Image,
    "epipolar": Image,
}
FAST = "_disparities:=32"
RECTIFIED = rv.CameraModel(
    WIDTH, HEIGHT, info_of("left").P[:3] + info_of("left").P[4:7] + [0, 0, 1]
)


def pixels(message):
    kind, channels = {
        "32FC1": ("f4", 1),
        "16UC1": ("u2", 1),
        "mono8": ("u1", 1),
        "bgr8": ("u1", 3),
    }[message.encoding]
    assert message.step == message.width * channels * np.dtype(kind).itemsize
    assert not message.is_bigendian
    image = np.frombuffer(message.data, "<" + kind)
    return image.reshape(message.height, message.width, channels).squeeze()


class Watched:
    """A pair of cameras, the node behind it, and its topics."""

    def __init__(self, start, *arguments, topics=TOPICS):
        self.cameras = StereoCameras()
        words = "__name:=stereo", FAST, "_diagnostic_period:=0.02"
        self.process = start("stereo_matcher_node", *words, *self.cameras.arguments(), *arguments)
        self.topics = {name: support.subscribed(f"/stereo/{name}", TOPICS[name]) for name in topics}
        self.cameras.wait_for()

    def answers(self, left=LEFT, right=RIGHT, encoding="mono8"):
        """What the node says of a pair, by topics; all of it has the left image's header."""
        stamp = self.cameras.show(left, right, encoding)
        found = {name: topic.of(stamp) for name, topic in self.topics.items()}
        assert {answer.header.frame_id for answer in found.values()} == {"left_eye"}
        return found


def params(**values):
    made = rv.StereoParams()
    for name, value in {"disparities": 32, **values}.items():
        setattr(made, name, value)
    return made


def disparity_of(left, right, **values):
    return rv.StereoMatcher(params(**values)).match(left, right, "mono8")


def equal(a, b):
    """Whether two arrays are equal, and NaN where the other one is."""
    return np.array_equal(np.isnan(a), np.isnan(b)) and np.array_equal(
        np.nan_to_num(a), np.nan_to_num(b)
    )


def geometry(offset=0.0):
    cameras = (
        rv.RectifiedCamera(
            rv.CameraModel(info.width, info.height, info.K, info.D, info.distortion_model),
            np.reshape(info.R, (3, 3)),
            np.reshape(info.P, (3, 4)),
        )
        for info in (info_of(side, offset) for side in SIDES)
    )
    return rv.StereoCamera(*cameras).geometry


def test_all_topics_of_a_pair(start):
    watched = Watched(start)
    found = watched.answers()
    disparity, of = disparity_of(LEFT, RIGHT), geometry()
    assert np.nanmedian(disparity) == 10.0
    message = found["disparity"]
    assert (message.f, message.T) == pytest.approx((FOCAL, BASELINE))
    assert (message.min_disparity, message.max_disparity) == (0.0, 31.0)
    assert message.delta_d == 1.0 / 16.0
    window = message.valid_window
    assert (window.x_offset, window.y_offset) == (0, 0)
    assert (window.width, window.height) == (WIDTH, HEIGHT)
    image = message.image
    assert (image.header.stamp, image.header.frame_id) == (message.header.stamp, "left_eye")
    assert image.encoding == "32FC1"
    assert np.array_equal(pixels(image), np.nan_to_num(disparity, nan=-1.0))

    colors = rv.disparity_to_colors(disparity, 0.0, 32.0)
    assert np.array_equal(pixels(found["disparity_image"]), colors)

    depth = rv.depth_from_disparity(disparity, of)
    assert found["depth"].encoding == "32FC1" and equal(pixels(found["depth"]), depth)
    assert np.nanmedian(depth) == pytest.approx(FOCAL * BASELINE / 10.0)

    info = found["camera_info"]
    assert (info.width, info.height, info.distortion_model) == (WIDTH, HEIGHT, "plumb_bob")
    assert list(info.D) == [0.0] * 5 and list(info.R) == np.eye(3).ravel().tolist()
    assert list(info.K) == [FOCAL, 0, CX, 0, FOCAL, CY, 0, 0, 1]
    assert list(info.P) == list(info_of("left").P)

    assert_cloud(found["points"], rv.DepthPoints(RECTIFIED).points(depth), LEFT)

    color = cv2.cvtColor(LEFT, cv2.COLOR_GRAY2BGR)
    assert np.array_equal(pixels(found["left/image_rect_color"]), color)

    other = cv2.cvtColor(RIGHT, cv2.COLOR_GRAY2BGR)
    assert np.array_equal(pixels(found["epipolar"]), rv.draw_rectified_pair(color, other))


def assert_cloud(cloud, points, gray):
    assert (cloud.width, cloud.height) == (WIDTH, HEIGHT)
    assert (cloud.point_step, cloud.row_step) == (16, 16 * WIDTH)
    assert not cloud.is_bigendian and not cloud.is_dense
    fields = [(field.name, field.offset, field.datatype, field.count) for field in cloud.fields]
    expected = enumerate(("x", "y", "z", "rgb"))
    assert fields == [(name, 4 * at, PointField.FLOAT32, 1) for at, name in expected]
    words = np.frombuffer(cloud.data, "<f4").reshape(HEIGHT, WIDTH, 4)
    assert equal(words[:, :, :3], points)
    packed = np.frombuffer(cloud.data, "<u4").reshape(HEIGHT, WIDTH, 4)[:, :, 3]
    assert np.array_equal(packed, gray.astype(np.uint32) * 0x010101)


def test_colors_are_rectified_and_packed(start):
    watched = Watched(start, topics=("points", "left/image_rect_color"))
    left = cv2.applyColorMap(LEFT, cv2.COLORMAP_JET)
    right = cv2.applyColorMap(RIGHT, cv2.COLORMAP_JET)
    found = watched.answers(left, right, "bgr8")
    assert np.array_equal(pixels(found["left/image_rect_color"]), left)
    packed = np.frombuffer(found["points"].data, "<u4").reshape(HEIGHT, WIDTH, 4)[:, :, 3]
    blue, green, red = np.moveaxis(left.astype(np.uint32), 2, 0)
    assert np.array_equal(packed, red << 16 | green << 8 | blue)


def test_parameters_and_calibration_change_live(start):
    watched = Watched(start, topics=("disparity", "depth"))
    watched.answers()
    values = {"method": "bm", "min_disparity": -16, "disparities": 48, "full_image": False}
    support.reconfigured("/stereo", depth_encoding="16UC1", **values)
    # The principal points of the rectified images differ from now on.
    watched.cameras.calibration = {side: info_of(side, 2.5) for side in SIDES}
    found = watched.answers()
    disparity = disparity_of(LEFT, RIGHT, **values)
    message = found["disparity"]
    assert (message.min_disparity, message.max_disparity) == (-18.5, 28.5)
    expected = np.where(np.isnan(disparity), -19.5, disparity - 2.5)
    assert np.array_equal(pixels(message.image), expected.astype(np.float32))
    window = message.valid_window
    matcher = rv.StereoMatcher(params(**values))
    box = window.x_offset, window.y_offset, window.width, window.height
    assert box == matcher.window(WIDTH, HEIGHT) and window.x_offset > 31
    depth = rv.depth_from_disparity(disparity, geometry(2.5))
    assert found["depth"].encoding == "16UC1"
    assert np.array_equal(pixels(found["depth"]), rv.encode_depth(depth))
    # The same images are of a sensor with four times as many pixels.
    watched.cameras.calibration = {side: of_whole_sensor(info_of(side, 2.5)) for side in SIDES}
    assert np.array_equal(pixels(watched.answers()["depth"]), rv.encode_depth(depth))

    for name, value, said in (
        ("disparities", 40, "disparities is 40, must be a multiple of 16"),
        ("epipolar", "magic", "epipolar is magic, must be rectified or fundamental"),
        ("depth_encoding", "8UC1", "depth_encoding is 8UC1, must be 32FC1 or 16UC1"),
    ):
        assert support.reconfigured("/stereo", **{name: value})[name] != value
        watched.process.wait_for_output("stay as they are: " + said)
    assert np.array_equal(pixels(watched.answers()["disparity"].image), expected)


def test_an_uncalibrated_pair_has_epipolar_lines(start):
    watched = Watched(start, "_epipolar:=fundamental", topics=("epipolar",))
    for info in watched.cameras.calibration.values():
        info.K, info.R, info.P = [0.0] * 9, [0.0] * 9, [0.0] * 12
    color = [cv2.cvtColor(image, cv2.COLOR_GRAY2BGR) for image in (LEFT, RIGHT)]
    drawn = pixels(watched.answers()["epipolar"])
    assert np.array_equal(drawn, rv.draw_epipolar_lines(*color))
    assert "ERROR" not in watched.process.output()


def zeros(info):
    info.K, info.R, info.P = [0.0] * 9, [0.0] * 9, [0.0] * 12


def alone(info):
    info.R, info.P = [0.0] * 9, [0.0] * 12


def small(info):
    info.width, info.height = WIDTH // 2, HEIGHT // 2


def no_baseline(info):
    info.P[3] = 0.0


def swapped(info):
    info.P[3] = -info.P[3]


def calibrated_by_itself(info):
    info.P[0], info.P[3] = 200.0, 0.0


def nan_in_k(info):
    info.K = [float("nan"), *info.K[1:]]


def infinite_baseline(info):
    info.P[3] = -float("inf")


def other_focal_length(info):
    info.P[0] = 200.0


@pytest.mark.parametrize(
    "side, spoil, topics, said",
    [
        ("left", zeros, ("left",), "K is 0 everywhere, must be that of a calibrated camera"),
        ("right", zeros, ("right",), "K is 0 everywhere, must be that of a calibrated camera"),
        ("right", alone, ("right",), "R is 0 everywhere, must be that of two cameras calibrated"),
        ("right", small, ("right",), "its size is 100x60, must be 200x120 as of the image"),
        ("right", no_baseline, SIDES, "P[3] of the right camera is 0, must be below 0, -P[0]"),
        ("right", swapped, SIDES, "P[3] of the right camera is 27, must be below 0, -P[0]"),
        ("right", calibrated_by_itself, SIDES, "P[3] of the right camera is 0, must be below 0"),
        ("left", nan_in_k, ("left",), "K is nan, must be finite"),
        ("right", infinite_baseline, ("right",), "P is -inf, must be finite"),
        ("right", other_focal_length, SIDES, "P[0] of the right camera is 200, must be 180 as of"),
    ],
)
def test_a_calibration_that_is_none_of_a_pair_is_refused(start, side, spoil, topics, said):
    watched = Watched(start, topics=("disparity",))
    cameras = watched.cameras
    cameras.calibration[side].P = list(cameras.calibration[side].P)
    spoil(cameras.calibration[side])
    cameras.show(LEFT, RIGHT)
    names = " and ".join(cameras.topic(one, "camera_info") for one in topics)
    images = " and ".join(f"{cameras.topic(one, 'image_raw')} (mono8, 200x120)" for one in SIDES)
    watched.process.wait_for_output(f"refused the pair of {images}: camera_info on {names}: {said}")
    cameras.calibration = {one: info_of(one) for one in SIDES}
    watched.answers()
    assert len(watched.topics["disparity"].received) == 1


def test_images_that_cannot_be_used_are_refused_and_counted(start):
    watched = Watched(start, topics=("disparity",))
    diagnostics = support.Diagnostics()
    cameras = watched.cameras
    stamp = rospy.Time(10)
    cameras.send("left", LEFT, stamp)
    cameras.send("right", RIGHT, stamp, data=b"")
    watched.process.wait_for_output(": the right image: data has 0 bytes, step * height is 24000")
    stamp = rospy.Time(11)
    cameras.calibration["right"].width = WIDTH - 1
    cameras.send("left", LEFT, stamp)
    cameras.send("right", RIGHT[:, 1:], stamp)

    def refused():
        return diagnostics.value("stereo", "frames refused") == "2"

    support.wait_for(refused, "two refusals")
    expected = "the size of the right camera is 199x120, must be 200x120 as of the left one"
    support.wait_for(
        lambda: expected in diagnostics.value("stereo", "last error"), "the last error"
    )
    cameras.calibration = {side: info_of(side) for side in SIDES}
    watched.answers()
    support.wait_for(
        lambda: diagnostics.value("stereo", "frames published") == "1", "the published pair"
    )


def test_stamps_that_never_meet_are_told(start):
    watched = Watched(start, topics=("disparity",))
    cameras = watched.cameras
    times = itertools.count(1000)
    left, right = (cameras.topic(side, "image_raw") for side in SIDES)
    said = f" images: the stamps on {left} and {right} do not meet: the newest are 1"

    def told():
        stamp = rospy.Time(next(times))
        cameras.send("left", LEFT, stamp)
        cameras.send("right", RIGHT, stamp + rospy.Duration(0.02))
        return said in watched.process.output()

    support.wait_for(told, "what is wrong")
    output = watched.process.output()
    assert " s, must be equal; slop allows cameras that are not in step" in output
    assert not watched.topics["disparity"].received
    watched.answers()  # a pair with equal stamps


def test_slop_lets_stamps_differ(start):
    watched = Watched(start, "_slop:=0.05", topics=("disparity",))
    stamp = rospy.Time(50)
    watched.cameras.send("left", LEFT, stamp)
    watched.cameras.send("right", RIGHT, stamp + rospy.Duration(0.02))
    assert watched.topics["disparity"].of(stamp).header.frame_id == "left_eye"


def test_a_camera_that_is_missing_is_named(start, diagnostics):
    watched = Watched(start, topics=("disparity",))
    cameras = watched.cameras
    times = itertools.count(1000)
    topic = cameras.topic("right", "image_raw")

    def told():
        cameras.send("left", LEFT, rospy.Time(next(times)))
        return f"no pairs for 20 images: nothing has come on {topic}" in watched.process.output()

    support.wait_for(told, "what is missing")

    def is_counted():
        told()
        counts = {pair.key: pair.value for pair in diagnostics.next("stereo").values}
        received, refused = (int(counts[f"frames {of}"]) for of in ("received", "refused"))
        return received > 30 and received - refused == 19

    support.wait_for(is_counted, "all left images to be refused from the 20th on")
    watched.answers()


def subscriptions(node):
    """The topics that a node subscribes to according to the master."""
    return {topic for topic, nodes in rosgraph.Master("/test").getSystemState()[1] if node in nodes}


def test_it_subscribes_while_somebody_subscribes(start):
    cameras = StereoCameras()
    start("stereo_matcher_node", "__name:=lazy", FAST, *cameras.arguments())
    diagnostics = support.Diagnostics()
    support.wait_for(  # The first status may be that of the start.
        lambda: diagnostics.next("lazy").message == "idle: nobody subscribes", "the idle node"
    )
    own = {cameras.topic(side, name) for side in SIDES for name in ("image_raw", "camera_info")}
    assert not subscriptions("/lazy") & own
    for topic, kind in (("left/image_rect_color", Image), ("points", PointCloud2)):
        messages = support.subscribed("/lazy/" + topic, kind)
        cameras.wait_for()
        assert subscriptions("/lazy") >= own
        messages.of(cameras.show(LEFT, RIGHT))
        messages.close()
        support.wait_for(lambda: not subscriptions("/lazy") & own, "the end of the subscriptions")
        cameras.wait_for(0)


def test_camera_info_may_come_from_elsewhere(start):
    cameras = StereoCameras()
    moved = "/elsewhere/right_info"
    words = [*cameras.arguments(), f"right/camera_info:={moved}"]
    start("stereo_matcher_node", "__name:=moved", FAST, *words)
    disparities = support.subscribed("/moved/disparity", DisparityImage)
    infos = Source(moved, CameraInfo)
    for source in (*cameras.images.values(), cameras.infos["left"], infos):
        source.wait_for()
    stamp = rospy.Time(7)
    cameras.send("left", LEFT, stamp)
    cameras.send("right", RIGHT, stamp)
    infos.send(cameras.calibration["right"])
    baseline = disparities.of(stamp).T
    assert baseline == pytest.approx(BASELINE)


def test_the_scene_s_pair_has_depths_where_its_objects_are(start):
    """The camera node and this one, as the launch file starts them."""
    start(ROSLAUNCH, "robot_vision", "stereo.launch", "camera:=true")
    kinds = {"depth": Image, "camera_info": CameraInfo}
    topics = [support.Messages(f"/stereo_matcher/{name}", kind) for name, kind in kinds.items()]
    truths = support.Messages("/usb_cam/ground_truth", GroundTruth)
    names = ("poster", "tag_0", "tag_1")

    def all_seen():
        """The messages of a frame in which nothing is before what is looked at."""
        *messages, truth = support.same_frame(*topics, truths)
        seen = {one.name for one in truth.objects if one.visible}
        return (*messages, truth) if seen.issuperset(names) else None

    image, info, truth = support.wait_for(all_seen, "a frame with all in view")
    depth, projection = pixels(image), np.reshape(info.P, (3, 4))
    for name in names:
        (place,) = (one.pose.position for one in truth.objects if one.name == name)
        x, y, z = projection @ (place.x, place.y, place.z, 1.0)
        column, row = round(x / z), round(y / z)
        around = depth[row - 5 : row + 6, column - 5 : column + 6]
        assert np.nanmedian(around) == pytest.approx(place.z, rel=0.05), name


def test_it_is_a_nodelet_beside_others(start):
    manager = support.NodeletManager(start)
    cameras = StereoCameras()
    remapped = dict(word.split(":=") for word in cameras.arguments())
    rospy.set_param("/pair/disparities", 32)
    assert manager.load("/pair", "stereo_matcher", {f"/{a}": b for a, b in remapped.items()})
    depths = support.subscribed("/pair/depth", Image)
    cameras.wait_for()
    depth = pixels(depths.of(cameras.show(LEFT, RIGHT)))
    assert np.nanmedian(depth) == pytest.approx(FOCAL * BASELINE / 10.0)
    assert manager.unload("/pair")
    assert manager.process.running()


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("method", "magic", "method is magic, must be bm, sgbm, sgbm_3way or hh"),
        ("p2", 100, "p2 is 100, must be above p1, 200"),
        ("slop", -1.0, "slop is -1, must be from 0 to 10"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "stereo_matcher_node", name, value, text)


def test_it_ends_in_the_middle_of_a_pair(start):
    watched = Watched(start, "_method:=hh", "_disparities:=256", topics=("disparity",))
    watched.answers()
    large = np.tile(LEFT, (2, 2))
    for info in watched.cameras.calibration.values():
        info.width, info.height = large.shape[1], large.shape[0]
    for _ in range(3):
        watched.cameras.show(large, large)
    watched.process.interrupt()
    assert watched.process.prompt_exit_code() == 0, watched.process.output()
