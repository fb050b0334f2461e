#!/usr/bin/env python3
"""Learns where AprilTags sit on a rigid body, from a running detector or a bag."""

import sys

from robot_vision.nodes.calibrate_bundle import main

if __name__ == "__main__":
    sys.exit(main())
