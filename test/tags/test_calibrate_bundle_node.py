"""The command calibrate_bundle.py: it learns known layouts, live and from bags; its errors."""

import os
import re

import cv2
import numpy as np
import pytest
import rosbag
import rosparam
import rospy
import support
import yaml
from frames import Source, message, new_topic
from geometry_msgs.msg import Point, PoseWithCovariance
from sensor_msgs.msg import CameraInfo, CompressedImage
from tag_studio import (
    SIZE,
    K,
    Studio,
    angle_between,
    assert_near,
    calibrated,
    corners_of,
    facing,
    image_of,
    matrix_of,
)
from tags import matrix, turned

import robot_vision as rv
from robot_vision.msg import TagBundlePose, TagDetection, TagDetectionArray
from robot_vision.tags.bundle_files import parse_bundles, write_bundles
from robot_vision.tags.calibrate_bundle import main
from robot_vision.tags.frame_collection import FrameCollection

IMAGE, INFO = "/eye/image_raw", "/eye/camera_info"


LAYOUT = {  # faces of a body like a box whose corners are cut off
    4: matrix(np.eye(3), [0.0, 0.0, 0.0]),
    5: matrix(turned((0.0, 0.7, 0.0)), [0.28, 0.0, -0.08]),
    6: matrix(turned((-0.7, 0.0, 0.0)), [0.0, 0.28, -0.08]),
    7: matrix(turned((0.0, -0.6, 0.3)), [-0.28, 0.02, -0.06]),
}


def views(count):
    """Poses of the body about 1 m away, seen from many sides."""
    for i in range(count):
        turn = 0.45 * np.array([np.cos(2.4 * i), np.sin(2.4 * i), 0.5 * np.sin(1.3 * i)])
        yield facing(0.08 * np.sin(i), 0.05 * np.cos(1.7 * i), 1.05 + 0.1 * np.sin(0.9 * i), turn)


def visible(body, hidden=()):
    """The tags that face the camera: [(id, pose), ...]."""
    poses = {tag: body @ pose for tag, pose in LAYOUT.items() if tag not in hidden}
    return [
        (tag, pose)
        for tag, pose in poses.items()
        if pose[:3, 2] @ pose[:3, 3] < -0.4 * np.linalg.norm(pose[:3, 3])
    ]


def image_at(body, hidden=()):
    return image_of(visible(body, hidden))


@pytest.fixture(scope="module")
def images():
    return [image_at(body) for body in views(24)]


def write_bag(path, images, info=None, encoding="mono8"):
    """Writes a bag of compressed images, or of images with padded rows."""
    with rosbag.Bag(str(path), "w") as bag:
        for number, image in enumerate(images):
            stamp = rospy.Time(100, number * 33_000_000)
            if info is not None:
                bag.write(INFO, info, stamp)
            if encoding == "png":
                data = cv2.imencode(".png", image)[1].tobytes()
                bag.write(IMAGE + "/compressed", CompressedImage(format="png", data=data), stamp)
            else:
                bag.write(IMAGE, message(image, encoding, padding=4), stamp)
    return path


@pytest.fixture(scope="module")
def bag(images, tmp_path_factory):
    return write_bag(tmp_path_factory.mktemp("bags") / "box.bag", images, calibrated())


def command(path):
    return ["--name", "box", "--ids", "4-7", "--size", SIZE, "--output", path]


@pytest.fixture
def calibrate(run_main, tmp_path):
    """calibrate(*arguments) runs the command here and returns its exit code and output."""

    def run(*arguments, output=tmp_path / "box.yaml"):
        return run_main(main, ["calibrate_bundle.py", *command(output), *arguments])

    return run


def assert_learnt(path, master=4):
    (bundle,) = parse_bundles(yaml.safe_load(path.read_text())["tag_bundles"])
    assert bundle.name == "box" and sorted(tag.id for tag in bundle.tags) == sorted(LAYOUT)
    for tag in bundle.tags:
        truth = np.linalg.inv(LAYOUT[master]) @ LAYOUT[tag.id]
        assert tag.size == SIZE
        assert np.linalg.norm(tag.pose[:3, 3] - truth[:3, 3]) < 0.0005, tag.id
        assert angle_between(tag.pose, truth) < 0.2, tag.id


def refused(calibrate, tmp_path, *arguments, **options):
    """The error message of a command that must end with 1 and write nothing."""
    code, output = calibrate(*arguments, **options)
    *_, error = output.splitlines()
    assert code == 1 and error.startswith("calibrate_bundle.py: "), output
    assert not (tmp_path / "box.yaml").exists()
    return error


def frames_told(process):
    """The number in the newest line of progress."""
    return int(re.findall("^([0-9]+) of 300 frames", process.output(), re.MULTILINE)[-1])


def test_live(start, images, tmp_path):
    # Every image shows all its tags, so that each is kept once, however fast the search is.
    studio = Studio(start, "_max_search_period:=0", info=calibrated())
    path = tmp_path / "box.yaml"
    process = start("calibrate_bundle.py", *command(path), "--master", 5, "tags:=/tag/tags")
    alone = image_at(next(views(1)), hidden=[5, 6, 7])
    support.wait_for(
        lambda: studio.show(alone) and "not seen: 5, 6, 7" in process.output(), "the recording"
    )
    two = image_at(next(views(1)), hidden=[5, 7])
    text = "tags: 4 (1), 6 (1); together: 4+6 (1); not seen: 5, 7; not linked with 5: 4, 6\n"
    support.wait_for(lambda: studio.show(two) and text in process.output(), text)

    def recorded():
        """Of frames that follow each other closely some are dropped; none is kept twice."""
        for image in images:
            studio.show(image)
        return frames_told(process) >= 25

    support.wait_for(recorded, "all frames")
    process.interrupt()
    assert process.exit_code() == 0, process.output()
    output = process.output()
    count = frames_told(process)
    assert f"box: 4 tags from {count} frames, in the frame of tag 5\n" in output
    assert f"saved in {path}\n" in output and "LARGE" not in output
    lines = output.splitlines()
    assert all(one != other for one, other in zip(lines, lines[1:])), output
    assert_learnt(path, master=5)


def test_of_several_calibrations_none_is_taken_unless_told(start, images, tmp_path):
    """A detector with depth subscribes to the camera_info of both, and either may sort first."""
    studio = Studio(start, "depth:=/depth/image", info=calibrated())
    process = start("calibrate_bundle.py", *command(tmp_path / "box.yaml"), "tags:=/tag/tags")
    topics = f"/depth/camera_info, {studio.infos.topic}"
    reason = f"the topic of the calibration is one of {topics}: say camera_info:=/usb_cam/camera_in"
    support.wait_for(lambda: studio.show(images[0]) and reason in process.output(), reason)
    process.interrupt()
    assert process.exit_code() == 1 and "of 300 frames" not in process.output()


def detection(tag, corners, family="tag36h11", **values):
    return TagDetection(
        family=family, id=tag, corners=[Point(x, y, 0.0) for x, y in corners], **values
    )


def good(body, *others):
    """A detector's message with the visible tags and these others."""
    seen = [detection(tag, corners_of(pose)) for tag, pose in visible(body)]
    return TagDetectionArray(width=640, height=480, detections=[*others, *seen])


NAN, INF, HIGHEST = float("nan"), float("inf"), 2**32 - 1
TERMINAL = "\x1b[2J\n\0\u202e" * 1000


def hostile_frames(body):
    """Frames that this camera cannot make, each with its CameraInfo and a part of the message."""
    for width, height in ((0, 0), (0, 480), (640, 0), (HIGHEST, HIGHEST), (480, 640)):
        frame = good(body)
        frame.width, frame.height = width, height
        yield frame, None, f"is of 640x480, the image {width}x{height}\n"
    for values, reason in (
        ({"matrix": np.full((3, 3), NAN)}, "K is nan, must be finite\n"),
        ({"matrix": np.zeros((3, 3))}, "the camera is not calibrated\n"),
        ({"matrix": K + np.eye(3) - np.diag([0.0, 0.0, 1.0])}, "is not that of the first frames\n"),
        ({"width": 320, "height": 240}, "is of 320x240, the image 640x480\n"),
        ({"width": 0, "height": HIGHEST}, f"is of 0x{HIGHEST}, the image 640x480\n"),
        ({"model": TERMINAL}, "distortion_model is '\\x1b[2J\\x0a"),
    ):
        yield good(body), calibrated(**values), reason


def hostile_detections(body):
    """Frames with wrong detections beside good tags, or in their place."""
    square = np.array([[300.0, 240.0], [340.0, 240.0], [340.0, 200.0], [300.0, 200.0]])
    for corners in (square + NAN, square * INF, square - 1e300, square * 0.0, square[::-1]):
        yield good(body, detection(4, corners))
        yield TagDetectionArray(width=640, height=480, detections=[detection(5, corners)])
    ids = (-1, -(2**31), 2**31 - 1, 587, 3)
    families = ("tag99h9", "", TERMINAL, "tag36h11 ")
    yield good(body, *(detection(tag, square) for tag in ids))
    yield good(body, *(detection(4, square, family) for family in families))
    many = [detection(tag % 9, square) for tag in range(5000)]
    yield TagDetectionArray(width=640, height=480, detections=many)
    nothing = PoseWithCovariance(covariance=[NAN] * 36)
    values = {"frame_id": TERMINAL, "size": NAN, "hamming": -1, "pose": nothing, "has_pose": True}
    yield good(body, detection(3, square, decision_margin=INF, **values))
    bundles = [TagBundlePose(name=TERMINAL, family=TERMINAL, ids=[-1] * 5000)] * 2
    for stamp in (rospy.Time(0), rospy.Time(HIGHEST, 999_999_999)):
        frame = good(body)
        frame.header.stamp, frame.header.frame_id, frame.bundles = stamp, TERMINAL, bundles
        yield frame


OFTEN_TOLD = """
from robot_vision.tags import bundle_recorder, calibrate_bundle
bundle_recorder.PROGRESS = 0.02  # s
raise SystemExit(calibrate_bundle.main())
"""


def test_hostile_detections_are_survived_and_reported(start, tmp_path):
    """Frames of other cameras and impossible corners are ignored; the others are learnt from."""
    tags, infos = Source(new_topic(), TagDetectionArray), Source(new_topic(), CameraInfo)
    program, path = tmp_path / "often_told.py", tmp_path / "box.yaml"
    program.write_text(OFTEN_TOLD)
    topics = f"tags:={tags.topic}", f"camera_info:={infos.topic}"
    process = start(str(program), *command(path), *topics)
    tags.wait_for()
    infos.wait_for()

    def send_until(text, frame, info=None):
        """Sends both messages again and again, because the two topics come in any order."""

        def told():
            infos.send(info or calibrated())
            tags.send(frame)
            *_, line = ["", *process.output().splitlines(keepends=True)]
            return text in line

        support.wait_for(told, text)

    body, *bodies = views(24)
    tiny = good(body)
    tiny.width, tiny.height = 2, 1
    for frame, info, reason in hostile_frames(body):
        if "first frames" in reason:  # there are no first frames yet
            continue
        if info:  # else a late valid calibration might meet the next good frame
            send_until("is of 320x240, the image 2x1", tiny, calibrated(width=320, height=240))
        send_until(reason, frame, info)
    assert process.output().count("waiting: ") == len(process.output().splitlines())
    send_until("1 of 300 frames", good(body))
    for frame, info, reason in hostile_frames(body):
        send_until(reason, frame, info)
    send_until("2 of 300 frames", good(bodies[0]))
    for frame in hostile_detections(body):
        tags.send(frame)
    send_until("whose corners no camera sees", good(body))
    assert frames_told(process) == 2
    for number, body in enumerate(bodies[1:], 3):
        send_until(f"{number} of 300 frames", good(body))
    process.interrupt()
    assert process.exit_code() == 0, process.output()
    output = process.output()
    assert "Traceback" not in output and output.replace("\n", "").isprintable(), output
    assert max(map(len, output.splitlines())) < 1000
    assert_learnt(path)


def test_from_a_bag_and_into_the_detector(calibrate, start, bag, tmp_path):
    code, output = calibrate("--bag", bag, "--image", IMAGE)
    assert code == 0, output
    path = tmp_path / "box.yaml"
    assert_learnt(path)
    assert path.read_text().startswith('tag_bundles:\n  - name: "box"\n    family: tag36h11\n')
    for values, namespace in rosparam.load_file(str(path), default_namespace="/tag"):
        rosparam.upload_params(namespace, values)
    body = facing(0.0, 0.0, 1.2, (0.2, -0.3, 0.1))
    studio = Studio(start, info=calibrated())
    answer = studio.show_until(lambda found: found.bundles, image_at(body, hidden=[4]))
    (bundle,) = answer.bundles
    assert (bundle.name, list(bundle.ids)) == ("box", [5, 6, 7])
    assert_near(matrix_of(bundle.pose.pose), body, 0.003, 0.5)


def test_a_camera_info_of_the_images_themselves_may_tell_the_binning(calibrate, images, tmp_path):
    info = calibrated()
    info.binning_x = info.binning_y = 2
    small = cv2.resize(images[1], (320, 240))
    mixed = write_bag(tmp_path / "mixed.bag", [images[0], small], info)
    error = refused(calibrate, tmp_path, "--bag", mixed, "--image", IMAGE)
    assert f"camera_info is of 640x480, image 1 on {IMAGE} 320x240" in error
    bag = write_bag(tmp_path / "binned.bag", images, info)
    code, output = calibrate("--bag", bag, "--image", IMAGE)
    assert code == 0, output
    assert_learnt(tmp_path / "box.yaml")


def test_compressed_images(calibrate, images, tmp_path):
    bag = write_bag(tmp_path / "box.bag", images, calibrated(), "png")
    code, output = calibrate("--bag", bag, "--image", IMAGE + "/compressed")
    assert code == 0, output
    assert_learnt(tmp_path / "box.yaml")


def test_ctrl_c_ends_the_collection(calibrate, bag, monkeypatch):
    add = FrameCollection.add

    def add_or_end(self, *arguments):
        if self.offered == 12:
            raise KeyboardInterrupt
        add(self, *arguments)

    monkeypatch.setattr(FrameCollection, "add", add_or_end)
    code, output = calibrate("--bag", bag, "--image", IMAGE)
    assert code == 0 and "box: 4 tags from 12 frames" in output, output


def test_no_more_frames_than_asked_for(calibrate, bag):
    code, output = calibrate("--bag", bag, "--image", IMAGE, "--frames", 12)
    assert code == 0, output
    assert "12 of 12 frames; tags: 4 (12), " in output
    assert "box: 4 tags from 12 frames, in the frame of tag 4\n  tag 4: 0." in output


def test_a_tag_of_another_size_than_stated(calibrate, bag, tmp_path):
    """A slightly larger tag leaves large residuals; a much larger one fits nowhere."""
    bag = ("--bag", bag, "--image", IMAGE, "--frames", 12, "--size")
    error = refused(calibrate, tmp_path, *bag, f"{SIZE},7:{1.3 * SIZE}")
    assert (
        "tag 7 fits in only 1 of the 10 frames that show it with others: is its size 0.26" in error
    )
    code, output = calibrate(*bag, f"{SIZE},7:{1.05 * SIZE}")
    (large,) = (line for line in output.splitlines() if "LARGE" in line)
    assert code == 0 and large.startswith("  tag 7: "), output
    (bundle,) = parse_bundles(yaml.safe_load((tmp_path / "box.yaml").read_text())["tag_bundles"])
    assert {tag.id: tag.size for tag in bundle.tags} == {4: SIZE, 5: SIZE, 6: SIZE, 7: 1.05 * SIZE}


def test_a_file_is_replaced_only_by_force(calibrate, bag, tmp_path):
    path = tmp_path / "box.yaml"
    write_bundles(str(path), [rv.Bundle("old", [rv.BundleTag(1, 0.1, np.eye(4))])])
    old = path.read_bytes()
    code, output = calibrate("--bag", bag, "--image", IMAGE)
    assert (code, output) == (
        1,
        f"calibrate_bundle.py: {path} is there already; --force replaces it\n",
    )
    assert path.read_bytes() == old
    code, output = calibrate("--bag", bag, "--image", IMAGE, "--force")
    assert code == 0, output
    assert_learnt(path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["box.yaml"]


def test_unsuitable_bags_are_named(calibrate, images, bag, tmp_path):
    def error(path, *arguments, image=IMAGE):
        return refused(calibrate, tmp_path, "--bag", path, "--image", image, *arguments)

    few = images[:3]
    missing = f"{tmp_path}/none.bag cannot be read: No such file or directory"
    assert missing in error(tmp_path / "none.bag")
    (tmp_path / "text.bag").write_text("not a bag")
    assert f"{tmp_path}/text.bag cannot be read: " in error(tmp_path / "text.bag")
    os.mkfifo(str(tmp_path / "pipe.bag"))
    for no_file in (tmp_path / "pipe.bag", tmp_path, "/dev/zero"):
        assert error(no_file).endswith(f"{no_file} cannot be read: it is no file")
    assert f"has no images on '/other', but on {IMAGE}" in error(bag, image="/other")
    assert f"has no images on '{INFO}', but on {IMAGE}" in error(bag, image=INFO)
    blind = write_bag(tmp_path / "blind.bag", few)
    assert f"has no camera_info on '{INFO}', but on no topic" in error(blind)
    assert f"no camera_info on '/x', but on {INFO}" in error(bag, "--camera-info", "/x")
    plain = write_bag(tmp_path / "plain.bag", few, calibrated(matrix=np.zeros((3, 3))))
    assert f"camera_info on {INFO}: the camera is not calibrated" in error(plain)
    other = write_bag(tmp_path / "other.bag", few, calibrated(320, 240))
    assert f"of 320x240, image 0 on {IMAGE} 640x480" in error(other)
    broken = write_bag(tmp_path / "broken.bag", [few[0][:, :0]], calibrated())
    assert f"image 0 on {IMAGE} cannot be used: " in error(broken)
    wide = write_bag(tmp_path / "wide.bag", [np.zeros((16, 8193), np.uint8)], calibrated())
    assert f"image 0 on {IMAGE} cannot be used: image is 8193x16" in error(wide)
    floats = write_bag(tmp_path / "floats.bag", [np.float32(few[0])], calibrated(), "32FC1")
    assert f"image 0 on {IMAGE} cannot be used: " in error(floats)
    with rosbag.Bag(str(tmp_path / "open.bag"), "w") as unfinished:
        unfinished.write(INFO, calibrated())
        unfinished.flush()
        assert f"has no index: try rosbag reindex {tmp_path}/open.bag" in error(
            tmp_path / "open.bag"
        )
    gray = write_bag(tmp_path / "gray.bag", [np.full((480, 640), 99, np.uint8)] * 2, calibrated())
    assert "none of the tags was seen in 2 frames" in error(gray)


def test_a_damaged_bag_is_named(calibrate, images, monkeypatch, tmp_path):
    """It is wherever the damage is, although rosbag's many errors do not name the file."""
    whole = write_bag(tmp_path / "whole.bag", images[:2], calibrated()).read_bytes()
    monkeypatch.setattr("robot_vision.tags.bundle_bag.TagDetector.detect", lambda *_: [])
    bag = tmp_path / "damaged.bag"
    random = np.random.default_rng(1)
    # Records of messages follow the first 4 kB; those of the index are at the end.
    places = [*range(13, 120, 9), *range(4096, 4400, 25), *range(len(whole) - 1500, len(whole), 60)]
    for place in places:
        bag.write_bytes(whole[:place] + random.bytes(8) + whole[place + 8 :])
        code, output = calibrate("--bag", bag, "--image", IMAGE)
        *_, error = output.splitlines()
        assert code == 1 and "Traceback" not in output, (place, output)
        assert str(bag) in error or "none of the tags was seen" in error or IMAGE in error, error
    for size in range(0, 4200, 300):
        bag.write_bytes(whole[:size])
        assert f"calibrate_bundle.py: {bag} " in refused(
            calibrate, tmp_path, "--bag", bag, "--image", IMAGE
        )


def test_errors_of_learning_are_named(calibrate, bag, tmp_path):
    def error(*arguments):
        return refused(calibrate, tmp_path, "--bag", bag, "--image", IMAGE, *arguments)

    assert "master tag 3 was not seen" in error("--ids", "3-7")
    assert "tag 9 was not seen" in error("--ids", "4-7,9")
    body = next(views(1))
    apart = [image_at(body, hidden=[6, 7]), image_at(body, hidden=[4, 5, 7])]
    bag = write_bag(tmp_path / "apart.bag", apart, calibrated())
    assert "tags [6] were never seen together with the master tag 4" in error("--ids", "4-6")


def test_a_live_recording_that_cannot_be_used(start, calibrate, monkeypatch, tmp_path):
    nobody = start("calibrate_bundle.py", *command(tmp_path / "1.yaml"), "tags:=/nobody/tags")
    studio = Studio(start, info=calibrated(matrix=np.zeros((3, 3))))
    plain = start("calibrate_bundle.py", *command(tmp_path / "2.yaml"), "tags:=/tag/tags")
    image = image_at(next(views(1)))
    info = studio.topic.replace("image", "camera_info")
    reason = f": camera_info on {info}: the camera is not calibrated\n"
    support.wait_for(
        lambda: studio.show(image) and f"waiting{reason}" in plain.output(), "what is wrong"
    )
    plain.interrupt()
    assert plain.exit_code() == 1
    assert f"calibrate_bundle.py{reason}" in plain.output()
    nobody.wait_for_output(
        "waiting: no tags came on /nobody/tags; nobody publishes there: see tags:= in --help\n"
    )
    nobody.interrupt()
    assert nobody.exit_code() == 1
    assert "calibrate_bundle.py: no tags came on /nobody/tags; nobody" in nobody.output()
    monkeypatch.setenv("ROS_MASTER_URI", f"http://127.0.0.1:{support.free_port()}")
    assert "no ROS master answers at http://127" in refused(calibrate, tmp_path)
    assert list(tmp_path.glob("*.yaml")) == []


@pytest.mark.parametrize(
    "arguments, reason",
    [
        (["--ids", "4"], "--ids: ids is '4', must be two or more different tags"),
        (["--ids", "4,4-5"], "--ids: ids is '4,4-5', must be two or more different tags"),
        (["--ids", "586-587"], "--ids: id is 587, tag36h11 has 0 to 586"),
        (["--family", "tag99h9"], "tag99h9"),
        (["--master", "9"], "--master: tag 9 is not one of --ids"),
        (["--size", "0"], "--size: '0' must be 0.1 or 3:0.1, above 0 and at most 100 m"),
        (["--size", "4:0.1,6:0.1"], "--size: there is none of the tags 5, 7"),
        (["--size", "0.1,0.2"], "--size: is '0.1,0.2', must have one size for all others"),
        (["--size", "0.1,9:0.1"], "--size: tag 9 is not one of --ids"),
        (["--name", ""], "--name: is '', must be a name of 1 to 255 printable letters"),
        (["--name", "a\tb"], "--name: is 'a\\tb', must be a name of 1 to 255 printable letters"),
        (["--name", "tag_4"], "--name: tag 4 of tag36h11 and bundle 'tag_4' have the same tr"),
        (["--name", "tag_99"], "--name: tag 99 of tag36h11 and bundle 'tag_99' have the same"),
        (["--frames", "0"], "--frames: 0 must be from 1 to 10000"),
        (["--bag", "box.bag"], "--bag needs --image"),
        (["--image", IMAGE], "--bag needs --image"),
    ],
)
def test_wrong_arguments_are_refused(calibrate, arguments, reason):
    code, output = calibrate(*arguments)
    assert code == 2 and reason in output, output


def test_an_output_that_cannot_be_written(calibrate, bag, tmp_path):
    for output, reason in (
        (tmp_path, "it is no file"),
        (tmp_path / "none" / "box.yaml", f"{tmp_path}/none is no folder"),
    ):
        arguments = ("--bag", bag, "--image", IMAGE)
        error = refused(calibrate, tmp_path, *arguments, output=output)
        assert error.endswith(f"{output} cannot be written: {reason}")


def test_help_has_examples(calibrate):
    code, output = calibrate("--help")
    assert code == 0 and "calibrate_bundle.py --name box --ids 0-5" in output
