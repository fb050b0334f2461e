"""The drawing in docs/architecture.md against the table of the rooms that is checked."""

import pathlib
import re
import runpy
import xml.etree.ElementTree as ElementTree

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CHECKED = runpy.run_path(str(ROOT / "tools" / "check_rooms"))  # its constants, by name


def drawn():
    """The text of the drawing, in the order of its lines."""
    svg = ElementTree.parse(str(ROOT / "docs/images/architecture.svg")).getroot()
    return " ".join(" ".join(svg.itertext()).replace("src/robot_vision/", "").split())


@pytest.mark.parametrize("layer", CHECKED["LAYERS"])
def test_the_drawing_has_all_rooms_of_cpp_in_their_order(layer):
    rooms = CHECKED["LAYERS"][layer]
    assert len(rooms) > 1
    assert " → ".join(rooms) in drawn()


def test_the_drawing_has_the_python_rooms_that_others_use_in_their_order():
    shared = CHECKED["PYTHON"]
    assert len(shared) > 2
    assert " → ".join(shared[:2]) in drawn() and " → ".join(shared[2:]) in drawn()


def test_the_drawing_has_all_other_python_rooms():
    rooms = {path.parent.name for path in (ROOT / "src/robot_vision").glob("*/__init__.py")}
    (words,) = re.findall(r"used by no other: ([a-z]+(?:, [a-z]+)*)", drawn())
    assert set(words.split(", ")) == rooms - set(CHECKED["PYTHON"])
