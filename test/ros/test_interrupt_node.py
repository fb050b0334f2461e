"""Every executable ends with code 0 on SIGINT, whatever it is doing."""

import concurrent.futures
import contextlib
import hashlib
import http.client
import itertools
import os
import pathlib
import random
import signal
import socket
import threading
import time
import types
import xmlrpc.client

import pytest
import rospy
import support
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from frames import Source
from sensor_msgs.msg import Image
from std_srvs.srv import Trigger

from robot_vision.common.commands import INTERRUPTED
from robot_vision.msg import TagDetectionArray
from robot_vision.ros import startup

NODES = [
    "camera_node",
    "brightness_node",
    "edge_detector_node",
    "filter_node",
    "dense_flow_node",
    "spectrum_node",
    "segmenter_node",
]
PAIR_NODES = ["stereo_matcher_node", "depth_registration_node"]  # which take those of two cameras
PYTHON_NODES = [
    "hsv_tracker.py",
    "ball_tracker.py",
    "line_follower.py",
    "code_reader.py",
    "face_detector.py",
    "face_recognizer.py",
    "motion_detector.py",
    "lane_detector.py",
    "cube_overlay.py",
    "object_tracker.py",
    "window_tracker.py",
    "histogram.py",
    "apriltag_detector.py",
    "hough.py",
    "contours.py",
    "features.py",
    "template_matcher.py",
    "people_detector.py",
    "object_detector.py",
    "detections_3d.py",
    "tabletop.py",
]
OTHER_NODES = [
    "camera_loader.py",
    "dashboard.py",
    "demo_status.py",
    "python_manager.py",
    "simple_camera_view_node.py",
]
BOARD = ["--size", "8x6", "--square", "0.05", "--output", "{folder}/{number}.yaml"]
TAGS = ["--name", "a", "--ids", "0-3", "--size", "0.1", "--output", "{folder}/{number}.yaml"]
TOOLS = {  # command: arguments
    "create_marker.py": ["--output", "{folder}/{number}.png", "1"],
    "pick_color.py": ["--hex", "#1e90ff"],
    "inspect_model.py": ["{folder}/none.onnx"],
    "calibrate_headless.py": ["--topic", "/none", *BOARD],
    "calibrate_bundle.py": ["tags:=/none", *TAGS],
    "check_arguments.py": ["/none.launch"],
}
STARTS = 200
TOGETHER = 4  # programs at a time


@pytest.mark.parametrize("node", [*NODES, *PAIR_NODES])
@pytest.mark.parametrize(
    "argument, waiting",
    [
        ("__name:=waits", "waiting for the master"),
        ("_source:=synthetic", "Failed to contact master"),
    ],
)
def test_while_waiting_for_the_master(start, node, argument, waiting):
    nowhere = {"ROS_MASTER_URI": f"http://127.0.0.1:{support.free_port()}"}
    process = start(node, argument, env=nowhere)
    process.wait_for_output(waiting)
    process.interrupt()
    assert process.prompt_exit_code() == 0, process.output()


@pytest.mark.parametrize("node", [*NODES, *PAIR_NODES, *PYTHON_NODES])
def test_while_idle(start, diagnostics, node):
    process = start(node, "__name:=idle", "_source:=synthetic")
    diagnostics.next("idle")
    process.interrupt()
    assert process.prompt_exit_code() == 0, process.output()


def test_python_programs_at_any_moment_while_they_start(start, display, tmp_path):
    """Each ends at once by itself, not by its watchdog, and leaves no incomplete file."""
    ignoring = 'trap "" INT; exec "$@"'  # SIGINT is ignored until Python sets its own handler
    folder = tmp_path / "made"
    folder.mkdir()
    whole = folder / "whole.png"
    made = start("create_marker.py", "--output", whole, "1", fork=False)
    assert made.exit_code() == 0, made.output()
    seed = random.SystemRandom().randrange(2**32)
    programs = [*PYTHON_NODES, *OTHER_NODES, *TOOLS]

    def begin(number):
        name = programs[number % len(programs)]
        words = TOOLS.get(name, ["__name:=n{number}"])
        words = [word.format(folder=folder, number=number) for word in words]
        process = start("/bin/sh", "-c", ignoring, "sh", support.executable(name), *words)
        command, status = (pathlib.Path(f"/proc/{process.pid}/{f}") for f in ("cmdline", "status"))

        def listens():
            if not process.running():  # a short command may end before on a slow machine
                return True
            if "python" not in command.read_text().partition("\0")[0]:
                return False  # it is still the shell
            ignored = status.read_text().split("SigIgn:")[1].split()[0]
            return not int(ignored, 16) >> (signal.SIGINT - 1) & 1

        support.wait_for(listens, "the first line of " + name)
        return name, process

    def measure(number):
        _, process = begin(number)
        began = time.monotonic()
        rospy.wait_for_service(f"/n{number}/save_parameters", support.DEADLINE)
        return time.monotonic() - began, process

    def interrupt(number, moment):
        name, process = begin(number)
        time.sleep(moment)
        process.interrupt()
        told = f"{name} after {moment:.3f} s, seed {seed}: "
        try:
            code = process.prompt_exit_code()
        except AssertionError as error:
            raise AssertionError(told + str(error)) from None
        told += process.output()
        expected = (0, 1, INTERRUPTED) if name in TOOLS else (0,)
        assert code in (*expected, -signal.SIGINT) and "Traceback" not in told, told

    with concurrent.futures.ThreadPoolExecutor(TOGETHER) as pool:
        seconds, processes = zip(*pool.map(measure, range(TOGETHER)))
        for process in processes:
            process.end()
        # There are more early moments, because they cost little time.
        drawn = random.Random(seed)
        moments = [drawn.triangular(0.0, max(seconds), 0.0) for _ in range(STARTS)]
        for _ in pool.map(interrupt, range(TOGETHER, TOGETHER + STARTS), moments):
            pass
    assert {path.read_bytes() for path in folder.iterdir()} == {whole.read_bytes()}


def test_the_status_printer_ends_too(start):
    nowhere = {"ROS_MASTER_URI": f"http://127.0.0.1:{support.free_port()}"}
    for env, output in [(nowhere, "waiting for the master"), ({}, "No display")]:
        process = start("demo_status.py", env=env, fork=False)
        process.wait_for_output(output)
        process.interrupt()
        assert process.prompt_exit_code() == 0, process.output()


def test_the_status_printer_in_the_middle_of_its_lines(start):
    """Its output ends with a complete line."""
    process = start("demo_status.py")
    source = Source("/diagnostics", DiagnosticArray)
    status = DiagnosticArray(
        status=[
            DiagnosticStatus(name="usb_cam: frames", message="fine"),
            DiagnosticStatus(name="usb_cam: depth", message="of something else"),
        ]
    )

    def printed():
        source.send(status)
        return process.output().count("fine\n") > 10

    support.wait_for(printed, "its lines")
    assert "of something else" not in process.output()
    process.interrupt()
    assert process.prompt_exit_code() == 0, process.output()
    assert "Traceback" not in process.output() and process.output().endswith("fine\n")


LOCKED_NODE = """
import threading, time, rospy
from robot_vision.ros import startup
from robot_vision.ros.startup import run_node

def start():
    lock = threading.Lock()
    rospy.on_shutdown(lock.acquire)
    with lock:
        print("locked", flush=True)
        time.sleep(0.5)
        if {stuck}:
            time.sleep(60)

startup.SHUTDOWN_GRACE = 5.0
run_node("locked", start)
"""


@pytest.mark.parametrize("stuck", [False, True])
def test_python_node_that_holds_a_lock_needed_for_its_shutdown(run_script, stuck):
    process = run_script(LOCKED_NODE.format(stuck=stuck))
    process.wait_for_output("locked")
    process.interrupt()
    assert process.exit_code() == 0, process.output()
    assert ("did not end within 5 s" in process.output()) == stuck


SLOW_NODE = """
import time
from robot_vision.ros.startup import run_node

def start():
    print("starts", flush=True)
    time.sleep(60)

run_node("slow", start)
"""


def test_python_node_that_is_still_starting(run_script):
    """A start may take long, with a master that has much to do."""
    process = run_script(SLOW_NODE)
    process.wait_for_output("starts")
    process.interrupt()
    assert process.exit_code() == 0, process.output()
    assert "did not end" not in process.output()


def test_a_node_that_waits_for_a_core_is_not_stuck(monkeypatch):
    monkeypatch.setattr(startup, "SHUTDOWN_GRACE", 0.0)
    ends = threading.Event()
    thread = threading.Thread(target=ends.wait)
    thread.start()
    monkeypatch.setattr(startup, "waited_for_cores", lambda: {"a": 5.0})
    assert startup.is_stuck(thread.is_alive)
    waits = itertools.count()

    def waited():
        """One thread that has waited for long ends, another one waits all the time."""
        count = next(waits)
        if count == 3:
            ends.set()
        return {"b": 1000.0 * count, **({} if count else {"a": 5000.0})}

    monkeypatch.setattr(startup, "waited_for_cores", waited)
    assert not startup.is_stuck(thread.is_alive)
    thread.join()


def test_a_node_that_was_stopped_is_not_stuck(monkeypatch):
    times = itertools.count(step=1.5)  # s, as it is stopped again and again
    clock = types.SimpleNamespace(monotonic=lambda: next(times), sleep=lambda _: None)
    monkeypatch.setattr(startup, "time", clock)
    monkeypatch.setattr(startup, "waited_for_cores", dict)
    goes_on = iter([True, True, True, False])
    assert not startup.is_stuck(lambda: next(goes_on))
    assert startup.is_stuck(lambda: True)  # after MAX_SHUTDOWN_GRACE


@pytest.mark.skipif(
    not os.path.exists("/proc/self/schedstat"), reason="the kernel does not count it"
)
def test_the_time_without_a_core_comes_from_the_kernel():
    """Two threads that compute on one core have to wait for each other."""
    cores = os.sched_getaffinity(0)
    done, read = threading.Semaphore(0), threading.Event()

    def compute():
        hashlib.pbkdf2_hmac("sha256", b"", b"", 500_000)  # releases the GIL
        done.release()
        read.wait()  # the kernel drops a thread's waiting time when the thread ends

    os.sched_setaffinity(0, {min(cores)})
    try:
        threads = [threading.Thread(target=compute) for _ in range(2)]
        before = startup.waited_for_cores()
        for thread in threads:
            thread.start()
        for _ in threads:
            done.acquire()
        waited = startup.waited_for_cores()  # without threads of others that have ended meanwhile
        assert sum(waited[thread] - before.get(thread, 0.0) for thread in waited) > 0.01
    finally:
        read.set()
        os.sched_setaffinity(0, cores)


@pytest.mark.parametrize("node", NODES)
def test_in_the_middle_of_a_frame(start, node):
    # The frames are so large that one is always being processed.
    size = ["_image_width:=1920", "_image_height:=1080"]
    camera = start("camera_node", "__name:=camera", "_source:=synthetic", *size)
    process, topic = camera, "/camera/image_raw"
    if node != "camera_node":
        process = start(node, "__name:=filter", "image:=/camera/image_raw")
        topic = "/filter/processed_image"
    support.Messages(topic, Image).wait(5)
    process.interrupt()
    assert process.prompt_exit_code() == 0, process.output()


def test_in_the_middle_of_a_search(start):
    size = ["_image_width:=1920", "_image_height:=1080"]
    start("camera_node", "__name:=camera", "_source:=synthetic", *size)
    arguments = ["image:=/camera/image_raw", "_max_search_period:=0.01"]  # always searches
    process = start("apriltag_detector.py", "__name:=tag", *arguments)
    support.Messages("/tag/tags", TagDetectionArray).wait(5)
    process.interrupt()
    assert process.prompt_exit_code() == 0, process.output()
    assert "did not end" not in process.output()


@pytest.mark.parametrize("node", NODES)
def test_after_the_master_has_gone(start, node):
    master = support.Master(start)
    process = start(node, "__name:=orphan", "_source:=synthetic", env=master.env)
    support.wait_for(
        lambda: support.has_service(master.api, "/orphan/set_parameters"), "the node's services"
    )
    master.end()
    process.interrupt()
    assert process.prompt_exit_code() == 0, process.output()


def request_of(connection):
    """The whole of a question to the master, or what comes of it before the connection ends."""
    asked = b""
    while b"</methodCall>" not in asked:
        part = connection.recv(4096)
        if not part:
            break
        asked += part
    return asked


@pytest.mark.parametrize("node", NODES)
def test_in_a_callback_that_the_master_does_not_answer(start, node):
    master = support.Master(start)
    process = start(node, "__name:=stuck", "_source:=synthetic", env=master.env)
    with support.service_of(master.api, "/stuck/save_parameters") as service:
        assert "config_file" in rospy.ServiceProxy(service, Trigger)().message
        master.end()
        # A server that never answers takes the place of the master.
        with socket.create_server(
            ("127.0.0.1", master.port)
        ) as mute, contextlib.ExitStack() as connections:
            mute.settimeout(support.DEADLINE)
            with concurrent.futures.ThreadPoolExecutor() as pool:
                pool.submit(rospy.ServiceProxy(service, Trigger))
                while True:
                    connection = connections.enter_context(mute.accept()[0])
                    connection.settimeout(support.DEADLINE)
                    if b"config_file" in request_of(connection):
                        break
                process.interrupt()
                assert process.exit_code() == 0, process.output()


@pytest.mark.parametrize("node", NODES)
def test_shutdown_request_while_the_master_is_stopped(start, node):
    master = support.Master(start)
    process = start(node, "__name:=node", "_source:=synthetic", env=master.env)
    with support.service_of(master.api, "/node/save_parameters") as service:
        rospy.ServiceProxy(service, Trigger)()  # the node answers when it has started
    address = master.api.lookupNode("/node")
    with support.standing_still(master.process):
        with contextlib.suppress(
            OSError, http.client.HTTPException
        ):  # if it ends before it answers
            xmlrpc.client.ServerProxy(address).shutdown("/test", "as rosnode kill does")
        assert process.exit_code() == 0, process.output()
