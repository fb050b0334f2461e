"""light.launch: a camera and some nodes in one process, with small images."""

import numpy as np
import rospy
import support
from bond.msg import Status
from ros_programs import ROSLAUNCH
from sensor_msgs.msg import CameraInfo, Image

from robot_vision.msg import DetectionArray, GroundTruth, Line, TagDetectionArray

SIZE = (320, 240)
NODES = {  # with what each publishes
    "brightness": ("/brightness/processed_image", Image),
    "edge_detector": ("/edge_detector/processed_image", Image),
    "hsv_tracker": ("/hsv_tracker/objects", DetectionArray),
    "ball_tracker": ("/ball_tracker/objects", DetectionArray),
    "line_follower": ("/line_follower/line", Line),
    "motion_detector": ("/motion_detector/motion", DetectionArray),
    "object_tracker": ("/object_tracker/object", DetectionArray),
    "apriltag": ("/apriltag_detector/tags", TagDetectionArray),
    "code_reader": ("/code_reader/codes", DetectionArray),
    "face_detector": ("/face_detector/faces", DetectionArray),
}


def centers(truth, name):
    return [(one.center.x, one.center.y) for one in truth.objects if one.name == name]


def is_near(places, detections):
    """Whether each place has a detection within 3 px."""
    return bool(places) and all(
        any(np.hypot(one.center.x - x, one.center.y - y) < 3.0 for one in detections)
        for x, y in places
    )


def test_all_nodes_of_the_light_launch_find_what_is_in_the_scene(start):
    launch = start(
        *(ROSLAUNCH, "robot_vision", "light.launch", "source:=synthetic"),
        "nodes:=" + ",".join(NODES),
    )
    truths = support.Messages("/usb_cam/ground_truth", GroundTruth)
    infos = support.Messages("/usb_cam/camera_info", CameraInfo)
    results = {name: support.Messages(*topic) for name, topic in NODES.items()}
    (info,) = infos.wait()
    assert (info.width, info.height) == SIZE
    for name, topic in results.items():
        message = topic.wait()[0]
        assert message.header.frame_id == info.header.frame_id, name
        if isinstance(message, Image):
            assert (message.width, message.height) == SIZE, name

    def finds(name, thing):
        truth, found = support.same_frame(truths, results[name])
        return is_near(centers(truth, thing), found.detections)

    support.wait_for(lambda: finds("hsv_tracker", "ball"), "the ball's color")
    support.wait_for(lambda: finds("ball_tracker", "ball"), "the ball")
    support.wait_for(lambda: finds("apriltag", "tag_0"), "the tag")
    support.wait_for(lambda: any(line.found for line in results["line_follower"].received), "line")
    assert rospy.get_param("/usb_cam/framerate") == 15
    assert "/cmd_vel" not in dict(rospy.get_published_topics())  # no robot drives unasked
    # The manager and all loaders, one of which is the camera's. A loader that is interrupted while
    # it asks the master says that it cannot reach it; its signs of life come when it has done so.
    signs = support.Messages("/vision/bond", Status)
    bonded = len(NODES) + 2

    def senders():
        return {sign._connection_header["callerid"] for sign in signs.received}

    support.wait_for(lambda: len(senders()) == bonded, "the signs of life of all")
    launch.interrupt()
    assert launch.exit_code() == 0, launch.output()
    assert "[ERROR]" not in launch.output() and "Traceback" not in launch.output()
