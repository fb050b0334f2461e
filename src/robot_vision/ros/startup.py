"""How a node starts and ends."""

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
from typing import Any, Callable

import rosgraph
import rospy
from rosgraph.roslogging import RosStreamHandler
from rospy.client import load_command_line_node_params

from ..common.commands import end_process
from ..common.files import ROS_HOME_NEEDED
from ..common.plain_text import printable, told
from .registration import AWAY, keep_registered

SIGNALS = (signal.SIGINT, signal.SIGTERM)
SHUTDOWN_GRACE = 2.0  # s that a node has to end by itself after a signal, of those it could run in
LONGEST_GRACE = 10.0  # s, however busy the machine is
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
) -> None:
    """Runs this process as the node `name` until it is shut down, and ends it; SIGINT with code 0.

    Waits for the master, unless a parameter of the command line is none, and calls `start`, which
    makes the node's publishers and subscribers. A ValueError of it, a bad parameter, is a FATAL
    line and exit code 1. What it returns is kept alive while the node spins: in `spin`, a main loop
    that is called with it and returns when the node is shut down (rospy.is_shutdown()) or has done
    its work. With --help it prints what the docstrings of `start`, a class, and its module say
    instead, and needs no master; that there is a file of its parameters only if it `has_file`.

    rospy waits for the master deaf to Ctrl-C, and shuts down inside its signal handler, where it
    blocks on any lock that the interrupted thread holds. Here a thread of its own does that.
    """
    if {"-h", "--help"}.intersection(sys.argv[1:]):
        print(_usage(start) + (PARAMETERS if has_file else ""), end="")
        return
    try:
        _require_storable_params()
    except ValueError as error:  # rospy's log begins with its node
        print(f"{name}: {error}", file=sys.stderr)
        end_process(1)
    _wait_for_master(name)
    _shut_down_on_signals()
    code = 0
    try:
        code = _start_and_spin(name, start, spin)
    except SystemExit as error:
        code = error.code if isinstance(error.code, int) else int(error.code is not None)
    except BaseException:
        # A node that is shut down while it starts finds rospy, or its pictures, closed.
        if not rospy.core.is_shutdown_requested():
            traceback.print_exc()
            code = 1
    with rospy.core._shutdown_lock:  # held by a thread that is shutting the node down
        pass
    end_process(code)


def _usage(start: Callable[[], Any]) -> str:
    return USAGE.format(
        program=os.path.basename(sys.argv[0]),
        module=inspect.getdoc(inspect.getmodule(start)),
        node=str(inspect.getdoc(start)).partition("\n\nRaises:")[0],  # that is for programmers
    )


def _require_storable_params() -> None:
    """Raises ValueError for a _parameter:=value that the parameter server cannot take.

    Such as an integer of more than 32 bits, a date, null, and text that is no text of XML.
    """
    try:
        params = load_command_line_node_params(sys.argv)
    except rospy.ROSInitException as error:  # no YAML; it has several lines
        raise ValueError(printable(" ".join(str(error).split()), 300)) from None
    for name, value in params.items():
        try:
            xmlrpc.client.loads(xmlrpc.client.dumps((value,)))
        except Exception as error:  # of many kinds
            what = f"{printable(name)} is {told(value)}, must be what the parameter server can hold"
            raise ValueError(f"{what}: {printable(str(error))}") from None


def _start_and_spin(name: str, start: Callable[[], Any], spin: Callable[[Any], object]) -> int:
    """The exit code."""
    try:
        _init_node(name)
        node = start()
    except ValueError as error:
        if rospy.core.is_shutdown_requested():
            return 0
        rospy.logfatal("%s: %s", rospy.get_name(), error)
        return 1
    keep_registered()
    spin(node)
    return 0


def _init_node(name: str) -> None:
    """Raises ValueError if its log is in a file that this user may not write to."""
    # rospy puts its own in place of this handler, but not if there can be no folder for its file:
    # the node would run, and end, without a word.
    logger = logging.getLogger("rosout")
    logger.addHandler(RosStreamHandler())
    logger.setLevel(logging.INFO)
    try:
        rospy.init_node(name, disable_signals=True)
    except PermissionError as error:
        raise ValueError(f"{error.filename}: {error.strerror}; {ROS_HOME_NEEDED}") from None


def _wait_for_master(name: str) -> None:
    """Returns when the master answers; a signal meanwhile ends the process with code 0."""
    for number in SIGNALS:
        signal.signal(number, lambda *_: os._exit(0))  # an exception might get lost
    master = rosgraph.Master("/" + name)
    waiting = False
    while True:
        try:
            master.getPid()
            return
        except AWAY:
            if not waiting:
                print(f"waiting for the master at {master.master_uri}", file=sys.stderr, flush=True)
            waiting = True
            time.sleep(0.1)


def is_stuck(thread: threading.Thread) -> bool:
    """Waits until `thread` has ended, or had SHUTDOWN_GRACE for it.

    Without the seconds that go by on a busy machine while this process has no core to run on.
    """
    begin, before = time.monotonic(), waited_for_cores()
    while thread.is_alive():
        grace = min(SHUTDOWN_GRACE + max(waited_for_cores() - before, 0.0), LONGEST_GRACE)
        if time.monotonic() - begin >= grace:
            return True
        thread.join(0.1)
    return False


def waited_for_cores() -> float:
    """s for which threads of this process were ready to run and had no core, in sum.

    The second number of /proc/PID/task/TID/schedstat, in ns; 0 where the kernel does not count it.
    """
    waited = 0
    for path in glob.glob("/proc/self/task/*/schedstat"):
        # The thread may have ended; and whatever a kernel writes there, the node is to end.
        with contextlib.suppress(OSError, ValueError, IndexError), open(path) as file:
            waited += int(file.read().split()[1])
    return waited * 1e-9


def _shut_down_on_signals() -> None:
    """From now on a signal shuts the node down; the process ends even if the node is stuck."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    # The interpreter writes to the pipe at once, whatever the main thread is doing or holding.
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    for number in SIGNALS:
        signal.signal(number, lambda *_: None)

    def wait() -> None:
        while os.read(reader, 1)[0] not in SIGNALS:
            pass
        # rospy closes sockets that threads of its own wait for.
        threading.excepthook = lambda _: None
        threading.Thread(target=rospy.signal_shutdown, args=("signal",), daemon=True).start()
        if is_stuck(threading.main_thread()):
            print(f"did not end within {SHUTDOWN_GRACE:g} s of a signal", file=sys.stderr)
            os._exit(0)

    threading.Thread(target=wait, name="signals", daemon=True).start()
