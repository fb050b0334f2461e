"""The bonds of a manager with the loaders of its nodes."""

import threading

import rospy
import support
from bond.msg import Constants, Status

from robot_vision.nodelets.bonds import Bonds

HOUR = 3600.0  # s


def test_a_loader_that_is_heard_once_and_then_killed_breaks_its_bond(monkeypatch):
    # Only the heartbeat can break it in time, so that it was formed.
    monkeypatch.setattr(Constants, "DEFAULT_CONNECT_TIMEOUT", HOUR)
    monkeypatch.setattr(Constants, "DEFAULT_HEARTBEAT_TIMEOUT", 0.2)
    broken = threading.Event()
    bonds = Bonds()
    loader = rospy.Publisher("/test/bond", Status, queue_size=1)
    bonds.form("/node", "its bond", broken.set)
    support.wait_for(loader.get_num_connections, "the manager's connection")
    loader.publish(Status(id="its bond", instance_id="its loader", active=True))
    support.wait_for(broken.is_set, "the end of the bond")
    bonds.end("/node")
    loader.unregister()
