"""Recorded images of every encoding become the gray pixels that the sensor saw."""

import struct

import cv2
import numpy as np
import pytest
from exif import sideways
from frames import message
from sensor_msgs.msg import CompressedImage

from robot_vision.recordings.gray_images import gray_file, gray_message
from robot_vision.recordings.recorded_images import from_files


@pytest.fixture
def gray():
    """Smooth, from black to white, 48x32."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, 48), np.linspace(0.0, 1.0, 32))
    image = np.rint(255.0 * (x + y) / 2.0).astype(np.uint8)
    assert (image.min(), image.max()) == (0, 255)
    return image


def repeated(gray, channels):
    return np.repeat(gray[:, :, None], channels, axis=2)


def wide(gray, factor):
    return gray.astype(np.uint16) * factor


def yuv(gray, luma):
    """Two bytes to a pixel, no color; the luma is at index `luma`."""
    pixels = np.full((*gray.shape, 2), 128, np.uint8)
    pixels[:, :, luma] = gray
    return pixels


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize(
    "encoding, pixels",
    [
        ("mono8", lambda gray: gray),
        ("8UC1", lambda gray: gray),
        ("8UC3", lambda gray: repeated(gray, 3)),
        ("rgb8", lambda gray: repeated(gray, 3)),
        ("bgra8", lambda gray: repeated(gray, 4)),
        ("mono16", lambda gray: wide(gray, 257)),
        ("mono16", lambda gray: wide(gray, 4)),
        ("16UC1", lambda gray: wide(gray, 16) + 500),
        ("bayer_rggb16", lambda gray: wide(gray, 16)),
        ("bayer_gbrg8", lambda gray: gray),
        ("yuv422", lambda gray: yuv(gray, 1)),
        ("yuv422_yuy2", lambda gray: yuv(gray, 0)),
    ],
)
def test_messages(gray, encoding, pixels, order):
    """Sixteen bits are stretched: cameras of 10 or 12 bits are dark otherwise."""
    found = gray_message(message(pixels(gray), encoding, padding=6, order=order))
    assert found.dtype == np.uint8
    assert np.abs(found.astype(int) - gray)[1:-1, 1:-1].max() <= (6 if "bayer" in encoding else 1)


def test_compressed_messages(gray):
    sent = cv2.imencode(".png", wide(gray, 16))[1].tobytes()
    found = gray_message(CompressedImage(format="mono16; png compressed ", data=sent))
    assert np.abs(found.astype(int) - gray).max() <= 1
    mosaic = gray.copy()
    mosaic[0::2, 0::2] = mosaic[1::2, 1::2] = 0  # green only
    sent = cv2.imencode(".png", mosaic)[1].tobytes()
    label = "bayer_rggb8; png compressed "
    found = gray_message(CompressedImage(format=label, data=sent))[2:-2, 2:-2]
    assert np.abs(found - 0.587 * gray[2:-2, 2:-2]).max() < 6.0  # no mosaic any more


def test_images_are_not_turned(gray):
    """As the lens bends them, whatever side of the camera was up."""
    jpeg = sideways(cv2.imencode(".jpg", gray)[1].tobytes())
    turned = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert turned.shape == gray.shape[::-1]
    for found in (gray_file(jpeg), gray_message(CompressedImage(format="jpeg", data=jpeg))):
        assert found.shape == gray.shape
        assert np.abs(found.astype(int) - gray).max() < 10


def test_videos_are_not_turned(gray, tmp_path):
    plain, turned = tmp_path / "plain.mp4", tmp_path / "turned.mp4"
    writer = cv2.VideoWriter(
        str(plain), cv2.CAP_FFMPEG, cv2.VideoWriter_fourcc(*"mp4v"), 30, gray.shape[::-1]
    )
    for _ in range(3):
        writer.write(repeated(gray, 3))
    writer.release()
    # The display matrix of the track header: the fixed-point numbers of no turn and a quarter turn.
    one, minus = struct.pack(">i", 1 << 16), struct.pack(">i", -(1 << 16))
    none, w = bytes(4), struct.pack(">i", 1 << 30)
    upright = one + none * 3 + one + none * 3 + w
    data = plain.read_bytes()
    track = data.index(upright, data.index(b"tkhd"))
    quarter = none + one + none + minus + none * 4 + w
    turned.write_bytes(data[:track] + quarter + data[track + len(quarter) :])
    if hasattr(cv2, "CAP_PROP_ORIENTATION_AUTO"):
        video = cv2.VideoCapture(str(turned), cv2.CAP_FFMPEG)
        assert video.read()[1].shape[:2] == gray.shape[::-1]
    images = [read() for _, read in from_files([str(turned)])]
    assert [image.shape for image in images] == [gray.shape] * 3
