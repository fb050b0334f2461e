"""YAML that is nested, repeated or long without limits."""

import os

import pytest
import yaml

from robot_vision import HsvRange
from robot_vision.color.color_file import save_colors
from robot_vision.common.yaml_text import MAX_DEPTH, compose_yaml, load_yaml

BOMB = "a0: &a0 [1, 2, 3, 4, 5, 6, 7, 8, 9]\n" + "".join(
    f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 20)
)
MERGED = "a0: &a0 {a: 1}\n" + "".join(
    f"a{i}: &a{i} {{k{i}: 1, <<: [{', '.join([f'*a{i - 1}'] * 9)}]}}\n" for i in range(1, 20)
)
HOSTILE = [
    (BOMB, "more than 20000 values"),
    (MERGED, "more than 20000 values"),
    ("a: [" + "1," * 30000 + "]", "more than 20000 values"),
    ("[" * 100000, "line 1, column 21: nested deeper than 20 levels"),
    ("{a: " * 100000, "nested deeper than 20 levels"),
    ("- " * 100000, "nested deeper than 20 levels"),
    ("a: &a [*a]", "line 1, column 8: an alias of what it is part of"),
    ("a: *b", "line 1, column 4: found undefined alias 'b'"),
    ("a: " + "9" * 100000, "line 1, column 4: no string, and longer than 100 characters"),
    ("a: " + "1:" * 100000 + "1", "no string, and longer than 100 characters"),
    ("a: 2001-99-99", "month must be in 1..12"),
    ("a: !!int ''", "string index out of range"),
    ("a: !!timestamp x", "groupdict"),
    ("a: !!python/object/apply:os.system [ls]", "could not determine a constructor"),
    ("? {a: 1}\n: 2", "found unhashable key"),
    ("a: 1\n---\nb: 2", "but found another document"),
    ("a\0b", "special characters are not allowed"),
    ("a: [1\nb", "line 2, column 2: "),
]


@pytest.mark.parametrize("text, reason", HOSTILE, ids=[reason for _, reason in HOSTILE])
def test_one_line_says_what_is_wrong(text, reason):
    with pytest.raises(ValueError) as error:
        load_yaml(text)
    assert reason in str(error.value)
    assert "\n" not in str(error.value) and len(str(error.value)) < 250


@pytest.mark.parametrize("text, reason", HOSTILE, ids=[reason for _, reason in HOSTILE])
def test_errors_name_files_of_colors_and_leave_them(tmp_path, text, reason):
    path = tmp_path / "hostile.yaml"
    path.write_text(text)
    with pytest.raises(ValueError) as error:
        save_colors(str(path), {"blue": HsvRange()})
    assert str(error.value).startswith(f"{path}: ") and reason in str(error.value)
    assert path.read_text() == text and os.listdir(tmp_path) == ["hostile.yaml"]


def test_files_that_are_too_large_are_not_parsed(tmp_path):
    path = tmp_path / "large.yaml"
    path.write_text("#" * (1 << 20) + "\n")
    with pytest.raises(OSError, match=r"large\.yaml cannot be read: it has 1 MB, must have at"):
        save_colors(str(path), {"blue": HsvRange()})


@pytest.mark.parametrize(
    "text",
    [
        "",
        "a: 1",
        "a: &a {b: [1, 2.5, yes, ~, 2001-01-01]}\nc: *a\nd: {<<: *a, e: 'x'}",
        "long: " + "x" * 10000,
        "[" * MAX_DEPTH + "]" * MAX_DEPTH,
    ],
)
def test_usual_files_are_read_as_by_pyyaml(text):
    assert load_yaml(text) == yaml.safe_load(text)
    node, expected = compose_yaml(text), yaml.compose(text, Loader=yaml.SafeLoader)
    assert yaml.serialize(node) == yaml.serialize(expected) if expected else node is None
