"""Lists of tag ids as users write them."""

import pytest

from robot_vision.tags.tag_ids import parse_ids, require_id


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0", [0]),
        ("586", [586]),
        ("3-5", [3, 4, 5]),
        ("7-7", [7]),
        ("9,0,3-4,3", [9, 0, 3, 4, 3]),
        (" 1, 2 - 3 ", [1, 2, 3]),
        ("007", [7]),
    ],
)
def test_lists_of_ids(text, expected):
    assert parse_ids(text, "tag36h11") == expected


@pytest.mark.parametrize(
    "text", ["", " ", "x", "-1", "1-", "1-2-3", "1,,2", "1,", "1 2", "+1", "٣"]
)
def test_invalid_lists_are_refused(text):
    with pytest.raises(ValueError, match=f"ids is '{text.replace('+', '.')}', must be a list such"):
        parse_ids(text, "tag36h11")


def test_the_lower_id_comes_first():
    with pytest.raises(ValueError, match="ids is '1, 5-3', must have the lower id of 5-3 first"):
        parse_ids("1, 5-3", "tag36h11")


def test_ids_must_be_in_the_family():
    for text in ("30", "0-30", "0-99999999999"):
        with pytest.raises(ValueError, match=r"id is \d+, tag16h5 has 0 to 29"):
            parse_ids(text, "tag16h5")
    with pytest.raises(ValueError, match="id is -1, tag16h5 has 0 to 29"):
        require_id(-1, "tag16h5")
    require_id(29, "tag16h5")
