#!/usr/bin/env python3
"""Shows a camera's pictures in a window; a click picks a colour."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.viewer.camera_view import main

if __name__ == "__main__":
    main()
