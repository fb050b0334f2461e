#!/usr/bin/env python3
"""Makes AprilTags and QR codes to print: see robot_vision.markers."""

import sys

from robot_vision.markers.command import main

if __name__ == "__main__":
    sys.exit(main())
