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

    def say(self, active, of="its bond", instance="its loader"):
        self._publisher.publish(Status(id=of, instance_id=instance, active=active))

    def heard(self, active, of="its bond"):
        """The signs of the manager that say so."""
        of_manager = (one for one in list(self._signs.received) if "loader" not in one.instance_id)
        return [one for one in of_manager if one.id == of and one.active == active]

    def close(self):
        self._signs.close()
        self._publisher.unregister()


@contextlib.contextmanager
def bound(**times):
    """The bonds of a manager, with the one of /node; its loader; and what is set as it breaks."""
    bonds, loader, broken = Bonds(**times), Loader(), threading.Event()
    try:
        loader.wait_for_connections()
        bonds.reserve("/node", "its bond")
        bonds.form("/node", broken.set)
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
    times = {"connect_timeout": HOUR, "heartbeat_timeout": HOUR, "period": 0.01}
    with bound(**times) as (bonds, loader, broken):
        support.wait_for(lambda: loader.heard(active=True), "a sign of life")
        assert not broken.is_set()
        loader.say(active=False)
        support.wait_for(broken.is_set, "the end of the bond")
        support.wait_for(lambda: loader.heard(active=False), "the answer")
        count = len(loader.heard(active=True))
        bonds.reserve("/other", "another bond")
        bonds.form("/other", lambda: None)
        loader.say(active=False)  # about which nobody knows any more
        loader.say(active=False, of="another bond")
        support.wait_for(lambda: loader.heard(active=False, of="another bond"), "an answer behind")
        assert len(loader.heard(active=False)) == 1
        assert len(loader.heard(active=True)) == count


def test_a_node_that_ends_is_told_to_its_loader_until_that_answers():
    times = {"connect_timeout": HOUR, "disconnect_timeout": HOUR, "period": HOUR}
    with bound(**times) as (bonds, loader, broken):
        support.wait_for(lambda: loader.heard(active=True), "a sign of life")
        bonds.end("/node")
        support.wait_for(lambda: len(loader.heard(active=False)) > 2, "that it has ended")
        loader.say(active=False)
        bonds.reserve("/other", "another bond")
        bonds.form("/other", lambda: None)
        loader.say(active=False, of="another bond")
        support.wait_for(lambda: loader.heard(active=False, of="another bond"), "an answer behind")
        count = len(loader.heard(active=False))
        bonds.end_all()  # which would tell it once more
        bonds.end_all()  # does nothing
        assert len(loader.heard(active=False)) == count
    assert not broken.is_set()


def test_the_loaders_of_all_nodes_hear_of_the_end_of_the_process():
    with bound(connect_timeout=HOUR, period=HOUR) as (bonds, loader, broken):
        support.wait_for(lambda: loader.heard(active=True), "a sign of life")
        bonds.end_all()
        support.wait_for(lambda: loader.heard(active=False), "the last words")
        bonds.reserve("/late", "a late bond")
        bonds.form("/late", broken.set)  # does nothing any more
    assert not broken.is_set() and not loader.heard(active=True, of="a late bond")


def test_a_loader_that_comes_has_a_sign_at_once():
    with bound(connect_timeout=HOUR, period=HOUR) as (_, loader, _):
        support.wait_for(lambda: loader.heard(active=True), "a sign of life")
        loader.say(active=True)
        support.wait_for(lambda: len(loader.heard(active=True)) == 2, "an answer")


def test_a_bond_is_of_two():
    with bound(connect_timeout=HOUR, heartbeat_timeout=HOUR, period=0.01) as (_, loader, broken):
        loader.say(active=True)
        loader.say(active=False, instance="another loader")
        count = len(loader.heard(active=True))
        support.wait_for(lambda: len(loader.heard(active=True)) > count + 5, "signs of life")
        assert not broken.is_set()


def test_an_id_is_of_one_node():
    with bound(connect_timeout=HOUR) as (bonds, loader, _):
        with pytest.raises(ValueError, match="bond_id is 'its bond', which is that of another"):
            bonds.reserve("/other", "its bond")
        bonds.end("/other")
        support.wait_for(lambda: loader.heard(active=True), "a sign of life")
        bonds.end("/node")  # of which nobody has taken notice yet
        support.wait_for(lambda: loader.heard(active=False), "that it has ended")
        count = len(loader.heard(active=True))
        bonds.reserve("/other", "its bond")
        bonds.form("/other", lambda: None)
        support.wait_for(lambda: len(loader.heard(active=True)) > count, "signs of the other")


def test_no_sign_is_missed_while_a_debugger_is_at_work():
    with bound(connect_timeout=HOUR, heartbeat_timeout=0.1, period=0.02) as (_, loader, broken):
        with support.missed_signs_allowed() as name:
            # The master tells the node later.
            support.node_api("/test_images").paramUpdate("/test", name, True)
            loader.say(active=True)
            support.wait_for(lambda: len(loader.heard(active=True)) > 20, "signs of life")
            assert not broken.is_set()
        support.wait_for(broken.is_set, "the end of the bond")


def test_signs_of_life_are_in_time_while_nothing_else_in_python_is():
    with bound(connect_timeout=HOUR, period=0.05) as (_, loader, _):
        support.wait_for(lambda: loader.heard(active=True), "a sign of life")
        windows = []

        def in_time():
            windows.append(without_other_threads(0.5))
            stamps = [one.header.stamp.to_sec() for one in loader.heard(active=True)]
            return any(sum(begin < one < end for one in stamps) > 2 for begin, end in windows)

        support.wait_for(in_time, "signs of such a time")


def without_other_threads(seconds):
    """Lets no other thread of Python come to its turn for some time: its begin and its end."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(HOUR)
    try:
        begin = now = rospy.get_time()
        while now < begin + seconds:
            now = rospy.get_time()
        return begin, now
    finally:
        sys.setswitchinterval(interval)


def test_all_signs_of_a_hundred_bonds_arrive():
    """Also the last ones, which are given at a time."""
    signs = support.Messages(TOPIC, Status)
    bonds = Bonds(connect_timeout=HOUR)
    ids = {f"bond {number}" for number in range(100)}
    try:
        support.wait_for(signs.connected, "the manager's signs")
        for one in ids:
            bonds.reserve(f"/node of {one}", one)
            bonds.form(f"/node of {one}", lambda: None)
        support.wait_for(lambda: {sign.id for sign in list(signs.received)} >= ids, "all of them")
    finally:
        bonds.end_all()

    def ended():
        return {sign.id for sign in list(signs.received) if not sign.active}

    support.wait_for(lambda: ended() >= ids, "the last words of all of them")
