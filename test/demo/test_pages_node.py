"""The pages of docs/ about nodes against running nodes."""

import re

import pages
import pytest
import rosgraph
import rosservice
import support

NODES = pages.nodes()
# What nodes have without being named: of rosout, roscpp, dynamic_reconfigure, image_transport, and
# of actions, which pages name as a whole.
UNNAMED = re.compile(
    r"/rosout|.*/(get_loggers|set_logger_level|set_parameters|parameter_(descriptions|updates))"
    r"|.*/(compressed|compressedDepth|theora|shm)(/.*)?"
    r"|.*/check_for_objects/(goal|cancel|status|feedback|result)"
)

OURS = {"/node", "/node_images"}  # a Python node and its roscpp half
WITHOUT_REPORTS = ("dashboard.py", "simple_camera_view_node.py")  # they process nothing
CHAIN = ("gaussian", "blend")  # of the filter, which has a topic for each NAME of it


def resolved(types):
    """What a page names, by its name in the running node."""
    return {
        (each.replace("~", "/node/") if each[0] in "~/" else "/" + each): kind
        for name, kind in types.items()
        for each in ([name.replace("NAME", one) for one in CHAIN] if "NAME" in name else [name])
    }


@pytest.mark.parametrize("node", NODES)
def test_the_help_names_topics_and_services(start, node):
    process = start(node, "--help", env={"ROS_MASTER_URI": "http://127.0.0.1:1"})
    assert process.exit_code() == 0, process.output()
    assert f"usage: rosrun robot_vision {node} " in process.output()
    words = set(re.findall(r"[~/\w]+", process.output()))
    for names in (NODES[node].inputs, NODES[node].outputs, NODES[node].services):
        assert set(names) <= words


@pytest.mark.parametrize("node", NODES)
def test_topics_and_services(start, display, node):
    page = NODES[node]
    inputs, outputs, services = map(resolved, (page.inputs, page.outputs, page.services))
    parameters = ["_source:=synthetic", "_always_subscribe:=true", "_ball_diameter:=0.2"]
    parameters += ["_auto_select:=true", "_use_second:=true", f"_chain:={','.join(CHAIN)}"]
    parameters += ["depth:=/depth"]  # some take it only if it is remapped
    start(node, "__name:=node", *parameters)
    reports = set() if node in WITHOUT_REPORTS else {"/diagnostics"}
    expected = (outputs.keys() | reports, set(inputs), set(services))
    master = rosgraph.Master("/test")

    def state():
        topics_of_node = [
            {name for name, nodes in part if OURS & set(nodes) and not UNNAMED.fullmatch(name)}
            for part in master.getSystemState()
        ]
        return tuple(topics_of_node)

    support.wait_for(
        lambda: all(a >= b for a, b in zip(state(), expected)), f"{expected} of {node}"
    )
    assert state() == expected
    types = dict(master.getTopicTypes())
    for name, kind in {**inputs, **outputs}.items():
        assert types[name] == kind, name
    for name, kind in services.items():
        assert rosservice.get_service_type(name) == kind, name
