"""The drawing in docs/architecture.md against the table of the rooms that is checked."""

import pathlib
import runpy
import xml.etree.ElementTree as ElementTree

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CHECKED = runpy.run_path(str(ROOT / "tools" / "check_rooms"))  # its constants, by name


def drawn():
    """The text of the drawing, in the order of its lines."""
    svg = ElementTree.parse(str(ROOT / "docs/images/architecture.svg")).getroot()
    return " ".join(" ".join(svg.itertext()).replace("src/robot_vision/", "").split())


@pytest.mark.parametrize(
    "rooms",
    [
        CHECKED["CORE"],
        CHECKED["ROS"],
        CHECKED["PYTHON"][:2],  # what all share has a box of its own
        CHECKED["PYTHON"][2:],
    ],
)
def test_the_drawing_has_all_rooms_in_their_order(rooms):
    assert len(rooms) > 1
    assert " → ".join(rooms) in drawn()
