"""When a master dies and comes back empty, nodes and nodelets register again."""

import pathlib
import sys
import time

import pytest
import rosgraph
import rospy
import support
from ros_programs import program_of
from std_srvs.srv import Trigger

CLIENT = """
import sys
import dynamic_reconfigure.client
import rospy
from nodelet.srv import NodeletLoad
from sensor_msgs.msg import Image
from std_srvs.srv import Trigger

rospy.init_node("client", anonymous=True)
node, key, value, *kinds = sys.argv[1:]
for kind in kinds:
    rospy.wait_for_service("/manager/load_nodelet", 60)
    load = rospy.ServiceProxy("/manager/load_nodelet", NodeletLoad)
    remappings = [[], []] if kind == "camera" else [["image"], ["/camera/image_raw"]]
    assert load("/" + kind, "robot_vision/" + kind, *remappings, [], "").success
for _ in range(12):  # each asks the master anew, whose answer rospy may have taken for newer news
    try:
        image = rospy.wait_for_message(node + "/processed_image", Image, 5)
        break
    except rospy.ROSException:
        pass
print("frame", image.header.frame_id)
client = dynamic_reconfigure.client.Client(node, timeout=60)
print("set", client.update_configuration({key: int(value)})[key])
rospy.wait_for_service(node + "/save_parameters", 60)
print("saved", rospy.ServiceProxy(node + "/save_parameters", Trigger)().message)
"""
CAMERA = {"source": "synthetic", "image_width": 160, "image_height": 120}


@pytest.mark.parametrize(
    "node, key, nodelets",
    [
        ("edge_detector_node", "blur_size", []),
        ("hsv_tracker.py", "opening", []),
        ("manager", "blur_size", ["camera", "edge_detector"]),
        ("python_manager.py", "opening", ["camera", "hsv_tracker"]),
    ],
)
def test_nodes_register_again(start, run_script, tmp_path, node, key, nodelets):
    master = support.Master(start)
    name = "/" + (nodelets[-1] if nodelets else node.replace("_node", "").replace(".py", ""))
    for parameter, value in CAMERA.items():
        master.api.setParam("/camera/" + parameter, value)
    file = tmp_path / "saved.yaml"
    master.api.setParam(name + "/config_file", str(file))
    commands = [["camera_node"], [node, "image:=/camera/image_raw"]]
    if nodelets:
        commands = [[node, "__name:=manager"]]
        if node == "manager":
            commands = [[program_of("nodelet", "nodelet"), "manager", "__name:=manager"]]
    processes = [start(*command, env=master.env) for command in commands]

    def ask(value, *kinds):
        client = run_script(CLIENT, name, key, value, *kinds, env=master.env, fork=True)
        assert client.exit_code() == 0, client.output()
        assert f"set {value}" in client.output()
        assert f"saved {file}" in client.output()
        assert f"{key}: {value}" in file.read_text()

    ask(9, *nodelets)
    services = services_of(master.api)
    master.end()
    master.begin()
    ask(11)
    support.wait_for(lambda: services_of(master.api) == services, "all services")
    cut_off = False  # as it ends within a second, whatever the master has to be told yet
    for process in processes:
        begin = time.monotonic()
        process.interrupt()
        assert process.exit_code() == 0, process.output()
        cut_off |= time.monotonic() - begin > 0.6
    assert cut_off or services_of(master.api) == {}


@pytest.mark.parametrize("node", ["edge_detector_node", "hsv_tracker.py"])
def test_a_master_with_the_process_id_of_the_old_one_is_another_one(start, node):
    """It knows the node already, by a parameter that the node's log asks for."""
    command = [sys.executable, str(pathlib.Path(support.__file__).with_name("numbered_master.py"))]
    master = support.Master(start, command)
    first = start(node, "__name:=name", "_misspelt:=1", env=master.env)
    wait_until_started(first, master.api, "/name/save_parameters")
    services, node_address = services_of(master.api), master.api.lookupNode("/name")
    with support.standing_still(first):
        master.end()
        master.begin()
        rosgraph.Master("/name", master.env["ROS_MASTER_URI"]).subscribeParam(node_address, "/any")
        assert master.api.lookupNode("/name") == node_address
    support.wait_for(lambda: services_of(master.api) == services, "all services")


@pytest.mark.parametrize("node", ["edge_detector_node", "hsv_tracker.py"])
def test_a_node_that_has_taken_the_name_keeps_it(start, node):
    master = support.Master(start)
    service = "/name/save_parameters"
    first = start(node, "__name:=name", "_misspelt:=1", env=master.env)
    wait_until_started(first, master.api, service)
    with support.standing_still(first):
        master.end()
        master.begin()
        second = start(node, "__name:=name", "_misspelt:=1", env=master.env)
        wait_until_started(second, master.api, service)
        node_address, address = master.api.lookupNode("/name"), master.api.lookupService(service)
    first.wait_for_output("knows another node of this name: not registered again")
    assert first.running() and second.running()
    assert master.api.lookupNode("/name") == node_address
    assert master.api.lookupService(service) == address


def wait_until_started(process, master, service):
    """Waits for the last line of a start, and for an answer of the service, which logs an error.

    The first line that rospy logs registers the node for a parameter, after it was printed. A
    process that was stopped in between would register with the next master as it goes on.
    """
    process.wait_for_output("misspelt is not known")
    with support.service_of(master, service):
        rospy.ServiceProxy(service, Trigger)()


def services_of(master):
    """The nodes of each service, without the services of the node /client."""
    services = master.getSystemState()[2]
    return {name: nodes for name, nodes in services if not name.startswith("/client")}
