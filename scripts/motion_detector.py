#!/usr/bin/env python3
"""Finds what moves: see robot_vision.nodes.motion_detector."""

from robot_vision.nodes.motion_detector import MotionDetector
from robot_vision.nodes.startup import run_node

if __name__ == "__main__":
    run_node("motion_detector", MotionDetector)
