"""The camera of images by their camera_info, also of a part of what the sensor sees."""

import copy

import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo, RegionOfInterest

from robot_vision.ros import camera_info
from robot_vision.ros.camera_info import CameraInfoListener, camera_model, image_size
from robot_vision.ros.transport import ReportedFrameError

SENSOR = CameraInfo(
    width=1280,
    height=960,
    distortion_model="plumb_bob",
    D=[0.1, 0.0, 0.0, 0.0, 0.0],
    K=[1000.0, 0.0, 640.0, 0.0, 1010.0, 480.0, 0.0, 0.0, 1.0],
    P=[900.0, 0.0, 650.0, 0.0, 0.0, 910.0, 490.0, 0.0, 0.0, 0.0, 1.0, 0.0],
)
REGION = RegionOfInterest(x_offset=100, y_offset=60, width=1001, height=400)


def sensor(**values):
    info = copy.deepcopy(SENSOR)
    for name, value in values.items():
        setattr(info, name, value)
    return info


@pytest.mark.parametrize(
    "values, size, own, straight",
    [
        ({}, (1280, 960), (1000, 640, 1010, 480), (900, 650, 910, 490)),
        (
            {"binning_x": 2, "binning_y": 4},
            (640, 240),
            (500, 320, 252.5, 120),
            (450, 325, 227.5, 122.5),
        ),
        ({"roi": REGION}, (1001, 400), (1000, 540, 1010, 420), (900, 550, 910, 430)),
        (
            {"roi": REGION, "binning_x": 2, "binning_y": 1},
            (500, 400),
            (500, 270, 1010, 420),
            (450, 275, 910, 430),
        ),
    ],
)
def test_the_camera_of_binned_pixels_and_of_a_region(values, size, own, straight):
    info = sensor(**values)
    assert image_size(info) == size
    for rectified, (fx, cx, fy, cy) in ((False, own), (True, straight)):
        camera = camera_model(info, size, rectified)
        assert (camera.width, camera.height) == size
        assert np.allclose(camera.K, [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], rtol=1e-12)
        assert list(camera.D) == ([] if rectified else SENSOR.D)


def test_a_camera_info_of_the_images_themselves_is_taken_as_it_is():
    """Some drivers tell the binning, too."""
    camera = camera_model(sensor(binning_x=2, binning_y=2), (1280, 960))
    assert np.array_equal(np.ravel(camera.K), SENSOR.K)


def test_images_of_another_size_are_refused():
    with pytest.raises(ValueError, match=r"^camera_info is of 640x480, the image 320x240$"):
        camera_model(sensor(binning_x=2, binning_y=2), (320, 240))


class Node:
    """What a CameraInfoListener uses of an ImageNode."""

    topic = "/eye/image_raw"

    def subscriber(self, _topic, _kind, callback):
        self.send = callback

    def on_idle(self, release):
        self.end_work = release


def test_a_region_that_moves_is_another_camera(monkeypatch):
    monkeypatch.setattr(camera_info, "remapped_camera_info", lambda: "/eye/camera_info")
    node = Node()
    listener = CameraInfoListener(node, "poses")
    cameras = []
    for x_offset in (100, 100, 90):
        region = copy.copy(REGION)
        region.x_offset = x_offset
        node.send(sensor(roi=region))
        cameras.append(listener.camera((1001, 400)))
    assert cameras[0] is cameras[1] and cameras[2] is not cameras[1]
    assert [camera.K[0, 2] for camera in cameras] == [540.0, 540.0, 550.0]
    node.end_work()
    assert listener.camera((1001, 400)) is None


@pytest.fixture
def clock(monkeypatch):
    """The time in s, which the test sets."""
    now = [100.0]
    monkeypatch.setattr(camera_info.time, "monotonic", lambda: now[0])
    return now


def test_a_rest_ends_what_was_said_of_the_camera_before(monkeypatch, clock):
    monkeypatch.setattr(camera_info, "remapped_camera_info", lambda: "/eye/camera_info")
    node = Node()
    listener = CameraInfoListener(node, "poses")
    waits = []
    monkeypatch.setattr(listener._arrived, "wait", waits.append)
    said = "no poses: camera_info on /eye/camera_info: "

    def asked():
        """Whether it is on its way, and the reason why a frame is refused, or an empty one."""
        assert listener.camera((1280, 960)) is None
        try:
            listener.refuse()
        except ReportedFrameError as error:
            assert str(error) == listener.problem
            return listener.is_on_its_way, str(error)
        return listener.is_on_its_way, ""

    node.send(sensor(K=[0.0] * 9))
    assert asked() == (False, said + "the camera is not calibrated")
    node.end_work()
    assert asked() == (True, "")
    listener.wait(3.0)
    clock[0] += 2.5
    assert asked() == (False, said + "there is none")
    listener.wait(4.0)
    assert waits == [3.0]
    node.send(SENSOR)
    assert listener.camera((1280, 960)) is not None
