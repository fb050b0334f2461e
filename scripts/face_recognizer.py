#!/usr/bin/env python3
"""Tells whose faces are seen: see robot_vision.faces.face_recognizer."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.faces.face_recognizer import FaceRecognizer
from robot_vision.ros.startup import run_node

if __name__ == "__main__":
    run_node("face_recognizer", FaceRecognizer)
