"""Many readers of shm, slow ones, those of other packages, and bags."""

import shutil

import cv2
import numpy as np
import pytest
import rosbag
import rospy
import support
from frames import Frames
from ros_programs import program_of
from sensor_msgs.msg import Image
from shared_images import Reader, uses_shm

MANY = 100
HOLDERS = 5  # processes that each hold eight frames: more than there is memory for
HOLD = """
import rospy
from robot_vision.transport import ImageSubscriber
rospy.init_node("hold")
held = []
number, holders = rospy.get_param("~number"), rospy.get_param("~holders")
def take(frame):
    mine = round(frame.header.stamp.to_sec() * 30) % holders == number
    if mine and len(held) < 8 and rospy.get_param("/hold", False):
        held.append(frame)
ImageSubscriber("image", take)
rospy.spin()
"""


@pytest.fixture
def camera(start):
    words = "_source:=synthetic", "_image_width:=160", "_image_height:=120", "_framerate:=30"
    start("camera_node", "__name:=shared_camera", *words)
    return "/shared_camera/image_raw"


def my_images():
    return rospy.get_name() + "_images"


def test_a_hundred_subscribers(start, camera):
    frames = [Frames(camera) for _ in range(MANY)]
    readers = [Reader(start, camera) for _ in range(4)]
    for reader in readers:
        support.Messages(reader.target, Image).wait()
    support.wait_for(lambda: uses_shm(my_images(), camera), "frames over shm")
    begin = [len(one.received) for one in frames]
    for one, count in zip(frames, begin):
        one.wait(count + 5)
    for reader in readers:
        support.wait_for(lambda one=reader: uses_shm(one.node, camera), "frames over shm")


def test_a_slow_reader_gets_whole_frames_and_delays_nobody(start, camera):
    fast = Frames(camera)
    raw = support.subscribed(camera, Image)
    slow = start("object_tracker.py", f"image:={camera}", "_always_subscribe:=true")
    fast.wait(3)
    support.wait_for(lambda: uses_shm("/object_tracker_images", camera), "the slow one's frames")
    with support.standing_still(slow):
        count = len(fast.received)
        fast.wait(count + 40)
    of_raw = {message.header.stamp: message for message in raw.received}
    both = [frame for frame in fast.received if frame.header.stamp in of_raw]
    assert both
    for frame in both:
        assert frame.image.tobytes() == of_raw[frame.header.stamp].data


def test_frames_that_are_kept_stay_as_they_are(camera):
    frames = Frames(camera)  # which keeps all of them
    support.wait_for(lambda: frames.received and uses_shm(my_images(), camera), "frames over shm")
    count = len(frames.received)
    copies = [frame.image.copy() for frame in frames.wait(count + 3)]
    kept = frames.wait(count + 60)
    for frame, copy in zip(kept, copies):
        assert np.array_equal(frame.image, copy)
    support.wait_for(lambda: uses_shm(my_images(), camera), "frames over shm at last")


def test_frames_for_which_there_is_no_memory_are_counted_and_come_again(run_script, camera):
    diagnostics = support.Diagnostics()
    assert diagnostics.value("shared_camera", "frames not shared") == "0"
    holders = [
        run_script(
            HOLD,
            f"image:={camera}",
            f"__name:=hold_{number}",
            f"_number:={number}",
            f"_holders:={HOLDERS}",
            fork=True,
        )  # each other frames
        for number in range(HOLDERS)
    ]
    for number in range(HOLDERS):  # The first frames come over raw.
        node = f"/hold_{number}_images"
        support.wait_for(lambda of=node: uses_shm(of, camera), f"frames of {node} over shm")
    rospy.set_param("/hold", True)
    support.wait_for(
        lambda: int(diagnostics.value("shared_camera", "frames not shared")) > 0,
        "frames that were not shared",
    )
    rospy.delete_param("/hold")
    for holder in holders:
        holder.kill()
        holder.exit_code()
    frames = Frames(camera)
    support.wait_for(lambda: frames.received and uses_shm(my_images(), camera), "frames over shm")
    frames.wait(len(frames.received) + 10)


def test_programs_of_other_packages_read_it(start, tmp_path, camera):
    form = str(tmp_path / "image_%04d.png")
    words = f"image:={camera}", "_image_transport:=shm", f"_filename_format:={form}"
    start(program_of("image_view", "image_saver"), *words, "__name:=saver")
    raw = support.subscribed(camera, Image)
    support.wait_for(lambda: uses_shm("/saver", camera), "frames over shm")
    seen = {file.name for file in tmp_path.glob("image_*.png")}

    def the_same():
        """Whether an image that was written while all came over shm is one that came over raw."""
        names = sorted(file.name for file in tmp_path.glob("image_*.png"))[:-1]  # which are whole
        new = [name for name in names if name not in seen]
        sent = {message.data for message in list(raw.received)}
        return any(cv2.imread(str(tmp_path / name)).tobytes() in sent for name in new)

    support.wait_for(the_same, "the same image")


def test_bags_hold_raw_and_are_played_over_raw(start, tmp_path, camera):
    path = str(tmp_path / "camera.bag")
    frames = Frames(camera)
    support.wait_for(lambda: frames.received and uses_shm(my_images(), camera), "frames over shm")
    rosbag_command = shutil.which("rosbag")
    assert start(rosbag_command, "record", "-O", path, "-l", "5", camera).exit_code() == 0
    with rosbag.Bag(path) as bag:
        recorded = {message.header.stamp: message.data for _, message, _ in bag.read_messages()}
    assert len(recorded) == 5
    frames.close()
    again = Frames("/played")
    start(rosbag_command, "play", "-l", path, f"{camera}:=/played")
    for frame in again.wait(10):
        assert frame.image.tobytes() == recorded[frame.header.stamp]
    assert support.receives_over(my_images(), "/played")
