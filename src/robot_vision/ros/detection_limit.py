"""How many detections of a message a node looks at."""

from typing import List

import rospy

from ..msg import Detection

MAX_DETECTIONS = 100  # of a message


def best_detections(detections: List[Detection]) -> List[Detection]:
    """Returns the detections, or of too many, with a warning, those of the highest score.

    A node that spends time on each would be stopped by a single message otherwise.
    """
    if len(detections) <= MAX_DETECTIONS:
        return detections
    rospy.logwarn_throttle(
        10.0,
        f"{len(detections)} detections in a message: only the {MAX_DETECTIONS} of the highest "
        "score are looked at",
    )
    return sorted(detections, key=lambda one: one.score, reverse=True)[:MAX_DETECTIONS]
