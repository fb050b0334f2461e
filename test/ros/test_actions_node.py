"""Servers of actions end with their node, and keep nothing of it."""

import pytest
import rospy

SCRIPT = """
import gc, weakref
import rosgraph, rospy
from robot_vision.msg import CheckForObjectsAction
from robot_vision.ros.actions import action_server
from robot_vision.ros.context import LoadedContext, active

class Node:
    def __init__(self):
        self.server = action_server("~act", CheckForObjectsAction, self.execute)
    def execute(self, server, goal):
        pass

rospy.init_node("actions")
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


SETTINGS = [("nothing", True), ("use_sim_time", True), ("actionlib_status_frequency", 0.0)]


@pytest.mark.parametrize("parameter, value", SETTINGS)
def test_a_server_keeps_neither_its_node_nor_topics(run_script, parameter, value):
    """Also while the clock stands still, and where its status is not published by a timer."""
    rospy.set_param("/" + parameter, value)
    process = run_script(SCRIPT)
    assert process.exit_code(60) == 0, process.output()
