#!/usr/bin/env python3
"""Finds what moves: see robot_vision.motion.motion_detector."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.motion.motion_detector import MotionDetector
from robot_vision.ros.startup import run_node

if __name__ == "__main__":
    run_node("motion_detector", MotionDetector)
