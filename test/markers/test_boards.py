"""Boards of create_marker.py: measured on the print, and cameras are calibrated by them."""

import re
import shlex
import subprocess
import sys

import cv2
import numpy as np
import pytest
import yaml
from board_views import Studio

import robot_vision as rv
from robot_vision.calibration import boards
from robot_vision.calibration.calibrate_headless import main as calibrate
from robot_vision.calibration.headless_arguments import parse_arguments
from robot_vision.markers.board import BOARDS, board_sheet, make_board
from robot_vision.markers.create_marker import main

DPI = 254  # 10 px for a mm
SIZE = (640, 480)
CAMERA = rv.CameraModel(
    *SIZE,
    np.array([[520.0, 0.0, 331.0], [0.0, 524.0, 236.0], [0.0, 0.0, 1.0]]),
    [-0.22, 0.07, 0.0008, -0.0005, 0.0],
)
DICTIONARY = ["--dictionary", "5x5_50"]
KINDS = {
    "checkerboard": ["--checkerboard", "8x6"],
    "circles": ["--circles", "7x6", "--square", 24],
    "acircles": ["--acircles", "4x9", "--square", 20.5],
    "charuco": ["--charuco", "8x6", "--square", 28],
    "charuco upright": [
        "--charuco",
        "6x9",
        "--square",
        "28",
        "--marker",
        "20",
        "--dictionary",
        "5x5_50",
    ],
}
POINTS = {"checkerboard": 48, "circles": 42, "acircles": 36, "charuco": 35, "charuco upright": 40}
A4 = (297.0, 210.0)  # mm


@pytest.fixture
def run(monkeypatch, capfd):
    """run(main, words) runs a command in this process: its exit code and its output."""

    def run_main(command, words):
        monkeypatch.setattr(sys, "argv", list(map(str, words)))
        try:
            code = command()
        except SystemExit as end:  # of argparse
            code = end.code
        return code, "".join(capfd.readouterr())

    return run_main


@pytest.fixture
def create(tmp_path, monkeypatch, run):
    """create("--circles", "7x6") runs the command in a folder of its own: exit code, output."""
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: run(main, ["create_marker.py", *arguments])


def made(result, folder):
    """The file that a run has written, and the arguments of calibrate_headless.py that it tells."""
    code, output = result
    assert code == 0, output
    (name,) = re.findall("^written: (.+)$", output, re.MULTILINE)
    (words,) = re.findall("calibrate_headless.py (.+) IMAGES$", output, re.MULTILINE)
    return folder / name, shlex.split(words)


def rendered(path):
    """The page as a gray image with 10 px for a mm."""
    if path.suffix == ".png":
        return cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    page = path.parent / "page.png"
    command = {
        ".pdf": ["pdftoppm", "-r", DPI, "-gray", "-png", "-singlefile", path, page.with_suffix("")],
        ".svg": ["rsvg-convert", "-d", DPI, "-p", DPI, path, "-o", page],
    }[path.suffix]
    subprocess.run(list(map(str, command)), check=True)
    return cv2.imread(str(page), cv2.IMREAD_GRAYSCALE)


def board_of(words):
    """What calibrate_headless.py looks for."""
    return parse_arguments([*words, "image.png"]).found


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
@pytest.mark.parametrize("kind", KINDS)
def test_each_point_of_a_board_is_where_it_should_be_to_a_tenth_of_a_millimetre(
    create, tmp_path, kind, ending
):
    path, words = made(create(*KINDS[kind], "--format", ending, "--dpi", DPI), tmp_path)
    page = rendered(path)
    sides = A4[::-1] if kind in ("acircles", "charuco upright") else A4
    assert page.shape[::-1] == pytest.approx([10 * side for side in sides], abs=1)
    # ArUco looks for markers in windows that are small beside those of 10 px for a mm.
    half = cv2.resize(page, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    found = board_of(words).find(half)
    assert len(found.points) == POINTS[kind]
    places = (found.pixels + 0.5) / 5.0  # mm
    points = 1000.0 * found.points[:, :2]
    points -= points.mean(axis=0)
    # Where a board is symmetric OpenCV may begin at either end of it.
    off = [
        np.linalg.norm(places - places.mean(axis=0) - way, axis=1).max()
        for way in (points, -points)
    ]
    assert min(off) < 0.1, off
    middle = (places.min(axis=0) + places.max(axis=0)) / 2
    # ArUco counts from the corner of the first pixel, not from its middle.
    half_pixel = 0.1 if "charuco" in kind else 0.0
    above_ruler = np.array([sides[0], sides[1] - 14.0]) / 2
    assert middle == pytest.approx(above_ruler, abs=0.1 + half_pixel)


@pytest.mark.parametrize("kind", KINDS)
def test_a_camera_is_calibrated_by_a_printed_board(create, tmp_path, run, kind):
    """By the very arguments that are told with it."""
    path, words = made(create(*KINDS[kind], "--format", "png", "--dpi", 127 * 2), tmp_path)
    page = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    # As a lens averages over the pixels of the print, of which there are more than of the camera.
    page = cv2.resize(page, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    scale, board = 127 / 25.4, board_of(words)  # px for a mm
    places = board.find(page).pixels
    square = np.linalg.norm(board.points[1] - board.points[0]) * 1000.0 * scale
    x, y, width, height = cv2.boundingRect(places)
    far = int(1.5 * square)  # it is cut out, with white around it
    around = page[max(y - far, 0) : y + height + far, max(x - far, 0) : x + width + far]
    size = [length / scale / 1000.0 for length in around.shape[::-1]]
    studio = Studio(around, CAMERA, size=size)
    images = tmp_path / "views"
    images.mkdir()
    for number in range(14):
        cv2.imwrite(str(images / f"{number:02}.png"), studio.frame())
    output = tmp_path / "eye.yaml"
    code, said = run(calibrate, ["calibrate_headless.py", *words, images, "--output", output])
    assert code == 0, said
    assert int(re.search(r"14 images: (\d+) used", said)[1]) >= 10, said
    found = yaml.safe_load(output.read_text())
    matrix = np.reshape(found["camera_matrix"]["data"], (3, 3))
    assert np.allclose(matrix, CAMERA.K, rtol=0.005), said
    assert np.allclose(found["distortion_coefficients"]["data"], CAMERA.D, atol=0.02), said


def test_a_checkerboard_s_first_square_is_black_and_it_has_one_more_than_corners():
    (part,) = make_board("checkerboard", 4, 3, 10.0).parts
    cells = part[0]
    assert cells.shape == (4, 5)
    assert np.array_equal(cells[:2, :3], [[True, False, True], [False, True, False]])


def test_defaults_of_a_charuco_board():
    board = make_board("charuco", 8, 6, 30.0)
    assert board.words.endswith("--square 0.03 --marker 0.021 --dictionary 4x4_50")
    assert (board.width, board.height, board.cell) == (240.0, 180.0, pytest.approx(21.0 / 6.0))
    assert len(board.parts) == 1 + 24


def test_a_board_lies_as_it_fits_best():
    for columns, rows, size in ((8, 6, A4), (6, 8, A4[::-1]), (6, 6, A4[::-1])):
        sheet = board_sheet(make_board("checkerboard", columns, rows, 20.0), "A4")
        assert (sheet.width, sheet.height) == size
    # 188.8x177 mm: wider than high, but a turned page has room for 176 mm above its ruler.
    sheet = board_sheet(make_board("checkerboard", 15, 14, 11.8), "A4")
    assert (sheet.width, sheet.height) == A4[::-1]


def test_larger_pages_have_room_for_larger_boards(create, tmp_path):
    path, _ = made(create("--checkerboard", "9x6", "--square", 60, "--page", "a1"), tmp_path)
    assert path.name == "checkerboard_9x6_60mm.pdf"
    info = subprocess.run(["pdfinfo", path], stdout=subprocess.PIPE, check=True, text=True).stdout
    size = re.search(r"Page size: +([\d.]+) x ([\d.]+) pts", info).groups()
    assert np.array(size, float) * 25.4 / 72.0 == pytest.approx((841.0, 594.0), abs=0.1)
    text = subprocess.run(["pdftotext", path, "-"], stdout=subprocess.PIPE, check=True, text=True)
    assert "checkerboard 9x6 60 mm" in re.sub(r"\s+", " ", text.stdout)


def test_what_belongs_to_a_board_is_what_calibrate_headless_has():
    assert set(BOARDS.values()) == set(boards.BOARDS)
    for kind in BOARDS:
        points = board_of(shlex.split(make_board(kind, 6, 5, 25.0).words)).points
        assert len(points) >= 5 * 4


@pytest.mark.parametrize(
    "arguments, code, error",
    [
        (["--checkerboard", "8x6", "0"], 2, "a board is made alone, without 0"),
        (["--checkerboard", "8x6", "-s", 5], 2, "argument -s/--size: is of tags and codes; a"),
        (["--checkerboard", "8x6", "--circles", "8x6"], 2, "not allowed with argument"),
        (["--checkerboard", "8x6", "--marker", 9], 2, "--marker and --dictionary are of --charuco"),
        (["--checkerboard", "8"], 2, "argument --checkerboard: '8' must be as 8x6, 3 to 99 each"),
        (["--checkerboard", "2x6"], 2, "'2x6' must be as 8x6, 3 to 99 each"),
        (["--checkerboard", "8x6", "--square", 0.5], 2, "0.5 must be from 1 to 300 mm"),
        (["--square", 5, "0"], 2, "argument --square: is of boards; tags and codes have --size"),
        (["--page", "A3", "0"], 2, "argument --page: invalid choice: 'A3'"),
        (
            ["--checkerboard", "11x8", "--page", "letter"],
            1,
            "the board has 300.0x225.0 mm, and on Letter there is room for 259.4x181.9 mm or "
            "195.9x245.4 mm",
        ),
        (["--charuco", "8x6", "--marker", 25], 1, "marker is 25 mm, must be less than a square"),
        (["--charuco", "8x6", "--dictionary", "9x9"], 1, "dictionary is '9x9', must be one of 4x4"),
        (
            ["--charuco", "12x9", "--square", 15],
            1,
            "dictionary 4x4_50 has 50 markers, the board 54",
        ),
        (
            ["--charuco", "8x6", "--square", 2, "--dictionary", "7x7_50"],
            1,
            "a cell of its markers has 0.16 mm, 1.8 dots at 300 dpi, must have 3 dots",
        ),
    ],
)
def test_what_cannot_be_made_is_refused(create, tmp_path, arguments, code, error):
    found, output = create(*arguments)
    assert found == code and error in output, output
    assert "Traceback" not in output and not list(tmp_path.iterdir())


def test_a_board_that_is_there_is_not_overwritten(create, tmp_path):
    old = tmp_path / "circles_7x6_24mm.svg"
    old.write_text("mine")
    arguments = ["--circles", "7x6", "--square", 24, "--format", "svg"]
    code, output = create(*arguments)
    assert code == 1 and "circles_7x6_24mm.svg is there already; --force" in output
    assert old.read_text() == "mine"
    assert create(*arguments, "--force")[0] == 0
    assert "<circle" in old.read_text()


@pytest.mark.skipif(not hasattr(cv2, "aruco"), reason="OpenCV has no aruco to take away")
def test_without_aruco_that_is_said(create, monkeypatch):
    monkeypatch.delattr(cv2, "aruco")
    code, output = create("--charuco", "8x6")
    assert code == 1 and "has no aruco, which ChArUco boards need" in output
