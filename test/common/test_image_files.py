"""Image files are read as the sensor's pixels, or upright as people look at them."""

import struct

import cv2
import numpy as np
import pytest
from exif import sideways

from robot_vision._core import decode_image_file
from robot_vision.common.image_files import sensor_pixels, upright
from robot_vision.recordings.gray_images import gray_file


def test_only_upright_images_are_rotated_by_exif():
    image = np.zeros((32, 48, 3), np.uint8)
    image[:16] = 40, 120, 200
    jpeg = cv2.imencode(".jpg", image)[1].tobytes()
    plain = sensor_pixels(jpeg)
    assert np.array_equal(sensor_pixels(sideways(jpeg)), plain)
    assert np.array_equal(upright(jpeg), plain)
    assert np.array_equal(upright(sideways(jpeg)), np.rot90(plain, -1))


def test_file_that_claims_to_fill_the_memory_is_refused():
    """A file of some hundred kilobytes may have 30000 x 30000 px."""
    image = cv2.imencode(".png", np.zeros((4, 4, 3), np.uint8))[1].tobytes()
    bomb = image[:16] + struct.pack(">II", 30000, 30000) + image[24:]
    for read in (sensor_pixels, upright, gray_file):
        with pytest.raises(ValueError, match="claims to be of 30000x30000, the most is 67108864"):
            read(bomb)


@pytest.mark.parametrize("data", [b"", b"no image"])
@pytest.mark.parametrize("read", [sensor_pixels, upright, gray_file])
def test_other_files_are_refused(read, data):
    with pytest.raises(ValueError, match=r"^no image that OpenCV can read$"):
        read(data)


def test_bytes_that_are_not_contiguous_are_refused():
    with pytest.raises(ValueError, match="bytes in a row"):
        decode_image_file(np.zeros(100, np.uint8)[::-1], cv2.IMREAD_COLOR)
