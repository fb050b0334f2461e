#!/usr/bin/env python3
"""Calibrates a camera, without a screen, by pictures of a board."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.commands import end_process
from robot_vision.nodes.calibrate_headless import main

if __name__ == "__main__":
    end_process(main())
