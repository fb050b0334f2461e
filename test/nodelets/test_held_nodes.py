"""The nodes that a manager holds, with a runtime and bonds that only remember."""

import concurrent.futures
import contextlib
import threading
import types

import pytest
import rospy
from nodelet.srv import NodeletUnloadRequest

from robot_vision.nodelets import held_nodes, loaded_node, python_manager
from robot_vision.nodelets.held_nodes import HeldNodes
from robot_vision.nodelets.load_requests import LoadRequest
from robot_vision.ros.context import current

DEADLINE = 60.0  # s


class Runtime:
    """Loads nodelets that are none."""

    def __init__(self):
        self.loaded = []

    def nodelet_types(self):
        return ["other/nodelet"]

    def load_nodelet(self, name, *_):
        self.loaded.append(name)

    def unload_nodelet(self, name):
        self.loaded.remove(name)


class Bonds:
    """Keeps what is to be done when a bond breaks."""

    def __init__(self):
        self.broken = []

    def reserve(self, name, bond_id):
        pass

    def form(self, name, on_broken):
        self.broken.append(on_broken)

    def end(self, name):
        pass

    def end_all(self):
        pass


@pytest.fixture
def runtime(monkeypatch):
    made = Runtime()
    monkeypatch.setattr(held_nodes, "process_runtime", lambda: made)
    return made


@pytest.fixture
def bonds(monkeypatch):
    made = Bonds()
    monkeypatch.setattr(held_nodes, "Bonds", lambda: made)
    return made


def test_a_bond_that_is_found_broken_late_does_not_unload_the_next_of_its_name(runtime, bonds):
    nodes = HeldNodes()
    request = LoadRequest("/edges", "other/nodelet", {}, [], "bond")
    nodes.load(request)
    nodes.unload("/edges")
    nodes.load(request)
    first, second = bonds.broken
    first()
    assert nodes.names() == ["/edges"] and runtime.loaded == ["/edges"]
    second()
    assert nodes.names() == [] and runtime.loaded == []


@pytest.mark.parametrize("ending", [False, True])
def test_an_unload_fails_only_while_its_manager_lives(monkeypatch, runtime, bonds, ending):
    """roslaunch tells a loader and its manager to end at a time; either may be the first."""
    node = types.SimpleNamespace(name="/manager", is_ending=lambda: ending)
    for name in ("on_end", "service"):
        setattr(node, name, lambda *_: None)
    monkeypatch.setattr(python_manager, "current", lambda: node)
    monkeypatch.setattr(python_manager, "log_by_node", lambda: None)
    manager = python_manager.PythonManager()
    manager._nodes.load(LoadRequest("/edges", "other/nodelet", {}, [], ""))

    def closed(_):
        raise RuntimeError("the node has been shut down")

    monkeypatch.setattr(runtime, "unload_nodelet", closed)
    if ending:
        assert manager._on_unload(NodeletUnloadRequest("/edges")).success
    else:
        with pytest.raises(rospy.ServiceException, match="not unloaded: the node has been shut"):
            manager._on_unload(NodeletUnloadRequest("/edges"))


class Halt:
    """A place where a thread stays until it may go on."""

    def __init__(self):
        self._reached, self._goes_on = threading.Event(), threading.Event()

    def stay(self):
        self._reached.set()
        assert self._goes_on.wait(DEADLINE)

    @contextlib.contextmanager
    def reached(self):
        """Waits until a thread is there, which goes on after the block."""
        try:
            assert self._reached.wait(DEADLINE)
            yield
        finally:
            self._goes_on.set()


@pytest.fixture
def loading(monkeypatch, runtime, bonds):
    """loading(make, check) starts to load a node that make() makes, behind which check() is called.

    It returns the nodes, and a future that is done when it is loaded.
    """
    with concurrent.futures.ThreadPoolExecutor(1) as pool:

        def load(make, check=lambda: None):
            kind = types.SimpleNamespace(load=lambda: make)
            registration = types.SimpleNamespace(check=check)
            monkeypatch.setattr(held_nodes, "find_type", lambda _: kind)
            monkeypatch.setattr(loaded_node, "keep_registered", lambda: registration)
            nodes = HeldNodes()
            request = LoadRequest("/works", "robot_vision/works", {}, [], "")
            return nodes, pool.submit(nodes.load, request)

        yield load


def test_a_node_that_works_already_is_told_of_the_end_while_it_is_being_loaded(loading):
    told, master = threading.Event(), Halt()  # which does not answer
    nodes, loaded = loading(lambda: current().on_end(told.set), master.stay)
    with master.reached():
        nodes.finish()
        assert told.wait(DEADLINE)
    loaded.result(DEADLINE)


def test_what_a_node_makes_after_it_was_told_of_the_end_is_told_too(loading):
    told_before, told_after, halt = threading.Event(), threading.Event(), Halt()

    def make():
        current().on_end(told_before.set)
        halt.stay()
        current().on_end(told_after.set)

    nodes, loaded = loading(make)
    with halt.reached():
        nodes.finish()
        assert told_before.wait(DEADLINE)
    loaded.result(DEADLINE)
    assert told_after.is_set()
