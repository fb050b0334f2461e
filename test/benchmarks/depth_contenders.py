"""The node depth_registration, and the nodelets of depth_image_proc that do the same."""

from typing import List

from measuring import Bench, Command, Contender, Contenders
from node_commands import TOPIC, node
from results import Size

IMAGE = "Depth of the color camera, by depth images of 640x480"
POINTS = "The same as points with colors"
NAMESPACE = "/camera"


def depth_image_proc(points: bool, fill: bool) -> List[Command]:
    """Its nodelets in a manager of their own; `fill`: without holes in larger images."""
    same = [f"__ns:={NAMESPACE}", f"rgb/camera_info:={NAMESPACE}/camera_info"]
    same.append("depth_registered/image_rect:=depth_registered/image_raw")
    words = {
        "register": ["depth/image_rect:=depth/image_raw", f"_fill_upsampling_holes:={fill}"],
        "point_cloud_xyzrgb": [f"rgb/image_rect_color:={TOPIC}", "_exact_sync:=true"],
    }
    commands = [node("nodelet", "nodelet", "depth", "manager")]
    for kind in ("register", "point_cloud_xyzrgb") if points else ("register",):
        load = "load", f"depth_image_proc/{kind}", "/depth", *same, *words[kind]
        commands.append(node("nodelet", "nodelet", kind, *load))
    return commands


def registrations(points: bool) -> Contenders:
    """Depth that fits the color image, as an image or as colored points."""

    def contender(name: str, commands: List[Command]) -> Contender:
        topic = NAMESPACE + "/depth_registered/" + ("points" if points else "image_raw")
        depth = NAMESPACE + "/depth/image_raw"
        return Contender(name, commands, topic, depth=depth, cloud=points)

    def nodes(_bench: Bench, _size: Size) -> List[Contender]:
        words = f"__ns:={NAMESPACE}", f"rgb/image_raw:={TOPIC}"
        ours = node("robot_vision", "depth_registration_node", "depth_registration", *words)
        return [
            contender("depth_registration_node", [ours]),
            contender("depth_image_proc", depth_image_proc(points, fill=False)),
            contender("the same, fill_upsampling_holes", depth_image_proc(points, fill=True)),
        ]

    return nodes
