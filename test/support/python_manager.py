"""A running python_manager.py, and what the ROS graph says of it."""

import contextlib
import pathlib
from typing import Any, Dict, Iterator, Optional, Sequence, Set, Tuple

import psutil
import rosgraph
import rospy
import support
from nodelet.srv import NodeletList, NodeletLoad, NodeletUnload
from private_memory import private_memory

NAME = "/vision"
TRIAL = str(pathlib.Path(__file__).with_name("trial_manager.py"))  # a manager with a trial_node


class PythonManager:
    """A manager, started with a fixture's `start` and these words and options."""

    def __init__(self, start: Any, *words: str, program: str = "python_manager.py", **options: Any):
        self.name = NAME
        self.process = start(program, f"__name:={NAME[1:]}", *words, **options)
        rospy.wait_for_service(NAME + "/list", support.DEADLINE)

    def load(
        self,
        name: str,
        kind: str,
        remappings: Optional[Dict[str, str]] = None,
        bond_id: str = "",
        words: Sequence[str] = (),
    ) -> bool:
        """Loads a node; raises rospy.ServiceException if it does not start."""
        load = rospy.ServiceProxy(NAME + "/load_nodelet", NodeletLoad)
        remappings = remappings or {}
        topics = list(remappings), list(remappings.values())
        return load(name, kind, *topics, list(words), bond_id).success

    def unload(self, name: str) -> bool:
        return rospy.ServiceProxy(NAME + "/unload_nodelet", NodeletUnload)(name).success

    def loaded(self) -> Set[str]:
        return set(rospy.ServiceProxy(NAME + "/list", NodeletList)().nodelets)


class Counts:
    """Threads, descriptors and private memory in MiB of a process."""

    def __init__(self, pid: int):
        process = psutil.Process(pid)
        self.threads = process.num_threads()
        self.descriptors = process.num_fds()
        self.memory = private_memory(pid)

    def __repr__(self) -> str:
        return f"{self.threads} threads, {self.descriptors} files, {self.memory:.1f} MiB"


Entry = Tuple[str, str, str]  # what it is, its name, its type


def graph_of(*nodes: str) -> Set[Entry]:
    """What nodes publish, subscribe to and serve, as the master knows it."""
    master = rosgraph.Master("/test")
    types = dict(master.getTopicTypes())
    kinds = ("publishes", "subscribes", "serves")
    found = set()
    for kind, entries in zip(kinds, master.getSystemState()):
        for name, by in entries:
            if set(nodes) & set(by):
                found.add((kind, name, types.get(name, "")))
    return found


@contextlib.contextmanager
def refused(text: str) -> Iterator[None]:
    """Asserts that a call of a service fails, and says this."""
    try:
        yield
    except rospy.ServiceException as error:
        assert text in str(error), error
        return
    raise AssertionError(f"it was not refused with: {text}")
