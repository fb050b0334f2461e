#!/usr/bin/env python3
"""Loads several cameras into one nodelet manager."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.camera.camera_loader import CameraLoader
from robot_vision.ros.startup import run_node

if __name__ == "__main__":
    run_node("camera_loader", CameraLoader, CameraLoader.run, has_file=False)
