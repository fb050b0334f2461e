"""Files that belong together are written all or none."""

import os

import pytest

from robot_vision.common.file_sets import add_files, replace_files

OLD, NEW = b"old\n", {"left.yaml": b"new left\n", "right.yaml": b"new right\n"}


def paths(folder):
    return {str(folder / name): data for name, data in NEW.items()}


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def fail_at_call(monkeypatch, name, number, error):
    """Makes a function of os raise an error instead of its call of this number, counted from 1."""
    function, calls = getattr(os, name), []

    def call(*arguments):
        calls.append(arguments)
        if len(calls) == number:
            raise error
        return function(*arguments)

    monkeypatch.setattr(os, name, call)


def test_new_files_appear_and_old_ones_are_replaced(tmp_path):
    (tmp_path / "right.yaml").write_bytes(OLD)
    os.chmod(tmp_path / "right.yaml", 0o640)
    replace_files(paths(tmp_path))
    assert contents(tmp_path) == NEW
    assert os.stat(tmp_path / "right.yaml").st_mode & 0o777 == 0o640


@pytest.mark.parametrize("error", [OSError(5, "Input/output error"), KeyboardInterrupt()])
@pytest.mark.parametrize("before", [{}, {"left.yaml": OLD}, {"left.yaml": OLD, "right.yaml": OLD}])
def test_if_one_cannot_be_replaced_all_are_as_they_were(tmp_path, monkeypatch, before, error):
    for name, data in before.items():
        (tmp_path / name).write_bytes(data)
    fail_at_call(monkeypatch, "replace", 2, error)
    with pytest.raises(type(error)):
        replace_files(paths(tmp_path))
    assert contents(tmp_path) == before


def test_what_is_no_file_keeps_all_from_being_replaced(tmp_path):
    (tmp_path / "left.yaml").write_bytes(OLD)
    (tmp_path / "right.yaml").mkdir()
    with pytest.raises(OSError, match=r"right.yaml cannot be written: it is no file"):
        replace_files(paths(tmp_path))
    assert (tmp_path / "left.yaml").read_bytes() == OLD
    assert sorted(os.listdir(tmp_path)) == ["left.yaml", "right.yaml"]


def without_hard_links(monkeypatch):
    def refuse(*_):
        raise PermissionError(1, "Operation not permitted")  # as FAT does

    monkeypatch.setattr(os, "link", refuse)


@pytest.mark.parametrize("links", [True, False])
@pytest.mark.parametrize("taken", ["left.yaml", "right.yaml"])
def test_new_files_have_the_same_number_where_a_name_is_taken(tmp_path, monkeypatch, links, taken):
    if not links:
        without_hard_links(monkeypatch)
    (tmp_path / taken).write_bytes(OLD)
    added = add_files(paths(tmp_path))
    assert added == [str(tmp_path / name) for name in ("left-1.yaml", "right-1.yaml")]
    numbered = {name.replace(".", "-1."): data for name, data in NEW.items()}
    assert contents(tmp_path) == {taken: OLD, **numbered}


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_if_one_cannot_be_added_there_is_none(tmp_path, monkeypatch, error):
    fail_at_call(monkeypatch, "fsync", 2, error)
    with pytest.raises(type(error)):
        add_files(paths(tmp_path))
    assert contents(tmp_path) == {}


@pytest.mark.parametrize("links", [True, False])
def test_if_one_gets_no_name_none_has_it(tmp_path, monkeypatch, links):
    if not links:
        without_hard_links(monkeypatch)
    fail_at_call(monkeypatch, "link" if links else "replace", 2, KeyboardInterrupt())
    with pytest.raises(KeyboardInterrupt):
        add_files(paths(tmp_path))
    assert contents(tmp_path) == {}
