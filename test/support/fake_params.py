"""A parameter server that is a dict, for code of nodes that runs without a master."""

from typing import Any, Dict

import rospy

from robot_vision.ros.context import NodeContext


def use_params(monkeypatch: Any, there: Dict[str, Any]) -> None:
    """Has the node of this process find its private parameters there, by names such as ~gain."""
    monkeypatch.setattr(rospy, "get_param", there.get)
    monkeypatch.setattr(rospy, "has_param", there.__contains__)
    monkeypatch.setattr(rospy, "set_param", there.__setitem__)
    monkeypatch.setattr(rospy, "delete_param", there.pop)
    monkeypatch.setattr(
        NodeContext,
        "private_params",
        lambda _context: {name[1:]: value for name, value in there.items()},
    )
