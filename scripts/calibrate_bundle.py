#!/usr/bin/env python3
"""Learns where AprilTags sit on a rigid body, from a running detector or a bag."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.common.commands import end_process
from robot_vision.tags.calibrate_bundle import main

if __name__ == "__main__":
    end_process(main())
