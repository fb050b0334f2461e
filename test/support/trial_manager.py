#!/usr/bin/env python3
"""python_manager.py, with nodes besides those of the package that do what no node may do."""

import os

import robot_vision
from robot_vision.common.commands import end_process
from robot_vision.nodelets import python_manager

robot_vision.__path__.append(os.path.join(os.path.dirname(__file__), "trial_nodes"))
end_process(python_manager.main())
