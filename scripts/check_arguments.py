#!/usr/bin/env python3
"""Refuses arguments that a launch file does not have: see robot_vision.demo.launch_arguments."""

import sys
from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # it writes nothing that could be half

from robot_vision.demo.launch_arguments import main

if __name__ == "__main__":
    sys.exit(main())
