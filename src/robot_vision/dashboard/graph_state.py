"""The nodes and topics that the master knows, put in order."""

from typing import Any, Dict, Iterable, List, NamedTuple, Set, Tuple

from ..ros.listeners import IMAGES

IMAGE = "sensor_msgs/Image"
COMPRESSED = "sensor_msgs/CompressedImage"
IMAGE_TYPES = (IMAGE, COMPRESSED)
# The ends of the topics that image_transport adds to one of images.
TRANSPORTS = ("/compressed", "/compressedDepth", "/theora", "/shm")
DESCRIPTIONS = "/parameter_descriptions"  # of dynamic_reconfigure
MAX_NODES = 2000
MAX_TOPICS = 5000

Edges = Dict[str, Set[str]]  # names by names


class State(NamedTuple):
    """What the master knows.

    Attributes:
        publishers: The nodes that publish each topic.
        subscribers: The nodes that subscribe to each topic.
        services: The node of each service.
        types: The type of each topic.
        nodes: All nodes. One in a nodelet manager is among them if it can be told by its name.
    """

    publishers: Edges
    subscribers: Edges
    services: Dict[str, str]
    types: Dict[str, str]
    nodes: Set[str]

    @property
    def topics(self) -> List[str]:
        return sorted({*self.publishers, *self.subscribers})[:MAX_TOPICS]


def state_of(system: Any, types: Any) -> State:
    """Returns what the answers of getSystemState and getTopicTypes say.

    The roscpp node in a Python node of this package, NAME_images, counts as the node NAME.
    """
    publishing, subscribing, serving = ((_pairs(kind)) for kind in system)
    everybody = {
        node for kind in (publishing, subscribing, serving) for _, nodes in kind for node in nodes
    }

    def owner(node: str) -> str:
        base = node[: -len(IMAGES)]
        return base if node.endswith(IMAGES) and base in everybody else node

    return State(
        {topic: set(map(owner, nodes)) for topic, nodes in publishing},
        {topic: set(map(owner, nodes)) for topic, nodes in subscribing},
        {service: owner(nodes[0]) for service, nodes in serving if nodes},
        {str(topic): str(kind) for topic, kind in types},
        set(sorted(set(map(owner, everybody)))[:MAX_NODES]),
    )


def _pairs(kind: Iterable[Any]) -> List[Tuple[str, List[str]]]:
    return [(str(name), [str(node) for node in nodes]) for name, nodes in kind]


def parameter_nodes(state: State) -> Set[str]:
    """Returns whose parameters dynamic_reconfigure can change, but for those of transports."""
    found = {
        topic[: -len(DESCRIPTIONS)] for topic in state.publishers if topic.endswith(DESCRIPTIONS)
    }
    return {node for node in found if not node.endswith(TRANSPORTS)}


def with_nodelets(state: State, names: Iterable[str]) -> State:
    """Returns the state in which nodelets have their own topics and services.

    In the graph these are their manager's. A nodelet's begin with its name.

    Args:
        state: What the master says.
        names: The names of nodes, by their status or their parameters. Nodelets are those that the
            master does not know, or whose parameters another node describes: the process that has
            loaded a nodelet into a manager is a node of the nodelet's name.
    """
    found = {
        name
        for name in names
        if name not in state.nodes or name not in state.publishers.get(name + DESCRIPTIONS, {name})
    }
    nodelets = sorted(found, key=len, reverse=True)
    if not nodelets:
        return state
    publishers = {
        topic: {_nodelet_of(topic, nodelets, node) for node in nodes}
        for topic, nodes in state.publishers.items()
    }
    subscribers = {
        topic: {_subscriber_of(topic, nodelets, node, publishers) for node in nodes}
        for topic, nodes in state.subscribers.items()
    }
    services = {
        service: _nodelet_of(service, nodelets, node) for service, node in state.services.items()
    }
    there = {node for nodes in publishers.values() for node in nodes}
    there.update(services.values())
    return state._replace(
        publishers=publishers,
        subscribers=subscribers,
        services=services,
        nodes=state.nodes | there.intersection(nodelets),
    )


def _nodelet_of(name: str, nodelets: List[str], node: str) -> str:
    """Returns the nodelet whose name a topic or service begins with, else its node."""
    if name.startswith(node + "/"):
        return node
    return next((one for one in nodelets if name.startswith(one + "/")), node)


def _subscriber_of(topic: str, nodelets: List[str], node: str, publishers: Edges) -> str:
    """Returns the nodelet that subscribes to a topic of its name, else the node.

    What a nodelet publishes itself, others in its manager subscribe to.
    """
    found = _nodelet_of(topic, nodelets, node)
    return node if found in publishers.get(topic, ()) else found


def of_nodes(edges: Edges) -> Dict[str, List[str]]:
    """Returns the topics by node."""
    found: Dict[str, List[str]] = {}
    for topic, nodes in sorted(edges.items()):
        for node in nodes:
            found.setdefault(node, []).append(topic)
    return found


def base_of(topic: str) -> str:
    """Returns the topic of images that one of a transport belongs to; others are returned as is."""
    return next((topic[: -len(end)] for end in TRANSPORTS if topic.endswith(end)), topic)


def is_image(topic: str, types: Dict[str, str], published: Iterable[str]) -> bool:
    """Returns whether a topic is one of images, and not only another transport of one."""
    kind = types.get(topic, "")
    return kind == IMAGE or (kind == COMPRESSED and base_of(topic) not in published)


def shown_topic(topic: str, state: State) -> str:
    """Returns the topic by which the images of one are shown; "" stays as it is.

    That is another one if only its compressed images are published, as of a bag that is played.
    """
    if not topic or topic in state.publishers:
        return topic
    return next((topic + end for end in TRANSPORTS if _has_compressed(topic + end, state)), topic)


def _has_compressed(topic: str, state: State) -> bool:
    return topic in state.publishers and state.types.get(topic) == COMPRESSED
