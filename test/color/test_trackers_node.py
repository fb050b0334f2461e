"""hsv_tracker and ball_tracker on the synthetic scene, against its ground truth and OpenCV."""

import itertools
import pathlib

import cv2
import numpy as np
import pytest
import rospy
import support
import tf2_msgs.msg
import yaml
from calibrated_camera import CalibratedCamera
from frames import Camera, Source, message, new_topic, pixels
from geometry_msgs.msg import PointStamped
from sensor_msgs.msg import CameraInfo, Image
from std_srvs.srv import Trigger

from robot_vision import (
    ColorRange,
    Scene,
    SceneParams,
    convert_range,
    draw_outline,
    mask_picture,
)
from robot_vision.msg import DetectionArray

COLORS = pathlib.Path(__file__).resolve().parents[2] / "config" / "colors"
BLUE = ((90, 50, 50), (120, 255, 255))
KERNEL = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (3, 3))


@pytest.fixture
def camera(start):
    start("camera_node", "__name:=camera", "_source:=synthetic")


def cleaned(bgr, low, high):
    """The tracker's mask as computed by OpenCV."""
    mask = cv2.inRange(cv2.cvtColor(bgr, cv2.COLOR_BGR2HSV), low, high)
    mask = cv2.morphologyEx(mask, cv2.MORPH_OPEN, KERNEL)
    return cv2.morphologyEx(mask, cv2.MORPH_CLOSE, KERNEL)


def test_hsv_tracker_finds_the_ball_by_its_blue(start, camera):
    start("hsv_tracker.py", "__name:=tracker", "image:=/camera/image_raw")
    images = support.Messages("/camera/image_raw", Image)
    objects = support.Messages("/tracker/objects", DetectionArray)
    masks = support.Messages("/tracker/mask", Image)
    overlays = support.Messages("/tracker/processed_image", Image)
    image, found, mask, overlay = support.same_frame(images, objects, masks, overlays)
    assert found.header.frame_id == mask.header.frame_id == image.header.frame_id
    assert (found.width, found.height) == (640, 480)
    expected = cleaned(pixels(image), *BLUE)
    assert mask.encoding == "mono8" and np.array_equal(pixels(mask), expected)

    count, labels, stats, centers = cv2.connectedComponentsWithStats(expected)
    wanted = [i for i in range(1, count) if stats[i, cv2.CC_STAT_AREA] >= 200]
    assert len(found.detections) == len(wanted) >= 1
    for one in found.detections:
        i = labels[round(one.outline[0].y), round(one.outline[0].x)]
        assert (one.label, one.id, one.score, one.area) == ("blue", -1, 1.0, stats[i, 4])
        box = one.box
        assert [box.x_offset, box.y_offset, box.width, box.height] == stats[i, :4].tolist()
        assert np.allclose([one.center.x, one.center.y], centers[i])
        outline = np.array([(p.x, p.y) for p in one.outline], np.float32)
        (x, y), radius = cv2.minEnclosingCircle(outline)
        circle = one.circle_center
        assert np.allclose([circle.x, circle.y, one.circle_radius], [x, y, radius], atol=0.05)

    inside = cv2.erode(expected, np.ones((9, 9))) > 0  # away from the lines that are drawn
    assert inside.any()
    assert np.array_equal(pixels(overlay)[inside], pixels(image)[inside])
    assert np.mean(np.any(pixels(overlay) > 0, axis=2)) < 0.1  # black elsewhere


def test_hsv_tracker_finds_several_colors_and_red_on_both_ends_of_the_hues(start, tmp_path):
    image = np.zeros((120, 160, 3), np.uint8)
    for box, hue in [((10, 10, 30, 40), 178), ((60, 10, 30, 40), 3), ((110, 10, 30, 40), 60)]:
        x, y, w, h = box
        color = cv2.cvtColor(np.uint8([[[hue, 200, 200]]]), cv2.COLOR_HSV2BGR)[0, 0]
        image[y : y + h, x : x + w] = color
    path = tmp_path / "colors.png"
    cv2.imwrite(str(path), image)
    rospy.set_param(
        "/tracker/colors",
        {
            "red": yaml.safe_load((COLORS / "red.yaml").read_text()),  # as the launch file has it
            "green": {"low": [50, 100, 100], "high": [70, 255, 255]},
        },
    )
    rospy.set_param("/tracker/opening", 1)
    start("camera_node", "__name:=camera", f"_source:={path}")
    start("hsv_tracker.py", "__name:=tracker", "image:=/camera/image_raw")
    found = support.Messages("/tracker/objects", DetectionArray).wait()[0]
    centers = sorted((d.label, d.center.x, d.center.y, d.area) for d in found.detections)
    assert centers == [
        ("green", 124.5, 29.5, 1200.0),
        ("red", 24.5, 29.5, 1200.0),
        ("red", 74.5, 29.5, 1200.0),
    ]


def test_a_name_is_drawn_without_its_accents(start):
    image = np.zeros((120, 160, 3), np.uint8)
    image[60:100, 20:60] = (255, 0, 0)
    blue = {"low": list(BLUE[0]), "high": list(BLUE[1])}
    rospy.set_param("/tracker/colors", {"bleuë": blue})
    topic = new_topic()
    start("hsv_tracker.py", "__name:=tracker", f"image:={topic}")
    images = Source(topic)
    objects = support.subscribed("/tracker/objects", DetectionArray)
    masks = support.subscribed("/tracker/mask", Image)
    overlays = support.subscribed("/tracker/processed_image", Image)
    images.wait_for()
    sent = message(image, "bgr8")
    sent.header.stamp = rospy.Time(1)
    images.send(sent)
    (found,) = objects.of(sent.header.stamp).detections
    assert found.label == "bleuë"
    expected = mask_picture(image, pixels(masks.of(sent.header.stamp)))
    draw_outline(expected, np.array([(p.x, p.y) for p in found.outline], int), "bleue")
    assert np.array_equal(pixels(overlays.of(sent.header.stamp)), expected)


def test_colors_are_changed_live_and_saved(start, camera, tmp_path):
    path = tmp_path / "tracker.yaml"
    path.write_text(
        "# mine\ncolors:\n  blue: {low: [90, 50, 50], high: [120, 255, 255]}\n"
        "  pink: {low: [150, 20, 20], high: [170, 255, 255]}\nmin_area: 200.0  # px\n"
    )
    for name, value in yaml.safe_load(path.read_text()).items():
        rospy.set_param("/tracker/" + name, value)
    process = start(
        "hsv_tracker.py",
        "__name:=tracker",
        "image:=/camera/image_raw",
        f"_config_file:={path}",
    )
    assert support.reconfigured("/tracker")["color"] == "blue"
    config = support.reconfigured("/tracker", color="pink")
    assert (config["h_low"], config["s_low"], config["h_high"]) == (150, 20, 170)
    support.reconfigured("/tracker", h_low=160, min_area=50.0)
    config = support.reconfigured("/tracker", s_low=255, s_high=10)
    assert (config["s_low"], config["s_high"]) == (20, 255)
    process.wait_for_output("refused, the parameters stay as they are: ")
    config = support.reconfigured("/tracker", color="blue", h_high=130)
    assert (config["h_low"], config["h_high"]) == (90, 130)  # another color with a new limit
    support.reconfigured("/tracker", h_high=120)
    config = support.reconfigured("/tracker", color="pink")
    assert (config["h_low"], config["h_high"]) == (160, 170)
    path.write_text(path.read_text() + "colors: [blue]\n")
    before = path.read_text()
    assert not rospy.ServiceProxy("/tracker/save_parameters", Trigger)().success
    assert path.read_text() == before
    path.write_text(before.replace("colors: [blue]\n", ""))
    assert support.reconfigured("/tracker", color="mauve")["color"] == "pink"
    process.wait_for_output("color is 'mauve', must be one of blue, pink")
    assert rospy.ServiceProxy("/tracker/save_parameters", Trigger)().success
    text = path.read_text()
    assert text.startswith("# mine\n") and "# px" in text
    assert yaml.safe_load(text) == {
        "colors": {
            "blue": {"low": [90, 50, 50], "high": [120, 255, 255]},
            "pink": {"low": [160, 20, 20], "high": [170, 255, 255]},
        },
        "min_area": 50.0,
        "opening": 3,
        "closing": 3,
    }


def test_colors_of_several_spaces_are_found_changed_live_and_saved(start, tmp_path):
    """On one frame, with OpenCV's masks; a colour keeps its limits in each space."""
    patches = np.random.RandomState(2).randint(0, 256, (9, 12, 3), np.uint8)
    image = cv2.resize(patches, (160, 120), interpolation=cv2.INTER_CUBIC)
    path = tmp_path / "tracker.yaml"
    path.write_text(
        "colors:\n  first: {space: lab, low: [80, 100, 110], high: [200, 160, 150]}\n"
        "  second: {low: [60, 20, 60], high: [120, 255, 255]}\nmin_area: 0.0\n"
    )
    for name, value in yaml.safe_load(path.read_text()).items():
        rospy.set_param("/tracker/" + name, value)
    topic = new_topic()
    process = start("hsv_tracker.py", "__name:=tracker", f"image:={topic}", f"_config_file:={path}")
    images, masks = Source(topic), support.subscribed("/tracker/mask", Image)
    images.wait_for()

    def expected(*ranges):
        union = np.zeros(image.shape[:2], np.uint8)
        for code, low, high in ranges:
            mask = cv2.inRange(cv2.cvtColor(image, code), low, high)
            for kind in (cv2.MORPH_OPEN, cv2.MORPH_CLOSE):
                mask = cv2.morphologyEx(mask, kind, KERNEL)
            union |= mask
        assert 0 < np.count_nonzero(union) < union.size
        return union

    def mask(number):
        sent = message(image, "bgr8")
        sent.header.stamp = rospy.Time(number)
        images.send(sent)
        return pixels(masks.of(sent.header.stamp))

    second = cv2.COLOR_BGR2HSV, (60, 20, 60), (120, 255, 255)
    lab = cv2.COLOR_BGR2Lab, (80, 100, 110), (200, 160, 150)
    assert np.array_equal(mask(1), expected(lab, second))
    config = support.reconfigured("/tracker")
    assert (config["color"], config["space"]) == ("first", "lab")
    names = [f"{end}_{number}" for end in ("low", "high") for number in (1, 2, 3)]
    assert [config[name] for name in names] == [80, 100, 110, 200, 160, 150]
    support.reconfigured("/tracker", low_1=120)
    lab = cv2.COLOR_BGR2Lab, (120, 100, 110), (200, 160, 150)
    assert np.array_equal(mask(2), expected(lab, second))

    before = support.reconfigured("/tracker")
    for wrong in ({"h_low": 10}, {"space": "hsv", "low_1": 7}, {"space": "cmyk"}, {"high_1": 100}):
        assert support.reconfigured("/tracker", **wrong) == before
    for line in (
        "h_low is 10, must not be set while space is lab, whose limits are low_1 to high_3 "
        "(lightness, green to red, blue to yellow)",
        "low_1 is 7, must not be set while space is hsv, whose limits are h_low to v_high "
        "(hue, saturation, value)",
        "space is 'cmyk', must be one of hsv, hls, lab, ycrcb, rgb, bgr",
        "l_high is 100, must be from 120 to 255",
    ):
        process.wait_for_output(line)

    config = support.reconfigured("/tracker", space="ycrcb")
    around = convert_range(ColorRange("lab", *lab[1:]), "ycrcb")
    assert [config[name] for name in names] == [*around.low, *around.high]
    config = support.reconfigured("/tracker", space="ycrcb", low_1=100, high_1=180)
    low, high = (100, *around.low[1:]), (180, *around.high[1:])
    assert np.array_equal(mask(3), expected((cv2.COLOR_BGR2YCrCb, low, high), second))
    assert support.reconfigured("/tracker", space="lab")["low_1"] == 120
    assert np.array_equal(mask(4), expected(lab, second))
    config = support.reconfigured("/tracker", color="second")
    assert (config["space"], config["h_low"], config["s_low"]) == ("hsv", 60, 20)

    assert rospy.ServiceProxy("/tracker/save_parameters", Trigger)().success
    assert path.read_text().startswith(
        "colors:\n  first: {space: lab, low: [120, 100, 110], high: [200, 160, 150]}\n"
        "  second: {low: [60, 20, 60], high: [120, 255, 255]}\nmin_area: 0.0\n"
    )
    assert yaml.safe_load(path.read_text()).keys() == {"colors", "min_area", "opening", "closing"}


@pytest.mark.parametrize(
    "node, name, value, message",
    [
        ("hsv_tracker.py", "colors", {}, "colors is {}, must be a map"),
        ("hsv_tracker.py", "colors", {"a": [1]}, "colors/a is [1], must be {low: [h, s, v]"),
        (
            "hsv_tracker.py",
            "colors",
            {"a": {"low": [1, 2, 300], "high": [4, 5, 6]}},
            "colors/a: v_low is 300, must be",
        ),
        ("hsv_tracker.py", "space", "cmyk", "space is 'cmyk', must be one of hsv, hls, lab"),
        ("ball_tracker.py", "h_low", 200, "h_low is 200, must be from 0 to 180"),
        ("ball_tracker.py", "ball_diameter", -1, "ball_diameter is -1, must be"),
        ("line_follower.py", "timeout", 11.0, "timeout is 11, must be from 0.05 to 10"),
        ("line_follower.py", "image_transport", "pigeon", "must be one that is installed: "),
    ],
)
def test_bad_value_at_start_is_fatal(start, node, name, value, message):
    support.assert_fatal_at_start(start, node, name, value, message)


def test_limits_at_start_are_those_of_the_only_color(start):
    process = start("hsv_tracker.py", "__name:=tracker", "image:=/no", "_h_low:=10", "_h_high:=20")
    config = support.reconfigured("/tracker")
    limits = [config[name] for name in ("color", "h_low", "s_low", "h_high")]
    assert limits == ["blue", 10, 50, 20]
    assert process.running()


def test_limits_at_start_may_be_of_another_space(start):
    limits = "_space:=hls", "_low_2:=10", "_high_1:=20", "_h_low:=70"
    process = start("hsv_tracker.py", "__name:=tracker", "image:=/no", *limits)
    config = support.reconfigured("/tracker")
    names = ("color", "space", "low_1", "low_2", "high_1", "high_2", "h_low")
    assert [config[name] for name in names] == ["blue", "hls", 0, 10, 20, 255, 90]
    process.wait_for_output(
        "without effect: h_low 70, because space is hls, whose limits are low_1 to high_3 "
        "(hue, lightness, saturation)"
    )


@pytest.mark.parametrize("node", ["hsv_tracker.py", "brightness_node"])
def test_config_file_must_be_absolute(start, node):
    """roslaunch would read a relative path in another folder than the node writes it."""
    start(node, "__name:=saver", "image:=/no", "_config_file:=mine.yaml")
    rospy.wait_for_service("/saver/save_parameters", support.DEADLINE)
    answer = rospy.ServiceProxy("/saver/save_parameters", Trigger)()
    assert not answer.success
    assert answer.message == "~config_file is 'mine.yaml', must be an absolute path"


@pytest.mark.parametrize("node", ["hsv_tracker.py", "brightness_node"])
def test_missing_frames_are_logged(start, node):
    process = start(node, "__name:=waiting", "image:=/nobody")
    images = support.Messages("/waiting/processed_image", Image)
    process.wait_for_output("no frames on /nobody for 5 s")
    images.close()


def test_ball_is_followed_as_it_moves(start):
    """Median errors while it is visible: centre 1 px, position 2 %, velocity 10 %.

    The frames have the scene's own time, however long the machine takes to render them.
    """
    topic, calibrated = new_topic(), "/elsewhere/camera_info"
    images, infos = Source(topic), Source(calibrated, CameraInfo)
    remapped = [f"image:={topic}", f"camera_info:={calibrated}"]
    start("ball_tracker.py", "__name:=ball", *remapped, "_ball_diameter:=0.2")
    objects = support.subscribed("/ball/objects", DetectionArray)
    positions = support.subscribed("/ball/position", PointStamped)
    transforms = support.subscribed("/tf", tf2_msgs.msg.TFMessage)
    for source in (images, infos):
        source.wait_for()
    scene = Scene(SceneParams())
    width, height = scene.camera.width, scene.camera.height
    calibration = {"K": scene.camera.K.ravel().tolist(), "D": scene.camera.D}
    info = CameraInfo(width=width, height=height, distortion_model="plumb_bob", **calibration)
    numbers = itertools.count(1)

    def is_calibrated():
        infos.send(info)
        image = message(scene.render(0), "bgr8")
        image.header.stamp = rospy.Time(0, next(numbers))
        images.send(image)
        return objects.of(image.header.stamp) and positions.received

    support.wait_for(is_calibrated, "camera_info to be used")
    centers, places, speeds, missed = [], [], [], 0
    for frame in range(200):
        image = message(scene.render(frame), "bgr8")
        image.header.stamp = rospy.Time.from_sec(1.0 + frame / 30.0)
        image.header.frame_id = "eye"
        images.send(image)
        (found,) = objects.of(image.header.stamp).detections
        ball = ball_in(scene, frame)
        if not ball.visible:
            continue
        assert (found.label, found.id, found.has_velocity) == ("ball", 0, True)
        if found.predicted:
            missed += 1
            continue
        centers.append(np.hypot(*np.subtract((found.center.x, found.center.y), ball.center)))
        point = positions.of(image.header.stamp).point
        true = ball.pose[:3, 3]
        places.append(np.linalg.norm([point.x, point.y, point.z] - true) / np.linalg.norm(true))
        before, after = (ball_in(scene, other).center for other in (frame - 1, frame + 1))
        velocity = np.subtract(after, before) / 2.0 * 30.0
        error = np.subtract([found.velocity.x, found.velocity.y], velocity)
        speeds.append(np.linalg.norm(error) / np.linalg.norm(velocity))
    assert len(centers) > 100 and missed < 0.05 * len(centers), missed
    assert np.median(centers) < 1.0 and np.percentile(centers, 99) < 3.0, np.percentile(
        centers, [50, 99]
    )
    assert np.median(places) < 0.02, np.median(places)
    assert np.median(speeds) < 0.1, np.median(speeds)
    frames = {t.child_frame_id: t for m in transforms.received for t in m.transforms}
    assert frames["ball"].header.frame_id == "eye"


def ball_in(scene, frame):
    return next(one for one in scene.truth(frame).objects if one.name == "ball")


def test_ball_without_a_diameter_has_no_position(start, camera):
    start("ball_tracker.py", "__name:=ball", "image:=/camera/image_raw")
    found = support.Messages("/ball/objects", DetectionArray).wait(5)[-1].detections[0]
    assert found.label == "ball"
    assert "/ball/position" not in dict(rospy.get_published_topics())


BALL = "__name:=ball", "_ball_diameter:=0.2"
DISC = cv2.circle(np.zeros((480, 640, 3), np.uint8), (500, 240), 40, (255, 0, 0), -1)


class BallCamera(CalibratedCamera):
    """A camera that sees a disc, a ball_tracker that knows its diameter, and what that says."""

    def __init__(self, start, info):
        super().__init__(10.0, info)
        self.process = start("ball_tracker.py", *BALL, f"image:={self.topic}")
        self.objects = support.subscribed("/ball/objects", DetectionArray)
        self.positions = support.subscribed("/ball/position", PointStamped)
        self.wait_for()

    def shown(self):
        """What is said of an image with a disc."""
        return self.objects.of(self.show(DISC).stamp)


def test_the_frame_of_the_ball_alone_makes_the_node_work_unless_it_is_turned_off(start):
    info = CameraInfo(width=640, height=480, K=[400, 0, 500, 0, 400, 240, 0, 0, 1])
    camera = CalibratedCamera(10.0, info)
    process = start("ball_tracker.py", *BALL, f"image:={camera.topic}")
    transforms = support.subscribed("/tf", tf2_msgs.msg.TFMessage)
    camera.wait_for()

    def comes():
        camera.show(DISC)
        return transforms.received

    (ball,) = support.wait_for(comes, "a transform")[0].transforms
    assert (ball.child_frame_id, ball.header.frame_id) == ("ball", "eye")
    place = ball.transform.translation
    # The rays along the outline are atan(40 px / 400 px) off the middle of the ball.
    distance = 0.1 / np.sin(np.arctan(0.1))
    assert [place.x, place.y, place.z] == pytest.approx([0.0, 0.0, distance], abs=0.02)
    assert ball.header.stamp.to_sec() < 1000.0 and ball.transform.rotation.w == 1.0
    timeless = message(DISC, "bgr8")
    timeless.header.frame_id = "eye"
    camera.send(timeless)

    def last_stamp():
        return transforms.received[-1].transforms[0].header.stamp.to_sec()

    support.wait_for(lambda: last_stamp() > 1000.0, "a transform of the present time")
    nameless = message(DISC, "bgr8")
    nameless.header.stamp = rospy.Time(5000)
    camera.send(nameless)
    process.wait_for_output(f"no transforms: the images of {camera.topic} have no frame_id")
    support.reconfigured("/ball", publish_tf=False)
    camera.wait_for(0)
    assert all(one.transforms[0].header.frame_id == "eye" for one in transforms.received)


def test_camera_info_of_another_size_gives_no_position(start):
    info = CameraInfo(width=320, height=240, K=[300, 0, 160, 0, 300, 120, 0, 0, 1])
    camera = BallCamera(start, info)
    text = "camera_info is of 320x240, the image 640x480"

    def is_told():
        found = camera.shown().detections[0]
        assert found.circle_radius == pytest.approx(40.0, abs=0.6)
        return text in camera.process.output()

    support.wait_for(is_told, text)
    assert "no position of the ball: camera_info on " in camera.process.output()
    assert not camera.positions.received


def test_a_ball_without_camera_info_is_found_and_what_is_missing_is_said(start):
    camera = BallCamera(start, CameraInfo())
    camera.show = super(CalibratedCamera, camera).show
    support.wait_for(
        lambda: camera.shown().detections and "there is none" in camera.process.output(),
        "what is missing",
    )
    assert not camera.positions.received


def test_the_newest_camera_info_counts_whatever_its_stamp_is(start):
    info = CameraInfo(width=640, height=480, K=[300, 0, 320, 0, 300, 240, 0, 0, 1])
    info.header.stamp = rospy.Time(12345)
    camera = BallCamera(start, info)
    (position,) = support.wait_for(
        lambda: camera.shown() and camera.positions.received[:1], "a position"
    )
    assert position.point.x / position.point.z == pytest.approx(180.0 / 300.0, abs=0.02)


def test_a_ball_in_images_of_another_size_is_another_one(start):
    """What was in the images before neither is expected there, nor drawn as a trail."""
    camera = Camera(10.0)
    start("ball_tracker.py", "__name:=ball", f"image:={camera.topic}", "_max_prediction:=60.0")
    objects = support.subscribed("/ball/objects", DetectionArray)
    overlays = support.subscribed("/ball/processed_image", Image)
    camera.wait_for()

    def shown(width, height, center):
        image = np.zeros((height, width, 3), np.uint8)
        cv2.circle(image, center, 30, (255, 0, 0), -1)
        stamp = camera.show(image).stamp
        (ball,) = objects.of(stamp).detections
        assert not ball.predicted
        assert (ball.center.x, ball.center.y) == pytest.approx(center, abs=0.6)
        return pixels(overlays.of(stamp))

    for x in (280, 290, 300):
        shown(640, 360, (x, 300))
    overlay = shown(320, 240, (100, 100))
    assert overlay[150:].max() == 0


def test_a_ball_is_followed_beside_a_larger_one_though_it_may_not_be_predicted(start):
    camera = Camera(10.0)
    start("ball_tracker.py", "__name:=ball", f"image:={camera.topic}", "_max_prediction:=0.0")
    objects = support.subscribed("/ball/objects", DetectionArray)
    camera.wait_for()
    for step in range(12):
        image = np.zeros_like(DISC)
        center = 100 + 5 * step, 240
        cv2.circle(image, center, 20, (255, 0, 0), -1)
        if step > 4:
            cv2.circle(image, (500, 120), 45, (255, 0, 0), -1)
        (ball,) = objects.of(camera.show(image).stamp).detections
        assert not ball.predicted
        assert (ball.center.x, ball.center.y) == pytest.approx(center, abs=1.5), step


def test_the_trail_of_a_ball_begins_anew_after_a_rest(start):
    camera = Camera(10.0)
    start("ball_tracker.py", "__name:=ball", f"image:={camera.topic}")
    for x in (100, 540):
        overlays = support.subscribed("/ball/processed_image", Image)
        camera.wait_for()
        stamp = camera.show(cv2.circle(np.zeros_like(DISC), (x, 240), 40, (255, 0, 0), -1)).stamp
        overlay = pixels(overlays.of(stamp))
        overlays.close()
        camera.wait_for(0)
    assert not overlay[:, 200:400].any()


@pytest.mark.parametrize(
    "node, output, kind",
    [
        ("hsv_tracker.py", "processed_image", Image),
        ("ball_tracker.py", "processed_image", Image),
        ("line_follower.py", "processed_image", Image),
        ("face_detector.py", "faces", DetectionArray),
        ("code_reader.py", "codes", DetectionArray),
    ],
)
def test_python_nodes_are_lazy(start, diagnostics, camera, node, output, kind):
    start(node, "__name:=lazy", "image:=/camera/image_raw", "_diagnostic_period:=0.1")
    idle, running = "idle: nobody subscribes", "running on /camera/image_raw"
    support.wait_for(lambda: diagnostics.next("lazy").message == idle, idle)
    results = support.Messages("/lazy/" + output, kind)
    results.wait()
    support.wait_for(lambda: diagnostics.next("lazy").message == running, running)
    results.close()
    support.wait_for(lambda: diagnostics.next("lazy").message == idle, idle)
    support.wait_for(lambda: diagnostics.next("camera").message == idle, "the camera idle")
