#!/usr/bin/env python3
"""Finds regions of named colours: see robot_vision.nodes.hsv_tracker."""

from robot_vision.nodes.hsv_tracker import HsvTracker
from robot_vision.nodes.startup import run_node

if __name__ == "__main__":
    run_node("hsv_tracker", HsvTracker)
