"""Colours that are picked and given to nodes, and what is selected, clicked and captured."""

import cv2
import numpy as np
import pytest
import rospy
import support
from feature_page import FeaturePage, RefusedError, subscribes
from frames import Camera
from sensor_msgs.msg import RegionOfInterest

from robot_vision.dashboard.capture_feature import CaptureFeature
from robot_vision.dashboard.color_feature import ColorFeature
from robot_vision.dashboard.select_feature import SelectFeature
from robot_vision.dashboard.select_topics import NodeTopics
from robot_vision.dashboard.settings import Settings
from robot_vision.msg import Click, DetectionArray
from robot_vision.ros.transport import Frame

RED, BLUE = (30, 20, 220), (220, 60, 20)  # BGR


def scene():
    """A red and a blue square on gray, and a gray pattern that can be followed."""
    image = np.full((240, 320, 3), 128, np.uint8)
    image[40:80, 40:80] = RED
    image[40:80, 240:280] = BLUE
    pattern = np.random.default_rng(3).integers(0, 256, (12, 12, 1), np.uint8)
    image[120:216, 100:196] = np.kron(pattern, np.ones((8, 8, 1), np.uint8))
    return image


class StillHub:
    """The newest image of all topics is the scene."""

    def newest(self, topic, timeout):
        header = rospy.Header(stamp=rospy.Time(7, 0), frame_id="eye")
        if topic == "/empty":
            raise TimeoutError(f"no image has come on {topic} within {timeout:g} s")
        return Frame(scene(), "bgr8", header)


@pytest.fixture
def page(master):
    features = [ColorFeature(Settings(), StillHub()), SelectFeature(Settings())]
    features.append(CaptureFeature(Settings()))
    made = FeaturePage(*features)
    yield made
    made.close()
    for feature in features:
        feature.close()


def test_the_color_of_a_pixel_and_the_range_around_it(page):
    told = page.request("color_at", topic="/cam", x=60, y=60)
    assert told["bgr"] == list(RED)
    hue, saturation, value = cv2.cvtColor(np.uint8([[RED]]), cv2.COLOR_BGR2HSV)[0, 0].tolist()
    assert told["hsv"] == [hue, saturation, value]
    assert told["lab"] == cv2.cvtColor(np.uint8([[RED]]), cv2.COLOR_BGR2LAB)[0, 0].tolist()
    limits = told["ranges"]["hsv"]
    assert limits["low"][0] > limits["high"][0]  # through red
    assert limits["low"][1] <= saturation <= limits["high"][1]
    assert set(told["ranges"]) == {"hsv", "hls", "lab", "ycrcb", "rgb", "bgr"}
    assert told["problems"] == {}
    assert "hsv" in page.request("color_at", topic="/cam", x=5, y=5)["problems"]  # gray


@pytest.mark.parametrize(
    "topic, x, says",
    [("/cam", 320, "not inside of the image"), ("/empty", 0, "no image"), ("x", 0, "is no name")],
)
def test_what_has_no_color_is_told(page, topic, x, says):
    with pytest.raises(RefusedError, match=says):
        page.request("color_at", topic=topic, x=x, y=0)


@pytest.fixture
def tracker(start):
    limits = {"low": [100, 100, 100], "high": [130, 255, 255]}
    rospy.set_param("/tracker/colors", {"blue": limits, "green": limits})
    camera = Camera(rate=10.0)
    start("hsv_tracker.py", "__name:=tracker", f"image:={camera.topic}")
    rospy.wait_for_service("/tracker/set_parameters", support.DEADLINE)
    return camera


def found_by(camera, output):
    """The labels and left borders of what the tracker finds in the scene."""
    header = camera.show(scene())
    message = output.of(header.stamp)
    return {(one.label, one.box.x_offset) for one in message.detections}


def test_a_range_is_given_to_the_color_that_is_named(page, tracker):
    names = page.request("color_names", node="/tracker")
    assert names["names"] == ["blue", "green"] and names["shown"] == "blue"
    output = support.Messages("/tracker/objects", DetectionArray)
    tracker.wait_for()
    assert found_by(tracker, output) == {("blue", 240), ("green", 240)}
    picked = page.request("color_at", topic="/cam", x=60, y=60)["ranges"]["hsv"]
    told = page.request("use_color", node="/tracker", name="green", space="hsv", **picked)
    assert told["refused"] == {} and told["values"]["color"] == "green"
    assert found_by(tracker, output) == {("blue", 240), ("green", 40)}


def test_a_range_in_another_space(page, tracker):
    output = support.Messages("/tracker/objects", DetectionArray)
    tracker.wait_for()
    picked = page.request("color_at", topic="/cam", x=60, y=60)["ranges"]["lab"]
    told = page.request("use_color", node="/tracker", name="blue", space="lab", **picked)
    assert told["refused"] == {} and told["values"]["space"] == "lab"
    assert found_by(tracker, output) == {("blue", 40), ("green", 240)}


def test_a_limit_that_another_color_has_is_set_all_the_same(page, tracker):
    output = support.Messages("/tracker/objects", DetectionArray)
    tracker.wait_for()
    both = {"low": [170, 100, 100], "high": [10, 255, 255]}
    for name in ("blue", "green"):
        told = page.request("use_color", node="/tracker", name=name, space="hsv", **both)
        assert told["refused"] == {}
    labels = {label for label, left in found_by(tracker, output) if left == 40}
    assert labels == {"blue", "green"}


def test_a_color_that_is_not_there_is_added(page, tracker):
    output = support.Messages("/tracker/objects", DetectionArray)
    tracker.wait_for()
    picked = page.request("color_at", topic="/cam", x=60, y=60)["ranges"]["hsv"]
    told = page.request("use_color", node="/tracker", name="cherry", space="hsv", **picked)
    assert told["refused"] == {} and told["values"]["color"] == "cherry"
    assert ("cherry", 40) in found_by(tracker, output)
    assert "cherry" in page.request("color_names", node="/tracker")["names"]


def test_a_ball_tracker_takes_ranges_in_hsv(page, start):
    start("ball_tracker.py", "__name:=ball", "image:=/nobody")
    rospy.wait_for_service("/ball/set_parameters", support.DEADLINE)
    limits = {"low": [1, 2, 3], "high": [40, 50, 60]}
    told = page.request("use_color", node="/ball", **limits)
    assert told["refused"] == {}
    names = ("h_low", "s_low", "v_low", "h_high", "s_high", "v_high")
    assert [told["values"][name] for name in names] == [1, 2, 3, 40, 50, 60]
    with pytest.raises(RefusedError, match="takes ranges in hsv only"):
        page.request("use_color", node="/ball", space="lab", **limits)
    assert page.request("color_names", node="/ball") == {"names": [], "shown": ""}


def test_a_node_without_colors_says_so(page, start):
    start("motion_detector.py", "__name:=motion", "image:=/nobody")
    rospy.wait_for_service("/motion/set_parameters", support.DEADLINE)
    with pytest.raises(RefusedError, match="takes no range"):
        page.request("use_color", node="/motion", low=[0, 0, 0], high=[1, 1, 1])


def test_an_object_is_selected_and_forgotten(page, start):
    camera = Camera(rate=10.0)
    start("object_tracker.py", "__name:=tracker", f"image:={camera.topic}")
    rospy.wait_for_service("/tracker/select_object", support.DEADLINE)
    output = support.Messages("/tracker/object", DetectionArray)
    camera.wait_for()
    output.of(camera.show(scene()).stamp)
    region = {"x": 100, "y": 120, "width": 96, "height": 96}
    number = page.start("select_object", node="/tracker", region=region, label="cup")
    while not page.has_answer_to(number):
        camera.show(scene())
        support.arrived.wait(0.05)
    told = page.answer_to(number)
    assert told["id"] >= 1 and told["message"] == f"object {told['id']} of /tracker is selected"
    (found,) = output.of(camera.show(scene()).stamp).detections
    assert found.label == "cup" and found.id == told["id"]
    assert abs(found.box.x_offset - 100) <= 2 and abs(found.box.y_offset - 120) <= 2
    with pytest.raises(RefusedError, match="must be of an object"):
        page.request("forget_object", node="/tracker", object=77)
    answer = page.request("forget_object", node="/tracker", object=told["id"])
    assert answer["message"] == f"object {told['id']} is forgotten"
    assert output.of(camera.show(scene()).stamp).detections == []


def test_a_region_goes_to_the_topic_of_a_node_without_the_service(page):
    regions = support.Messages("/chart/select", RegionOfInterest)
    region = {"x": 1, "y": 2, "width": 3, "height": 4}
    told = page.request("select_object", node="/chart", region=region)
    assert told == {"message": "sent to /chart/select", "id": -1}
    (got,) = regions.wait()
    assert (got.x_offset, got.y_offset, got.width, got.height) == (1, 2, 3, 4)


def test_two_pages_may_select_at_the_same_time(page):
    regions = support.Messages("/chart/select", RegionOfInterest)
    senders = [NodeTopics(), NodeTopics()]  # The second one finds the connection of the first.
    for number, sender in enumerate(senders, 1):
        assert sender.send("/chart", "select", RegionOfInterest(x_offset=number))
    support.wait_for(lambda: len(regions.received) == 2, "both regions")
    assert [region.x_offset for region in regions.received] == [1, 2]
    for sender in senders:
        sender.close()


def test_a_region_without_pixels_is_refused(page):
    region = {"x": 1, "y": 2, "width": 0, "height": 4}
    with pytest.raises(RefusedError, match="a region of 0x4, must have pixels"):
        page.request("select_object", node="/chart", region=region)


def test_nobody_who_takes_a_region_is_told(page, monkeypatch):
    monkeypatch.setattr("robot_vision.dashboard.select_topics.CONNECTION_TIMEOUT", 0.1)
    region = {"x": 1, "y": 2, "width": 3, "height": 4}
    with pytest.raises(RefusedError, match="nobody subscribes to /gone/select"):
        page.request("select_object", node="/gone", region=region)
    with pytest.raises(RefusedError, match="/gone has no service forget"):
        page.request("forget_object", node="/gone", object=1)


def test_a_click_has_the_color_and_the_header_of_its_pixel(page):
    clicks = support.Messages("/chart/click", Click)
    page.request("click", node="/chart", topic="/cam", x=60, y=61)
    (got,) = clicks.wait()
    assert (got.x, got.y, tuple(got.bgr)) == (60, 61, RED)
    assert tuple(got.hsv) == tuple(cv2.cvtColor(np.uint8([[RED]]), cv2.COLOR_BGR2HSV)[0, 0])
    assert got.header.frame_id == "eye" and got.header.stamp == rospy.Time(7, 0)


def test_a_capture_is_stopped_and_started(page, start):
    start("camera_node", "__name:=cam", "_source:=synthetic", "_always_subscribe:=true")
    rospy.wait_for_service("/cam/stop_capture", support.DEADLINE)
    assert page.request("capture", node="/cam", start=False)["message"].endswith("has stopped")
    assert page.request("capture", node="/cam", start=True)["message"].endswith("goes on")
    with pytest.raises(RefusedError, match="/gone has no service start_capture"):
        page.request("capture", node="/gone", start=True)
    assert not subscribes("/cam/image_raw")
