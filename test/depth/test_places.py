"""Names, markers and the input of places, without a node."""

import math

import numpy as np
import pytest
import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import Header

from robot_vision.depth.depth_overlay import depth_colors
from robot_vision.depth.detection_places import misfit, region_of_interest
from robot_vision.depth.places import at_position, frame_ids, markers, title, transforms
from robot_vision.msg import Detection, Detection3D, Detection3DArray, DetectionArray
from robot_vision.ros.messages import box_detection, points
from robot_vision.transport import Frame


def labelled(*labels):
    return [Detection(label=label, id=number) for label, number in labels]


def test_transforms_have_names_of_prefix_label_and_id():
    found = labelled(("face", 3), ("red", -1), ("blue", -1), ("red", -1), ("Zoë Ä.", 12))
    expected = ["r_face_3", "r_red_0", "r_blue_0", "r_red_1", "r_Zoe_A_12"]
    assert frame_ids(found, "r_") == expected


def test_no_two_transforms_have_the_same_name():
    found = labelled(("eye", 2), ("eye", 2), ("eye", 1), ("e y e", 0), ("e/y/e", 0))
    assert frame_ids(found, "") == ["eye_2", "", "eye_1", "e_y_e_0", ""]


@pytest.mark.parametrize("label", ["", "\n\t", "日本", "///", "x" * 5000, "a\x00b"])
def test_any_label_makes_a_name_that_all_tools_can_show(label):
    (name,) = frame_ids(labelled((label, 1)), "")
    assert name.endswith("_1") and 2 < len(name) < 70
    assert name.isascii() and name.replace("_", "").isalnum()


def place(**values):
    return Detection3D(pose=at_position(np.array([0.3, 0.0, 0.4]), np.eye(3)), **values)


def test_what_has_no_name_has_no_transform_but_a_marker():
    header = Header(stamp=rospy.Time(1), frame_id="eye")
    array = Detection3DArray(header, [place(frame_id="a_0"), place(id=-1, label="ü\n")], 0)
    (transform,) = transforms(array).transforms
    assert (transform.header, transform.child_frame_id) == (header, "a_0")
    assert len(markers(array).markers) == 4
    assert title(array.detections[1]) == "u?: 0.50 m"
    assert not transforms(Detection3DArray()).transforms
    assert not markers(Detection3DArray()).markers


def test_a_place_has_no_orientation():
    made = at_position(np.array([1.0, 2.0, 3.0]), np.diag([1.0, 4.0, 9.0]))
    diagonal = np.reshape(made.covariance, (6, 6)).diagonal().tolist()
    assert diagonal == [1.0, 4.0, 9.0] + [math.pi**2 / 3] * 3
    assert made.pose.orientation.w == 1.0 and made.pose.position.y == 2.0


def test_the_center_is_that_of_the_circle_or_of_the_box_if_there_is_none():
    found = box_detection((10, 20, 30, 40), "thing")
    assert region_of_interest(found)["center"] == (24.5, 39.5)
    found.center = Point()
    region = region_of_interest(found)
    assert region["center"] is None and region["box"] == (10, 20, 30, 40)
    assert region["outline"].tolist() == [[10, 20], [39, 20], [39, 59], [10, 59]]
    found.circle_center, found.circle_radius = Point(20.5, 30.0, 0.0), 9.5
    region = region_of_interest(found)
    assert (region["center"], region["radius"]) == ((20.5, 30.0), 9.5)
    found.outline = points(np.empty((0, 2)))
    assert region_of_interest(found)["outline"] is None
    assert math.isnan(region_of_interest(Detection(center=Point(math.nan, 0, 0)))["center"][0])


@pytest.mark.parametrize(
    "size, frames, said",
    [
        ((8, 6), ("eye", "eye", "eye"), ""),
        ((8, 6), ("/eye", "eye", ""), ""),
        ((8, 6), ("", "eye", "eye"), ""),
        ((8, 6), ("", "", ""), ""),
        ((8, 5), ("eye", "eye", "eye"), "an image of 8x5, the depth of 8x6"),
        ((0, 0), ("eye", "eye", "eye"), "an image of 0x0, the depth of 8x6"),
        ((8, 6), ("eye", "ear", ""), "frame 'eye', the depth in 'ear', its camera_info in ''"),
        ((8, 6), ("eye", "", "e\n"), "frame 'eye', the depth in '', its camera_info in 'e\\n'"),
    ],
)
def test_what_does_not_belong_together_is_told(size, frames, said):
    detections = DetectionArray(Header(frame_id=frames[0]), *size, [])
    depth = Frame(np.zeros((6, 8), np.uint16), "16UC1", Header(frame_id=frames[1]))
    told = misfit(detections, depth, frames[2])
    assert said in told and bool(said) == bool(told)


@pytest.mark.parametrize("kind, unit", [(np.float32, 1.0), (np.uint16, 1000.0)])
def test_depths_in_colors_go_from_blue_to_red(kind, unit):
    depths = np.array([[0.0, 0.4, 1.8, 8.0, 60.0]]) * unit
    (none, near, middle, far, beyond) = depth_colors(depths.astype(kind))[0].astype(int)
    assert none.tolist() == [0, 0, 0]
    assert near[0] > near[1] + near[2] and far[2] > far[0] + far[1]
    assert middle[1] > max(middle[0], middle[2]) and beyond.tolist() == far.tolist()
