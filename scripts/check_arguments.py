#!/usr/bin/env python3
"""Refuses arguments that a launch file does not have: see robot_vision.launch_arguments."""

import sys

from robot_vision.launch_arguments import main

if __name__ == "__main__":
    sys.exit(main())
