"""A manager of nodes in Python: each node is its own, whatever the others do."""

import signal

import pytest
import rospy
import support
from frames import Camera, message
from geometry_msgs.msg import Twist
from python_manager import NAME, TRIAL, PythonManager, graph_of, refused
from ros_programs import program_of
from rosgraph_msgs.msg import Log
from simulation import TrackWorld
from std_srvs.srv import Trigger
from track import course_track

import robot_vision as rv
from robot_vision.msg import DetectionArray

SCENE = rv.Scene().render(60)
MB = 1000000


@pytest.fixture
def camera():
    return Camera(rate=30.0)


def load_trial(manager, name, does, image="/nothing"):
    if does:
        rospy.set_param(name + "/does", does)
    manager.load(name, "robot_vision/trial_node", {"/image": image})


def assert_works(camera, *nodes, count=5):
    """Asserts that nodes answer frames that are sent one after the other."""
    outputs = [support.subscribed(name + "/objects", DetectionArray) for name in nodes]
    support.wait_for(lambda: _answers(camera, outputs), f"results of {nodes}")
    for _ in range(count):
        stamp = camera.show(SCENE).stamp
        for output in outputs:
            output.of(stamp)
    for output in outputs:
        output.close()


def _answers(camera, outputs):
    stamp = camera.show(SCENE).stamp
    return all(any(one.header.stamp <= stamp for one in output.received) for output in outputs)


def test_two_nodes_of_a_class_are_apart(start, camera):
    manager = PythonManager(start)
    other = Camera(rate=30.0)
    rospy.set_param("/left/hsv", {"opening": 5, "min_area": 100.0})
    rospy.set_param("/right/colors/hsv_2", {"opening": 9})
    assert manager.load("/left/hsv", "robot_vision/hsv_tracker", {"/left/image": camera.topic})
    words = {"/right/colors/image": other.topic, "/right/colors/hsv_2/objects": "/found"}
    assert manager.load("/right/colors/hsv_2", "robot_vision/hsv_tracker", words)
    assert manager.loaded() == {"/left/hsv", "/right/colors/hsv_2"}
    assert_works(camera, "/left/hsv")
    found = support.subscribed("/found", DetectionArray)
    support.wait_for(lambda: other.show(SCENE) and found.received, "what is remapped")
    assert support.reconfigured("/left/hsv")["opening"] == 5
    assert support.reconfigured("/left/hsv", opening=3)["opening"] == 3
    assert support.reconfigured("/right/colors/hsv_2")["opening"] == 9
    assert rospy.get_param("/right/colors/hsv_2/opening") == 9


@pytest.mark.parametrize(
    "does, says",
    [
        ("refuses at_start", "does is this, must not be"),
        ("raises at_start", "of the trial"),
        ("exits at_start", "sys.exit(4)"),
    ],
)
def test_a_node_that_does_not_start_is_refused_and_leaves_nothing(start, camera, does, says):
    manager = PythonManager(start, program=TRIAL)
    manager.load("/hsv", "robot_vision/hsv_tracker", {"/image": camera.topic})
    log = support.subscribed("/rosout", Log)
    before = graph_of(NAME, NAME + "_images")
    with refused(says):
        load_trial(manager, "/trial", does)
    support.wait_for(lambda: graph_of(NAME, NAME + "_images") == before, "the graph of before")
    fatal = support.wait_for(
        lambda: [one for one in log.received if one.level == Log.FATAL], "the reason"
    )
    assert fatal[0].name == "/trial" and says in fatal[0].msg
    assert manager.loaded() == {"/hsv"}
    assert_works(camera, "/hsv")
    rospy.set_param("/trial/does", "")
    load_trial(manager, "/trial", "", camera.topic)  # The name is free again.
    assert_works(camera, "/trial", "/hsv")


def test_a_refused_parameter_is_that_nodes_alone(start, camera):
    manager = PythonManager(start)
    manager.load("/hsv", "robot_vision/hsv_tracker", {"/image": camera.topic})
    rospy.set_param("/bad/min_area", -1.0)
    with refused("min_area is -1, must be"):
        manager.load("/bad", "robot_vision/hsv_tracker", {"/image": camera.topic})
    manager.process.wait_for_output("FATAL")
    assert_works(camera, "/hsv")


def test_a_live_parameter_that_a_node_refuses_is_that_nodes_alone(start, camera):
    manager = PythonManager(start, program=TRIAL)
    manager.load("/hsv", "robot_vision/hsv_tracker", {"/image": camera.topic})
    load_trial(manager, "/trial", "", camera.topic)
    assert support.reconfigured("/trial", opening=3)["opening"] == 3
    assert support.reconfigured("/trial", opening=7)["opening"] == 3
    manager.process.wait_for_output("opening is 7, must not be")
    assert support.reconfigured("/hsv", opening=7)["opening"] == 7
    assert_works(camera, "/hsv", "/trial")


@pytest.mark.parametrize("where", ["frame", "service"])
def test_failing_callbacks_harm_no_other_node(start, camera, where):
    manager = PythonManager(start, program=TRIAL)
    manager.load("/hsv", "robot_vision/hsv_tracker", {"/image": camera.topic})
    rospy.set_param("/trial/always_subscribe", True)
    load_trial(manager, "/trial", f"raises at_{where}", camera.topic)
    if where == "service":
        with pytest.raises(rospy.ServiceException, match="of the trial"):
            rospy.ServiceProxy("/trial/release", Trigger)()
        assert_works(camera, "/trial")
    assert_works(camera, "/hsv")

    def has_failed():
        """The trial may have subscribed after the frames that were for the other node."""
        camera.show(SCENE)
        return "KeyError: 'of the trial'" in manager.process.output()

    support.wait_for(has_failed, "the callback's error")
    assert manager.loaded() == {"/hsv", "/trial"}


@pytest.mark.parametrize("way", ["a frame", "a service"])
def test_a_node_that_exits_is_unloaded_alone(start, camera, way):
    manager = PythonManager(start, program=TRIAL)
    manager.load("/hsv", "robot_vision/hsv_tracker", {"/image": camera.topic})
    rospy.set_param("/trial/always_subscribe", True)
    load_trial(manager, "/trial", "exits at_frame" if way == "a frame" else "", camera.topic)
    if way == "a service":
        with pytest.raises(rospy.ServiceException):
            rospy.ServiceProxy("/trial/exit", Trigger)()
    support.wait_for(
        lambda: camera.show(SCENE) and manager.loaded() == {"/hsv"}, "the end of the node"
    )
    assert_works(camera, "/hsv")
    assert manager.process.running()


def test_a_slow_node_holds_up_no_other(start, camera):
    manager = PythonManager(start, program=TRIAL)
    manager.load("/hsv", "robot_vision/hsv_tracker", {"/image": camera.topic})
    rospy.set_param("/trial/always_subscribe", True)
    load_trial(manager, "/trial", "waits at_frame", camera.topic)
    support.wait_for(
        lambda: camera.show(SCENE) and "waiting" in manager.process.output(), "a node that waits"
    )
    assert_works(camera, "/hsv", count=30)
    manager.load("/hsv_2", "robot_vision/hsv_tracker", {"/image": camera.topic})
    assert_works(camera, "/hsv", "/hsv_2")
    rospy.ServiceProxy("/trial/release", Trigger)()
    assert_works(camera, "/trial")


def test_logs_have_the_name_of_the_node(start, camera):
    manager = PythonManager(start, env={"ROSCONSOLE_FORMAT": "${node} says: ${message}"})
    log = support.subscribed("/rosout", Log)
    manager.load("/colors/hsv", "robot_vision/hsv_tracker", {"/colors/image": camera.topic})
    answer = rospy.ServiceProxy("/colors/hsv/save_parameters", Trigger)()
    assert not answer.success
    manager.process.wait_for_output("/colors/hsv says: parameters not saved")
    support.wait_for(
        lambda: any(one.name == "/colors/hsv" and "not saved" in one.msg for one in log.received),
        "the message on /rosout",
    )


def test_a_robot_stops_when_its_driver_is_unloaded_and_when_the_manager_ends(start, camera):
    rospy.set_param("/driver/timeout", 10.0)  # so long that the watchdog does not stop the robot
    manager = PythonManager(start)
    commands = support.Messages("/cmd_vel", Twist)
    track = course_track()
    line = TrackWorld(track).render(track.starts[0], 0)

    def drives():
        camera.send(message(line, "bgr8"))  # without a stamp it is not too old
        return commands.received and commands.received[-1].linear.x > 0.0

    for end in (lambda: manager.unload("/driver"), manager.process.interrupt):
        manager.load("/driver", "robot_vision/line_follower", {"/image": camera.topic})
        support.wait_for(drives, "a robot that drives")
        end()
        support.wait_for(lambda: commands.received[-1] == Twist(), "the stop")
    assert manager.process.prompt_exit_code() == 0


def test_nodelets_in_cpp_and_nodes_in_python_are_in_one_process(start):
    rospy.set_param("/camera", {"source": "synthetic", "framerate": 30.0})
    manager = PythonManager(start)
    manager.load("/camera", "robot_vision/camera")
    manager.load("/hsv", "robot_vision/hsv_tracker", {"/image": "/camera/image_raw"})
    manager.load("/edges", "robot_vision/edge_detector", {"/image": "/camera/image_raw"})
    objects = support.subscribed("/hsv/objects", DetectionArray)
    assert any(one.detections for one in objects.wait(10))
    assert manager.loaded() == {"/camera", "/hsv", "/edges"}
    serving = {name for what, name, _ in graph_of(NAME + "_images") if what == "publishes"}
    assert {"/camera/image_raw", "/edges/processed_image"} <= serving
    manager.unload("/edges")
    count = len(objects.received)
    objects.wait(count + 10)
    manager.unload("/camera")
    assert manager.loaded() == {"/hsv"}


HOSTILE = [
    ("x", "robot_vision/unheard_of", {}, "hsv_tracker"),
    ("x", "robot_vision/unheard_of", {}, "image_proc/rectify"),
    ("x", "unheard_of/hsv_tracker", {}, "type is unheard_of/hsv_tracker"),
    ("x", "robot_vision/python_manager", {}, "type is"),
    ("x", "robot_vision/camera_loader", {}, "type is"),
    ("x", "robot_vision/dashboard", {}, "type is"),
    ("x", "robot_vision/../hsv_tracker", {}, "type is"),
    ("x", "hsv_tracker", {}, "must be like robot_vision/hsv_tracker"),
    ("x", "", {}, "must be like robot_vision/hsv_tracker"),
    ("x", "t" * MB, {}, "must be like robot_vision/hsv_tracker"),
    ("", "robot_vision/hsv_tracker", {}, "name is ''"),
    ("/", "robot_vision/hsv_tracker", {}, "name is '/'"),
    ("a b", "robot_vision/hsv_tracker", {}, "name is 'a b'"),
    ("a\n", "robot_vision/hsv_tracker", {}, "name is"),
    ("1", "robot_vision/hsv_tracker", {}, "name is '1'"),
    ("n" * MB, "robot_vision/hsv_tracker", {}, "must be a name"),
    (NAME, "robot_vision/hsv_tracker", {}, "another one than the manager's"),
    ("x", "robot_vision/hsv_tracker", {"a b": "/c"}, "remap_source_args is 'a b'"),
    ("x", "robot_vision/hsv_tracker", {"/b": "é"}, "remap_target_args is"),
    ("x", "robot_vision/hsv_tracker", {"/b": "c" * MB}, "remap_target_args is"),
]


def test_requests_that_cannot_be_met_are_refused_and_change_nothing(start, camera):
    manager = PythonManager(start)
    manager.load("/hsv", "robot_vision/hsv_tracker", {"/image": camera.topic})
    before = graph_of(NAME, NAME + "_images")
    for name, kind, remappings, says in HOSTILE:
        with refused(says):
            manager.load(name, kind, remappings)
    with refused("bond_id is"):
        manager.load("x", "robot_vision/hsv_tracker", {}, bond_id="b" * MB)
    with refused("there is a node of this name already"):
        manager.load("/hsv", "robot_vision/ball_tracker")
    for name in ("/nobody", "", "a b", "n" * MB, NAME):
        with refused("not unloaded"):
            manager.unload(name)
    assert manager.load("/words", "robot_vision/contours", words=["w" * MB, "", "--x", "a:=b"])
    manager.unload("/words")
    assert manager.loaded() == {"/hsv"}
    support.wait_for(lambda: graph_of(NAME, NAME + "_images") == before, "the graph of before")
    assert_works(camera, "/hsv")
    assert max(map(len, manager.process.output().splitlines())) < 5000


@pytest.mark.parametrize("does", ["waits at_start", "outlasts at_start"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_in_the_middle_of_a_load(start, camera, number, does):
    manager = PythonManager(start, program=TRIAL)
    manager.load("/hsv", "robot_vision/hsv_tracker", {"/image": camera.topic})
    rospy.set_param("/trial/does", does)
    loader = start(
        program_of("nodelet", "nodelet"), "load", "robot_vision/trial_node", NAME, "__name:=trial"
    )
    manager.process.wait_for_output("waiting")
    manager.process._popen.send_signal(number)
    assert manager.process.prompt_exit_code() == 0, manager.process.output()
    assert "FATAL" not in manager.process.output()
    loader.interrupt()
