"""Calibrating a camera by pictures of a board: NumPy and OpenCV, no ROS."""
