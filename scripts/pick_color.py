#!/usr/bin/env python3
"""Prints the HSV range around a colour for hsv_tracker, or saves it in its parameter file."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.color.pick_color import main
from robot_vision.common.commands import end_process

if __name__ == "__main__":
    end_process(main())
