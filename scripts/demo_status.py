#!/usr/bin/env python3
"""Prints what the nodes of the demo report: see robot_vision.demo.demo_status."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.demo.demo_status import DemoStatus
from robot_vision.ros.startup import run_node

if __name__ == "__main__":
    run_node("demo_status", DemoStatus, has_file=False)
