#!/usr/bin/env python3
"""Makes AprilTags and QR codes to print: see robot_vision.markers."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.common.commands import end_process
from robot_vision.markers.command import main

if __name__ == "__main__":
    end_process(main())
