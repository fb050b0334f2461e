"""Text that others have sent, as it is shown to people; and how often errors are logged."""

import pytest

from robot_vision.common import throttle
from robot_vision.common.plain_text import printable


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("bgr8; jpeg", "bgr8; jpeg"),
        ("J\u00fcrgen", "J\u00fcrgen"),
        ("a\nb\x1b[2J\x9b\u2028\u202e\udc80", r"a\nb\x1b[2J\x9b\u2028\u202e\udc80"),
        ("a" * 100, "a" * 100),
        ("a" * 1000000, "a" * 97 + "..."),
        ("\0" * 1000000, (r"\x00" * 25)[:97] + "..."),
    ],
)
def test_text_becomes_one_short_line_without_control_characters(text, expected):
    assert printable(text) == expected


def test_throttles_are_independent(monkeypatch):
    now = 0.0
    monkeypatch.setattr(throttle.time, "monotonic", lambda: now)
    one, other = throttle.Throttle(), throttle.Throttle()
    assert one.due() and other.due()
    now = 4.9
    assert not one.due()
    now = 5.0
    assert one.due() and not one.due()
