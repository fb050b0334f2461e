"""Starting and ending a node."""

import contextlib
import glob
import inspect
import logging
import os
import signal
import sys
import threading
import time
import traceback
import xmlrpc.client
from typing import Any, Callable, Dict

import rosgraph
import rospy
import rospy.impl.tcpros_base
from rosgraph.roslogging import RosStreamHandler
from rospy.client import load_command_line_node_params

from ..common.commands import end_process
from ..common.files import ROS_HOME_NEEDED
from ..common.plain_text import brief, printable
from .registration import UNREACHABLE_ERRORS, keep_registered

SIGNALS = (signal.SIGINT, signal.SIGTERM)
SHUTDOWN_GRACE = 2.0  # s of time on a core that a node has to end by itself after a signal
MAX_SHUTDOWN_GRACE = 10.0  # s until it is ended by force, however busy the machine is
# Connections to topics and services that wait until the node has time for them. rospy has room
# for 5; Linux lets all others try again after a second.
BACKLOG = 128
TURN, MAX_TURN = 0.05, 0.1  # s from one look at a node that ends to the next, and what of it counts
START_GRACE = 0.5  # s after the shutdown that a node has to end by itself which was still starting
USAGE = """usage: rosrun robot_vision {program} [TOPIC:=OTHER ...] [_PARAMETER:=VALUE ...]

{module}

{node}
"""
PARAMETERS = """
Its parameters are described in docs/parameters.md of this package; its folder config has a file of
them, where ~save_parameters (std_srvs/Trigger) saves those that can be changed live.
"""


def run_node(
    name: str,
    start: Callable[[], Any],
    spin: Callable[[Any], object] = lambda _: rospy.spin(),
    has_file: bool = True,
    own_process: bool = False,
) -> None:
    """Runs this process as the node `name` until it is shut down; SIGINT ends it with code 0.

    With --help it prints the docstrings of the node's class and module, and needs no master.
    Otherwise it checks the parameters of the command line, waits for the master and starts the
    node. If that raises ValueError, as for a bad parameter, a FATAL line is logged and the exit
    code is 1.

    rospy itself ignores Ctrl-C while it waits for the master. It also shuts down inside its signal
    handler, where it blocks on any lock that the interrupted thread holds. Here a separate thread
    shuts the node down.

    Args:
        name: The default name of the node.
        start: The node's class, which makes its publishers and subscribers. The object is kept
            until the end.
        spin: A main loop that is called with the object. It returns when the node is shut down
            (rospy.is_shutdown()) or has done its work.
        has_file: Whether there is a file of the node's parameters, which --help then mentions.
        own_process: Whether python_manager.py must not load it beside others; a node with a `spin`
            of its own cannot be loaded either.
    """
    if {"-h", "--help"}.intersection(sys.argv[1:]):
        print(_usage(start) + (PARAMETERS if has_file else ""), end="")
        return
    try:
        _require_storable_params()
    except ValueError as error:  # There is no node yet, and so no log of rospy.
        print(f"{name}: {error}", file=sys.stderr)
        end_process(1)
    _wait_for_master(name)
    started = threading.Event()
    _shut_down_on_signals(started)
    code = 0
    try:
        code = _start_and_spin(name, start, spin, started)
    except SystemExit as error:
        code = error.code if isinstance(error.code, int) else int(error.code is not None)
    except BaseException:
        # A node that is shut down while it starts may find rospy or its images closed.
        if not rospy.core.is_shutdown_requested():
            traceback.print_exc()
            code = 1
    with rospy.core._shutdown_lock:  # A thread that is shutting the node down holds it.
        pass
    end_process(code)


def become_node(name: str) -> None:
    """Makes this process, a command, a node with a unique name.

    Raises:
        OSError: There is no master.
    """
    if not rosgraph.is_master_online():
        raise OSError(f"no ROS master answers at {rosgraph.get_master_uri()}")
    rospy.init_node(name, anonymous=True, disable_signals=True)


def _usage(start: Callable[[], Any]) -> str:
    return USAGE.format(
        program=os.path.basename(sys.argv[0]),
        module=inspect.getdoc(inspect.getmodule(start)),
        node=str(inspect.getdoc(start)).partition("\n\nRaises:")[0],  # which is for programmers
    )


def _require_storable_params() -> None:
    """Raises ValueError for a _parameter:=value that the parameter server cannot hold.

    Examples are an integer of more than 32 bits, a date, null, and text that XML does not allow.
    """
    try:
        params = load_command_line_node_params(sys.argv)
    except rospy.ROSInitException as error:  # The value is not YAML; the message has several lines.
        raise ValueError(printable(" ".join(str(error).split()), 300)) from None
    for name, value in params.items():
        try:
            xmlrpc.client.loads(xmlrpc.client.dumps((value,)))
        except Exception as error:  # There are many kinds.
            what = (
                f"{printable(name)} is {brief(value)}, must be what the parameter server can hold"
            )
            raise ValueError(f"{what}: {printable(str(error))}") from None


def _start_and_spin(
    name: str, start: Callable[[], Any], spin: Callable[[Any], object], started: threading.Event
) -> int:
    """Returns the exit code. `started` is set in between."""
    try:
        _init_node(name)
        node = start()
        started.set()
    except ValueError as error:
        if rospy.core.is_shutdown_requested():
            return 0
        rospy.logfatal("%s: %s", rospy.get_name(), error)
        return 1
    keep_registered()
    spin(node)
    return 0


def _init_node(name: str) -> None:
    """Initializes rospy; raises ValueError if this user may not write to the log file."""
    # rospy replaces this handler by its own, unless there can be no folder for its log file. The
    # node would then run and end without a word.
    logger = logging.getLogger("rosout")
    logger.addHandler(RosStreamHandler())
    logger.setLevel(logging.INFO)
    try:
        rospy.init_node(name, disable_signals=True)
    except PermissionError as error:
        raise ValueError(f"{error.filename}: {error.strerror}; {ROS_HOME_NEEDED}") from None
    rospy.impl.tcpros_base._tcpros_server.tcp_ros_server.server_sock.listen(BACKLOG)


def _wait_for_master(name: str) -> None:
    """Returns when the master answers; a signal until then ends the process with code 0."""
    for number in SIGNALS:
        signal.signal(number, lambda *_: os._exit(0))  # An exception might get lost.
    master = rosgraph.Master("/" + name)
    waiting = False
    while True:
        try:
            master.getPid()
            return
        except UNREACHABLE_ERRORS:
            if not waiting:
                print(f"waiting for the master at {master.master_uri}", file=sys.stderr, flush=True)
            waiting = True
            time.sleep(0.1)


def is_stuck(goes_on: Callable[[], bool]) -> bool:
    """Waits while something goes on; returns whether it still does after SHUTDOWN_GRACE.

    The time during which this process waits for a core of a busy machine does not count, nor that
    during which it is stopped.
    """
    begin = last = time.monotonic()
    before, waited, passed = waited_for_cores(), 0.0, 0.0
    while goes_on():
        waits, now = waited_for_cores(), time.monotonic()
        # Threads end meanwhile: what they have waited before is not to be taken from the sum.
        waited += sum(seconds - before.get(thread, 0.0) for thread, seconds in waits.items())
        passed += min(now - last, MAX_TURN)
        before, last = waits, now
        if passed >= SHUTDOWN_GRACE + waited or now - begin >= MAX_SHUTDOWN_GRACE:
            return True
        time.sleep(TURN)
    return False


def waited_for_cores() -> Dict[str, float]:
    """Returns the time in s that each thread of this process has waited for a core.

    It is the second number of /proc/PID/task/TID/schedstat, in ns. Where the kernel does not count
    this time, there is none.
    """
    waited = {}
    for path in glob.glob("/proc/self/task/*/schedstat"):
        # A thread may have ended meanwhile, and no content of the file may keep the node alive.
        with contextlib.suppress(OSError, ValueError, IndexError), open(path) as file:
            waited[path] = int(file.read().split()[1]) * 1e-9
    return waited


def _shut_down_on_signals(started: threading.Event) -> None:
    """Makes signals shut the node down, and ends the process even if the node is stuck.

    A node that has not started then goes on to do so until something fails, which may be much work
    for the master. As soon as rospy is shut down it has nothing more to do.
    """
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    # The interpreter writes to this pipe at once, whatever the main thread is doing.
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    for number in SIGNALS:
        signal.signal(number, lambda *_: None)

    def wait() -> None:
        while os.read(reader, 1)[0] not in SIGNALS:
            pass
        # rospy closes sockets that its own threads are waiting for.
        threading.excepthook = lambda _: None
        shutdown = threading.Thread(target=rospy.signal_shutdown, args=("signal",), daemon=True)
        shutdown.start()
        if is_stuck(lambda: started.is_set() or shutdown.is_alive()):
            print(f"did not end within {SHUTDOWN_GRACE:g} s of a signal", file=sys.stderr)
        else:
            time.sleep(START_GRACE)
        os._exit(0)

    threading.Thread(target=wait, name="signals", daemon=True).start()
