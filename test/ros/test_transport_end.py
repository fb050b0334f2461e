"""How the thread of images ends."""

from types import SimpleNamespace

from robot_vision.ros.transport import _Process


def test_a_process_that_ends_waits_once_for_a_callback_that_does_not_return():
    process, waits, ends = object.__new__(_Process), [], []
    process._stopped = False
    process.runtime = SimpleNamespace(stop=lambda: ends.append(True))
    process._thread = SimpleNamespace(join=waits.append)
    process.stop()  # by rospy when it shuts down
    process.stop()  # by the process when it ends
    assert (waits, ends) == ([1.0], [True])
