#!/usr/bin/env python3
"""Prints the HSV range around a colour for hsv_tracker, or saves it in its parameter file."""

import sys

from robot_vision.nodes.pick_color import main

if __name__ == "__main__":
    sys.exit(main())
