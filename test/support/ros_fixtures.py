"""A private ROS master for all tests of nodes, and processes that end with each test."""

import contextlib
import itertools
import logging
import os
import re
import shutil
import sys
import xmlrpc.client

import pytest
import support
from ports import free_port
from ros_programs import ROSLAUNCH


def pytest_collection_modifyitems(items):
    for item in items:
        if item.nodeid.partition("::")[0].endswith("_node.py"):
            item.fixturenames[:0] = ["master", "subscriptions_end"]


@pytest.fixture(scope="session")
def master(tmp_path_factory):
    """A private ROS master; this process becomes one of its nodes."""
    folder = tmp_path_factory.mktemp("ros")
    os.environ.update(
        ROS_HOSTNAME="127.0.0.1",
        ROS_HOME=str(folder),
        ROSCONSOLE_STDOUT_LINE_BUFFERED="1",
    )
    os.environ.pop("ROS_LOG_DIR", None)  # which would take the logs from ROS_HOME

    def start(*command):
        return support.Process([*map(str, command)], folder / "master.log")

    made = support.Master(start)
    os.environ.update(made.env)

    import rospy

    rospy.init_node(
        "test",
        disable_signals=True,
        disable_rosout=True,
        # Who still calls a killed node of another test must not get here: see free_port().
        xmlrpc_port=free_port(),
        tcpros_port=free_port(),
    )
    yield made
    rospy.signal_shutdown("tests done")
    made.end()


@pytest.fixture(scope="session")
def python_starter(master, tmp_path_factory):
    made = support.PythonStarter(tmp_path_factory.mktemp("python"))
    yield made
    made.end()


@pytest.fixture
def subscriptions_end():
    """Ends the subscriptions of each test."""
    yield
    for messages in list(support.open_messages):
        messages.close()


def forget(nodes):
    """Makes the master forget ended nodes, as `rosnode cleanup` does.

    It knows one by a parameter that the log requested, and, if the machine was so busy that the
    node had no time to say good-bye, by its topics and services: the next node would wait for
    those. Otherwise, if another program of this test got the node's port, the master would shut
    that program down when the next node of this name starts.
    """
    import rosgraph

    lookups = xmlrpc.client.MultiCall(xmlrpc.client.ServerProxy(rosgraph.get_master_uri()))
    for name in nodes:
        lookups.lookupNode("/test", name)
    for name, (known, _, uri) in zip(nodes, lookups()):
        with contextlib.suppress(rosgraph.MasterException):  # it ends at this moment
            if known == 1:
                forget_known(rosgraph.Master(name), name, uri)


def forget_known(master, node, uri):
    master.unsubscribeParam(uri, "/rosout_disable_topics_generation")
    if support.is_running(node):
        return
    published, subscribed, services = master.getSystemState()
    for topic in (topic for topic, by in published if node in by):
        master.unregisterPublisher(topic, uri)
    for topic in (topic for topic, by in subscribed if node in by):
        master.unregisterSubscriber(topic, uri)
    for service in (service for service, by in services if node in by):
        master.unregisterService(service, master.lookupService(service))


def namespaces(param):
    """The namespaces of a parameter, /a and /a/b of /a/b/c; one of them is its node's name."""
    words = param.split("/")
    return {"/".join(words[:count]) for count in range(2, len(words))}


@contextlib.contextmanager
def starting(folder, request):
    """The function that the fixtures start and start_once give; it ends what it has started."""
    import rosgraph
    import rospy

    before = set(rospy.get_param_names())
    processes = []
    numbers = itertools.count()

    def start_process(name, *arguments, env=None, fork=True):
        path = name if "/" in name else support.executable(name)
        log = folder / f"{next(numbers)}-{os.path.basename(path)}.log"
        run = support.spawn
        if fork and (path.endswith(".py") or path == ROSLAUNCH):
            run = request.getfixturevalue("python_starter").spawn
        process = support.Process([path, *map(str, arguments)], log, env, run)
        processes.append(process)
        return process

    yield start_process
    nodes = {
        node for kind in rosgraph.Master("/test").getSystemState() for _, by in kind for node in by
    }
    for process in processes:  # all are stopped before one is waited for
        process.interrupt()
    for process in processes:
        process.end()
        print(f"{process}:\n{process.output()[-4000:]}")  # pytest shows it if the test fails
    params = set(rospy.get_param_names()) - before
    nodes = nodes.union(*map(namespaces, params))  # also those that have ended before
    forget([*nodes, *(node + "_images" for node in nodes)])
    for name in {name.split("/")[1] for name in params}:
        rospy.delete_param("/" + name)  # with all below it, else empty maps stay


@pytest.fixture
def start(tmp_path, request):
    """start(name, "arg", ..., env={...}) starts a command of this package, or a path.

    Python programs of this package and roslaunch are forked from a common process unless `fork` is
    False; tests of how they start and end run the interpreter itself. At the end of the test all
    processes are stopped and their parameters deleted.
    """
    with starting(tmp_path, request) as start_process:
        yield start_process


@pytest.fixture
def run_script(start, tmp_path):
    """run_script(text, "image:=/x", ..., env={...}) starts a Python script.

    With fork=True, for one that is not itself under test, it is forked as the package's programs.
    """
    numbers = itertools.count()

    def run(text, *arguments, env=None, fork=False):
        path = tmp_path / f"script_{next(numbers)}.py"
        path.write_text(text)
        if fork:
            return start(str(path), *arguments, env=env)
        return start("/usr/bin/python3", path, *arguments, env=env)

    return run


@pytest.fixture(scope="module")
def start_once(tmp_path_factory, request):
    """Like start, for processes that all tests of a file share: they end after the last test."""
    with starting(tmp_path_factory.mktemp("once"), request) as start_process:
        yield start_process


@pytest.fixture
def diagnostics():
    return support.Diagnostics()


@pytest.fixture(scope="module")
def x_server(start_once, tmp_path_factory):
    """A virtual X server: its display number and the file of its frame buffer."""
    folder = tmp_path_factory.mktemp("x")
    # Without -noreset it resets, and refuses clients, whenever the last one (xdotool) leaves.
    options = ["-displayfd", "1", "-noreset", "-fbdir", folder, "-screen", "0", "1400x1100x24"]
    process = start_once(shutil.which("Xvfb"), *options)
    # It first prints errors about display numbers that are in use.
    number = support.wait_for(
        lambda: re.findall(r"^\d+\n", process.output(), re.MULTILINE), "the X server"
    )
    return ":" + number[0].strip(), folder / "Xvfb_screen0"


@pytest.fixture
def display(x_server, monkeypatch):
    """Uses the X server in this process and its children; gives the file of its frame buffer."""
    number, frame_buffer = x_server
    monkeypatch.setenv("DISPLAY", number)
    return frame_buffer


@pytest.fixture
def log(capfd):
    """log() gives all that this process has logged in the test: rospy's lines, then roscpp's."""

    rospy_lines, roscpp_output = [], []
    handler = logging.Handler()
    handler.emit = lambda record: rospy_lines.append(record.getMessage())
    logging.getLogger("rosout").addHandler(handler)

    def read():
        roscpp_output.append(capfd.readouterr().err)
        return "\n".join(rospy_lines) + "".join(roscpp_output)

    yield read
    logging.getLogger("rosout").removeHandler(handler)


@pytest.fixture
def run_main(monkeypatch, capsys):
    """run_main(main, words) runs a command in this process: its exit code and output."""

    def run(main, words):
        monkeypatch.setattr(sys, "argv", list(map(str, words)))
        try:
            code = main()
        except SystemExit as error:
            code = error.code
        printed = capsys.readouterr()
        return code, printed.out + printed.err

    return run
