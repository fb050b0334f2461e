"""The README's table of nodes against running nodes."""

import pathlib
import re

import pytest
import rosgraph
import rosservice
import support

README = pathlib.Path(__file__).resolve().parents[2] / "README.md"
# What every node has without being named: of rosout, roscpp, dynamic_reconfigure, image_transport.
UNNAMED = re.compile(
    r"/rosout|.*/(get_loggers|set_logger_level|set_parameters|parameter_(descriptions|updates))"
    r"|.*/(compressed|compressedDepth|theora)(/.*)?"
)

OURS = {"/node", "/node_images"}  # a Python node and its roscpp half


def rows():
    """The cells of the table of nodes, by executable."""
    lines = README.read_text().splitlines()
    begin = lines.index("| node | nodelet | subscribes to | publishes | services |")
    found = {}
    for line in lines[begin + 2 :]:
        if not line.startswith("|"):
            return found
        node, nodelet, *cells = (
            re.findall(r"`([^`]+)`", cell) for cell in line.strip("|").split("|")
        )
        found[node[0]] = (nodelet[0] if nodelet else None, *cells)
    return found


def service_types():
    """Those that the table names, by executable and service."""
    found = {}
    for line in README.read_text().splitlines():
        node = re.match(r"\| `(\w+(?:_node|\.py))` \|", line)
        if node:
            services = line.strip("| ").rpartition("|")[2]
            found[node[1]] = dict(re.findall(r"`([^`]+)` \(([\w/]+)\)", services))
    return found


def resolved(names):
    return {name.replace("~", "/node/") if name[0] in "~/" else "/" + name for name in names}


def test_every_nodelet_is_there():
    declared = (README.parent / "nodelet_plugins.xml").read_text()
    assert {nodelet for nodelet, *_ in rows().values() if nodelet} == set(
        re.findall(r'class name="([^"]+)"', declared)
    )


@pytest.mark.parametrize("node", rows())
def test_the_help_names_topics_and_services(start, node):
    process = start(node, "--help", env={"ROS_MASTER_URI": "http://127.0.0.1:1"})
    assert process.exit_code() == 0, process.output()
    assert f"usage: rosrun robot_vision {node} " in process.output()
    words = set(re.findall(r"[~/\w]+", process.output()))
    for names in rows()[node][1:]:
        assert set(names) <= words


@pytest.mark.parametrize("node", rows())
def test_topics_and_services(start, display, node):
    _, subscribed, published, services = rows()[node]
    parameters = ["_source:=synthetic", "_always_subscribe:=true", "_ball_diameter:=0.2"]
    parameters += ["_auto_select:=true"]
    start(node, "__name:=node", *parameters)
    reports = set() if node == "simple_camera_view_node.py" else {"/diagnostics"}
    expected = (resolved(published) | reports, resolved(subscribed), resolved(services))

    def state():
        topics_of_node = [
            {name for name, nodes in part if OURS & set(nodes) and not UNNAMED.fullmatch(name)}
            for part in rosgraph.Master("/test").getSystemState()
        ]
        return tuple(topics_of_node)

    support.wait_for(
        lambda: all(a >= b for a, b in zip(state(), expected)), f"{expected} of {node}"
    )
    assert state() == expected
    there = {"~save_parameters": "std_srvs/Trigger", **service_types()[node]}
    assert there.keys() == set(services)
    for name, kind in there.items():
        assert rosservice.get_service_type(*resolved([name])) == kind, name
