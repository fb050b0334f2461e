"""The nodes that a manager holds, with a runtime and bonds that only remember."""

import pytest

from robot_vision.nodelets import held_nodes
from robot_vision.nodelets.held_nodes import HeldNodes
from robot_vision.nodelets.load_requests import LoadRequest


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
