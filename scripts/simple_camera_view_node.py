#!/usr/bin/env python3
"""Shows a camera's pictures in a window; a click picks a colour."""

from robot_vision.nodes.camera_view import main

if __name__ == "__main__":
    main()
