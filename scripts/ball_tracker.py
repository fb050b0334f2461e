#!/usr/bin/env python3
"""Follows a ball: see robot_vision.ball.ball_tracker."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.ball.ball_tracker import BallTracker
from robot_vision.ros.startup import run_node

if __name__ == "__main__":
    run_node("ball_tracker", BallTracker)
