"""Pairs of images from files: by their order, if there is nothing against it."""

import cv2
import numpy as np
import pytest

from robot_vision.recordings.image_pairs import pairs_from_files


def gray(level):
    return np.full((8, 16), level, np.uint8)


def folder_of(path, names):
    """A folder of images, each darker than the one before."""
    path.mkdir()
    for number, name in enumerate(names):
        cv2.imwrite(str(path / name), gray(200 - 10 * number))
    return str(path)


def levels(names):
    """The names of the pairs, and the gray levels of both images."""
    pairs = [(name, read()) for name, read in pairs_from_files(names)]
    return {name: (int(left[0, 0]), int(right[0, 0])) for name, (left, right) in pairs}


@pytest.mark.parametrize(
    "left, right",
    [
        (["l1.png", "l2.png"], ["r1.png", "r2.png"]),
        (["0001.png", "0002.png"], ["0001.jpg", "0002.jpg"]),
        (["cam0_07.png", "cam0_08.png"], ["cam1_07.png", "cam1_08.png"]),
        (["a.png", "b.png"], ["1.png", "2.png"]),
        (["1403636579763.png", "1403636579813.png"], ["1403636579764.png", "1403636579812.png"]),
    ],
    ids=["counted", "named alike", "of two cameras", "not counted", "times"],
)
def test_the_first_images_are_the_first_pair(tmp_path, left, right):
    names = folder_of(tmp_path / "left", left), folder_of(tmp_path / "right", right)
    found = levels(names)
    assert list(found) == [f"{names[0]}/{a} + {names[1]}/{b}" for a, b in zip(left, right)]
    assert np.allclose(list(found.values()), [(200, 200), (190, 190)], atol=2)


def test_patterns_take_pairs_from_one_folder(tmp_path):
    path = folder_of(tmp_path / "both", ["left_1.png", "left_2.png", "right_1.png", "right_2.png"])
    assert list(levels((f"{path}/left*", f"{path}/right*")).values()) == [(200, 180), (190, 170)]


def test_two_videos_end_with_the_shorter_one(tmp_path):
    names = []
    for name, count in (("left", 4), ("right", 3)):
        names.append(str(tmp_path / f"{name}.avi"))
        code = cv2.VideoWriter_fourcc(*"FFV1")
        writer = cv2.VideoWriter(names[-1], cv2.CAP_FFMPEG, code, 30, (64, 48))
        for number in range(count):
            writer.write(np.full((48, 64, 3), 50 * number, np.uint8))
        writer.release()
    found = levels(names)
    assert list(found) == [f"{names[0]}, frame {i} + {names[1]}, frame {i}" for i in range(3)]
    assert np.allclose(list(found.values()), [(50 * i, 50 * i) for i in range(3)], atol=2)


def test_names_of_files_are_shown_so_that_they_control_no_terminal(tmp_path):
    left = folder_of(tmp_path / "left", ["\x1b[2Jl.png"])
    right = folder_of(tmp_path / "right", ["r\n.png"])
    assert list(levels((left, right))) == [f"{left}/\\x1b[2Jl.png + {right}/r\\n.png"]
    right = folder_of(tmp_path / "counted", ["\x1b7.png"])
    with pytest.raises(ValueError) as error:
        levels((left, right))
    assert str(error.value).startswith(f"{left}/\\x1b[2Jl.png and {right}/\\x1b7.png are no pair: ")


def test_what_is_no_pair_is_named(tmp_path):
    left = folder_of(tmp_path / "left", ["l_1.png", "l_2.png"])
    right = folder_of(tmp_path / "right", ["r_2.png", "r_3.png"])
    one = folder_of(tmp_path / "one", ["r_1.png"])
    with pytest.raises(ValueError, match=f"{left}/l_1.png and {right}/r_2.png are no pair: no num"):
        levels((left, right))
    with pytest.raises(ValueError, match=f"{left} and {one} have 2 and 1 files, must have one"):
        levels((left, one))
    with pytest.raises(ValueError, match="/no/such: no such file or folder"):
        levels((left, "/no/such"))
