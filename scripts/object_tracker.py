#!/usr/bin/env python3
"""Follows selected objects: see robot_vision.tracking.object_tracker."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.ros.startup import run_node
from robot_vision.tracking.object_tracker import ObjectTracker

if __name__ == "__main__":
    run_node("object_tracker", ObjectTracker)
