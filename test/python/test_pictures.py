"""Picture files: the sensor's pixels, or the picture as people look at it."""

import cv2
import numpy as np
from exif import sideways

from robot_vision.gallery_files import decode
from robot_vision.pictures import sensor_pixels, upright


def test_the_sensor_s_pixels_are_never_turned_and_people_s_are():
    picture = np.zeros((32, 48, 3), np.uint8)
    picture[:16] = 40, 120, 200
    jpeg = cv2.imencode(".jpg", picture)[1].tobytes()
    plain = sensor_pixels(jpeg)
    assert np.array_equal(sensor_pixels(sideways(jpeg)), plain)
    for read in (upright, decode):  # the latter is that of faces
        assert np.array_equal(read(jpeg), plain)
        assert np.array_equal(read(sideways(jpeg)), np.rot90(plain, -1))


def test_what_is_no_picture_is_none():
    for data in (b"", b"no picture"):
        assert sensor_pixels(data) is None and upright(data) is None
