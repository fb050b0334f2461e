#!/usr/bin/env python3
"""Follows a ball: see robot_vision.nodes.ball_tracker."""

from robot_vision.nodes.ball_tracker import BallTracker
from robot_vision.nodes.startup import run_node

if __name__ == "__main__":
    run_node("ball_tracker", BallTracker)
