"""The bonds of a manager with the loaders of its nodes."""

import contextlib
import sys
import threading

import pytest
import rospy
import support
from bond.msg import Status

from robot_vision.nodelets.bonds import Bonds

HOUR = 3600.0  # s
TOPIC = "/test/bond"


class Loader:
    """The other side of the bond `its bond`."""

    def __init__(self):
        self._signs = support.Messages(TOPIC, Status)
        self._publisher = rospy.Publisher(TOPIC, Status, queue_size=10)

    def wait_for_connections(self):
        support.wait_for(self._signs.connected, "the manager's signs")
        # One is its own, as it hears itself.
        support.wait_for(lambda: self._publisher.get_num_connections() == 2, "the manager's ears")

    def say(self, active):
        self._publisher.publish(Status(id="its bond", instance_id="its loader", active=active))

    def heard(self, active):
        """The signs of the manager that say so."""
        of_manager = (one for one in self._signs.received if one.instance_id != "its loader")
        return [one for one in of_manager if one.id == "its bond" and one.active == active]

    def close(self):
        self._signs.close()
        self._publisher.unregister()


@contextlib.contextmanager
def bound(**times):
    """The bonds of a manager, with the one of /node; its loader; and what is set as it breaks."""
    bonds, loader, broken = Bonds(**times), Loader(), threading.Event()
    try:
        loader.wait_for_connections()
        bonds.form("/node", "its bond", broken.set)
        yield bonds, loader, broken
    finally:
        bonds.end_all()
        loader.close()


def test_a_loader_that_is_heard_once_and_then_killed_breaks_its_bond():
    # Only the heartbeat can break it in time, so that it was formed.
    with bound(connect_timeout=HOUR, heartbeat_timeout=0.2) as (_, loader, broken):
        loader.say(active=True)
        support.wait_for(broken.is_set, "the end of the bond")
        support.wait_for(lambda: loader.heard(active=False), "a word of it")


def test_a_loader_that_never_comes_breaks_its_bond():
    with bound(connect_timeout=0.1, heartbeat_timeout=HOUR) as (_, _, broken):
        support.wait_for(broken.is_set, "the end of the bond")


def test_a_loader_that_ends_is_answered_once():
    with bound(connect_timeout=HOUR, heartbeat_timeout=HOUR, period=0.01) as (_, loader, broken):
        support.wait_for(lambda: loader.heard(active=True), "a sign of life")
        assert not broken.is_set()
        loader.say(active=False)
        support.wait_for(broken.is_set, "the end of the bond")
        support.wait_for(lambda: loader.heard(active=False), "the answer")
        count = len(loader.heard(active=True))
        loader.say(active=False)  # about which nobody knows any more
    assert (len(loader.heard(active=False)), len(loader.heard(active=True))) == (1, count)


def test_a_node_that_ends_is_told_to_its_loader_until_that_answers():
    with bound(connect_timeout=HOUR, period=0.01) as (bonds, loader, broken):
        support.wait_for(lambda: loader.heard(active=True), "a sign of life")
        bonds.end("/node")
        support.wait_for(lambda: len(loader.heard(active=False)) > 2, "that it has ended")
        loader.say(active=False)
    assert not broken.is_set()


def test_the_loaders_of_all_nodes_hear_of_the_end_of_the_process():
    with bound(connect_timeout=HOUR, period=HOUR) as (bonds, loader, broken):
        support.wait_for(lambda: loader.heard(active=True), "a sign of life")
        bonds.end_all()
        support.wait_for(lambda: loader.heard(active=False), "the last words")
    assert not broken.is_set()


def test_signs_of_life_are_in_time_while_nothing_else_in_python_is():
    with bound(connect_timeout=HOUR, period=0.05) as (_, loader, _):
        support.wait_for(lambda: loader.heard(active=True), "a sign of life")
        interval = sys.getswitchinterval()
        sys.setswitchinterval(HOUR)
        try:
            begin = rospy.get_time()
            while rospy.get_time() < begin + 0.5:  # no other thread of Python comes to its turn
                pass
            end = rospy.get_time()
        finally:
            sys.setswitchinterval(interval)

        def of_the_time():
            stamps = (one.header.stamp.to_sec() for one in loader.heard(active=True))
            return sum(begin < stamp < end for stamp in stamps) >= 3

        support.wait_for(of_the_time, "the signs of the time")


@pytest.mark.parametrize("count", [100])
def test_each_of_many_bonds_gives_its_signs(count):
    signs = support.Messages(TOPIC, Status)
    bonds = Bonds(connect_timeout=HOUR)
    support.wait_for(signs.connected, "the manager's signs")
    ids = {f"bond {number}" for number in range(count)}
    for number, one in enumerate(sorted(ids)):
        bonds.form(f"/node_{number}", one, print)
    support.wait_for(lambda: {sign.id for sign in signs.received} >= ids, "all of them")
    bonds.end_all()
