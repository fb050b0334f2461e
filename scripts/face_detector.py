#!/usr/bin/env python3
"""Finds faces: see robot_vision.faces.face_detector."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.faces.face_detector import FaceDetector
from robot_vision.ros.startup import run_node

if __name__ == "__main__":
    run_node("face_detector", FaceDetector)
