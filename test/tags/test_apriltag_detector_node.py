"""The node apriltag_detector: tags, poses, tf, markers and ~detect against the ground truth."""

import itertools
import os
import struct
import threading
import zlib

import cv2
import numpy as np
import pytest
import rospy
import support
from exif import sideways
from frames import Source, message
from sensor_msgs.msg import Image
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
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from robot_vision.msg import GroundTruth, TagDetectionArray
from robot_vision.srv import DetectTags


def with_poses(answer):
    return answer.detections and all(tag.has_pose for tag in answer.detections)


def test_all_fields_of_a_tag(start):
    studio = Studio(start, info=calibrated())
    truth = facing(0.1, -0.05, 1.0, (0.5, 0.2, 0.3))
    transforms = support.subscribed("/tf", TFMessage)
    answer = studio.show_until(with_poses, image_of([(5, truth)]))
    assert (answer.width, answer.height, answer.header.frame_id) == (640, 480, "eye")
    (tag,) = answer.detections
    assert (tag.family, tag.id, tag.frame_id, tag.size) == ("tag36h11", 5, "tag_5", SIZE)
    assert tag.hamming == 0 and tag.decision_margin > 50.0 and 0.9 < tag.similarity <= 1.0
    corners = np.array([(corner.x, corner.y) for corner in tag.corners])
    assert np.abs(corners - corners_of(truth)).max() < 0.3
    middle = truth[:2, 3] / truth[2, 3] * 500.0 + K[:2, 2]
    assert np.hypot(tag.center.x - middle[0], tag.center.y - middle[1]) < 0.3
    assert_near(matrix_of(tag.pose.pose), truth)
    covariance = np.reshape(tag.pose.covariance, (6, 6))
    assert np.allclose(covariance, covariance.T)
    assert (np.linalg.eigvalsh(covariance) > 0.0).all() and np.sqrt(covariance[2, 2]) < 0.02
    assert tag.reprojection_error < 0.3 and tag.probability > 0.9
    assert tag.has_other_pose and tag.other_reprojection_error > tag.reprojection_error
    assert tag.error_ratio == pytest.approx(tag.reprojection_error / tag.other_reprojection_error)
    assert angle_between(matrix_of(tag.other_pose), truth) > 20.0
    (transform,) = transforms.of(answer.header.stamp).transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("eye", "tag_5")
    assert np.allclose(matrix_of(transform.transform), matrix_of(tag.pose.pose))


def test_poses_follow_the_scene(start):
    start("camera_node", "__name:=camera", "_source:=synthetic")
    start("apriltag_detector.py", "__name:=tag", "image:=/camera/image_raw", "_tag_size:=0.24")
    tags = support.Messages("/tag/tags", TagDetectionArray)
    truths = support.Messages("/camera/ground_truth", GroundTruth)

    def common():
        return {support.stamp_of(one) for one in tags.received} & {
            support.stamp_of(one) for one in truths.received
        }

    support.wait_for(lambda: len(common()) >= 150, "tags and the truth of 150 frames")
    truth_of = {message.header.stamp: message for message in truths.received}
    seen, missed, pixels, places, turns = 0, 0, [], [], []
    for answer in tags.received:
        if answer.header.stamp not in truth_of:
            continue
        found = {tag.id: tag for tag in answer.detections}
        assert set(found) <= {0, 1}
        for name in ("tag_0", "tag_1"):
            truth = next(o for o in truth_of[answer.header.stamp].objects if o.name == name)
            tag = found.get(int(name[-1]))
            missed += truth.visible and tag is None
            if not truth.visible or tag is None or not tag.has_pose:
                continue
            seen += 1
            corners = zip(tag.corners, truth.outline)
            pixels += [np.hypot(a.x - b.x, a.y - b.y) for a, b in corners]
            pose, true = matrix_of(tag.pose.pose), matrix_of(truth.pose)
            distance = np.linalg.norm(true[:3, 3])
            places.append(np.linalg.norm(pose[:3, 3] - true[:3, 3]) / distance)
            turns.append(angle_between(pose, true))
    assert seen > 150 and missed < 0.1 * seen, (seen, missed)
    assert np.median(pixels) < 0.3, np.percentile(pixels, [50, 99])
    assert np.median(places) < 0.01, np.percentile(places, [50, 99])
    assert np.median(turns) < 2.0, np.percentile(turns, [50, 99])


def test_measuring_of_corners_is_switched_while_running(start):
    studio = Studio(start, info=calibrated())
    truth = facing(0.1, -0.05, 1.0, (0.5, 0.2, 0.3))

    def deviation(answer):
        return answer.detections[0].pose.covariance[14] ** 0.5  # m, of z

    image = image_of([(5, truth)])
    measured = studio.show_until(with_poses, image)
    assert_near(matrix_of(measured.detections[0].pose.pose), truth, metres=0.002, degrees=0.2)
    support.reconfigured("/tag", measure_corners=False)
    found = studio.show_until(
        lambda answer: with_poses(answer) and deviation(answer) > 2.0 * deviation(measured), image
    )
    assert_near(matrix_of(found.detections[0].pose.pose), truth)
    support.reconfigured("/tag", measure_corners=True)
    studio.show_until(
        lambda answer: with_poses(answer) and deviation(answer) < 1.1 * deviation(measured), image
    )


def test_without_calibration_there_are_corners_and_one_warning(start):
    studio = Studio(start, info=calibrated(matrix=np.zeros((3, 3))))
    truth = facing(0.0, 0.0, 1.0)
    image = image_of([(3, truth)])
    reason = f"no poses of tags: camera_info on {studio.topic.replace('image', 'camera_info')}: "
    reason += "the camera is not calibrated"

    def is_told():  # An image may be there before its camera_info.
        (tag,) = studio.show(image).detections
        assert not tag.has_pose
        corners = np.array([(corner.x, corner.y) for corner in tag.corners])
        assert np.abs(corners - corners_of(truth)).max() < 0.3
        return reason in studio.process.output()

    support.wait_for(is_told, "the reason")
    told = studio.process.output().count("no poses of tags")
    for _ in range(10):
        is_told()
    assert studio.process.output().count(reason) == 1
    assert studio.process.output().count("no poses of tags") == told
    studio.info = calibrated()  # comes late
    answer = studio.show_until(with_poses, image)
    assert_near(matrix_of(answer.detections[0].pose.pose), truth)
    for info, problem in (
        (calibrated(width=320), "camera_info is of 320x480, the image 640x480"),
        (calibrated(matrix=K * [[np.nan], [1], [1]]), "nan"),
        (calibrated(model="wobbly"), "wobbly"),
    ):
        studio.info = info
        # Images may overtake camera_info.
        support.wait_for(
            lambda problem=problem: studio.show(image) and problem in studio.process.output(),
            problem,
        )
        (tag,) = studio.show(image).detections
        assert not tag.has_pose
    studio.info = calibrated()
    studio.show_until(with_poses, image)


def test_tags_without_camera_info(start):
    studio = Studio(start)
    image = image_of([(3, facing(0.0, 0.0, 1.0))])
    support.wait_for(
        lambda: (
            not studio.show(image).detections[0].has_pose
            and "camera_info: there is none" in studio.process.output()
        ),
        "the warning",
    )


def test_sizes_names_families_and_bundles(start):
    layout = {
        "standalone_tags": [
            {"id": 7, "size": 0.1, "name": "dock"},
            {"ids": "20-22", "size": 0.05},
            {"id": 3, "family": "tag25h9", "size": 0.3},
        ],
        "tag_bundles": [
            {
                "name": "rig",
                "layout": [
                    {"id": 1, "size": SIZE, "x": -0.15},
                    {"id": 2, "size": SIZE, "x": 0.15},
                ],
            }
        ],
    }
    for name, value in layout.items():
        rospy.set_param("/tag/" + name, value)
    studio = Studio(start, "_families:=tag36h11, tag25h9", info=calibrated())
    rig = facing(0.05, 0.1, 1.2, (0.3, -0.3, 0.1))
    shifts = [np.eye(4) for _ in range(2)]
    shifts[0][0, 3], shifts[1][0, 3] = -0.15, 0.15
    image = image_of([(1, rig @ shifts[0]), (2, rig @ shifts[1]), (7, facing(0.2, -0.3, 1.0))])
    other = image_of([(3, facing(-0.4, -0.3, 1.2))], "tag25h9")
    image = np.where(other == 150, image, other)
    answer = studio.show_until(lambda a: len(a.detections) == 4 and with_poses(a), image)
    found = {(tag.family, tag.id): tag for tag in answer.detections}
    assert {key: (tag.size, tag.frame_id) for key, tag in found.items()} == {
        ("tag36h11", 1): (SIZE, "tag_1"),
        ("tag36h11", 2): (SIZE, "tag_2"),
        ("tag36h11", 7): (0.1, "dock"),
        ("tag25h9", 3): (0.3, "tag25h9_3"),
    }
    # A tag of half the stated size is taken to be half as far away.
    place = matrix_of(found["tag36h11", 7].pose.pose)[:3, 3]
    assert np.allclose(place, [0.1, -0.15, 0.5], atol=0.01)
    (bundle,) = answer.bundles
    assert (bundle.name, bundle.family, list(bundle.ids)) == ("rig", "tag36h11", [1, 2])
    assert_near(matrix_of(bundle.pose.pose), rig, 0.005, 0.5)
    assert bundle.reprojection_error < 0.3 and bundle.probability > 0.99


def test_two_tags_of_one_id_have_poses_but_no_transform(start):
    studio = Studio(start, info=calibrated())
    transforms = support.subscribed("/tf", TFMessage)
    places = [facing(-0.3, 0.0, 1.0), facing(0.3, 0.0, 1.0)]
    image = image_of([(4, places[0]), (4, places[1]), (6, facing(0.0, 0.3, 1.0))])
    answer = studio.show_until(lambda a: len(a.detections) == 3 and with_poses(a), image)
    twins = sorted((t for t in answer.detections if t.id == 4), key=lambda t: t.center.x)
    for tag, truth in zip(twins, places):
        assert_near(matrix_of(tag.pose.pose), truth, 0.02, 15.0)
    (transform,) = transforms.of(answer.header.stamp).transforms
    assert transform.child_frame_id == "tag_6"
    studio.process.wait_for_output("tag 4 of tag36h11 is there more than once: no transform of it")


def test_markers_and_overlay(start):
    studio = Studio(start, info=calibrated())
    boxes = support.subscribed("/tag/markers", MarkerArray)
    overlays = support.subscribed("/tag/processed_image", Image)
    truth = facing(0.0, 0.0, 1.0, (0.6, 0.0, 0.0))
    image = image_of([(5, truth)])
    answer = studio.show_until(with_poses, image)
    support.wait_for(lambda: any(array.markers for array in boxes.received), "markers")
    box, text = boxes.received[-1].markers
    assert (box.type, box.ns, box.id, box.scale.x) == (Marker.CUBE, "tag36h11", 5, SIZE)
    assert (text.type, text.text) == (Marker.TEXT_VIEW_FACING, "5")
    assert box.header.frame_id == "eye" and 0.0 < box.lifetime.to_sec() < 2.0
    assert_near(matrix_of(box.pose), truth)
    drawn = overlays.of(answer.header.stamp)
    assert drawn.encoding == "bgr8"
    bgr = np.frombuffer(drawn.data, np.uint8).reshape(480, 640, 3)
    x, y, _ = truth[:3, :3].T * SIZE / 2
    for axis, color in ((x, (0, 0, 255)), (y, (0, 255, 0))):
        point = truth[:3, 3] + 0.8 * axis
        column, row = np.rint(point[:2] / point[2] * 500.0 + K[:2, 2]).astype(int)
        near = bgr[row - 2 : row + 3, column - 2 : column + 3].reshape(-1, 3)
        assert (np.abs(near.astype(int) - color).max(axis=1) < 60).any(), axis


def test_images_of_any_encoding(start):
    studio = Studio(start, info=calibrated())
    overlays = support.subscribed("/tag/processed_image", Image)
    gray = image_of([(5, facing(0.0, 0.0, 1.0))])
    for number, (encoding, image) in enumerate(
        {
            "bgr8": np.dstack([gray] * 3),
            "rgb8": np.dstack([gray] * 3),
            "bgra8": np.dstack([gray] * 4),
            "mono8": gray,
            "mono16": gray.astype(np.uint16) * 257,
        }.items()
    ):
        assert [tag.id for tag in studio.show(image, encoding).detections] == [5], encoding
        overlays.wait(number + 1)


def test_frames_of_other_encodings_are_refused(start):
    studio = Studio(start, info=calibrated())
    source = Source(studio.topic)
    source.wait_for()
    refused = f"refused a frame on {studio.topic} "
    for dtype, encoding, reason in (
        (np.float32, "32FC1", "expected an array of uint8 or uint16, got float32"),
        (np.uint8, "8UC1", "encoding '8UC1' is not one of bgr8, "),
    ):
        frame, said = message(np.zeros((48, 64), dtype), encoding), f"({encoding}, 64x48): {reason}"
        # The error is throttled, however many frames are refused.
        support.wait_for(
            lambda: source.send(frame) or refused + said in studio.process.output(),  # noqa: B023
            said,
        )
    assert "Traceback" not in studio.process.output()
    assert studio.show(image_of([(5, facing(0.0, 0.0, 1.0))])).detections


class Caller:
    """Calls ~detect in a thread while the camera goes on."""

    def __init__(self, studio):
        self._studio = studio
        studio.tags.close()  # leaves the node without subscribers

    def __call__(self, file="", image=None, encoding="mono8"):
        answers = []
        detect = rospy.ServiceProxy("/tag/detect", DetectTags)
        call = threading.Thread(target=lambda: answers.append(detect(file)))
        call.start()
        while call.is_alive():
            if image is None:
                self._studio.infos.send(self._studio.info)
            else:
                self._studio.send(image, encoding)
            call.join(0.1)
        return answers[0]


def test_detect_the_next_frame(start):
    detect = Caller(Studio(start, info=calibrated()))
    image = image_of([(9, facing(0.0, 0.0, 1.0)), (8, facing(0.3, 0.0, 1.0))])
    answer = detect(image=image)
    assert answer.success and [tag.id for tag in answer.tags.detections] == [8, 9]
    assert answer.tags.header.frame_id == "eye"

    def refused():
        """The answer of a frame that has come, which those before may still get ahead of."""
        one = detect(image=np.zeros((48, 64), np.uint8), encoding="8UC1")
        return None if one.success else one

    answer = support.wait_for(refused, "a refusal")
    assert "encoding '8UC1' is not one of" in answer.message


def test_detect_waits_for_a_calibration_that_comes_after_the_frame(start):
    studio = Studio(start)
    detect = Caller(studio)
    send = studio.send

    def answered():
        """An answer with poses; the calibration may come too late on a busy machine."""
        studio.infos.wait_for(0)  # the node has forgotten an earlier one
        images = itertools.count()

        def show(*arguments):
            studio.info = calibrated() if next(images) >= 5 else None
            send(*arguments)

        studio.send = show
        one = detect(image=image_of([(9, facing(0.0, 0.0, 1.0))]))
        return one if with_poses(one.tags) else None

    assert support.wait_for(answered, "poses").message == ""


def test_detect_a_file(start, tmp_path):
    studio = Studio(start, info=calibrated())
    studio.info.header.frame_id = "lens"
    detect = Caller(studio)
    image = image_of([(9, facing(0.0, 0.0, 1.0)), (8, facing(0.3, 0.0, 1.0))])
    path = str(tmp_path / "tags.png")
    cv2.imwrite(path, image)

    def located(path, is_right=lambda _: True):
        """The answer to a call for which the calibration has come in time."""

        def answer():
            one = detect(path)
            return one if with_poses(one.tags) and is_right(one.tags.detections[1]) else None

        return support.wait_for(answer, "poses")

    answer = located(path)
    assert (answer.success, answer.message) == (True, "")
    assert [tag.id for tag in answer.tags.detections] == [8, 9] and with_poses(answer.tags)
    assert answer.tags.header.frame_id == "lens"
    assert_near(matrix_of(answer.tags.detections[1].pose.pose), facing(0, 0, 1.0), 0.01, 15.0)
    # The calibration holds for the sensor's pixels, whichever side of the camera was up.
    file = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 99])[1].tobytes()
    (tmp_path / "sideways.jpg").write_bytes(sideways(file))
    answer = located(str(tmp_path / "sideways.jpg"))
    assert (answer.success, answer.message) == (True, "")
    assert_near(matrix_of(answer.tags.detections[1].pose.pose), facing(0, 0, 1.0), 0.01, 15.0)
    # Another lens has been put on the camera while the node did nothing.
    studio.infos.wait_for(0)
    studio.info = calibrated(matrix=K @ np.diag([2.0, 2.0, 1.0]))
    located(path, lambda tag: tag.pose.pose.position.z == pytest.approx(2.0, rel=0.01))
    studio.info = calibrated()
    cv2.imwrite(path, cv2.copyMakeBorder(image, 8, 8, 8, 8, cv2.BORDER_REPLICATE))
    reason = "camera_info is of 640x480, the image 656x496"
    answers = []
    support.wait_for(lambda: answers.append(detect(path)) or reason in answers[-1].message, reason)
    assert answers[-1].success and not answers[-1].tags.detections[0].has_pose
    header = struct.pack(">IIBBBBB", 60000, 60000, 8, 0, 0, 0, 0)
    chunk = (
        struct.pack(">I", 13) + b"IHDR" + header + struct.pack(">I", zlib.crc32(b"IHDR" + header))
    )
    (tmp_path / "huge.png").write_bytes(b"\x89PNG\r\n\x1a\n" + chunk)
    os.mkfifo(str(tmp_path / "pipe.png"))
    for file, reason in (
        ("tags.png", "file is 'tags.png', must be an absolute path"),
        (str(tmp_path / "none.png"), "none.png cannot be read: No such file or directory"),
        (str(tmp_path / "huge.png"), "huge.png: claims to be of 60000x60000, the most is 67108864"),
        (str(tmp_path / "pipe.png"), "pipe.png cannot be read: it is no file"),
        ("/dev/zero", "/dev/zero cannot be read: it is no file"),
        (__file__, "no image that OpenCV can read"),
    ):
        answer = detect(file)
        assert not answer.success and reason in answer.message, answer.message


def test_detect_a_file_without_a_camera(start, tmp_path):
    Studio(start).tags.close()
    path = str(tmp_path / "tags.png")
    cv2.imwrite(path, image_of([(9, facing(0.0, 0.0, 1.0))]))
    answer = rospy.ServiceProxy("/tag/detect", DetectTags)(path)
    assert answer.success and [tag.id for tag in answer.tags.detections] == [9]
    assert answer.message.startswith("no poses of tags: camera_info on /frames_")


def test_detect_without_frames(start):
    Studio(start).tags.close()
    answer = rospy.ServiceProxy("/tag/detect", DetectTags)("")
    assert not answer.success and "no frame on /frames_" in answer.message


def test_a_listener_to_transforms_is_a_subscriber(start):
    studio = Studio(start, info=calibrated())
    studio.tags.close()
    studio.wait_for_subscribers(0)
    transforms = support.Messages("/tf", TFMessage)
    image = image_of([(2, facing(0.0, 0.0, 1.0))])
    support.wait_for(lambda: studio.send(image) and transforms.received, "a transform")
    assert transforms.received[0].transforms[0].child_frame_id == "tag_2"


def test_listeners_to_transforms_that_are_off_do_not_count(start):
    studio = Studio(start, "_publish_tf:=false", info=calibrated())
    transforms = support.subscribed("/tf", TFMessage)
    studio.show(image_of([(2, facing(0.0, 0.0, 1.0))]))
    studio.tags.close()
    studio.wait_for_subscribers(0)
    support.reconfigured("/tag", publish_tf=True)
    studio.wait_for_subscribers(1)
    assert not transforms.received


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("families", "tag36h12", "tag36h12"),
        ("decimate", 11.0, "decimate is 11, must be from 0 to 10"),
        ("threads", -1, "threads is -1, must be from 0 (all cores) to 256"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "apriltag_detector.py", name, value, text)
