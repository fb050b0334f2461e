#!/usr/bin/env python3
"""Reads QR codes and bar codes: see robot_vision.nodes.code_reader."""

from robot_vision.nodes.code_reader import CodeReader
from robot_vision.nodes.startup import run_node

if __name__ == "__main__":
    run_node("code_reader", CodeReader)
