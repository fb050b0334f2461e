#!/usr/bin/env python3
"""Finds regions of named colours: see robot_vision.color.hsv_tracker."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.color.hsv_tracker import HsvTracker
from robot_vision.ros.startup import run_node

if __name__ == "__main__":
    run_node("hsv_tracker", HsvTracker)
