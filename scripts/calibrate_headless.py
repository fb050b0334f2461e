#!/usr/bin/env python3
"""Calibrates a camera, without a screen, by pictures of a board."""

import sys

from robot_vision.nodes.calibrate_headless import main

if __name__ == "__main__":
    sys.exit(main())
