"""create_marker.py: what it prints is measured, detected and read."""

import functools
import os
import pathlib
import re
import shlex
import struct
import subprocess
import sys
from typing import NamedTuple

import cv2
import numpy as np
import pytest
import roslib.packages
import yaml

import robot_vision as rv
from robot_vision.markers.arguments import EXAMPLES
from robot_vision.markers.create_marker import main
from robot_vision.markers.drawing import runs
from robot_vision.markers.marker import qr_modules
from robot_vision.markers.sheet import fitting

DPI = 508  # of what is rendered here: 20 px for a mm
MM = DPI / 25.4
COARSE = 254  # dpi, where a pixel more or less changes nothing
FAMILIES = [family.name for family in rv.tag_families()]


class Result(NamedTuple):
    returncode: int
    stdout: str
    stderr: str


@pytest.fixture
def create(tmp_path, monkeypatch, capfd):
    """create("-s", 5, 0) runs the command in a folder of its own."""

    def run(*arguments):
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["create_marker.py", *map(str, arguments)])
        try:
            code = main()
        except SystemExit as end:  # of argparse
            code = end.code
        return Result(code, *capfd.readouterr())

    return run


def made(result, folder):
    """The files that a run has written, which it names and which are all there is."""
    assert result.returncode == 0, result.stderr
    names = re.findall("^written: (.+)$", result.stdout, re.MULTILINE)
    assert sorted(os.listdir(folder)) == sorted(names)
    return [folder / name for name in names]


def rendered(path, dpi=DPI):
    """The pages of a file as gray images, and their pixels per mm."""
    if path.suffix == ".png":
        data = path.read_bytes()
        per_metre, also, unit = struct.unpack(">IIB", data[data.index(b"pHYs") + 4 :][:9])
        assert (also, unit) == (per_metre, 1)
        return [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)], per_metre / 1000.0
    folder = path.parent / (path.name + ".rendered")
    folder.mkdir()
    command = {
        ".pdf": ["pdftoppm", "-r", str(dpi), "-gray", path, folder / "page"],
        ".svg": ["rsvg-convert", "-d", str(dpi), "-p", str(dpi), path, "-o", folder / "page.png"],
    }[path.suffix]
    subprocess.run(command, check=True)
    pages = [cv2.imread(str(page), cv2.IMREAD_GRAYSCALE) for page in sorted(folder.iterdir())]
    return pages, dpi / 25.4


def box_of_ink(image):
    """x, y, width and height of what is black, px; edges count as far as they are gray."""
    ink = 255.0 - image
    columns, rows = ink.max(axis=0) / 255.0, ink.max(axis=1) / 255.0
    (x, width), (y, height) = ((np.argmax(line > 0.5), line.sum()) for line in (columns, rows))
    return x, y, width, height


def cells_of(image, number):
    """The middles of so many cells to a side, True where they are black."""
    places = ((np.arange(number) + 0.5) * len(image) / number).astype(int)
    return image[np.ix_(places, places)] < 128


@functools.lru_cache(maxsize=None)
def detector_of(family):
    """The tables of a large family take longer to make than all searches."""
    params = rv.TagDetectorParams()
    params.families = [family]
    return rv.TagDetector(params)


def tags_in(image, family):
    """Corners (4, 2) by id of the tags in an image, to which some white around it is added."""
    white = cv2.copyMakeBorder(image, *[20] * 4, cv2.BORDER_CONSTANT, value=255)
    tags = detector_of(family).detect(white, "mono8")
    assert all(tag.hamming == 0 for tag in tags)
    assert len({tag.id for tag in tags}) == len(tags)
    return {tag.id: tag.corners - 20 for tag in tags}


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
@pytest.mark.parametrize("size, id", [(2, 0), (5, 1), (9, 586), (14.37, 100)])
def test_a_tag_is_of_its_size_to_a_tenth_of_a_millimetre(create, tmp_path, ending, size, id):
    (path,) = made(create("-s", size, "-o", f"tag.{ending}", id), tmp_path)
    (image,), scale = rendered(path)
    whole = size * 10 * 10 / 8  # mm, with the white around it
    assert np.array(image.shape) / scale == pytest.approx((whole, whole), abs=0.1)
    box = np.array(box_of_ink(image)) / scale
    expected = (whole - size * 10) / 2, (whole - size * 10) / 2, size * 10, size * 10
    assert box == pytest.approx(expected, abs=0.06)  # 0.1 mm, and no more than a pixel less
    assert np.array_equal(cells_of(image, 10), rv.tag_cells("tag36h11", id) == 0)
    assert list(tags_in(cv2.resize(image, (400, 400)), "tag36h11")) == [id]


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_every_family_is_printed_cell_by_cell(create, tmp_path, family, ending):
    facts = rv.tag_family(family)
    white = 1 if facts.width - facts.width_at_border > 2 else 0  # around what has a meaning
    for id in (0, 17, facts.ids - 1):
        result = create("-s", 4, "--family", family, "-o", f"{id}.{ending}", id)
        assert result.returncode == 0, result.stderr
        (image,), scale = rendered(tmp_path / f"{id}.{ending}", COARSE)
        number = facts.width + 2 * white
        assert len(image) / scale == pytest.approx(number * 40 / facts.width_at_border, abs=0.1)
        expected = np.pad(rv.tag_cells(family, id) < 255, white)
        assert np.array_equal(cells_of(image, number), expected)
        small = cv2.resize(image, (300, 300), interpolation=cv2.INTER_AREA)
        assert list(tags_in(small, family)) == [id]


def test_png_edges_are_sharp(create, tmp_path):
    (path,) = made(create("-s", 5, "--dpi", 150, 3), tmp_path)
    assert path.name == "tag36h11_3.png"
    (image,), scale = rendered(path)
    assert scale == pytest.approx(150 / 25.4, abs=1e-3)
    assert set(np.unique(image)) == {0, 255}


@pytest.mark.parametrize("page, size", [("A4", (210, 297)), ("letter", (215.9, 279.4))])
def test_a_sheet_has_all_tags_and_a_ruler_in_their_sizes(create, tmp_path, page, size):
    (path,) = made(create("-s", 4, "--page", page, "0-10,37"), tmp_path)
    assert path.name == "tag36h11_0-10_37.pdf"
    (image,), scale = rendered(path)
    assert np.array(image.shape[::-1]) / scale == pytest.approx(size, abs=0.1)
    quarter = cv2.resize(image, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)
    tags = tags_in(quarter, "tag36h11")
    assert sorted(tags) == [*range(11), 37]
    for id, corners in tags.items():
        x, y = (corners.min(axis=0) * 4 - 2 * scale).astype(int)
        around = image[y : y + int(44 * scale), x : x + int(44 * scale)]
        box = np.array(box_of_ink(around)) / scale
        assert box[2:] == pytest.approx((40, 40), abs=0.1), id
        marks = cut_marks(image, x / scale + box[0] - 5, y / scale + box[1] - 5, 50, 55)
        assert all(marks), (id, marks)
    words = " ".join(text_of(path))
    for id in tags:
        assert f"tag36h11 id {id} 40 mm" in words
    assert "Print at 100 %, then measure this ruler." in words
    line = image[-int(11.5 * scale), : int(113 * scale)] < 128  # across the ruler's ticks
    ticks = np.flatnonzero(np.diff(line.astype(int)) > 0) / scale
    assert np.diff(ticks) == pytest.approx([10] * 10, abs=0.06)
    assert ticks[-1] - ticks[0] == pytest.approx(100, abs=0.1)


def cut_marks(image, left, top, width, height):
    """Whether there is ink on the lines through each corner of a rectangle, outside of it; mm."""
    for x, across in ((left, -1), (left + width, 1)):
        for y, down in ((top, -1), (top + height, 1)):
            for place in ((x + 2 * across, y), (x, y + 2 * down)):
                column, row = np.rint(np.array(place) * MM).astype(int)
                yield (image[row - 1 : row + 2, column - 1 : column + 2] < 128).any()


def text_of(path):
    command = ["pdftotext", "-layout", str(path), "-"]
    return subprocess.run(command, stdout=subprocess.PIPE, check=True, text=True).stdout.split()


def test_a_sheet_is_followed_by_more_sheets(create, tmp_path):
    (path,) = made(create("-s", 6, "0-13"), tmp_path)
    pages, _ = rendered(path)
    small = [cv2.resize(page, None, fx=0.3, fy=0.3) for page in pages]
    ids = [sorted(tags_in(page, "tag36h11")) for page in small]
    assert ids == [[0, 1, 2, 3, 4, 5], [6, 7, 8, 9, 10, 11], [12, 13]]


@pytest.mark.parametrize("ending", ["png", "svg"])
def test_images_of_sheets_are_a_file_each(create, tmp_path, ending):
    paths = made(create("-s", 6, "--format", ending, "--dpi", 150, 0, "2-7"), tmp_path)
    assert [path.name for path in paths] == [
        f"tag36h11_0_tag36h11_2-7-{n}.{ending}" for n in (1, 2)
    ]
    pages = [page for path in paths for page in rendered(path, COARSE)[0]]
    small = [cv2.resize(page, (1050, 1485), interpolation=cv2.INTER_AREA) for page in pages]
    assert [sorted(tags_in(page, "tag36h11")) for page in small] == [[0, 2, 3, 4, 5, 6], [7]]


TEXTS = [
    "http://wiki.ros.org/robot_vision",
    "1234",
    "<&>\n\t",
    "x" * 300,
    "--page",
    "a b",
]


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
@pytest.mark.parametrize("page", [(), ("--page", "A4", "--dpi", COARSE)])
def test_a_text_becomes_a_qr_code(create, tmp_path, ending, page):
    reader = rv.CodeReader()
    for number, text in enumerate(TEXTS):
        result = create("-s", 5, "--qr", "-o", f"{number}.{ending}", *page, "--", text)
        assert result.returncode == 0, result.stderr
        (image,), scale = rendered(tmp_path / f"{number}.{ending}", COARSE if page else DPI)
        small = cv2.resize(image, None, fx=0.7, fy=0.7, interpolation=cv2.INTER_AREA)
        (code,) = reader.read(small, "mono8")
        assert (code.type, code.data) == ("qr", text.encode())
        if not page:
            box = np.array(box_of_ink(image)) / scale
            assert box[2:] == pytest.approx((50, 50), abs=0.1)
            white = 4 * 50 / len(qr_modules(text.encode()))
            assert box[:2] == pytest.approx((white, white), abs=0.1)
            assert len(image) / scale == pytest.approx(50 + 2 * white, abs=0.1)


@pytest.mark.skipif(not rv.keeps_bytes(), reason="zbar is older than 0.23.1")
def test_any_text_and_any_bytes_become_a_qr_code(create, tmp_path):
    for name, data in (("text.png", "Grüße, 世界".encode()), ("bytes.png", bytes(range(1, 256)))):
        assert create("-o", name, "--page", "A4", os.fsdecode(data)).returncode == 0
        (image,), _ = rendered(tmp_path / name)
        assert [code.data for code in rv.CodeReader().read(image, "mono8")] == [data]


def test_the_level_of_a_qr_code_is_how_much_of_it_may_be_lost(create, tmp_path):
    text = "Much is lost, and still it is read."
    modules = []
    for level in "LMQH":
        assert create("--level", level, "-o", f"{level}.svg", text).returncode == 0
        width = re.search(r'width="([\d.]+)mm"', (tmp_path / f"{level}.svg").read_text()).group(1)
        modules.append(8 * 100 / (float(width) - 100))  # eight are white, and the others 100 mm
    assert modules == pytest.approx([29, 29, 33, 37], abs=0.01)
    assert create("--level", "H", "-o", "covered.png", text).returncode == 0
    (image,), _ = rendered(tmp_path / "covered.png")
    middle = slice(len(image) // 2 - 150, len(image) // 2 + 150)
    image[middle, middle] = 255
    assert rv.CodeReader().read(image, "mono8")[0].data == text.encode()


@pytest.mark.parametrize(
    "arguments, code, text",
    [
        (["587"], 1, "id is 587, tag36h11 has 0 to 586; --qr makes a QR code of it"),
        (["--family", "tag16h5", "25-30"], 1, "id is 30, tag16h5 has 0 to 29"),
        (["99999999999999999999"], 1, "id is 99999999999999999999, tag36h11 has 0 to 586"),
        (["0-99999999999"], 1, "id is 99999999999, tag36h11 has"),
        (["5-3"], 1, "ids is '5-3', must have the lower id of 5-3 first"),
        (["1,,2"], 1, "ids is '1,,2', must be a list such as 0,3,7-9; --qr makes a QR code of it"),
        (["1 2"], 1, "ids is '1 2', must be a list"),
        (["-5"], 1, "ids is '-5', must be a list"),
        ([""], 1, "an empty text needs no QR code"),
        (["--qr", "x" * 2332], 1, "2332 bytes fit no QR code of level M"),
        (["--family", "tag36h10", "0"], 2, "argument --family: invalid choice: 'tag36h10'"),
        (
            ["-s", "15.3", "--page", "A4", "0"],
            1,
            "a marker is 191.2 mm wide with the white around it, and on A4 there is room for 190.0",
        ),
        (["-s", "20", "0", "1"], 1, "a marker is 250.0 mm wide with the white"),
        (["-s", "0", "0"], 2, "argument -s/--size: 0 must be from 0.5 to 300"),
        (["-s", "nan", "0"], 2, "argument -s/--size: nan must be from 0.5 to 300"),
        (["-s", "five", "0"], 2, "argument -s/--size: invalid number value: 'five'"),
        (["--dpi", "72", "0"], 2, "argument --dpi: 72 must be from 150 to 1200"),
        (["--dpi", "1200", "-s", "100", "0"], 1, "at 1200 dpi it is 59055x59055 px, must be at"),
        (["-o", "tag.jpg", "0"], 1, "tag.jpg must end in .png, .svg or .pdf"),
        (
            ["-o", "a.png", "--format", "pdf", "0"],
            1,
            "a.png is no name of a file of the format pdf",
        ),
        (
            ["-o", "no/such/tag.png", "0"],
            1,
            "no/such/tag.png cannot be written: No such file or directory",
        ),
        (["--page", "A3", "0"], 2, "argument --page: invalid choice: 'A3'"),
        ([], 2, "the following arguments are required: what"),
    ],
)
def test_what_cannot_be_made_is_refused(create, tmp_path, arguments, code, text):
    result = create(*arguments)
    assert (result.returncode, result.stdout) == (code, "")
    assert f"create_marker.py: {'error: ' if code == 2 else ''}{text}" in result.stderr
    assert "Traceback" not in result.stderr
    assert not os.listdir(tmp_path)


@pytest.mark.parametrize("family", FAMILIES)
def test_the_size_told_is_that_between_the_corners_that_are_detected(create, tmp_path, family):
    result = create("-s", 6.4, "--family", family, 1)
    (told,) = re.findall(
        r"^tag_size: ([\d.]+)  # m, side of (.+), for", result.stdout, re.MULTILINE
    )
    is_classic = family in ("tag36h11", "tag25h9", "tag16h5")
    assert told[1] == ("the black square" if is_classic else "the square inside the black frame")
    (image,), scale = rendered(tmp_path / f"{family}_1.png")
    corners = tags_in(image, family)[1] / scale / 1000
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    assert sides == pytest.approx([float(told[0])] * 4, abs=2e-4)
    ink = np.array(box_of_ink(image)[2:]) / scale / 1000
    assert not is_classic or ink == pytest.approx([float(told[0])] * 2, abs=1e-4)


def test_the_default_size_is_that_of_the_detector(create):
    checkout = pathlib.Path(__file__).resolve().parents[2]
    config = checkout / "config" / "apriltag_detector.yaml"
    tag_size = yaml.safe_load(config.read_text())["tag_size"]
    assert f"\ntag_size: {tag_size:g}  # m" in create(0, "hello").stdout
    assert "tag_size" not in create("hello").stdout


def test_qr_codes_that_are_hard_to_read_are_told(create, tmp_path):
    text = "x" * 300  # 69 modules of level M
    result = create("-s", 2.5, "-o", "small.png", text)
    assert "a cell has 0.36 mm, and few cameras read less than 0.4 mm: take a --size of 2.8, " in (
        result.stderr
    )
    result = create("-s", 2.8, "-o", "good.png", text)
    assert (result.returncode, result.stderr) == (0, "")
    result = create("-s", 1.7, "-o", "tiny.pdf", text)
    assert result.returncode == 1 and not (tmp_path / "tiny.pdf").exists()
    assert (
        ": a cell has 0.25 mm, 2.9 dots at 300 dpi, must have 3 dots: take a --size of 1.8, "
        in (result.stderr)
    )
    # As small as it may be, it can be read off the image.
    assert create("-s", 1.8, "-o", "least.png", text).returncode == 0
    (image,), _ = rendered(tmp_path / "least.png")
    assert [code.data for code in rv.CodeReader().read(image, "mono8")] == [text.encode()]


def test_forgotten_quotes_are_told(create, tmp_path):
    for words in (("hello", "big", "world"), ("room", 12)):
        result = create(*words)
        assert result.returncode == 0
        quoted = f"'{' '.join(map(str, words))}'"
        assert f"each of the {len(words)} words has become a marker" in result.stderr
        assert result.stderr.endswith(f"for one QR code write {quoted}\n")
    for words in (["hello big world"], ["hello"], [1, 2]):
        assert create("--force", *words).stderr == ""


def test_labels_are_no_wider_than_their_marker():
    for text, letter in (("x" * 40, 0.6), ("世界" * 20, 1.0)):
        assert fitting(text, 0.0, 0.0, 20.0).size * letter * 40 == pytest.approx(20.0)
    assert fitting("short", 0.0, 0.0, 20.0).size == 3.0


def test_no_file_is_overwritten_without_force(create, tmp_path):
    old = tmp_path / "tag36h11_0.png"
    old.write_text("mine")
    result = create(0)
    assert result.returncode == 1
    assert result.stderr == (
        "create_marker.py: tag36h11_0.png is there already; --force replaces it\n"
    )
    assert old.read_text() == "mine" and os.listdir(tmp_path) == [old.name]
    (path,) = made(create("--force", 0), tmp_path)
    assert cv2.imread(str(path)) is not None


def test_no_sheet_is_written_if_one_is_there(create, tmp_path):
    (tmp_path / "a-2.svg").symlink_to("nowhere")
    result = create("-o", "a.svg", "-s", 9, "0-7")
    assert result.returncode == 1 and "a-2.svg is there already" in result.stderr
    assert os.listdir(tmp_path) == ["a-2.svg"]


@pytest.mark.parametrize("line", [line for line in EXAMPLES.splitlines() if ".py" in line])
def test_every_example_of_the_help_works(create, tmp_path, line):
    command, _, said = line.strip().partition("   ")
    words = shlex.split(command)
    (path,) = made(create(*words[1:]), tmp_path)
    name = re.search(r"[\w-]+\.(png|pdf|svg)", said) or re.search(r"-o ([\w.]+)", command)
    if name:
        assert path.name in name.group()
    assert rendered(path)[0]


def test_the_executable_needs_no_master(tmp_path):
    program = roslib.packages.find_node("robot_vision", "create_marker.py")[0]
    for arguments, code in ((["0"], 0), (["0"], 1), (["--no-such-option"], 2)):
        result = subprocess.run(
            [program, *arguments],
            cwd=tmp_path,
            env={**os.environ, "ROS_MASTER_URI": "http://127.0.0.1:1"},
            capture_output=True,
            timeout=60,
            check=False,
        )
        assert result.returncode == code, result.stderr
    assert os.listdir(tmp_path) == ["tag36h11_0.png"]


def test_help_has_the_examples_and_all_families(create):
    result = create("--help")
    assert result.returncode == 0 and EXAMPLES.strip() in result.stdout
    for family in FAMILIES:
        assert family in result.stdout


def test_runs_are_the_black_cells_of_a_row():
    cells = np.array([[1, 1, 0, 1], [0, 0, 0, 0], [0, 1, 1, 1]], bool)
    assert list(runs(cells)) == [(0, 0, 2), (0, 3, 4), (2, 1, 4)]
