"""Messages as JSON: what is kept, what is cut, and that JSON can hold it."""

import base64
import json
import math

import pytest
import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import Point32, PolygonStamped
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import (
    ByteMultiArray,
    Duration,
    Empty,
    Float32,
    Float64MultiArray,
    Header,
    Int64,
    String,
)

from robot_vision.dashboard import message_json
from robot_vision.dashboard.message_json import stamp_of, to_plain
from robot_vision.msg import Contour, ContourArray, Detection, DetectionArray, Histogram


def received(message):
    """A message as it comes over the network, where arrays are tuples and bytes."""
    import io

    buffer = io.BytesIO()
    message.serialize(buffer)
    return type(message)().deserialize(buffer.getvalue())


def plain(message):
    made = to_plain(received(message))
    json.dumps(made, allow_nan=False)
    return made


def test_a_detection_is_told_whole():
    header = Header(seq=7, stamp=rospy.Time(12, 500000000), frame_id="eye")
    found = Detection(label="blue", id=-1, score=0.5, mask=b"\x00\xff")
    found.box.width = 2
    found.outline = [Point32(1, 2, 0), Point32(3, 4, 0)]
    made = plain(DetectionArray(header=header, width=640, height=480, detections=[found]))
    assert made["header"] == {"seq": 7, "stamp": 12.5, "frame_id": "eye"}
    assert (made["width"], made["height"]) == (640, 480)
    (one,) = made["detections"]
    assert (one["label"], one["id"], one["score"]) == ("blue", -1, 0.5)
    assert one["outline"] == [{"x": 1.0, "y": 2.0, "z": 0.0}, {"x": 3.0, "y": 4.0, "z": 0.0}]
    assert base64.b64decode(one["mask"]) == b"\x00\xff"
    assert one["box"]["width"] == 2 and one["has_velocity"] is False
    assert set(one) == set(Detection.__slots__)  # and no _cut


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_null(value):
    assert plain(Float32(value)) == {"data": None}
    assert plain(LaserScan(ranges=[1.0, value, 2.0]))["ranges"] == [1.0, None, 2.0]
    assert plain(LaserScan(range_min=value))["range_min"] is None


def test_large_finite_numbers_are_no_infinity():
    assert plain(Float64MultiArray(data=[1e308, 1e308]))["data"] == [1e308, 1e308]


def test_arrays_are_cut_and_say_their_length():
    made = plain(LaserScan(ranges=list(range(10000)), intensities=[1.0]))
    assert made["ranges"] == [float(index) for index in range(message_json.MAX_ITEMS)]
    assert made["intensities"] == [1.0]
    assert made["_cut"] == {"ranges": 10000}


def test_the_largest_histogram_of_a_node_is_told_whole():
    counts = list(range(3 * 1024))
    assert plain(Histogram(bins=1024, counts=counts))["counts"] == counts


def test_arrays_of_messages_are_cut_in_sum():
    status = DiagnosticStatus(values=[KeyValue("k", "v")] * 1500)
    made = plain(DiagnosticArray(status=[status] * 5))["status"]
    kept = sum(len(one["values"]) for one in made)
    assert kept + len(made) == message_json.MAX_OBJECTS
    assert "_cut" not in made[0] and made[-1]["_cut"] == {"values": 1500}


def test_points_are_cut_in_sum_as_the_numbers_that_they_have():
    points = [Point32(index, 0, 0) for index in range(1500)]
    made = plain(DetectionArray(detections=[Detection(outline=points)] * 20))["detections"]
    assert sum(3 * len(one["outline"]) for one in made) == message_json.MAX_VALUES // 3 * 3
    assert "_cut" not in made[0] and made[-1] == {
        **made[-1],
        "outline": [],
        "_cut": {"outline": 1500},
    }


def test_as_many_contours_as_a_node_takes_by_default_are_told_whole():
    points = [Point32(index, 0, 0) for index in range(80)]
    contour = Contour(outline=points, hull=points[:40], approximation=points[:10])
    contour.defect_starts = contour.defect_ends = contour.defect_points = points[:2]
    made = plain(ContourArray(contours=[contour] * 100))
    assert made["contours"] == [plain(contour)] * 100 and "_cut" not in plain(contour)


def test_numbers_are_cut_in_sum():
    scans = [tuple(range(2000))] * 30
    budget = message_json._Budget()
    kept = 0
    for scan in scans:
        try:
            kept += len(message_json._reals(scan, budget))
        except message_json.CutError as error:
            kept += len(error.left)
    assert kept == message_json.MAX_VALUES


@pytest.mark.parametrize(
    "size, kept", [(0, True), (message_json.MAX_BYTES, True), (message_json.MAX_BYTES + 1, False)]
)
def test_bytes_are_told_up_to_a_limit(size, kept):
    data = bytes(index % 256 for index in range(size))
    made = plain(Image(data=data))
    if kept:
        assert base64.b64decode(made["data"]) == data and "_cut" not in made
    else:
        assert made["data"] is None and made["_cut"] == {"data": size}


def test_long_texts_are_cut():
    made = plain(String("x" * 100000))
    assert made == {"data": "x" * message_json.MAX_TEXT, "_cut": {"data": 100000}}


def test_bytes_that_are_no_text_do_not_end_it():
    message = String()
    message.data = b"\xff\xfe"
    assert json.dumps(to_plain(message))


def test_markup_is_a_text_as_any_other():
    text = "<script>alert(1)</script>\n\x1b[31m"
    assert plain(String(text)) == {"data": text}


@pytest.mark.parametrize(
    "message, expected",
    [
        (Empty(), {}),
        (Int64(-(2**62)), {"data": -(2**62)}),
        (Duration(rospy.Duration(-2, 500000000)), {"data": -1.5}),
        (PolygonStamped(), None),
    ],
)
def test_small_messages(message, expected):
    made = plain(message)
    assert expected is None or made == expected


def test_lists_of_bytes_and_nested_lists():
    made = plain(ByteMultiArray(data=[1, -2]))
    assert made["data"] == [1, -2]
    status = DiagnosticStatus(level=1, name="a", values=[KeyValue("k", "v")])
    made = plain(DiagnosticArray(status=[status]))
    assert made["status"][0]["values"] == [{"key": "k", "value": "v"}]


def test_the_time_of_a_message_is_its_header_s():
    assert stamp_of(Image(header=Header(stamp=rospy.Time(3, 0)))) == 3.0
    assert stamp_of(String()) == 0.0
