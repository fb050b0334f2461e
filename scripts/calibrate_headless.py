#!/usr/bin/env python3
"""Calibrates a camera, without a screen, by pictures of a board."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.calibration.calibrate_headless import main
from robot_vision.common.commands import end_process

if __name__ == "__main__":
    end_process(main())
