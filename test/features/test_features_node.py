"""The node features: what it publishes, its reference files, and its live parameters."""

import cv2
import numpy as np
import pytest
import rospy
import skimage.data
import support
from frames import Camera
from sensor_msgs.msg import Image

import robot_vision as rv
from robot_vision.common.plain_text import brief
from robot_vision.msg import DetectionArray, KeypointMatches, Keypoints

PORTRAIT = cv2.resize(cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2BGR), (240, 240))
TILTED = np.array([[0.9, -0.1, 60.0], [0.1, 0.9, 30.0], [2e-4, 1e-4, 1.0]])
VIEW = cv2.warpPerspective(PORTRAIT, TILTED, (320, 300))
OUTLINE = cv2.perspectiveTransform(
    np.array([[(-0.5, -0.5), (239.5, -0.5), (239.5, 239.5), (-0.5, 239.5)]]), TILTED
)[0]
GREEN, RED, YELLOW = (0, 255, 0), (0, 0, 255), (0, 255, 255)


class Desk:
    """A node, and what it says of each frame."""

    def __init__(self, start, *arguments):
        self._camera = Camera(10.0)
        topic = f"image:={self._camera.topic}"
        self.process = start("features.py", "__name:=features", topic, *arguments)
        self._topics = [
            support.subscribed("/features/keypoints", Keypoints),
            support.subscribed("/features/matches", KeypointMatches),
            support.subscribed("/features/objects", DetectionArray),
            support.subscribed("/features/processed_image", Image),
        ]
        self._camera.wait_for()

    def begin_anew(self):
        """Has the stamps begin anew, with others than those that were."""
        self._camera = Camera(11.0, self._camera.topic)
        self._camera.wait_for()

    def show(self, pixels):
        """Sends a frame; its keypoints, matches, objects and overlay."""
        header = self._camera.show(pixels)
        answers = [topic.of(header.stamp) for topic in self._topics]
        assert all(answer.header.frame_id == "eye" for answer in answers)
        *messages, overlay = answers
        assert overlay.encoding == "bgr8"
        drawn = np.frombuffer(overlay.data, np.uint8).reshape(pixels.shape)
        return (*messages, drawn)


def has(image, color):
    return (image == color).all(axis=2)


def params(**values):
    made = rv.KeypointParams()
    for name, value in values.items():
        setattr(made, name, value)
    return made


@pytest.fixture
def portrait(tmp_path):
    path = tmp_path / "portrait.png"
    cv2.imwrite(str(path), PORTRAIT)
    return path


def test_keypoints_of_a_frame_field_by_field_and_live_parameters(start):
    desk = Desk(start)
    found, matches, objects, drawn = desk.show(PORTRAIT)
    expected = rv.find_keypoints(PORTRAIT)
    assert found.detector == "orb" and len(found.x) == len(expected) > 100
    assert np.array_equal(np.column_stack([found.x, found.y]), expected.points)
    assert np.array_equal(found.size, expected.sizes)
    assert np.array_equal(found.angle, expected.angles) and max(found.angle) > 3.0
    assert np.array_equal(found.response, expected.responses)
    assert np.array_equal(found.octave, expected.octaves) and max(found.octave) > 2
    assert not matches.points and not matches.found and matches.reference == ""
    assert (objects.width, objects.height, objects.detections) == (240, 240, [])
    circles = [
        cv2.KeyPoint(*values)
        for values in zip(found.x, found.y, found.size, np.rad2deg(found.angle).tolist())
    ]
    rich = cv2.DRAW_MATCHES_FLAGS_DRAW_RICH_KEYPOINTS
    expected = cv2.drawKeypoints(PORTRAIT, circles, None, YELLOW, rich)
    assert has(drawn, YELLOW).sum() > 500 and (drawn != expected).mean() < 0.01
    config = support.reconfigured("/features", detector="shi_tomasi", max_features=7)
    assert (config["detector"], config["max_features"]) == ("shi_tomasi", 7)
    found = desk.show(PORTRAIT)[0]
    expected = rv.find_keypoints(PORTRAIT, params=params(detector="shi_tomasi", max_features=7))
    assert found.detector == "shi_tomasi"
    assert np.array_equal(np.column_stack([found.x, found.y]), expected.points)
    assert found.angle == (-1.0,) * 7
    config = support.reconfigured("/features", detector="surf", max_features=8)
    assert (config["detector"], config["max_features"]) == ("shi_tomasi", 7)
    desk.process.wait_for_output("refused, the parameters stay as they are: detector is surf")


def test_a_reference_is_found_by_its_file(start, portrait):
    desk = Desk(start, "_match:=reference", f"_reference:={portrait}", "_detector:=akaze")
    _, matches, objects, drawn = desk.show(VIEW)
    (found,) = objects.detections
    assert (found.label, found.id) == ("portrait", -1)
    outline = [(point.x, point.y) for point in found.outline]
    assert np.abs(outline - OUTLINE).max() < 1.5
    left, top = np.floor(np.min(outline, axis=0) + 0.5).astype(int)
    right, bottom = np.ceil(np.max(outline, axis=0) - 0.5).astype(int)
    assert (found.box.x_offset, found.box.y_offset) == (left, top)
    assert (found.box.width, found.box.height) == (right - left + 1, bottom - top + 1)
    assert found.area == pytest.approx(cv2.contourArea(OUTLINE.astype(np.float32)), rel=0.02)
    middle = cv2.perspectiveTransform(np.array([[(119.5, 119.5)]]), TILTED)[0, 0]
    assert (found.center.x, found.center.y) == pytest.approx(middle, abs=1.0)
    assert matches.reference == "portrait" and matches.reference_stamp == rospy.Time()
    assert matches.found and found.score == pytest.approx(np.mean(matches.inliers))
    ends = [[(p.x, p.y) for p in side] for side in (matches.reference_points, matches.points)]
    assert len(matches.distances) == len(matches.inliers) == len(ends[0]) == len(ends[1]) > 30
    homography = np.reshape(matches.homography, (3, 3))
    there = cv2.perspectiveTransform(np.array([ends[0]]), homography)[0]
    inliers = np.array(matches.inliers)
    assert np.abs(there - ends[1])[inliers].max() < 6.0 and max(matches.distances) < 486
    x, y = np.rint((OUTLINE[0] + OUTLINE[1]) / 2).astype(int)
    assert has(drawn[y - 3 : y + 4, x - 3 : x + 4], GREEN).any()
    x, y = np.rint(np.array(ends[1])[inliers][0]).astype(int)
    assert has(drawn[y : y + 1, x : x + 1], GREEN).all()
    _, matches, objects, drawn = desk.show(np.full_like(VIEW, 90))
    assert not objects.detections and not matches.found and matches.homography == (0.0,) * 9
    assert (drawn == 90).all()


@pytest.mark.parametrize("arguments", [(), ("_matcher:=flow", "_detector:=shi_tomasi")])
def test_points_are_matched_with_the_frame_before(start, arguments):
    desk = Desk(start, "_match:=last_frame", *arguments)
    first, matches, _, _ = desk.show(PORTRAIT)
    assert not matches.points and matches.reference_stamp == rospy.Time()
    moved = np.roll(PORTRAIT, (6, -9), (0, 1))
    _, matches, objects, drawn = desk.show(moved)
    assert matches.reference == "" and matches.reference_stamp == first.header.stamp
    assert len(matches.points) == len(matches.distances) > 50 and not objects.detections
    assert not arguments or max(matches.distances) <= 1.0  # px by which a point misses itself
    homography = np.reshape(matches.homography, (3, 3))
    middle = cv2.perspectiveTransform(np.array([[(119.5, 119.5)]]), homography)[0, 0]
    assert middle == pytest.approx((110.5, 125.5), abs=0.3)
    inlier = matches.inliers.index(True)
    x, y = round(matches.points[inlier].x), round(matches.points[inlier].y)
    assert has(drawn[y - 1 : y + 2, x - 1 : x + 2], GREEN).any()
    x, y = round(x + 4.5), round(y - 3)  # half of the way back
    assert (drawn[y - 1 : y + 2, x - 1 : x + 2] != moved[y - 1 : y + 2, x - 1 : x + 2]).any()
    desk.begin_anew()
    _, matches, _, _ = desk.show(PORTRAIT)
    assert not matches.points and matches.reference_stamp == rospy.Time()
    assert desk.show(moved)[1].points
    support.reconfigured("/features", min_inliers=11)
    assert not desk.show(PORTRAIT)[1].points  # another matcher has no last frame


def test_bad_references_are_refused_in_words(start, portrait, tmp_path):
    desk = Desk(start)
    plain, text, bomb = tmp_path / "plain.png", tmp_path / "text.png", tmp_path / "bomb.ppm"
    cv2.imwrite(str(plain), np.full((90, 90), 70, np.uint8))
    text.write_text("no image")
    bomb.write_bytes(b"P6 60000 60000 255\n")
    for path, reason in [
        ("", ""),
        ("portrait.png", ""),
        (tmp_path / "none.png", ": No such file or directory"),
        (tmp_path, ": it is no file"),
        (text, ": no image that OpenCV can read"),
        (bomb, ": "),
        (plain, "the reference's number of described keypoints is 0, must be at least min_inliers"),
    ]:
        config = support.reconfigured("/features", match="reference", reference=str(path))
        assert (config["match"], config["reference"]) == ("none", "")
        if path != plain:
            given = f"reference is {brief(str(path))}, must be the absolute path of an image file"
            reason = given + reason
        desk.process.wait_for_output(f"refused, the parameters stay as they are: {reason}")
    wanted = {"match": "reference", "reference": str(portrait)}
    config = support.reconfigured("/features", matcher="flow", **wanted)
    assert (config["match"], config["matcher"]) == ("none", "brute_force")
    desk.process.wait_for_output(
        "matcher is flow, must be brute_force or flann if match is reference"
    )
    config = support.reconfigured("/features", **wanted)
    assert config["reference"] == str(portrait)
    assert desk.show(VIEW)[1].reference == "portrait"


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("match", "reference", "reference is '', must be the absolute path of an image file"),
        ("reference", 7, "reference is 7, must be a string"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "features.py", name, value, text)
