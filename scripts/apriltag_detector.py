#!/usr/bin/env python3
"""Finds AprilTags and where they are: see robot_vision.tags.apriltag_detector."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.ros.startup import run_node
from robot_vision.tags.apriltag_detector import ApriltagDetector

if __name__ == "__main__":
    run_node("apriltag_detector", ApriltagDetector)
