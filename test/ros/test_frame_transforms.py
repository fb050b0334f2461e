"""What of /tf is taken when the time goes back."""

import numpy as np
import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from robot_vision.ros.frame_transforms import _Listener


def said(seconds, x):
    transform = TransformStamped(child_frame_id="eye")
    transform.header.frame_id = "base"
    transform.header.stamp = rospy.Time(seconds)
    transform.transform.translation.x = x
    transform.transform.rotation.w = 1.0
    return TFMessage([transform])


def places(monkeypatch, simulated, messages):
    """Where the eye is after each of (time, message)."""
    monkeypatch.setattr(rospy.rostime, "is_wallclock", lambda: not simulated)
    buffer = tf2_ros.Buffer(debug=False)
    listener, seen = _Listener(), []
    listener.add(buffer)
    for now, message in messages:
        monkeypatch.setattr(rospy.Time, "now", lambda now=now: rospy.Time(now))
        listener.take(message)
        try:
            found = buffer.lookup_transform_core("base", "eye", rospy.Time())
            seen.append(found.transform.translation.x)
        except tf2_ros.TransformException:
            seen.append(np.nan)
    return seen


def test_what_comes_late_after_the_time_went_back_is_left_out(monkeypatch):
    messages = [(1000, said(1000, 1.0)), (500, said(1000, 2.0)), (500, said(500, 3.0))]
    assert np.array_equal(places(monkeypatch, True, messages), [1.0, np.nan, 3.0], equal_nan=True)


def test_stamps_ahead_are_taken_as_long_as_there_is_no_simulated_time(monkeypatch):
    messages = [(500, said(1000, 1.0)), (501, said(1001, 2.0))]
    assert places(monkeypatch, False, messages) == [1.0, 2.0]
    assert places(monkeypatch, True, [(0, said(1000, 1.0)), (0, said(1001, 2.0))]) == [1.0, 2.0]
    assert places(monkeypatch, True, [(500, said(509, 1.0))]) == [1.0]
