#!/usr/bin/env python3
"""Drives along a line: see robot_vision.nodes.line_follower."""

from robot_vision.nodes.line_follower import LineFollower
from robot_vision.nodes.startup import run_node

if __name__ == "__main__":
    run_node("line_follower", LineFollower)
