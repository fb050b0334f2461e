"""Poses as messages and transforms."""

import numpy as np
import pytest
import rospy
import tf2_py
from std_msgs.msg import Header

from robot_vision.ros.poses import transform_of


def shown(monkeypatch, stamps):
    """Where tf2 has a frame that moves by 1 m from each image to the next, a second later."""
    buffer, places = tf2_py.BufferCore(), []
    for number, stamp in enumerate(stamps, 1):
        monkeypatch.setattr(rospy.Time, "now", lambda number=number: rospy.Time(100 + number))
        pose = np.eye(4)
        pose[0, 3] = number
        header = Header(number, stamp, "eye")
        sent = transform_of(header, "tag_5", pose)
        assert header == Header(number, stamp, "eye")
        assert (sent.header.frame_id, sent.child_frame_id) == ("eye", "tag_5")
        buffer.set_transform(sent, "test")
        newest = buffer.lookup_transform_core("eye", "tag_5", rospy.Time())
        places.append((newest.transform.translation.x, newest.header.stamp.to_sec()))
    return places


@pytest.mark.parametrize(
    "stamps, expected",
    [((7, 8, 9), [7.0, 8.0, 9.0]), ((0, 0, 0), [101.0, 102.0, 103.0])],
)
def test_tf_has_the_newest_pose_of_images_with_and_without_stamps(monkeypatch, stamps, expected):
    places = shown(monkeypatch, map(rospy.Time, stamps))
    assert places == list(zip([1.0, 2.0, 3.0], expected))
