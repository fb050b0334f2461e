"""What holds for all tests here.

What they share is in support. A test of running nodes is in a file test_X_node.py: it has a ROS
master.
"""

import os
import pathlib
import signal
import sys

HERE = pathlib.Path(__file__).resolve().parent
# Its threads yield to each other at every small matrix: beside other work a second becomes minutes.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path[:0] = [str(HERE / "support"), str(HERE / "benchmarks"), str(HERE / "vivid")]


# What a shell starts in the background ignores SIGINT, as all does that it starts: a master would
# then be waited for that was told to end.
signal.signal(signal.SIGINT, signal.default_int_handler)


def has_nodes(path):
    return path.name.endswith("_node.py") or (path.is_dir() and any(path.rglob("*_node.py")))


def pytest_configure(config):
    paths = [pathlib.Path(argument.split("::")[0]) for argument in config.args]
    if any(has_nodes(path) for path in paths):
        config.pluginmanager.import_plugin("ros_fixtures")
    else:
        # As many files are tested at a time as there are cores, and threads that wait for work turn
        # in a loop. What several threads do is the gtests' matter.
        os.environ.setdefault("OPENCV_FOR_THREADS_NUM", "1")
