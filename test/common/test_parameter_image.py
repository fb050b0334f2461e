"""The image file that a parameter names: what is read, and what is refused in one line."""

import os

import cv2
import numpy as np
import pytest

from robot_vision.common.image_files import load_parameter, upright

IMAGE = np.random.default_rng(1).integers(0, 256, (20, 30, 3), np.uint8)
EXPECTED = "must be the absolute path of an image file"


def refusal(path):
    with pytest.raises(ValueError) as error:
        load_parameter("shape", str(path), upright)
    line = str(error.value)
    assert line.startswith("shape is '") and line.isprintable() and len(line) < 500, line
    return line


def test_an_image_is_read_and_decoded_as_wanted(tmp_path):
    cv2.imwrite(str(tmp_path / "a.png"), IMAGE)
    assert np.array_equal(load_parameter("shape", str(tmp_path / "a.png"), upright), IMAGE)
    cv2.imwrite(str(tmp_path / "gray.png"), IMAGE[:, :, 0])
    assert load_parameter("shape", str(tmp_path / "gray.png"), upright).shape == IMAGE.shape
    size = (tmp_path / "a.png").stat().st_size
    assert load_parameter("shape", str(tmp_path / "a.png"), len) == size


def test_what_is_no_image_is_refused(tmp_path):
    cv2.imwrite(str(tmp_path / "a.png"), IMAGE)
    whole = (tmp_path / "a.png").read_bytes()
    size = (2**31 - 1).to_bytes(4, "big")
    contents = {
        "empty": b"",
        "text": b"no image\n" * 10,
        "cut.png": whole[: len(whole) // 3],
        "huge.png": whole[:16] + size + size + whole[24:],
    }
    for name, content in contents.items():
        (tmp_path / name).write_bytes(content)
        assert f"{EXPECTED}: " in refusal(tmp_path / name)
    (tmp_path / "large").touch()
    os.truncate(str(tmp_path / "large"), 300 << 20)  # it takes no room on the disk
    assert "it has 300 MB, must have at most 256" in refusal(tmp_path / "large")


def test_what_is_no_file_is_refused(tmp_path):
    os.mkfifo(str(tmp_path / "pipe"))
    assert refusal(tmp_path / "pipe").endswith(f"{EXPECTED}: it is no file")
    assert refusal(tmp_path).endswith("it is no file")
    assert refusal("/dev/zero").endswith("it is no file")
    assert refusal(tmp_path / "none").endswith("No such file or directory")
    assert refusal("/" + "x" * 5000).endswith("File name too long")


@pytest.mark.parametrize("path", ["", "a.png", "./a.png", "~/a.png", "x" * 100000, "\n\x9b2J"])
def test_a_relative_path_is_refused_as_the_node_has_another_folder(path):
    assert refusal(path).endswith(EXPECTED)


@pytest.mark.parametrize("path", ["/a\0b", "/\udc80", "/\n\x9b2J\u202e"])
def test_a_path_that_no_file_can_have_is_refused(path):
    assert f"{EXPECTED}: " in refusal(path)
