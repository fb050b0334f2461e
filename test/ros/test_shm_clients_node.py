"""What images over shm go together with: camera_info, simulated time, windows, diagnostics."""

import numpy as np
import pytest
import rospy
import support
from frames import Frames
from ros_programs import program_of
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image
from shared_images import uses_shm

from robot_vision.transport import CameraSubscriber

SIZE = 160, 120


@pytest.fixture
def camera(start):
    size = f"_image_width:={SIZE[0]}", f"_image_height:={SIZE[1]}"
    start("camera_node", "__name:=shm_client_camera", "_source:=synthetic", "_framerate:=50", *size)
    return "/shm_client_camera/image_raw"


def my_images():
    return rospy.get_name() + "_images"


def test_images_come_with_their_camera_info(camera):
    frames = Frames(camera, kind=CameraSubscriber)
    support.wait_for(lambda: frames.received and uses_shm(my_images(), camera), "frames over shm")
    for frame in frames.wait(len(frames.received) + 5)[-5:]:
        assert frame.camera_info.header.stamp == frame.header.stamp
        assert (frame.camera_info.width, frame.camera_info.height) == SIZE


def test_no_frames_count_as_lost_where_shm_takes_over(start, camera):
    """The publisher numbers the frames of each transport by itself; those of shm are ahead here."""
    frames = Frames(camera)
    support.wait_for(lambda: uses_shm(my_images(), camera), "frames over shm")
    frames.wait(150)
    diagnostics = support.Diagnostics()

    def sent():
        return int(diagnostics.value("shm_client_camera", "frames published"))

    before = sent()
    words = f"image:={camera}", "_always_subscribe:=true", "_diagnostic_period:=0.1"
    start("edge_detector_node", "__name:=shm_counter", *words)
    support.wait_for(lambda: uses_shm("/shm_counter", camera), "frames over shm")
    first = int(diagnostics.value("shm_counter", "frames received"))
    support.wait_for(
        lambda: int(diagnostics.value("shm_counter", "frames received")) > first + 5, "frames"
    )
    values = {pair.key: pair.value for pair in diagnostics.next("shm_counter").values}
    counted = sum(int(values["frames " + what]) for what in ("received", "dropped"))
    assert counted <= sent() - before + 100  # a takeover that counted would add 150


def test_a_frame_comes_also_while_simulated_time_stands_still(start):
    clock = rospy.Publisher("/clock", Clock, queue_size=1, latch=True)
    clock.publish(Clock(rospy.Time(1234, 500000000)))
    rospy.set_param("/use_sim_time", True)
    try:
        words = "_source:=synthetic", "_image_width:=160", "_image_height:=120"
        start("camera_node", "__name:=simulated_camera", *words)
        topic = "/simulated_camera/image_raw"
        start("motion_detector.py", "__name:=late", f"image:={topic}", "_always_subscribe:=true")
        support.wait_for(lambda: uses_shm("/late_images", topic), "frames over shm")
        diagnostics = support.Diagnostics()
        first = int(diagnostics.value("late", "frames received"))
        support.wait_for(
            lambda: int(diagnostics.value("late", "frames received")) > first + 5, "frames"
        )
    finally:
        rospy.delete_param("/use_sim_time")
        clock.unregister()


def test_image_view_shows_it(start, display, camera):
    words = f"image:={camera}", "_image_transport:=shm", "__name:=shm_viewer"
    start(program_of("image_view", "image_view"), *words)
    support.wait_for(lambda: uses_shm("/shm_viewer", camera), "frames over shm")
    support.wait_for(lambda: any(camera in name for name in support.windows()), "the window")
    support.wait_for(
        lambda: len(np.unique(support.screen(display))) > 50, "the image of the camera"
    )


def test_two_topics_that_are_exchanged_by_their_names(start, camera):
    """What was remapped is not remapped again, over either transport."""
    other = "/shm_other_camera/image_raw"
    words = "_source:=synthetic", "_image_width:=80", "_image_height:=64", "_framerate:=50"
    start("camera_node", "__name:=shm_other_camera", *words)
    exchanged = f"{camera}:={other}", f"{other}:={camera}"
    node, out = "/shm_exchanged", "/shm_exchanged/processed_image"
    result = support.Messages(out, Image)
    start("edge_detector_node", "__name:=shm_exchanged", f"image:={camera}", *exchanged)
    support.wait_for(lambda: uses_shm(node, camera), "frames over shm")
    count = len(result.received)
    assert (result.wait(count + 3)[-1].width, result.received[0].width) == (SIZE[0], SIZE[0])


def test_python_nodes_tell_what_they_could_not_share(start, camera):
    start("motion_detector.py", "__name:=sharing", f"image:={camera}", "_always_subscribe:=true")
    assert support.Diagnostics().value("sharing", "frames not shared") == "0"
