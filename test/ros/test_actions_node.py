"""Servers of actions end with their node, and keep nothing of it."""

import pytest
import rospy

SCRIPT = """
import gc, weakref
import rosgraph, rospy
from robot_vision.msg import CheckForObjectsAction
from robot_vision.ros import actions
from robot_vision.ros.actions import action_server
from robot_vision.ros.context import LoadedContext, active

class Node:
    def __init__(self):
        self.server = action_server("~act", CheckForObjectsAction, self.execute)
    def execute(self, server, goal):
        pass

rospy.init_node("actions")
actions.END_TIMEOUT = 30.0
context = LoadedContext("/loaded", {}, print)
with active(context):
    node = Node()
def topics():
    return {topic for kind in rosgraph.Master("/test").getSystemState() for topic, _ in kind
            if topic.startswith("/loaded/act/")}
assert len(topics()) == 5, topics()
context.end()
left = weakref.ref(node)
del node, context
gc.collect()
assert left() is None, "the node is still there"
assert not topics(), topics()
"""

ENDS = """
import threading
import actionlib, rospy
from robot_vision.msg import CheckForObjectsAction, CheckForObjectsGoal, CheckForObjectsResult
from robot_vision.ros import actions
from robot_vision.ros.actions import action_server
from robot_vision.ros.context import LoadedContext, active, current

begun, closed, done = threading.Event(), threading.Event(), threading.Event()

def waits(server, goal):
    begun.set()
    ending.wait()

def comes_too_late(server, goal):
    begun.set()
    closed.wait()
    try:
        server.set_succeeded(CheckForObjectsResult())
    finally:
        done.set()

rospy.init_node("actions", log_level=rospy.INFO)
if EXECUTE is waits:
    actions.END_TIMEOUT = 30.0
ending = threading.Event()
context = LoadedContext("/loaded", {}, print)
context.on_end(ending.set)
with active(context):
    server = action_server("~act", CheckForObjectsAction, EXECUTE)
client = actionlib.SimpleActionClient("/loaded/act", CheckForObjectsAction)
client.wait_for_server()
client.send_goal(CheckForObjectsGoal())
begun.wait()
context.end()
closed.set()
if EXECUTE is comes_too_late:
    done.wait()
else:
    client.wait_for_result()
    assert client.get_goal_status_text() == "/loaded ends", client.get_goal_status_text()
server.execute_thread.join()
print("all is done")
"""


SETTINGS = [("nothing", True), ("use_sim_time", True), ("actionlib_status_frequency", 0.0)]


@pytest.mark.parametrize("parameter, value", SETTINGS)
def test_a_server_keeps_neither_its_node_nor_topics(run_script, parameter, value):
    """Also while the clock stands still, and where its status is not published by a timer."""
    rospy.set_param("/" + parameter, value)
    process = run_script(SCRIPT)
    assert process.exit_code(60) == 0, process.output()


@pytest.mark.parametrize("execute", ["waits", "comes_too_late"])
def test_a_goal_whose_node_ends_is_no_error_of_the_server(run_script, execute):
    process = run_script(ENDS.replace("EXECUTE", execute))
    assert process.exit_code(60) == 0, process.output()
    assert "all is done" in process.output()
    for complaint in ("Traceback", "bug", "Exception"):
        assert complaint not in process.output(), process.output()
