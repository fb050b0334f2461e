"""Calibrating a camera with images of a board, by NumPy and OpenCV; only the command needs ROS."""
