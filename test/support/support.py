"""Shared by the tests of running nodes: processes on a private master, topics, deadlines."""

import contextlib
import functools
import json
import os
import pathlib
import select
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.parse
import xmlrpc.client
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Set

import numpy as np
import private_master
import rosgraph
import roslib.packages
import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from nodelet.srv import NodeletList, NodeletLoad, NodeletUnload
from ports import free_port
from ros_programs import program_of

DEADLINE = 60.0  # s; on an idle machine everything takes a moment only
RENEWAL_PERIOD = 2.0  # s
MASTER = (sys.executable, private_master.__file__)
PARAMETER_TYPES = {"bool": bool, "int": int, "double": float, "str": str}


arrived = threading.Event()  # set by each message, cleared by wait_for()


def wait_for(condition: Callable[[], Any], what: str, seconds: float = DEADLINE) -> Any:
    """Waits for a true value of `condition`; fails the test naming `what` after `seconds`.

    The condition is checked when messages arrive, and now and then: the less often the longer it
    is waited for. After each check there is a pause of its length, up to 0.2 s, because many ask
    the master and nodes, whose answers others wait for, too.
    """
    begin = time.monotonic()
    while time.monotonic() < begin + seconds:
        arrived.clear()
        asked = time.monotonic()
        value = condition()
        if value:
            return value
        for subscription in list(open_messages):
            if isinstance(subscription, _Subscription):
                subscription.renew_if_silent()
        now = time.monotonic()
        time.sleep(min(now - asked, 0.2))
        arrived.wait(min(max(0.02, (now - begin) / 10), 0.2))
    raise AssertionError(f"not within {seconds:.0f} s: {what}")


def has_service(master: rosgraph.Master, service: str) -> bool:
    """True if a master, which may not be running yet, knows the service."""
    try:
        return bool(master.lookupService(service))
    except (rosgraph.MasterException, OSError):
        return False


@contextlib.contextmanager
def missed_signs_allowed() -> Iterator[str]:
    """No bond breaks because a process does not come to giving signs of life; the parameter."""
    name = "/bond_disable_heartbeat_timeout"
    rospy.set_param(name, True)
    try:
        yield name
    finally:
        rospy.delete_param(name)


@contextlib.contextmanager
def service_of(master: rosgraph.Master, service: str) -> Iterator[str]:
    """Makes a service of another master usable by rospy.ServiceProxy under the name it gives."""
    wait_for(lambda: has_service(master, service), f"the service {service}")
    node, address = service.rpartition("/")[0], master.lookupService(service)
    own = rosgraph.Master(node)
    own.registerService(service, address, master.lookupNode(node))
    try:
        yield service
    finally:
        own.unregisterService(service, address)


@contextlib.contextmanager
def standing_still(process: "Process") -> Iterator[None]:
    """Stops a process (SIGSTOP), so that it answers nobody but keeps its connections open."""
    os.kill(process.pid, signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(process.pid, signal.SIGCONT)


def spawn(command: List[str], log: pathlib.Path, env: Dict[str, str]) -> subprocess.Popen:
    """Starts a command whose output goes to `log`."""
    with open(log, "wb") as out:
        return subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=subprocess.STDOUT,
            env=env,
            start_new_session=True,
        )


class Process:
    """A command under test, with its output in a file.

    Args:
        run: the function that starts it, spawn or PythonStarter.spawn.
    """

    def __init__(
        self,
        command: List[str],
        log: pathlib.Path,
        env: Optional[Dict[str, str]] = None,
        run: Callable[..., Any] = spawn,
    ):
        self._log = log
        self._interrupted = False
        self._popen = run(command, log, dict(os.environ, **(env or {})))

    def __str__(self) -> str:
        return " ".join(map(str, self._popen.args))

    @property
    def pid(self) -> int:
        return self._popen.pid

    def output(self) -> str:
        return self._log.read_text(errors="replace")

    def running(self) -> bool:
        return self._popen.poll() is None

    def _is_idle(self) -> bool:
        """Whether none of its threads needs a core or the disk, or is stopped."""
        for thread in pathlib.Path(f"/proc/{self.pid}/task").glob("*/stat"):
            with contextlib.suppress(OSError):  # It has ended.
                if thread.read_text(errors="replace").rpartition(")")[2].split()[0] in "RDT":
                    return False
        return True

    def kill(self) -> None:
        self._popen.send_signal(signal.SIGKILL)

    def interrupt(self) -> None:
        self._interrupted = True
        self._popen.send_signal(signal.SIGINT)

    def exit_code(self, seconds: float = DEADLINE) -> int:
        """Waits for the process to end; fails with its output if it does not."""
        try:
            return self._popen.wait(seconds)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"still running after {seconds} s:\n{self.output()}") from None

    def prompt_exit_code(self) -> int:
        """The exit code of a process that was told to end, which must take at most a second.

        On a busy machine it may take longer, but not while it waits for neither a core nor a master
        that is as busy.
        """
        with contextlib.suppress(subprocess.TimeoutExpired):
            return self._popen.wait(1.0)
        turns = 0  # in which it could have ended, and the master has answered
        deadline = time.monotonic() + DEADLINE
        while self.running():
            assert turns < 100 and time.monotonic() < deadline, f"still running:\n{self.output()}"
            with contextlib.suppress(Exception):
                rosgraph.Master("/test").getPid()
            time.sleep(0.02)
            turns += self._is_idle()
        # A stuck Python node is ended by its watchdog with the same code, but with a message.
        assert "did not end within" not in self.output(), self.output()
        return self.exit_code()

    def wait_for_output(self, text: str, seconds: float = DEADLINE) -> None:
        try:
            wait_for(lambda: text in self.output() or not self.running(), text, seconds)
        except AssertionError as error:
            raise AssertionError(f"{error}; the output:\n{self.output()}") from None
        assert text in self.output(), self.output()

    def end(self) -> None:
        """Ends the process and all its children."""
        if self.running():
            if not self._interrupted:
                self.interrupt()
            # roslaunch ends its nodes one by one; if it were killed, some would stay.
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._popen.wait(DEADLINE)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._popen.pid, signal.SIGKILL)
        self._popen.wait()


class Master:
    """A separate master, started with a fixture's `start`, this command and these options.

    It can be ended and started again on the same port.
    """

    def __init__(
        self, start: Callable[..., Process], command: Sequence[str] = MASTER, **options: Any
    ):
        private_master.mark_own_processes()
        self._start = functools.partial(start, *command, **options)
        self.port = free_port()
        self.env = {"ROS_MASTER_URI": f"http://127.0.0.1:{self.port}"}
        self.api = rosgraph.Master("/test", self.env["ROS_MASTER_URI"])
        self.begin()

    def begin(self) -> None:
        self.process = self._start("--core", "-p", self.port)
        wait_for(lambda: rosgraph.is_master_online(self.env["ROS_MASTER_URI"]), "a master")

    def end(self) -> None:
        self.process.end()


class NodeletManager:
    """A running nodelet manager, started with a fixture's `start` and these options."""

    def __init__(self, start: Callable[..., Process], **options: Any):
        self.name = "/manager"
        self.process = start(
            program_of("nodelet", "nodelet"), "manager", f"__name:={self.name[1:]}", **options
        )
        rospy.wait_for_service(self.name + "/load_nodelet", DEADLINE)

    def load(self, name: str, kind: str, remappings: Optional[Dict[str, str]] = None) -> bool:
        """Loads a nodelet of this package; raises rospy.ServiceException if it does not start."""
        load = rospy.ServiceProxy(self.name + "/load_nodelet", NodeletLoad)
        remappings = remappings or {}
        topics = list(remappings), list(remappings.values())
        return load(name, "robot_vision/" + kind, *topics, [], "").success

    def unload(self, name: str) -> bool:
        return rospy.ServiceProxy(self.name + "/unload_nodelet", NodeletUnload)(name).success

    def loaded(self) -> Set[str]:
        return set(rospy.ServiceProxy(self.name + "/list", NodeletList)().nodelets)


class PythonStarter:
    """Starts Python programs without the second that their imports take: see python_starter.py."""

    def __init__(self, folder: pathlib.Path):
        self._socket = str(folder / "python")
        program = str(pathlib.Path(__file__).with_name("python_starter.py"))
        self._process = Process([sys.executable, program, self._socket], folder / "python.log")

    def spawn(self, command: List[str], log: pathlib.Path, env: Dict[str, str]) -> "Fork":
        connection = wait_for(self._connect, "the starter of Python programs")
        log.write_bytes(b"")  # it must exist at once for those who read it
        path, *arguments = command
        request = {"path": path, "arguments": arguments, "env": env, "log": str(log)}
        connection.sendall(json.dumps({**request, "cwd": os.getcwd()}).encode() + b"\n")
        return Fork(command, connection)

    def _connect(self) -> Optional[socket.socket]:
        assert self._process.running(), self._process.output()
        connection = socket.socket(socket.AF_UNIX)
        try:
            connection.connect(self._socket)
            return connection
        except OSError:
            connection.close()
            return None

    def end(self) -> None:
        self._process.end()


class Fork:
    """A process of python_starter.py with the interface of subprocess.Popen."""

    def __init__(self, command: List[str], connection: socket.socket):
        self.args = command
        self._connection = connection
        self._answers = connection.makefile()
        self.pid = int(self._answers.readline())
        self.returncode: Optional[int] = None

    def poll(self) -> Optional[int]:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.wait(0.0)
        return self.returncode

    def wait(self, timeout: Optional[float] = None) -> int:
        if self.returncode is None:
            if not select.select([self._connection], [], [], timeout)[0]:
                raise subprocess.TimeoutExpired(self.args, timeout)
            self.returncode = int(self._answers.readline())
            self._answers.close()
            self._connection.close()
        return self.returncode

    def send_signal(self, number: int) -> None:
        if self.poll() is None:
            os.kill(self.pid, number)


@functools.lru_cache(maxsize=None)
def executable(name: str) -> str:
    """The path of an executable of this package."""
    return roslib.packages.find_node("robot_vision", name)[0]


def node_api(name: str) -> xmlrpc.client.ServerProxy:
    """The XML-RPC interface of a running node (Slave API in the ROS wiki)."""
    return xmlrpc.client.ServerProxy(rosgraph.Master(rospy.get_name()).lookupNode(name))


def is_running(node: str) -> bool:
    """False if a node is no more; raises rosgraph.MasterException if the master knows none."""
    uri = rosgraph.Master(rospy.get_name()).lookupNode(node)
    port = urllib.parse.urlparse(uri).port or 0
    return private_master.is_port_of_test(port, os.environ[private_master.MARK])


def publishers_of(topic: str) -> List[str]:
    """The nodes that publish a topic, as the master knows them."""
    return dict(rosgraph.Master(rospy.get_name()).getSystemState()[0]).get(topic, [])


def sends(node: str, topic: str, receiver: str = "") -> bool:
    """True as long as a running node has a connection to a receiver of a topic; to us, if none."""
    me = receiver or rospy.get_name()
    try:
        _, _, connections = node_api(node).getBusInfo(me)
    except (OSError, rosgraph.MasterException):  # it has ended, or has not quite begun
        return False
    return any((to, way, of) == (me, "o", topic) for _, to, way, _, of, *_ in connections)


def receives_over(node: str, topic: str) -> bool:
    """True as long as a running node has a connection to a publisher of this very topic."""
    _, _, connections = node_api(node).getBusInfo(rospy.get_name())
    return any((way, of) == ("i", topic) for _, _, way, _, of, *_ in connections)


def receives(node: str, topic: str) -> bool:
    """True as long as a running node has the messages of a topic, raw or over shm."""
    return receives_over(node, topic) or receives_over(node, topic + "/shm")


open_messages: List[Any] = []  # what subscribes: closed at the end of each test


class _Subscription:
    """Messages of a topic; how they are kept is the derived class's."""

    def __init__(self, topic: str, kind: Any, **options: Any):
        open_messages.append(self)
        self._asked = time.monotonic()
        self._topic = topic
        self._subscriber = rospy.Subscriber(topic, kind, self._on_message, **options)

    def _on_message(self, message: Any) -> None:
        raise NotImplementedError

    def is_silent(self) -> bool:
        raise NotImplementedError

    def renew_if_silent(self) -> None:
        """What wait_for() calls while it waits: see _renew()."""
        if self.is_silent():
            self._renew_now_and_then()

    def _renew_now_and_then(self) -> None:
        if time.monotonic() - self._asked > RENEWAL_PERIOD:
            self._asked = time.monotonic()
            with contextlib.suppress(rosgraph.MasterException, OSError):  # if it is not there now
                self._renew()

    def _renew(self) -> None:
        """Tells rospy of the publishers again, as the master knows them.

        Where one registers while the master answers rospy's own question, and its news are there
        before that answer, rospy takes the answer for what is newer, and never connects.
        """
        topic, me, uri = self._subscriber.resolved_name, rospy.get_name(), rospy.get_node_uri()
        publishers = rosgraph.Master(me).registerSubscriber(topic, self._subscriber.type, uri)
        xmlrpc.client.ServerProxy(uri).publisherUpdate(me, topic, publishers)

    def close(self) -> None:
        open_messages.remove(self)
        self._subscriber.unregister()


class Messages(_Subscription):
    """Collects all messages of a topic from now on."""

    def __init__(self, topic: str, kind: Any):
        self.received: List[Any] = []
        super().__init__(topic, kind, queue_size=100, buff_size=2**26, tcp_nodelay=True)

    def _on_message(self, message: Any) -> None:
        self.received.append(message)
        arrived.set()

    def is_silent(self) -> bool:
        return not self.received

    def wait(self, count: int = 1, seconds: float = DEADLINE) -> List[Any]:
        """Waits for the first `count` messages."""
        what = f"{count} messages on {self._topic}"
        wait_for(lambda: len(self.received) >= count, what, seconds)
        return self.received[:count]

    def of(self, stamp: rospy.Time) -> Any:
        """Waits for the message with this stamp, such as the result of a frame."""
        return wait_for(
            lambda: [message for message in self.received if stamp_of(message) == stamp],
            f"the message of {stamp.to_sec():.3f} s on {self._topic}",
        )[0]

    def connected(self) -> bool:
        """True if each publisher sends to this; rospy starts to a bit after it has said so."""
        topic = self._subscriber.resolved_name
        publishers = publishers_of(topic)
        if publishers and all(sends(node, topic) for node in publishers):
            return True
        self._renew_now_and_then()
        return False


def subscribed(topic: str, kind: Any) -> Messages:
    """All messages of a topic from now on, when its publishers are connected."""
    messages = Messages(topic, kind)
    wait_for(messages.connected, f"the publishers of {topic}")
    return messages


def reconfigured(node: str, **values: Any) -> Dict[str, Any]:
    """Sets live parameters of a node, and returns all that it has then."""
    # Not dynamic_reconfigure's client, which may miss the only message of a node that starts now.
    from dynamic_reconfigure.encoding import decode_config, decode_description, encode_config
    from dynamic_reconfigure.msg import Config, ConfigDescription
    from dynamic_reconfigure.srv import Reconfigure

    described = Messages(node + "/parameter_descriptions", ConfigDescription)
    description = decode_description(described.wait()[0])
    described.close()
    if values:
        types = {one["name"]: PARAMETER_TYPES[one["type"]] for one in _parameters(description)}
        config = encode_config({name: types[name](value) for name, value in values.items()})
        rospy.wait_for_service(node + "/set_parameters", DEADLINE)
        config = rospy.ServiceProxy(node + "/set_parameters", Reconfigure)(config).config
    else:
        updates = Messages(node + "/parameter_updates", Config)
        config = updates.wait()[0]
        updates.close()
    return decode_config(config, description)


def _parameters(group: Dict[str, Any]) -> List[Dict[str, Any]]:
    """The parameters of a group of dynamic_reconfigure, and of all groups in it."""
    groups = group["groups"].values()
    return [*group["parameters"], *(one for other in groups for one in _parameters(other))]


def windows() -> Dict[str, str]:
    """The visible windows: name -> number."""
    search = ["xdotool", "search", "--onlyvisible", "--name", "."]
    found = subprocess.run(search, stdout=subprocess.PIPE, check=False, text=True).stdout.split()
    names = {}
    for number in found:
        command = ["xdotool", "getwindowname", number]
        name = subprocess.run(
            command, stdout=subprocess.PIPE, check=False, text=True
        ).stdout.strip()
        names[name] = number
    return names


def screen(frame_buffer: pathlib.Path) -> np.ndarray:
    """The pixels on the screen, (height, width, 3), BGR, from X's window dump (X11/XWDFile.h)."""
    data = frame_buffer.read_bytes()
    head = np.frombuffer(data[:100], ">u4")
    header_size, width, height, row, colors = head[0], head[4], head[5], head[12], head[19]
    pixels = np.frombuffer(data, np.uint8, row * height, header_size + 12 * colors)
    return pixels.reshape(height, row)[:, : 4 * width].reshape(height, width, 4)[:, :, :3]


def assert_fatal_at_start(start: Any, node: str, name: str, value: Any, text: str) -> None:
    """Asserts that a Python node ends with code 1 and one FATAL line that has `text` in it.

    Args:
        start: the fixture of that name.
        name: the private parameter that is set to `value`.
    """
    rospy.set_param("/bad/" + name, value)
    process = start(node, "__name:=bad")
    assert process.exit_code() == 1
    fatal = [line for line in process.output().splitlines() if "FATAL" in line]
    assert len(fatal) == 1, process.output()
    assert "/bad: " in fatal[0] and text in fatal[0], process.output()


def stamp_of(message: Any) -> rospy.Time:
    """The stamp of a message with a header, or of the first transform of a TFMessage."""
    return message.header.stamp if hasattr(message, "header") else stamp_of(message.transforms[0])


def same_frame(*topics: Messages) -> List[Any]:
    """Waits for one message of each topic, all with the same stamp."""

    def common() -> Set[Any]:
        return set.intersection(*({stamp_of(m) for m in t.received} for t in topics))

    stamp = max(wait_for(common, "a frame that has come on all topics"))
    return [next(m for m in t.received if stamp_of(m) == stamp) for t in topics]


class Diagnostics(_Subscription):
    """Keeps the last status of the frames of every node on /diagnostics."""

    def __init__(self) -> None:
        self._heard = False
        self._statuses: Dict[str, DiagnosticStatus] = {}
        super().__init__("/diagnostics", DiagnosticArray)

    def is_silent(self) -> bool:
        return not self._heard

    def _on_message(self, message: DiagnosticArray) -> None:
        self._heard = True
        for status in message.status:
            node, _, what = status.name.partition(": ")
            if what == "frames":  # Some nodes have statuses of something else, too.
                self._statuses[node] = status
        arrived.set()

    def next(self, node: str) -> DiagnosticStatus:
        """Waits for the next status of `node` ("camera")."""
        self._statuses.pop(node, None)
        wait_for(lambda: node in self._statuses, "diagnostics of " + node)
        return self._statuses[node]

    def value(self, node: str, key: str) -> str:
        """One value of the next status of `node` that has any: the one of its start has none."""
        while True:
            values = {pair.key: pair.value for pair in self.next(node).values}
            if values:
                return values[key]
