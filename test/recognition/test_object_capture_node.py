"""object_capture.py on topics: it waits for images with depths, ends by itself, and by Ctrl-C."""

import itertools

import numpy as np
import pytest
import rospy
import support
import turntable
from frames import Source, message
from sensor_msgs.msg import CameraInfo
from textured_boxes import box

from robot_vision.meshes import Mesh
from robot_vision.recognition.database import Database, Object

VIEWS = 4


class Eye:
    """A depth camera whose stamps go on by a second from frame to frame."""

    def __init__(self):
        self._stamps = itertools.count(100)
        self._image, self._depth = Source("/eye/image_raw"), Source("/eye/depth")
        self._info = Source("/eye/camera_info", CameraInfo)
        self._calibration = CameraInfo(
            width=turntable.CAMERA.width,
            height=turntable.CAMERA.height,
            K=np.ravel(turntable.CAMERA.K).tolist(),
            D=list(turntable.CAMERA.D),
            distortion_model="plumb_bob",
        )

    def show(self, frame, with_depth=True):
        stamp = rospy.Time(next(self._stamps))
        self._info.send(self._calibration)
        for source, pixels, encoding in (
            (self._image, frame.image, "bgr8"),
            (self._depth, frame.depth, "16UC1"),
        ):
            if with_depth or encoding == "bgr8":
                sent = message(pixels, encoding)
                sent.header.stamp = stamp
                source.send(sent)

    def show_until(self, frame, process, text):
        """Shows a frame again and again, until a process has printed a text."""
        support.wait_for(lambda: self.show(frame) or text in process.output(), text)


@pytest.fixture(scope="module")
def frames():
    made = box((0.1, 0.08, 0.12), 3)
    standing = Mesh(made.vertices + np.float32([0.0, 0.0, 0.06]), made.triangles)
    return turntable.Turntable(standing).turn(VIEWS)


@pytest.fixture
def path(tmp_path):
    path = str(tmp_path / "objects.db")
    with Database(path, write=True) as database, database.transaction():
        database.objects.add(Object("thing"))
    return path


def stored(path):
    with Database(path) as database:
        return database.observations.count(database.objects.find("thing").id)


def command(path, tmp_path, *words):
    plate = turntable.write_bundle(tmp_path / "plate.yaml")
    topics = ("--image", "/eye/image_raw", "--depth", "/eye/depth")
    return ("--database", path, "thing", plate, *topics, "--views", VIEWS, "--commit", *words)


def test_it_ends_when_all_views_are_there(start, path, tmp_path, frames):
    eye = Eye()
    process = start("object_capture.py", *command(path, tmp_path))
    support.wait_for(
        lambda: eye.show(frames[0], False) or "no image comes on /eye/depth" in process.output(),
        "what is missing",
    )
    for number, frame in enumerate(frames, 1):
        eye.show_until(frame, process, f"{number} of {VIEWS} views")
    assert process.exit_code() == 0, process.output()
    assert f"{VIEWS} of {VIEWS} views, stored" in process.output()
    assert "a mesh of " in process.output()
    assert stored(path) == VIEWS


def test_ctrl_c_keeps_what_is_there(start, path, tmp_path, frames):
    eye = Eye()
    process = start("object_capture.py", *command(path, tmp_path, "--no-mesh"))
    support.wait_for(lambda: eye.show(frames[0]) or stored(path) == 1, "a view")
    process.interrupt()
    assert process.exit_code() == 130, process.output()
    assert f"interrupted; 1 of {VIEWS} views, missing at 90-270 degrees, stored" in process.output()
    assert stored(path) == 1


def test_without_a_calibration_it_says_so(start, path, tmp_path):
    process = start("object_capture.py", *command(path, tmp_path))
    assert process.exit_code() == 1
    assert "no camera_info comes on /eye/camera_info" in process.output()
