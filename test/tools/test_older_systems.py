"""What tests must not use, or they would not run where ROS and pytest are other ones than here."""

import ast
import pathlib
import re

TESTS = pathlib.Path(__file__).resolve().parents[1]
TEXTS = {path: path.read_text() for path in sorted(TESTS.glob("*/*.py"))}
# Of pytest 4.6, which Ubuntu 20.04 has.
OF_PYTEST = {"approx", "fail", "fixture", "importorskip", "mark", "param", "raises", "skip"}
# They have such paths as texts that are only read.
NAME_PROGRAMS = {"test_process_costs.py", "test_launch_arguments.py"}
PROGRAM = re.compile(r'"/usr/(bin/ros|lib/(nodelet|image_transport|image_view|rosbag)/)')


def is_list(node):
    """True if the ids of parameters are a list, or a function that makes a text of each."""
    if isinstance(node, ast.Call):
        return isinstance(node.func, ast.Name) and node.func.id in ("list", "sorted")
    if isinstance(node, ast.Name):
        return node.id.islower()
    return isinstance(node, (ast.List, ast.ListComp, ast.Lambda))


def test_pytest_may_be_old():
    for path, text in TEXTS.items():
        used = set(re.findall(r"(?<!\w)pytest\.(\w+)", text))
        assert used - {"ini"} <= OF_PYTEST, path.name


def test_ids_of_parameters_are_lists():
    for path, text in TEXTS.items():
        calls = (
            [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
            if "ids=" in text
            else []
        )
        for call in calls:
            if isinstance(call.func, ast.Attribute) and call.func.attr in (
                "parametrize",
                "fixture",
            ):
                others = [
                    one for one in call.keywords if one.arg == "ids" and not is_list(one.value)
                ]
                assert not others, f"{path.name}:{call.lineno}"


def test_programs_of_ros_may_be_anywhere():
    """ros_programs.py says where they are."""
    assert [path.name for path, text in TEXTS.items() if PROGRAM.search(text)] == sorted(
        NAME_PROGRAMS
    )
