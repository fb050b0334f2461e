"""How the thread of a node's images ends."""

from types import SimpleNamespace

from robot_vision.ros.node_images import NodeImages


def test_a_process_that_ends_waits_once_for_a_callback_that_does_not_return():
    images, waits, ends = object.__new__(NodeImages), [], []
    images._stopped = False
    images.queue = SimpleNamespace(close=lambda: ends.append(True))
    images._thread = SimpleNamespace(join=waits.append)
    images.stop()  # by rospy when it shuts down
    images.stop()  # by the process when it ends
    assert (waits, ends) == ([1.0], [True])
