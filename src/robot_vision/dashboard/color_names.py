"""The named colours of a node, as the parameter server has them."""

from typing import Any, Dict, List, Tuple

from ..color.named_colors import ADD
from ..common.plain_text import brief
from ..ros.graph_master import graph_name, server_param

HSV = ("h_low", "s_low", "v_low", "h_high", "s_high", "v_high")
NUMBERED = ("low_1", "low_2", "low_3", "high_1", "high_2", "high_3")
MAX_NAMES = 200


def colors_at_start(node: str) -> List[str]:
    """Returns the names in a node's ~colors, sorted; none if it has no such parameter.

    Raises:
        OSError: The master does not answer.
    """
    colors = server_param(f"{graph_name(node)}/colors")
    return sorted(map(str, colors))[:MAX_NAMES] if isinstance(colors, dict) else []


def color_names(node: str) -> Dict[str, Any]:
    """Returns the names of a node's colours, and the one that its live parameters show or "".

    Raises:
        OSError: The master does not answer.
    """
    names = colors_at_start(node)
    shown = server_param(f"{node}/color")
    shown = shown if isinstance(shown, str) else ""
    return {"names": sorted({*names, shown} - {""}), "shown": shown}


def range_values(
    types: Dict[str, str], name: str, space: str, limits: Tuple[List[int], List[int]]
) -> Dict[str, Any]:
    """Returns the live parameters that give a node the range of a colour.

    Args:
        types: The types of the node's live parameters.
        name: The name of the colour, for a node that has several, which gets it if it has none
            of this name; "" is the one that is shown.
        space: The space of the limits.
        limits: The low and the high limits.

    Raises:
        ValueError: The node does not take such a range.
    """
    values = [*limits[0], *limits[1]]
    if not set(HSV) <= set(types):
        raise ValueError("this node takes no range of a colour")
    if not {"color", "space"} <= set(types):
        if space != "hsv":
            raise ValueError(f"space is {brief(space)}, this node takes ranges in hsv only")
        return dict(zip(HSV, values))
    names = HSV if space == "hsv" else NUMBERED
    return {"color": ADD + name if name else "", "space": space, **dict(zip(names, values))}
