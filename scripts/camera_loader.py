#!/usr/bin/env python3
"""Loads several cameras into one nodelet manager."""

from robot_vision.nodes.camera_loader import CameraLoader
from robot_vision.nodes.startup import run_node

if __name__ == "__main__":
    run_node("camera_loader", CameraLoader, CameraLoader.run, has_file=False)
