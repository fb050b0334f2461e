#!/usr/bin/env python3
"""Prints a line per node and second from /diagnostics: rate, age, processing time, state."""

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from robot_vision.nodes.startup import run_node

TOPICS = (
    "/usb_cam/image_raw",
    "/brightness/processed_image",
    "/edge_detector/processed_image",
)


def line(status: DiagnosticStatus) -> str:
    """The status of one node as one line of text."""
    values = {pair.key: pair.value for pair in status.values}
    return "{:<14} {:>6} Hz  age {:>8} ms  processing {:>8} ms  {}".format(
        status.name.split(":")[0],
        values.get("output rate (Hz)", "?"),
        values.get("output age (ms)", "?"),
        values.get("processing time (ms)", "?"),
        status.message,
    )


def on_diagnostics(message: DiagnosticArray) -> None:
    for status in message.status:
        print(line(status), flush=True)


def start() -> rospy.Subscriber:
    """Says where to look, and from then on prints what the nodes report."""
    if not rospy.get_param("~view", False):
        print("No display: look at these topics, for instance with")
        print("  rosrun image_view image_view image:=" + TOPICS[-1])
        print(*("  " + topic for topic in TOPICS), sep="\n", flush=True)
    return rospy.Subscriber("/diagnostics", DiagnosticArray, on_diagnostics, queue_size=10)


if __name__ == "__main__":
    run_node("demo_status", start)
