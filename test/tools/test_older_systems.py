"""What tests must not use, or they would not run where ROS and pytest are other ones than here."""

import ast
import functools
import pathlib
import re

TESTS = pathlib.Path(__file__).resolve().parents[1]
FILES = sorted(TESTS.glob("*/*.py"))
# Of pytest 4.6, which Ubuntu 20.04 has.
OF_PYTEST = {"approx", "fail", "fixture", "importorskip", "mark", "param", "raises", "skip"}
# They have such paths as texts that are only read.
NAME_PROGRAMS = {"test_older_systems.py", "test_process_costs.py", "test_launch_arguments.py"}
PROGRAM = re.compile(r"^/usr/(bin/ros\w+|lib/(nodelet|image_transport|image_view|rosbag)/.*)$")


@functools.lru_cache(maxsize=None)
def parsed(path):
    return ast.parse(path.read_text())


def found(kind, is_wrong, but=()):
    """Where nodes of a kind are wrong, as FILE:LINE."""
    return [
        f"{path.name}:{node.lineno}"
        for path in FILES
        if path.name not in but
        for node in ast.walk(parsed(path))
        if isinstance(node, kind) and is_wrong(node)
    ]


def is_list(node):
    """True if the ids of parameters are a list, or a function that makes a text of each."""
    if isinstance(node, ast.Call):
        return isinstance(node.func, ast.Name) and node.func.id in ("list", "sorted")
    if isinstance(node, ast.Name):
        return node.id.islower()
    return isinstance(node, (ast.List, ast.ListComp, ast.Lambda))


def test_pytest_may_be_old():
    def is_newer(node):
        return (
            isinstance(node.value, ast.Name)
            and node.value.id == "pytest"
            and node.attr not in OF_PYTEST
        )

    assert found(ast.Attribute, is_newer) == []


def test_ids_of_parameters_are_lists():
    def has_others(call):
        is_one = isinstance(call.func, ast.Attribute) and call.func.attr in (
            "parametrize",
            "fixture",
        )
        return is_one and any(one.arg == "ids" and not is_list(one.value) for one in call.keywords)

    assert found(ast.Call, has_others) == []


def test_programs_of_ros_may_be_anywhere():
    """ros_programs.py says where they are."""

    def is_path(node):
        return isinstance(node.value, str) and PROGRAM.match(node.value)

    assert found(ast.Constant, is_path, NAME_PROGRAMS) == []
