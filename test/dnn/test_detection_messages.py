"""What a network found, and what is followed, as messages and drawn."""

from types import SimpleNamespace

import numpy as np
import pytest

import robot_vision as rv
from robot_vision.dnn.compatible_messages import detections_2d
from robot_vision.dnn.detection_messages import Seen, object_detection, seen_object, seen_track
from robot_vision.dnn.detection_overlay import draw_seen
from robot_vision.msg import DetectionArray

SIZE = 160, 120
BOX = 20.0, 30.0, 60.0, 70.0


def tracked():
    params = rv.BoxTrackerParams()
    params.min_hits = 1
    tracker = rv.BoxTracker(params)
    assert [one.detection for one in tracker.update(5.0, [(3, 0.9, BOX)])] == [0]
    return tracker


def test_a_frame_with_the_stamp_of_the_last_result_has_its_tracks():
    tracker = tracked()
    for tracks in (tracker.predict(5.0), tracker.update(5.0, [])):
        (track,) = tracks
        seen = seen_track(track, [], "cup", 0.8)
        assert seen.found is None and seen.score == 0.8
        message = object_detection(seen, SIZE)
        assert (message.id, message.label, message.class_id) == (1, "cup", 3)
        box = message.box
        assert (box.x_offset, box.y_offset, box.width, box.height) == (20, 30, 40, 40)


def found(**details):
    plain = {"box_pixels": (20, 30, 40, 40), "mask": np.empty((0, 0), np.uint8)}
    plain.update(outline=np.empty((0, 2), np.float32), keypoints=np.empty((0, 3), np.float32))
    return SimpleNamespace(**{**plain, **details})


def test_an_oriented_box_that_reaches_out_of_the_image_has_its_own_center():
    params = rv.HeadParams()
    params.head, params.task, params.classes = "yolov8", "oriented", 1
    params.input_width, params.input_height = SIZE
    # Centre, width, height, score and angle: a square on its corner, half of it left of the image.
    values = np.float32([0.0, 60.0, 40.0, 40.0, 0.9, np.pi / 4]).reshape(1, 6, 1)
    (one,) = rv.HeadDecoder(params).decode([values], rv.InputPlacement(), SIZE)
    message = object_detection(seen_object(one, "ship"), SIZE)
    assert (message.center.x, message.center.y) == pytest.approx((-0.5, 59.5), abs=1e-3)
    assert message.box.x_offset == 0 and message.box.width == 29  # px, half of the diagonal
    (other,) = detections_2d(DetectionArray(detections=[message])).detections
    box = other.bbox
    assert (box.center.x, box.center.y) == pytest.approx((-0.5, 59.5), abs=1e-3)
    assert (box.size_x, box.size_y) == pytest.approx((40.0, 40.0), abs=1e-3)


FAR = [1e6, 1e8, 1e9, 1e30, 3e38]


@pytest.mark.parametrize("far", [*FAR, *(-one for one in FAR)])
def test_what_is_far_outside_of_the_image_is_drawn_as_if_it_were_not_there(far):
    plain = np.full((*SIZE[::-1], 3), 90, np.uint8)
    drawn = plain.copy()
    keypoints = np.float32([(far, 40.0, 0.9), (40.0, far, 0.9), (40.0, 50.0, 0.9)])
    draw_seen(drawn, [Seen("", 0, 0.9, BOX, found(keypoints=keypoints))])
    nearby = plain.copy()
    draw_seen(nearby, [Seen("", 0, 0.9, BOX, found(keypoints=keypoints[2:]))])
    np.testing.assert_array_equal(drawn, nearby)
    assert (drawn[50, 40] != 90).any()


@pytest.mark.parametrize("far", FAR)
def test_an_outline_that_reaches_far_out_is_drawn_where_it_is_in_the_image(far):
    drawn = np.full((*SIZE[::-1], 3), 90, np.uint8)
    outline = np.float32([(20.5, 30.5), (far, 30.5), (far, far), (20.5, far)])
    draw_seen(drawn, [Seen("", 0, 0.9, BOX, found(outline=outline))])
    assert (drawn[30, 60:140] != 90).any(axis=1).all()
    assert (drawn[60:110, 20] != 90).any(axis=1).all()
