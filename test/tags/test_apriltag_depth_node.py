"""The node apriltag_detector with a depth image beside its image, good ones and bad ones."""

import itertools
import re
import threading

import numpy as np
import pytest
import rosgraph
import rospy
import support
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from frames import Source, message
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header
from tag_depths import tilt_of, view_of
from tag_studio import SIZE, K, Studio, assert_near, calibrated, facing, matrix_of
from tag_views import image_of
from tf2_msgs.msg import TFMessage

import robot_vision as rv
from robot_vision.msg import GroundTruth, TagDetectionArray
from robot_vision.srv import DetectTags
from robot_vision.transport import ImagePublisher

NAN = float("nan")
VIEW = view_of(rv.CameraModel(640, 480, K))
HALF = np.diag([0.5, 0.5, 1.0]) @ K
SMALL = view_of(rv.CameraModel(320, 240, HALF))
BEFORE = 0.0007  # s by which the depth camera is ahead
FRONT = facing(0.05, -0.05, 1.5, (0.06, 0.03, 0.3))

numbers = itertools.count()


def noisy_image(pose, rng):
    """An image of the tag 5, of a camera that sees little light."""
    rays = VIEW.rays[:, :, :2]
    return image_of(pose, VIEW.camera, rays, 5, rng, blur=0.7, noise=12.0, size=SIZE)


SCENERY = noisy_image(FRONT, np.random.default_rng(0))


def depth_of(pose, view=VIEW):
    """The depths (m) of the whole plane of a tag."""
    normal = pose[:3, 2]
    return ((normal @ pose[:3, 3]) / (view.rays @ normal)).astype(np.float32)


def millimetres(depth):
    return np.rint(np.nan_to_num(depth) * 1000).astype(np.uint16)


def deviation_of(pose):
    """The standard deviation of the tilt of a PoseWithCovariance, degrees."""
    covariance = np.reshape(pose.covariance, (6, 6))
    assert np.isfinite(covariance).all() and np.isfinite(matrix_of(pose.pose)).all()
    return np.degrees(np.sqrt(covariance[3:5, 3:5].trace()))


def has_pose(answer):
    return bool(answer.detections) and answer.detections[0].has_pose


def is_fused(answer):
    """By corners alone the tilt in a single frame of such a tag is less certain."""
    return has_pose(answer) and deviation_of(answer.detections[0].pose) < 0.5


class DepthStudio(Studio):
    """A Studio with a depth camera.

    Its frames are farther apart in time than max_gap of the poses, so that none is averaged over
    them: of a tag at rest, which is seen more often on a busy machine, corners alone tell the tilt
    as well as depth in time.
    """

    def __init__(self, start, *arguments):
        name = f"/depth_{next(numbers)}"
        self.depth_topic = f"{name}/image"
        self.depth = Source(self.depth_topic)
        self.depth_infos = Source(f"{name}/camera_info", CameraInfo)
        self.depth_info = None
        self.frame, self.lag = "eye", -BEFORE
        words = f"depth:={self.depth_topic}", *arguments
        super().__init__(start, *words, info=calibrated(), rate=1.0)
        self.depth.wait_for()
        self.depth_infos.wait_for()

    def send_both(self, image, depth, encoding="32FC1"):
        """Sends an image and, if there is one, its depth; returns the stamp of the image."""
        if self.depth_info is not None:
            self.depth_infos.send(self.depth_info)
        stamp = self.send(image)
        if depth is not None:
            sent = message(depth, encoding)
            sent.header = Header(
                stamp=stamp + rospy.Duration.from_sec(self.lag), frame_id=self.frame
            )
            self.depth.send(sent)
        return stamp

    def show_both_until(self, condition, image, depth, encoding="32FC1"):
        """Sends both until an answer satisfies the condition; returns that answer."""
        begin = len(self.tags.received)

        def answers():
            self.send_both(image, depth, encoding)
            return [one for one in self.tags.received[begin:] if condition(one)]

        return support.wait_for(answers, "such an answer")[-1]


def test_poses_are_nearer_to_the_truth_than_those_of_a_node_without_depth(start):
    search = "_max_search_period:=0"
    studio = DepthStudio(start, search)
    words = f"image:={studio.topic}", f"_tag_size:={SIZE}", search
    start("apriltag_detector.py", "__name:=plain", *words)
    plain = support.subscribed("/plain/tags", TagDetectionArray)
    studio.wait_for_subscribers(2)
    studio.infos.wait_for(2)
    studio.show_both_until(is_fused, SCENERY, depth_of(FRONT))
    rng = np.random.default_rng(1)
    errors = []
    for number in range(12):
        turn = (*rng.uniform(-0.12, 0.12, 2), 0.3 * number)
        truth = facing(*rng.uniform(-0.2, 0.2, 2), rng.uniform(1.2, 1.8), turn)
        depth = depth_of(truth) + rng.normal(0.0, 0.003, (480, 640)).astype(np.float32)
        image = noisy_image(truth, rng)

        def answered_by_both(image=image, depth=depth):
            """The answers to a pair: where its two come too far apart, the image goes alone."""
            stamp = studio.send_both(image, depth)
            both = [topic.of(stamp) for topic in (studio.tags, plain)]
            return both if is_fused(both[0]) or not has_pose(both[0]) else None

        answers = support.wait_for(answered_by_both, "the answers to an image and its depth")
        if not all(map(has_pose, answers)):
            continue
        poses = [matrix_of(one.detections[0].pose.pose) for one in answers]
        errors.append(
            [(tilt_of(pose, truth), np.linalg.norm(pose[:3, 3] - truth[:3, 3])) for pose in poses]
        )
    assert len(errors) >= 8
    (tilt, place), (tilt_alone, place_alone) = np.sqrt(np.mean(np.square(errors), axis=0))
    assert tilt < 0.5 * tilt_alone and tilt < 0.5, (tilt, tilt_alone)
    assert place < 1.1 * place_alone, (place, place_alone)


@pytest.mark.parametrize("encoding", ["16UC1", "mono16", "32FC1"])
def test_all_outputs_are_of_corners_and_depth(start, encoding):
    studio = DepthStudio(start)
    transforms = support.subscribed("/tf", TFMessage)
    depth = depth_of(FRONT)
    depth[::7] = NAN  # a sensor has holes
    if encoding != "32FC1":
        depth = millimetres(depth)

    def is_complete(answer):
        """Whether its transforms have come, too, which may give way to those of the next one."""
        come = any(support.stamp_of(one) == answer.header.stamp for one in transforms.received)
        return come and is_fused(answer)

    answer = studio.show_both_until(is_complete, SCENERY, depth, encoding)
    (tag,) = answer.detections
    assert_near(matrix_of(tag.pose.pose), FRONT, 0.005, 0.5)
    (transform,) = transforms.of(answer.header.stamp).transforms
    assert np.allclose(matrix_of(transform.transform), matrix_of(tag.pose.pose))
    assert answer.header.frame_id == "eye"


def test_depth_of_another_size_has_the_camera_of_its_camera_info(start):
    studio = DepthStudio(start)
    studio.depth_info = calibrated(320, 240, HALF)
    answer = studio.show_both_until(is_fused, SCENERY, depth_of(FRONT, SMALL))
    assert_near(matrix_of(answer.detections[0].pose.pose), FRONT, 0.005, 0.5)


def test_bundles_and_single_images_are_of_both(start):
    layout = [{"id": 5, "size": SIZE, "x": 0.1, "shift_noise": 0.0, "turn_noise": 0.0}]
    rospy.set_param("/tag/tag_bundles", [{"name": "rig", "layout": layout}])
    studio = DepthStudio(start)
    (bundle,) = studio.show_both_until(is_fused, SCENERY, depth_of(FRONT)).bundles
    shift = np.eye(4)
    shift[0, 3] = -0.1
    assert_near(matrix_of(bundle.pose.pose), FRONT @ shift, 0.005, 0.5)
    assert deviation_of(bundle.pose) < 0.5
    detect, answers = rospy.ServiceProxy("/tag/detect", DetectTags), []

    def is_answered_by_both():
        """An image whose depth gives way to the next one is looked at alone."""
        call = threading.Thread(target=lambda: answers.append(detect("")))
        call.start()
        while call.is_alive():
            studio.tags.of(studio.send_both(SCENERY, depth_of(FRONT)))
            call.join(0.0)
        return answers[-1].success and is_fused(answers[-1].tags)

    support.wait_for(is_answered_by_both, "the tags of an image and its depth")


def test_the_first_frame_that_is_asked_for_is_of_both(start):
    """No depth is there before the first image, which is not looked at for the call."""
    detect, answers = rospy.ServiceProxy("/tag/detect", DetectTags), []

    def is_answered_by_both():
        """A new node, because an image whose depth gives way to the next one is looked at alone."""
        studio = DepthStudio(start)
        studio.tags.close()
        studio.depth.wait_for(0)
        call = threading.Thread(target=lambda: answers.append(detect("")))
        call.start()
        while call.is_alive():
            studio.send_both(SCENERY, depth_of(FRONT))
            call.join(0.1)
        return answers[-1].success and is_fused(answers[-1].tags)

    support.wait_for(is_answered_by_both, "the tags of an image and its depth")


def test_depth_is_taken_only_with_the_images(start):
    studio = DepthStudio(start)
    studio.tags.close()
    for source in (studio.depth, studio.depth_infos):
        source.wait_for(0)
    studio.wait_for_subscribers(0)
    studio.tags = support.subscribed("/tag/tags", TagDetectionArray)
    studio.depth.wait_for(1)
    studio.depth_infos.wait_for(1)
    studio.show_both_until(is_fused, SCENERY, depth_of(FRONT))


def test_without_a_topic_for_it_there_is_no_depth(start):
    studio = Studio(start, info=calibrated())
    studio.show(SCENERY)
    subscriptions = rosgraph.Master("/test").getSystemState()[1]
    taken = [topic for topic, nodes in subscriptions if any("/tag" in node for node in nodes)]
    assert studio.topic in taken and not any("depth" in topic for topic in taken)


def test_depth_comes_over_another_transport(start):
    topic = f"/depth_{next(numbers)}/image"
    sender, depth = ImagePublisher(topic), millimetres(depth_of(FRONT))
    transport = "_depth_image_transport:=compressedDepth"
    studio = Studio(start, f"depth:={topic}", transport, info=calibrated())

    def fused():
        stamp = studio.send(SCENERY)
        sender.publish(depth, "16UC1", Header(stamp=stamp, frame_id="eye"))
        return any(map(is_fused, studio.tags.received))

    try:
        support.wait_for(fused, "a pose by both")
    finally:
        sender.unregister()


GOOD = depth_of(FRONT)
BAD = {
    "colors": (np.zeros((480, 640, 3), np.uint8), "bgr8", "must be 16UC1 (mm) or 32FC1 (m)"),
    "nothing": (np.full_like(GOOD, NAN), "32FC1", "none of the 640x480 pixels has a depth"),
    "zeros": (np.zeros((480, 640), np.uint16), "16UC1", "none of the 640x480 pixels has a depth"),
    "mm as m": (GOOD * 1000, "32FC1", " m by the encoding 32FC1, expected 0.05 to 200 m"),
    "m as mm": (GOOD.astype(np.uint16), "16UC1", " mm by the encoding 16UC1, expected 0.05 to 30"),
    "0.1 mm as mm": (
        millimetres(GOOD * 10),
        "16UC1",
        "do not fit their corners: it is 10 times too",
    ),
    "another place": (GOOD + 0.4, "32FC1", "do not fit their corners: it is off by +0.4"),
    "another size": (GOOD[::2, ::2], "32FC1", "expected the same, or a camera_info of 320x240 on"),
}


@pytest.mark.parametrize("what", BAD)
def test_depth_that_cannot_be_is_told_and_left_out(start, what):
    depth, encoding, said = BAD[what]
    studio = DepthStudio(start)

    def told():
        studio.send_both(SCENERY, depth, encoding)
        return said in studio.process.output()

    support.wait_for(told, said)
    output = studio.process.output()
    (line,) = {line.split("] ")[-1] for line in output.splitlines() if said in line}
    assert studio.depth_topic in line and "Traceback" not in output, output
    answer = studio.show_both_until(has_pose, SCENERY, depth, encoding)
    assert not is_fused(answer)
    assert_near(matrix_of(answer.detections[0].pose.pose), FRONT, 0.01, 5.0)
    studio.show_both_until(is_fused, SCENERY, GOOD)


def test_a_camera_that_does_not_fit_is_named(start):
    studio = DepthStudio(start, "_diagnostic_period:=0.01")
    diagnostics = support.Messages("/diagnostics", DiagnosticArray)

    def told(said, in_status):
        def is_there():
            studio.send_both(SCENERY, GOOD)
            reasons = [one.message for one in statuses(diagnostics, DiagnosticStatus.WARN)]
            is_in_status = any(in_status in reason for reason in reasons)
            return said in studio.process.output() and is_in_status

        support.wait_for(is_there, said)

    studio.frame = "depth_eye"
    refused = f"refused a frame on {studio.depth_topic} (32FC1, 640x480): "
    told(
        f"{refused}its frame is 'depth_eye', must be that of the images on {studio.topic}, 'eye': "
        "is it registered?",
        "is it registered?",
    )
    studio.frame = "eye"
    studio.depth_info = calibrated(320, 240, HALF)
    of = f"camera_info on {studio.depth_topic.replace('image', 'camera_info')}: "
    told(
        f"{refused}{of}camera_info is of 320x240, the image 640x480",
        "camera_info is of 320x240, the image 640x480",
    )
    studio.depth_info = calibrated()
    studio.show_both_until(is_fused, SCENERY, GOOD)


def test_a_camera_without_calibration_is_on_diagnostics(start):
    studio = DepthStudio(start, "_diagnostic_period:=0.01")
    diagnostics = support.Messages("/diagnostics", DiagnosticArray)
    studio.info = CameraInfo(width=640, height=480)
    lack = f"no poses of tags: camera_info on {studio.topic.replace('image', 'camera_info')}: "

    def told():
        studio.send_both(SCENERY, GOOD)
        warnings = [one.message for one in statuses(diagnostics, DiagnosticStatus.WARN)]
        return any(text.startswith(lack) for text in warnings)

    support.wait_for(told, lack)
    studio.info = calibrated()
    studio.show_both_until(is_fused, SCENERY, GOOD)


def test_stamps_that_never_meet_are_told(start):
    studio = DepthStudio(start)
    studio.lag = 0.45
    said = f"the stamps on {studio.topic} and {studio.depth_topic} do not meet: the newest are "

    def told():
        studio.send_both(SCENERY, GOOD)
        return said in studio.process.output()

    support.wait_for(told, said)
    assert "must be at most 0.02 s apart: poses of tags are" in studio.process.output()
    assert not is_fused(studio.show_both_until(has_pose, SCENERY, GOOD))
    assert support.reconfigured("/tag", depth_slop=1.0)["depth_slop"] == 1.0
    studio.lag = 0.03
    studio.show_both_until(is_fused, SCENERY, GOOD)


def test_a_depth_camera_that_is_silent_is_told_once(start):
    studio = DepthStudio(start, "_diagnostic_period:=0.01")
    diagnostics = support.Messages("/diagnostics", DiagnosticArray)
    assert not is_fused(studio.show_both_until(has_pose, SCENERY, None))
    said = rf"no depth on {studio.depth_topic} for \d+ s: poses of tags are from the corners alone"

    def told():
        studio.send(SCENERY)
        return re.search(said, studio.process.output())

    support.wait_for(told, said)
    for _ in range(5):
        studio.show(SCENERY)
    assert studio.process.output().count("no depth on ") == 1
    warnings = support.wait_for(lambda: statuses(diagnostics, DiagnosticStatus.WARN), "the status")
    assert warnings[-1].message.startswith(f"no depth on {studio.depth_topic} for ")
    studio.show_both_until(is_fused, SCENERY, GOOD)


def test_tags_of_the_scene_by_a_registered_kinect(start):
    """All nodes of docs/depth.md, in the frames that they themselves give."""
    start("camera_node", "__name:=camera", "_source:=synthetic", "_views:=rgbd", "_framerate:=3")
    start("depth_registration_node", "__name:=registration", "__ns:=/camera")
    words = "image:=/camera/rgb/image_raw", "_tag_size:=0.24"
    depth = "depth:=/camera/depth_registered/image_raw"
    start("apriltag_detector.py", "__name:=tag", *words, depth)
    start("apriltag_detector.py", "__name:=plain", *words)
    topics = [support.Messages(f"/{name}/tags", TagDetectionArray) for name in ("tag", "plain")]
    truths = support.Messages("/camera/ground_truth", GroundTruth)

    def answers_to_both():
        of = [{one.header.stamp: one for one in topic.received} for topic in (*topics, truths)]
        return [[one[stamp] for one in of] for stamp in set.intersection(*map(set, of))]

    support.wait_for(lambda: len(answers_to_both()) >= 40, "answers of both nodes")
    errors = []
    for *answers, truth in answers_to_both():
        poses = [{tag.id: tag.pose for tag in one.detections if tag.has_pose} for one in answers]
        true = {one.name: matrix_of(one.pose) for one in truth.objects}
        for tag in set.intersection(*map(set, poses)):
            found = [one[tag] for one in poses]
            tilts = [tilt_of(matrix_of(one.pose), true[f"tag_{tag}"]) for one in found]
            errors.append((*tilts, *map(deviation_of, found)))
    tilt, tilt_alone, said, said_alone = np.median(errors, axis=0)
    assert len(errors) >= 20
    assert said < 0.9 * said_alone, (said, said_alone)
    assert tilt < 1.2 * tilt_alone, (tilt, tilt_alone)


def statuses(diagnostics, level):
    """All of the depth with this level."""
    every = (status for array in diagnostics.received for status in array.status)
    return [one for one in every if one.name == "tag: depth" and one.level == level]


def test_a_sensor_that_is_off_is_on_diagnostics(start):
    studio = DepthStudio(
        start, "_diagnostic_period:=0.01", "_depth_bias:=0.05", "_max_search_period:=0"
    )
    diagnostics = support.Messages("/diagnostics", DiagnosticArray)

    distances = itertools.cycle([1.0, 1.4, 1.8, 2.2])

    def warned():
        pose = facing(0.05, -0.05, next(distances), (0.3, 0.2, 0.1))
        image = noisy_image(pose, np.random.default_rng(0))
        studio.send_both(image, 1.03 * depth_of(pose) + np.float32(0.02))
        warnings = statuses(diagnostics, DiagnosticStatus.WARN)
        return [one for one in warnings if "off by" in one.message]

    status = support.wait_for(warned, "the warning")[-1]
    found = {value.key: value.value for value in status.values}
    assert "off by +0.0" in status.message
    assert int(found["tags compared"]) > 0
    true, near = float(found["scale"]), float(found["nearest (m)"])
    error = (true - 1.0) * near + float(found["bias (m)"])
    assert error == pytest.approx(0.03 * near + 0.02, abs=0.01)


def test_a_bad_transport_is_fatal(start):
    arguments = "depth:=/depth/image", "_depth_image_transport:=pigeon"
    process = start("apriltag_detector.py", "__name:=bad", *arguments)
    assert process.exit_code() == 1
    assert "pigeon" in process.output() and "Traceback" not in process.output()
