"""The pages of docs, and the images that make docs renders for them."""

import pathlib
import re
import subprocess
import sys

import cv2
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
IMAGES = sorted((ROOT / "docs" / "images").glob("*.jpg"))


def rendered():
    """The names of the images that tools/docs/render has in its table."""
    text = (ROOT / "tools/docs/render").read_text()
    return re.findall(r'^    "([\w-]+)": \w+\.\w+,$', text, re.MULTILINE)


def test_each_image_is_rendered():
    assert rendered() == sorted(rendered())
    assert [path.stem for path in IMAGES] == rendered()


def test_each_image_is_shown_by_a_page():
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    text = "".join(page.read_text() for page in pages)
    assert set(re.findall(r"images/([\w-]+)\.jpg", text)) == set(rendered())


@pytest.mark.parametrize("path", IMAGES, ids=[path.stem for path in IMAGES])
def test_images_are_small_files(path):
    assert path.stat().st_size <= 30000
    assert cv2.imread(str(path)).shape[1] <= 640


def test_an_unknown_image_is_named():
    result = subprocess.run(
        [sys.executable, str(ROOT / "tools/docs/render"), "nothing"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
        text=True,
    )
    assert result.returncode == 2
    assert result.stdout.startswith("no such image: nothing; there are ")
