"""The page is opened in a browser where there is a display, and never as a failure."""

import os

import pytest
import support

from robot_vision.dashboard.open_browser import open_browser

URL = "http://127.0.0.1:8080/?code=0123"


@pytest.fixture
def desktop(monkeypatch, tmp_path):
    """desktop(name) makes a program that notes what it is given; returns the note's path."""
    note = tmp_path / "note"
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("DISPLAY", ":7")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)

    def make(name, mode=0o755):
        program = tmp_path / name
        program.write_text(f'#!/bin/sh\necho "$# $1" > {note}.new && /bin/mv {note}.new {note}\n')
        program.chmod(mode)
        return note

    return make


@pytest.mark.parametrize("name", ["xdg-open", "x-www-browser"])
def test_the_browser_of_the_desktop_gets_the_address(desktop, name):
    note = desktop(name)
    assert open_browser(URL)
    support.wait_for(note.exists, "the browser")
    assert note.read_text() == f"1 {URL}\n"


def test_the_desktop_s_own_way_comes_first(desktop, tmp_path):
    desktop("x-www-browser", 0o644)
    note = desktop("xdg-open")
    assert open_browser(URL)
    support.wait_for(note.exists, "the browser")


def test_without_a_display_no_browser_takes_the_terminal(desktop, monkeypatch):
    desktop("xdg-open")
    monkeypatch.setenv("DISPLAY", "")
    assert not open_browser(URL)


def test_without_a_browser_nothing_happens(desktop):
    assert not open_browser(URL)


def test_a_browser_that_cannot_be_started_is_no_failure(desktop, tmp_path):
    desktop("xdg-open")
    (tmp_path / "xdg-open").write_text("#!/no/such/program\n")
    assert not open_browser(URL)
    os.unlink(str(tmp_path / "xdg-open"))
