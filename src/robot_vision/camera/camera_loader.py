"""The node camera_loader: cameras in one nodelet manager, each on its own."""

import contextlib
import threading
import time
import uuid
import xmlrpc.client
from typing import Any, Dict, List, Tuple

import bondpy.bondpy
import rosgraph
import rospy
from nodelet.srv import NodeletList, NodeletLoad, NodeletUnload

from ..ros.params import read_any, read_name
from ..ros.registration import AWAY
from ..ros.startup import run_node
from .camera_list import parse_cameras

PLUGIN = "robot_vision/camera"
LOOK_AROUND = 0.5  # s, between looks at what there is to do
UNTIL_BONDED = 2.0  # s, at most
UNTIL_MANAGER_ENDS = 0.5  # s, if it ends together with this node
FIRST_RETRY, LAST_RETRY = 1.0, 60.0  # s, until a camera that was refused is tried again
MOST_CRASHES = 2  # of the manager while it loads a camera, until that one is left out


class CameraLoader:
    """Loads the cameras of the list ~cameras into ~manager, and again when that comes back.

    A list that is wrong is told, and waited for in a better form: roslaunch would start a node that
    ends over and over. When another list comes, cameras are added, removed and loaded anew as it
    says; those that it leaves as they were go on. A camera that is refused is tried again, less and
    less often. A bond with each tells when the manager has died, and the manager when this node
    has: it unloads the cameras then, but needs some seconds to notice; a loader that is there again
    before that unloads them itself. A loader that is told to end unloads them, too, unless the
    manager is just loading one: that may take long, and it answers nothing meanwhile.
    """

    def __init__(self) -> None:
        self._manager = rospy.resolve_name(read_name("manager", "camera_manager"))
        self._list: Any = None  # as it was read last
        self._cameras: Dict[str, Dict[str, Any]] = {}  # their parameters; empty: no list yet
        self._crashes: Dict[str, int] = {}  # of the manager, while it loaded that camera
        self._wrong = ""  # what has been told of the list
        # Guards _loaded and _lost: bonds break in threads of their own.
        self._lock = threading.Lock()
        self._loaded: Dict[str, Tuple[str, bondpy.bondpy.Bond]] = {}  # with the manager's URI
        self._lost: Dict[str, str] = {}  # the URI of the manager that may have it still
        self._refused: Dict[str, Tuple[float, float]] = {}  # when to try again, and the wait (s)
        self._met = ""  # the URI of the manager that has none of another loader's cameras
        self._waiting = False
        self._loading = False  # the manager has been asked to load one
        self._done = threading.Event()
        rospy.on_shutdown(self._end)

    def run(self) -> None:
        """Until the node is shut down."""
        # In a thread of its own, for a manager that is loading a camera may answer late or never.
        work = threading.Thread(target=self._work, daemon=True)
        work.start()
        while not self._done.wait(LOOK_AROUND):
            if not work.is_alive() and not rospy.core.is_shutdown_requested():
                raise SystemExit(1)  # it has told why

    def _work(self) -> None:
        while not rospy.core.is_shutdown_requested():
            self._read_list()
            manager = self._manager_uri() if self._cameras else ""
            if manager and self._meet(manager):
                # One that the manager dies of ends the round.
                all(self._load(name, manager) for name in self._missing())
            rospy.rostime.wallsleep(LOOK_AROUND)

    def _read_list(self) -> None:
        """Follows ~cameras; what is wrong with it is told once, and all stays as it is."""
        try:
            values = read_any("cameras", None)
        except AWAY:
            return
        if self._cameras and values in (self._list, None):  # None: of a master that is new
            self._wrong = ""
            return
        try:
            cameras = parse_cameras(values)
        except ValueError as error:
            if str(error) != self._wrong:
                rospy.logerr("%s; waiting for another list in ~cameras", error)
            self._wrong = str(error)
            return
        self._list, self._wrong = values, ""
        self._change({rospy.resolve_name(name): of for name, of in cameras.items()})

    def _change(self, cameras: Dict[str, Dict[str, Any]]) -> None:
        """Unloads what is another camera now, or none, and leaves all others alone."""
        for name, parameters in self._cameras.items():
            if cameras.get(name) == parameters:
                continue
            with self._lock:
                _, bond = self._loaded.pop(name, ("", None))
                lost = self._lost.pop(name, "")
            self._refused.pop(name, None)
            if bond or lost:
                self._unload(name)
            if bond:
                bond.shutdown()
            if name not in cameras:
                _replace_params(name, {})
                rospy.loginfo("%s: removed", name)
        for name, parameters in cameras.items():
            if self._cameras.get(name) != parameters:
                _replace_params(name, parameters)
                self._crashes[name] = 0
        self._cameras = cameras

    def _manager_uri(self) -> str:
        """Where the manager answers; empty if it does not."""
        uri = ""
        with contextlib.suppress(*AWAY):
            master = rosgraph.Master(rospy.get_name())
            master.lookupService(self._manager + "/load_nodelet")
            uri = master.lookupNode(self._manager)
        if uri and not _answers(uri):
            uri = ""
        if not uri and not self._waiting and not rospy.core.is_shutdown_requested():
            rospy.loginfo("waiting for the manager %s", self._manager)
        self._waiting = not uri
        return uri

    def _meet(self, manager: str) -> bool:
        """Whether a manager is ready for cameras.

        What another one had is forgotten: a bond tells of its death later.
        """
        if manager == self._met:
            return True
        with self._lock:
            old = {name: loaded for name, loaded in self._loaded.items() if loaded[0] != manager}
            for name in old:
                del self._loaded[name]
        for _, bond in old.values():
            bond.shutdown()
        self._refused.clear()
        service = rospy.ServiceProxy(self._manager + "/list", NodeletList)
        try:
            left = set(service().nodelets) & set(self._cameras)
        except (rospy.ServiceException, rospy.ROSException):
            return False
        for name in sorted(left):
            rospy.loginfo("%s: unloaded, another loader has left it", name)
            self._unload(name)
        self._met = manager
        return True

    def _missing(self) -> List[str]:
        now = time.monotonic()
        with self._lock:
            return [
                name
                for name in self._cameras
                if name not in self._loaded
                and self._crashes[name] < MOST_CRASHES
                and self._refused.get(name, (now, 0.0))[0] <= now
            ]

    def _load(self, name: str, manager: str) -> bool:
        """Whether the manager is still there."""
        bond = bondpy.bondpy.Bond(
            self._manager + "/bond", str(uuid.uuid4()), on_broken=lambda: self._lose(name, bond)
        )
        service = rospy.ServiceProxy(self._manager + "/load_nodelet", NodeletLoad)
        if self._lost.pop(name, "") == manager:
            self._unload(name)
        self._loading = True
        try:
            service(name, PLUGIN, [], [], [], bond.id)
        except (rospy.ServiceException, rospy.ROSException) as error:
            bond.shutdown()
            return self._survives(name, manager, error)
        finally:
            self._loading = False
        self._refused.pop(name, None)
        with self._lock:
            self._loaded[name] = manager, bond
        bond.start()
        # A manager that is ended before, crashes.
        bond.wait_until_formed(rospy.Duration(UNTIL_BONDED))
        rospy.loginfo("%s: loaded", name)
        return True

    def _survives(self, name: str, manager: str, error: Exception) -> bool:
        """Whether the manager is still there after a camera has not been loaded; tells it."""
        if rospy.core.is_shutdown_requested():
            return False
        if _answers(manager):
            wait = min(2.0 * self._refused.get(name, (0.0, FIRST_RETRY / 2.0))[1], LAST_RETRY)
            self._refused[name] = time.monotonic() + wait, wait
            why = "%s: not loaded, the manager says why; trying again in %.0f s"
            rospy.logerr(why, name, wait)
            return True
        self._crashes[name] += 1
        again = self._crashes[name] < MOST_CRASHES
        rospy.logerr(
            "%s: the manager died of it; %s", name, "once more" if again else "it is left out"
        )
        return False

    def _lose(self, name: str, bond: bondpy.bondpy.Bond) -> None:
        with self._lock:
            if self._loaded.get(name, ("", None))[1] is not bond:
                return
            self._lost[name], _ = self._loaded.pop(name)
        if not rospy.core.is_shutdown_requested():
            rospy.logwarn("%s: lost, the manager has died or unloaded it", name)

    def _end(self) -> None:
        # A manager that is ending, by the same Ctrl-C, would crash if a bond were to break now.
        try:
            rospy.rostime.wallsleep(UNTIL_MANAGER_ENDS)
            if not self._loading and self._manager_uri():
                with self._lock:
                    loaded, self._loaded = self._loaded, {}
                for name, (_, bond) in loaded.items():
                    self._unload(name)
                    bond.shutdown()
        finally:
            self._done.set()

    def _unload(self, name: str) -> None:
        service = rospy.ServiceProxy(self._manager + "/unload_nodelet", NodeletUnload)
        with contextlib.suppress(rospy.ServiceException, rospy.ROSException):
            service(name)


def _answers(uri: str) -> bool:
    """Whether there is a living node."""
    try:
        return xmlrpc.client.ServerProxy(uri).getPid("/camera_loader")[0] == 1
    except AWAY:
        return False


def _replace_params(camera: str, parameters: Dict[str, Any]) -> None:
    """Gives a camera these parameters in place of what it had, and leaves those of other nodes."""
    state = rosgraph.Master(rospy.get_name()).getSystemState()
    nodes = {node + "/" for kind in state for _, of_topic in kind for node in of_topic}
    present = rospy.get_param(camera, {})
    kept = {
        key: value
        for key, value in present.items()
        if any(node.startswith(f"{camera}/{key}/") for node in nodes)
    }
    if kept or parameters:
        rospy.set_param(camera, {**kept, **parameters})
    elif present:
        rospy.delete_param(camera)


def main() -> None:
    run_node("camera_loader", CameraLoader, CameraLoader.run, has_file=False)
