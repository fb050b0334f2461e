"""Templates in files and folders, with their alpha channels."""

import cv2
import numpy as np
import pytest

from robot_vision.templates.template_files import MAX_FILES, load_templates

BGR = np.random.default_rng(1).integers(0, 256, (6, 8, 3), np.uint8)
ALPHA = np.arange(48, dtype=np.uint8).reshape(6, 8) * 5


def write(path, image):
    assert cv2.imwrite(str(path), image)
    return str(path)


def test_files_and_folders_are_read_in_order(tmp_path):
    folder = tmp_path / "more"
    folder.mkdir()
    for name in ("b.png", "a.bmp", ".hidden.png"):
        write(folder / name, BGR)
    (folder / "notes.txt").write_text("no image")
    first = write(tmp_path / "first.png", BGR[:, :, 0])
    templates = load_templates(f" {first}, {folder} ,")
    assert [template.name for template in templates] == ["first", "a", "b"]
    assert np.array_equal(templates[0].pixels, cv2.cvtColor(BGR[:, :, 0], cv2.COLOR_GRAY2BGR))
    assert np.array_equal(templates[1].pixels, BGR) and templates[1].mask is None
    assert load_templates("") == []


@pytest.mark.parametrize("white", [1, 257])
def test_the_alpha_channel_of_a_png_is_the_mask(tmp_path, white):
    image = np.dstack([BGR, ALPHA]).astype(np.uint16 if white > 1 else np.uint8) * white
    (template,) = load_templates(write(tmp_path / "a.png", image))
    assert np.array_equal(template.pixels, BGR) and np.array_equal(template.mask, ALPHA)
    assert template.pixels.flags.c_contiguous and template.mask.flags.c_contiguous


def test_what_is_no_template_is_refused_in_words(tmp_path):
    text, empty = tmp_path / "text.png", tmp_path / "empty"
    text.write_text("no image")
    empty.mkdir()
    many = tmp_path / "many"
    many.mkdir()
    for number in range(MAX_FILES + 1):
        (many / f"{number}.png").touch()
    for path, reason in [
        ("here.png", "^templates is 'here.png', must be the absolute path of an image file$"),
        (text, "must be the absolute path of an image file: no image that OpenCV can read$"),
        (tmp_path / "none.png", "of an image file: No such file or directory$"),
        (empty, "^templates: '.*/empty' has no image files$"),
        (many, "templates: 101 files, must be at most 100"),
    ]:
        with pytest.raises(ValueError, match=reason):
            load_templates(str(path))
