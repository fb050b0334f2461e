#!/usr/bin/env python3
"""Reads QR codes and bar codes: see robot_vision.codes.code_reader."""

from _signal import SIG_DFL, SIGINT, signal

signal(SIGINT, SIG_DFL)  # what follows takes a second, and cannot be interrupted otherwise

from robot_vision.codes.code_reader import CodeReader
from robot_vision.ros.startup import run_node

if __name__ == "__main__":
    run_node("code_reader", CodeReader)
