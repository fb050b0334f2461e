"""The images of the pages in docs, which make docs renders."""

import pathlib
import re
import subprocess
import sys

import cv2
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
IMAGES = sorted((ROOT / "docs" / "images").glob("*.jpg"))
RENDER = ROOT / "tools" / "docs" / "render"


def named():
    """The images that RENDER has in its table, by name."""
    return re.findall(r'^    "([\w-]+)": \w+\.\w+,$', RENDER.read_text(), re.MULTILINE)


def test_pages_show_the_images_that_are_there():
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    text = "".join(page.read_text(encoding="utf-8") for page in pages)
    assert {path.stem for path in IMAGES} == set(re.findall(r"images/([\w-]+)\.jpg", text))


def test_each_image_can_be_rendered():
    assert named() == sorted(named()) and len(named()) > 20
    names = {path.stem for path in IMAGES}
    assert set(named()) <= names
    assert names - set(named()) <= {
        path.stem for path in (ROOT / "src/robot_vision").glob("*/*.py")
    }


@pytest.mark.parametrize("path", IMAGES, ids=lambda path: path.stem)
def test_images_are_small(path):
    is_page = path.stem.startswith("dashboard")  # its words must be legible
    assert path.stat().st_size <= (150000 if is_page else 30000)
    assert cv2.imread(str(path)).shape[1] <= (1280 if is_page else 640)


def test_an_unknown_image_is_named():
    result = subprocess.run(
        [sys.executable, str(RENDER), "nothing"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
        text=True,
    )
    assert result.returncode == 2, result.stdout
    assert result.stdout.startswith("no such image: nothing; there are ")
