#!/usr/bin/env python3
"""Drives along a line: see robot_vision.line.line_follower."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.line.line_follower import LineFollower
from robot_vision.ros.startup import run_node

if __name__ == "__main__":
    run_node("line_follower", LineFollower)
