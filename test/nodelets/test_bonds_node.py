"""The bonds of a manager with the loaders of its nodes."""

import threading

import rospy
import support
from bond.msg import Constants, Status
from rospy.impl.tcpros_base import TCPROSTransport

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


def test_all_heartbeats_of_many_bonds_arrive_when_sending_was_held_up(start, monkeypatch):
    heartbeats = rospy.Publisher("/test/bond", Status, queue_size=1)
    bonds = Bonds()
    bonds.form("/node", "its bond", lambda: None)
    echo = ["/usr/bin/rostopic", "echo", "--filter", "'of' in m.id", "/test/bond"]
    loader = start(*echo, env={"PYTHONUNBUFFERED": "1"})
    support.wait_for(lambda: heartbeats.get_num_connections() == 2, "its connection")
    go_on, write = threading.Event(), TCPROSTransport.write_data

    def write_late(*arguments):
        assert go_on.wait(support.DEADLINE)
        write(*arguments)

    monkeypatch.setattr(TCPROSTransport, "write_data", write_late)
    ids = [f"heartbeat {number} of bond {bond}" for number in range(4) for bond in range(30)]
    for one in ids:
        heartbeats.publish(Status(id=one))
    go_on.set()
    support.wait_for(lambda: all(f'id: "{one}"' in loader.output() for one in ids), "all of them")
    bonds.end("/node")
    heartbeats.unregister()
