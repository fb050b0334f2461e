#!/usr/bin/env python3
"""The node dashboard, for which nodes and the master may take as long as on a busy machine."""

from robot_vision.dashboard import dashboard, graph_calls, parameter_node
from robot_vision.ros import graph_master

graph_calls.TIMEOUT = graph_master.TIMEOUT = 60.0
parameter_node.DESCRIPTION_TIMEOUT = 60.0
dashboard.main()
