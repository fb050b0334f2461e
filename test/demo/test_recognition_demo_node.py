"""The demo with recognition: its things are learned at its start, and found on their table."""

import numpy as np
import support
from ros_programs import ROSLAUNCH
from tag_studio import matrix_of

from robot_vision.msg import DetectionArray, GroundTruth, RecognizedObjectArray

PLACE = 0.01  # m, by which a thing may be off
TABLE = "/table/camera/ground_truth"


def test_demo_recognizes_the_things_on_its_table(start, tmp_path):
    words = "demo.launch", "recognition:=true"
    demo = start(ROSLAUNCH, "robot_vision", *words, env={"ROS_HOME": str(tmp_path)})
    demo.wait_for_output("object_recognizer ", 2 * support.DEADLINE)
    truths = support.Messages(TABLE, GroundTruth)
    names = support.Messages("/object_recognizer/detections", DetectionArray)
    objects = support.Messages("/object_recognizer/recognized_object_array", RecognizedObjectArray)

    def most_are_found():
        truth, named, placed = support.same_frame(truths, names, objects)
        for topic in (truths, names, objects):
            topic.received.clear()
        there = {one.name: matrix_of(one.pose)[:3, 3] for one in truth.objects}
        found = {
            detection.label: matrix_of(one.pose.pose.pose)[:3, 3]
            for detection, one in zip(named.detections, placed.objects)
        }
        right = {name for name in found if np.linalg.norm(found[name] - there[name]) < PLACE}
        return right == found.keys() and len(right) >= 5

    support.wait_for(most_are_found, "five things, and no other", 2 * support.DEADLINE)
    assert (tmp_path / "robot_vision_demo_objects.db").is_file()
    demo.interrupt()
    assert demo.exit_code() == 0, demo.output()
