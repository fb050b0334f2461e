"""What holds for all tests of the dashboard's features."""

import contextlib
from unittest.mock import patch

import pytest
import support


@pytest.fixture(autouse=True)
def patience(request):
    """Nodes, and the master, may take as long as they do on a busy machine.

    A test of a time limit sets its own.
    """
    with contextlib.ExitStack() as patched:
        if "master" in request.fixturenames:
            from robot_vision.dashboard import graph_calls, parameter_node, select_topics
            from robot_vision.ros import graph_master

            for module, name in (
                (graph_calls, "TIMEOUT"),
                (graph_master, "TIMEOUT"),
                (parameter_node, "DESCRIPTION_TIMEOUT"),
                (select_topics, "CONNECTION_TIMEOUT"),
            ):
                patched.enter_context(patch.object(module, name, support.DEADLINE))
        yield
