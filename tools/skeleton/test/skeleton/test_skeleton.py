"""The measure of skeleton, on NumPy arrays."""

import numpy as np
import pytest

import robot_vision as rv


@pytest.mark.parametrize("encoding, channels", [("bgr8", 3), ("bgra8", 4)])
def test_bright_pixels_are_counted_in_every_encoding(encoding, channels):
    image = np.zeros((40, 30, channels), np.uint8)
    image[30:] = 255
    assert rv.measure_skeleton(image, encoding) == 0.25


def test_an_image_of_another_encoding_is_refused():
    with pytest.raises(ValueError, match="mono8"):
        rv.measure_skeleton(np.zeros((40, 30, 3), np.uint8), "mono8")
