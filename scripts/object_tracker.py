#!/usr/bin/env python3
"""Follows selected objects: see robot_vision.nodes.object_tracker."""

from robot_vision.nodes.object_tracker import ObjectTracker
from robot_vision.nodes.startup import run_node

if __name__ == "__main__":
    run_node("object_tracker", ObjectTracker)
