"""The drawing in docs/architecture.md against the order of the rooms that is checked."""

import pathlib
import re
import runpy
import xml.etree.ElementTree as ElementTree

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CHECKED = runpy.run_path(str(ROOT / "tools" / "check_rooms"))  # its constants, by name
PACKAGE = ROOT / "src/robot_vision"
UNORDERED = {path.parent.name for path in PACKAGE.glob("*/__init__.py")} - {*CHECKED["PYTHON"]}
ORDERS = {**CHECKED["LAYERS"], "Python": [*CHECKED["PYTHON"], *sorted(UNORDERED)]}


def chains():
    """The chains of rooms in the drawing, each as a list of rooms."""
    svg = ElementTree.parse(str(ROOT / "docs/images/architecture.svg")).getroot()
    text = " ".join(" ".join(svg.itertext()).replace("src/robot_vision/", "").split())
    return [chain.split(" → ") for chain in re.findall(r"[\w/]+(?: → [\w/]+)+", text)]


@pytest.mark.parametrize("layer", ORDERS)
def test_rooms_are_drawn_in_their_order(layer):
    """A new room need not be drawn; what is drawn must be right."""
    order = ORDERS[layer]
    drawn = [chain for chain in chains() if {*chain} <= {*order}]
    assert drawn
    assert all(chain == sorted(chain, key=order.index) for chain in drawn)


def test_all_that_is_drawn_are_rooms_of_a_layer():
    for chain in chains():
        assert any({*chain} <= {*order} for order in ORDERS.values()), chain
