"""The node camera_loader, which loads cameras into one nodelet manager and follows their list."""

import contextlib
import threading
import time
import uuid
from typing import Any, Dict, List, Tuple

import bondpy.bondpy
import rosgraph
import rospy
from nodelet.srv import NodeletList, NodeletLoad, NodeletUnload

from ..ros.graph_master import MasterCalls, NodeCalls, has_service
from ..ros.params import read_any, read_name
from ..ros.registration import UNREACHABLE_ERRORS
from ..ros.startup import run_node
from .camera_list import parse_cameras

PLUGIN = "robot_vision/camera"
POLL_PERIOD = 0.5  # s between two rounds of work
BOND_TIMEOUT = 2.0  # s, longest wait for a bond
MANAGER_END_DELAY = 0.5  # s that a manager takes to end if it was told together with this node
FIRST_RETRY, LAST_RETRY = 1.0, 60.0  # s, shortest and longest wait after a camera was refused
MAX_CRASHES = 2  # of the manager while it loads a camera, before that camera is left out


class CameraLoader:
    """Loads the cameras of the list ~cameras into ~manager, and again when that was restarted.

    A wrong list is logged, and the node waits for a better one; if it ended instead, roslaunch
    would restart it again and again. When the list changes, cameras are added, removed and loaded
    again as needed, and all others go on. A camera that the manager refuses is tried again, at
    growing intervals.

    A bond with each camera tells this node when the manager has died. It also tells the manager
    when this node has died: the manager then unloads the cameras, but notices it only after some
    seconds, so that a restarted loader may have to unload them itself. A loader that is told to
    end unloads its cameras, unless the manager is loading one at the moment: that may take long,
    and the manager answers nothing meanwhile.
    """

    def __init__(self) -> None:
        self._manager = rospy.resolve_name(read_name("manager", "camera_manager"))
        self._list: Any = None  # the value of ~cameras that was read last
        self._cameras: Dict[str, Dict[str, Any]] = {}  # their parameters; empty without a list
        self._crashes: Dict[str, int] = {}  # of the manager, while it loaded that camera
        self._list_error = ""  # the error of the list that was logged last
        # Guards _loaded and _lost, because each bond breaks in a thread of its own.
        self._lock = threading.Lock()
        self._loaded: Dict[str, Tuple[str, bondpy.bondpy.Bond]] = {}  # with the manager's URI
        self._lost: Dict[str, str] = {}  # with the URI of the manager that may still have it
        self._refused: Dict[str, Tuple[float, float]] = {}  # time of the next try, and wait (s)
        self._prepared_manager = ""  # URI of the manager that has no cameras of an earlier loader
        self._waiting = False
        self._loading = False  # whether the manager is loading a camera
        self._done = threading.Event()
        rospy.on_shutdown(self._end)

    def run(self) -> None:
        """Works until the node is shut down."""
        # The work has its own thread: a manager that is loading a camera may answer late or never.
        work = threading.Thread(target=self._work, daemon=True)
        work.start()
        # rospy never calls a function that comes to on_shutdown() while it calls the others.
        while not (self._done.wait(POLL_PERIOD) or rospy.is_shutdown()):
            if not work.is_alive() and not rospy.core.is_shutdown_requested():
                raise SystemExit(1)  # The thread has logged the reason.

    def _work(self) -> None:
        while not rospy.core.is_shutdown_requested():
            self._read_list()
            manager = self._manager_uri() if self._cameras else ""
            if manager and self._prepare_manager(manager):
                # If the manager dies of a camera, the round ends.
                all(self._load(name, manager) for name in self._missing())
            rospy.rostime.wallsleep(POLL_PERIOD)

    def _read_list(self) -> None:
        """Follows ~cameras. An error in it is logged once, and all cameras stay as they are."""
        try:
            values = read_any("cameras", None)
        except UNREACHABLE_ERRORS:
            return
        if self._cameras and values in (self._list, None):  # A restarted master has no list.
            self._list_error = ""
            return
        try:
            cameras = parse_cameras(values)
        except ValueError as error:
            if str(error) != self._list_error:
                rospy.logerr("%s; waiting for another list in ~cameras", error)
            self._list_error = str(error)
            return
        self._list, self._list_error = values, ""
        self._change({rospy.resolve_name(name): of for name, of in cameras.items()})

    def _change(self, cameras: Dict[str, Dict[str, Any]]) -> None:
        """Unloads cameras that have changed or gone, and leaves all others alone."""
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
        """Returns the URI of the manager, or "" if it does not answer."""
        uri = ""
        with contextlib.suppress(*UNREACHABLE_ERRORS):
            registered = self._registered_manager()
            if registered:
                _require_node(registered)
                uri = registered
        if not uri and not self._waiting and not rospy.core.is_shutdown_requested():
            rospy.loginfo("waiting for the manager %s", self._manager)
        self._waiting = not uri
        return uri

    def _registered_manager(self) -> str:
        """Returns the URI of the manager by the master, or "" if it knows none.

        Raises:
            OSError: The master does not answer.
        """
        if not has_service(self._manager + "/load_nodelet"):
            return ""
        with contextlib.closing(MasterCalls()) as master:
            return str(master.call("lookupNode", self._manager))

    def _prepare_manager(self, manager: str) -> bool:
        """Prepares a manager for cameras, and returns whether it is ready for them.

        Cameras of an earlier manager are forgotten. Their bonds would tell of its death too late.
        """
        if manager == self._prepared_manager:
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
        self._prepared_manager = manager
        return True

    def _missing(self) -> List[str]:
        now = time.monotonic()
        with self._lock:
            return [
                name
                for name in self._cameras
                if name not in self._loaded
                and self._crashes[name] < MAX_CRASHES
                and self._refused.get(name, (now, 0.0))[0] <= now
            ]

    def _load(self, name: str, manager: str) -> bool:
        """Loads a camera; returns whether the manager is still alive."""
        bond = bondpy.bondpy.Bond(
            self._manager + "/bond",
            str(uuid.uuid4()),
            on_broken=lambda: self._drop(name, bond),
        )
        service = rospy.ServiceProxy(self._manager + "/load_nodelet", NodeletLoad)
        if self._lost.pop(name, "") == manager:
            self._unload(name)
        with contextlib.suppress(
            *UNREACHABLE_ERRORS
        ):  # The manager could read no parameters either.
            if not rospy.has_param(f"{name}/source"):  # A restarted master has none of them.
                _replace_params(name, self._cameras[name])
        self._loading = True
        try:
            service(name, PLUGIN, [], [], [], bond.id)
        except (rospy.ServiceException, rospy.ROSException) as error:
            bond.shutdown()
            return self._is_manager_alive_after(name, manager, error)
        finally:
            self._loading = False
        self._refused.pop(name, None)
        self._crashes[name] = 0
        with self._lock:
            self._loaded[name] = manager, bond
        bond.start()
        # A manager that has to end before the bond is formed crashes.
        bond.wait_until_formed(rospy.Duration(BOND_TIMEOUT))
        rospy.loginfo("%s: loaded", name)
        return True

    def _is_manager_alive_after(self, name: str, manager: str, error: Exception) -> bool:
        """Logs that a camera was not loaded; returns whether the manager is still alive."""
        if rospy.core.is_shutdown_requested():
            return False
        if _is_there(manager):
            wait = min(2.0 * self._refused.get(name, (0.0, FIRST_RETRY / 2.0))[1], LAST_RETRY)
            self._refused[name] = time.monotonic() + wait, wait
            message = "%s: not loaded, the manager says why; trying again in %.0f s"
            rospy.logerr(message, name, wait)
            return True
        self._crashes[name] += 1
        again = self._crashes[name] < MAX_CRASHES
        rospy.logerr(
            "%s: the manager died of it; %s", name, "once more" if again else "it is left out"
        )
        return False

    def _drop(self, name: str, bond: bondpy.bondpy.Bond) -> None:
        with self._lock:
            if self._loaded.get(name, ("", None))[1] is not bond:
                return
            self._lost[name], _ = self._loaded.pop(name)
        if not rospy.core.is_shutdown_requested():
            rospy.logwarn("%s: lost, the manager has died or unloaded it", name)

    def _end(self) -> None:
        # A manager that is ending too, by the same Ctrl-C, would crash if a bond broke now.
        try:
            rospy.rostime.wallsleep(MANAGER_END_DELAY)
            if not self._loading and self._is_manager_there():
                with self._lock:
                    loaded, self._loaded = self._loaded, {}
                for name, (_, bond) in loaded.items():
                    self._unload(name)
                    bond.shutdown()
        finally:
            self._done.set()

    def _is_manager_there(self) -> bool:
        with contextlib.suppress(OSError):
            manager = self._registered_manager()
            return bool(manager) and _is_there(manager)
        return False

    def _unload(self, name: str) -> None:
        service = rospy.ServiceProxy(self._manager + "/unload_nodelet", NodeletUnload)
        with contextlib.suppress(rospy.ServiceException, rospy.ROSException):
            service(name)


def _require_node(uri: str) -> None:
    """Raises one of UNREACHABLE_ERRORS if no node answers at the URI, TimeoutError if it is busy.

    The port of a node that was killed may have been given to a program that reads on, and never
    answers: a node's own server of topics does.
    """
    with contextlib.closing(NodeCalls(uri)) as node:
        node.call("getPid")


def _is_there(uri: str) -> bool:
    """Returns whether a node is at the URI, even if it is too busy to answer."""
    try:
        _require_node(uri)
    except TimeoutError:
        return True
    except UNREACHABLE_ERRORS:
        return False
    return True


def _replace_params(camera: str, parameters: Dict[str, Any]) -> None:
    """Replaces the parameters of a camera, but keeps those of nodes below its name."""
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
