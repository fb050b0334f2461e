"""What an import loads: libraries that bring many others along come when they are used."""

import subprocess
import sys

import pytest

SCRIPT = """
import robot_vision.{module}

def loaded():
    with open("/proc/self/maps", encoding="utf-8") as maps:
        text = maps.read()
    names = "opencv_imgcodecs", "opencv_videoio", "avcodec", "gdal", "cv_bridge"
    return [name for name in names if "/lib" + name in text]

print(loaded())
{use}
print(loaded())
"""
READ_PNG = """
import struct, zlib
from robot_vision._core import decode_image_file

def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

header, row = struct.pack(">IIBBBBB", 2, 1, 8, 0, 0, 0, 0), zlib.compress(bytes([0, 7, 9]))
png = b"\\x89PNG\\r\\n\\x1a\\n" + chunk(b"IHDR", header) + chunk(b"IDAT", row) + chunk(b"IEND", b"")
image = decode_image_file(png, 1)  # in color, and turned as its EXIF data says
assert image.tolist() == [[[7] * 3, [9] * 3]], image
"""
READ_PGM = """
from robot_vision._core import decode_image_file
image = decode_image_file(b"P5 2 1 255 \\x07\\x09", 0)
assert image.tolist() == [[7, 9]], image
"""


def printed(module, use=""):
    script = SCRIPT.format(module=module, use=use)
    command = [sys.executable, "-c", script]
    return subprocess.run(command, check=True, capture_output=True, encoding="utf-8").stdout


@pytest.mark.parametrize("module", ["_core", "_transport", "dashboard.dashboard"])
def test_an_import_loads_no_readers_of_files_and_videos(module):
    assert printed(module) == "[]\n[]\n"


def test_a_png_is_read_without_them():
    assert printed("_core", READ_PNG) == "[]\n[]\n"


def test_another_file_has_them_loaded():
    before, after = printed("_core", READ_PGM).splitlines()
    assert before == "[]" and "opencv_imgcodecs" in after
