"""What nodes ask the master for when they start: their values in lists, not one by one."""

import collections
import importlib
import pathlib
import re
import threading
import xmlrpc.client

import pytest
import rosgraph
import rospy
import support
from rosgraph.xmlrpc import ThreadingXMLRPCServer
from sensor_msgs.msg import Image

NODES = {"edge_detector_node": "EdgeDetector", "motion_detector.py": "MotionDetector"}
OUTPUT = "/asking/processed_image"
TRANSPORTS = [f"{OUTPUT}/{kind}/set_parameters" for kind in ("compressed", "theora")]


class Between:
    """Passes what nodes ask the master, and keeps it. It may be a master that takes no lists."""

    def __init__(self, takes_lists):
        self.asked = collections.defaultdict(list)  # arguments by method
        self.takes_lists = takes_lists
        self.master = rosgraph.get_master_uri()
        self.answered_once = ("", "")  # a method and the node that has no other answer to it
        self.held = ""  # the method that is answered only when `released`
        self.holds = threading.Event()  # set as soon as there is an answer that is held
        self.released = threading.Event()
        self._server = ThreadingXMLRPCServer(("127.0.0.1", 0), False)
        self._server.register_instance(self)
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    @property
    def env(self):
        return {"ROS_MASTER_URI": f"http://127.0.0.1:{self._server.server_address[1]}"}

    def _dispatch(self, method, arguments):
        self.asked[method].append(arguments)
        if method == "system.multicall" and not self.takes_lists:
            raise LookupError(method)
        callers = [of[0] for of in self.asked[method]]
        if (method, arguments[0]) == self.answered_once and callers.count(arguments[0]) > 1:
            raise ConnectionError(method)
        answer = getattr(xmlrpc.client.ServerProxy(self.master), method)(*arguments)
        if method == self.held:
            self.holds.set()
            self.released.wait(support.DEADLINE)
        return answer

    def names(self, method):
        """The parameters that were asked for one by one."""
        return {arguments[1] for arguments in self.asked[method]}

    def end(self):
        self.released.set()
        self._server.shutdown()
        self._server.server_close()


@pytest.fixture
def slow():
    made = Between(True)
    yield made
    made.end()


@pytest.fixture(params=[True, False], ids=["lists", "no lists"])
def between(request):
    made = Between(request.param)
    yield made
    made.end()


@pytest.mark.parametrize("node", NODES)
def test_all_values_are_on_the_master(between, start, node):
    """Those of the node and of its transports; also where it takes no lists."""
    config = importlib.import_module(f"robot_vision.cfg.{NODES[node]}Config")
    name, value = next((k, v) for k, v in config.defaults.items() if isinstance(v, float))
    live = {**config.defaults, name: value + 1.0}
    rospy.set_param("/asking/" + name, live[name])
    rospy.set_param(OUTPUT + "/compressed/jpeg_quality", 55)
    rospy.set_param(OUTPUT + "/compressed/png_level", "high")  # It has another type.
    start(node, "__name:=asking", env=between.env)
    support.reconfigured("/asking")  # The node answers when it has started.
    support.wait_for(lambda: rospy.has_param(OUTPUT + "/theora/quality"), "what theora has")
    present = rospy.get_param("/asking")
    assert {key: present[key] for key in live} == live
    compressed = rospy.get_param(OUTPUT + "/compressed")
    assert (compressed["jpeg_quality"], compressed["png_level"]) == (55, 9)
    names = {f"/asking/{key}" for key in live}
    assert not between.names("getParam") & names
    missing = set() if between.takes_lists else names - {f"/asking/{name}"}
    assert missing <= between.names("setParam")
    assert not between.takes_lists or not between.names("setParam") & names


def test_values_of_a_nodelet_are_not_set_in_the_name_of_its_manager(between, start):
    """Else the master would not tell the manager, in which others may keep a parameter."""
    manager = support.NodeletManager(start, env=between.env)
    manager.load("/asking", "edge_detector")
    support.reconfigured("/asking", blur_size=9, aperture=5)
    assert rospy.get_param("/asking/blur_size") == 9
    lists = [calls for (calls,) in between.asked["system.multicall"]]
    assert any(call["params"][1:] == ["/asking/blur_size", 9] for calls in lists for call in calls)
    assert all(call["params"][0] != manager.name for calls in lists for call in calls)


def test_a_signal_does_not_break_off_what_the_master_is_asked(slow, start):
    """Else roscpp would tell of a master that does not answer, and ask again."""
    slow.held = "registerSubscriber"
    process = start("pick_color.py", "--topic", "/silent", "--at", 1, 1, env=slow.env)
    support.wait_for(lambda: slow.asked["registerSubscriber"], "a subscription")
    process.interrupt()
    status = pathlib.Path(f"/proc/{process.pid}/status")
    support.wait_for(
        lambda: re.search(r"^ShdPnd:\s*0+$", status.read_text(), re.MULTILINE), "a taken signal"
    )
    slow.released.set()
    assert process.prompt_exit_code() == 130
    assert process.output() == ""


def test_services_that_came_just_before_a_restart_are_registered_again(slow, start):
    """The node has not asked for services since its transports began theirs."""
    slow.answered_once = ("getSystemState", "/asking_images")
    start("hsv_tracker.py", "__name:=asking", env=slow.env)
    for service in ("asking/save_parameters", *TRANSPORTS):
        rospy.wait_for_service(service, support.DEADLINE)
    services = services_of("asking")
    restarted = support.Master(start)
    slow.master = restarted.env["ROS_MASTER_URI"]
    support.wait_for(lambda: services_of("asking", restarted.api) >= services, "all services")


def test_a_publisher_that_comes_while_a_node_of_roscpp_registers_again_is_heard(slow, start):
    edges = support.Messages("/asking/processed_image", Image)
    start(
        "edge_detector_node",
        "__name:=asking",
        "image:=/late",
        "_image_transport:=raw",
        env=slow.env,
    )
    support.wait_for(lambda: asked_for(slow, "/late"), "a subscription")
    restarted = restart(slow, start)
    camera = ["__name:=late", "_source:=synthetic", "_image_width:=160", "_image_height:=120"]
    start("camera_node", *camera, "late/image_raw:=/late", env=restarted.env)
    edges.wait()
    answer_late(slow, "/late")
    begin = rospy.get_rostime()
    support.wait_for(lambda: edges.received[-1].header.stamp > begin, "an image from now on")


LISTENER = """
import rospy
from std_msgs.msg import String
from robot_vision.ros.registration import keep_registered

rospy.init_node("asking")
keep_registered()
rospy.Subscriber("/late", String, lambda message: print(message.data, flush=True))
rospy.spin()
"""
SPEAKER = """
import sys
import rospy
from std_msgs.msg import String

rospy.init_node("speaker")
publisher = rospy.Publisher("/late", String, queue_size=1)
while not rospy.is_shutdown():
    publisher.publish(open(sys.argv[1]).read())
    rospy.sleep(0.05)
"""


def test_a_publisher_that_comes_while_a_node_of_rospy_registers_again_is_heard(
    slow, run_script, start, tmp_path
):
    listener = run_script(LISTENER, env=slow.env, fork=True)
    support.wait_for(lambda: asked_for(slow, "/late"), "a subscription")
    restarted = restart(slow, start)
    words = tmp_path / "words"
    words.write_text("early")
    run_script(SPEAKER, words, env=restarted.env, fork=True)
    listener.wait_for_output("early")
    answer_late(slow, "/late")
    words.write_text("late")
    listener.wait_for_output("late")


def asked_for(slow, topic):
    """How many times a node has asked for the publishers of a topic."""
    return sum(arguments[1] == topic for arguments in slow.asked["registerSubscriber"])


def restart(slow, start):
    """Another master; a node has asked it for publishers, of which it knows none, and waits."""
    restarted = support.Master(start)
    slow.held, slow.master = "registerSubscriber", restarted.env["ROS_MASTER_URI"]
    support.wait_for(slow.holds.is_set, "a node that registers again")
    return restarted


def answer_late(slow, topic):
    """Has the node get that answer now; it has to ask whether it still holds."""
    before = asked_for(slow, topic)
    slow.released.set()
    support.wait_for(lambda: asked_for(slow, topic) > before, "another question")


def services_of(node, master=None):
    """The services of a Python node and of its images' node in roscpp."""
    services = (master or rosgraph.Master("/test")).getSystemState()[2]
    nodes = {f"/{node}", f"/{node}_images"}
    return {(name, *of) for name, of in services if nodes & set(of)}
