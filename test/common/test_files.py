"""Files are read with care, and replaced in one step, whatever is at their path."""

import contextlib
import os
import stat
import subprocess
import sys

import pytest

from robot_vision.common.files import (
    add_file,
    create_file,
    make_folder,
    read_file,
    read_text,
    replace_file,
    require_file,
    require_replaceable,
)

OLD, NEW = b"old\n", b"new " * 10000


@contextlib.contextmanager
def changed(function, *arguments):
    """Restores a property of the process at the end."""
    before = function(*arguments)
    yield
    function(before)


def make_odd(folder, kind):
    """Makes something that is no regular file, and returns its path."""
    path = str(folder / "odd.yaml")
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        os.mkdir(path)
    elif kind == "device":
        path = "/dev/zero"
    else:
        target = {"link to a device": "/dev/zero", "dangling": "nowhere", "loop": "odd.yaml"}[kind]
        os.symlink(target, path)
    return path


ODD = [
    ("pipe", "it is no file"),
    ("folder", "it is no file"),
    ("device", "it is no file"),
    ("link to a device", "it is no file"),
    ("dangling", "it is a symbolic link that leads nowhere"),
    ("loop", "Too many levels of symbolic links"),
]


@pytest.mark.parametrize("kind, reason", ODD)
def test_only_files_are_read_and_replaced(tmp_path, kind, reason):
    path = make_odd(tmp_path, kind)
    before = os.lstat(path)
    with pytest.raises(OSError) as error:
        replace_file(path, NEW)
    assert str(error.value) == f"{path} cannot be written: {reason}"
    for new_folders in (False, True):
        with pytest.raises(OSError) as error:
            require_replaceable(path, replace=True, new_folders=new_folders)
        assert str(error.value) == f"{path} cannot be written: {reason}"
    no_file = "No such file or directory" if kind == "dangling" else reason
    for read in (read_text, require_file, lambda path: read_file(path, 100)):
        with pytest.raises(OSError) as error:
            read(path)
        assert str(error.value) == f"{path} cannot be read: {no_file}"
    assert stat.S_IFMT(os.lstat(path).st_mode) == stat.S_IFMT(before.st_mode)
    assert os.listdir(tmp_path) in ([], ["odd.yaml"])


def test_no_more_is_read_than_allowed(tmp_path):
    path = str(tmp_path / "file")
    for size in (0, 1, 2 << 20):
        data = os.urandom(size)
        replace_file(path, data)
        assert read_file(path, size) == data
    with pytest.raises(OSError) as error:
        read_file(path, (2 << 20) - 1)
    assert str(error.value) == f"{path} cannot be read: it has 2 MB, must have at most 1"
    os.truncate(path, 1 << 40)  # does not fit into the memory
    with pytest.raises(OSError, match="it has 1048576 MB, must have at most 256"):
        read_file(path, 256 << 20)
    with pytest.raises(OSError, match="must have at most 0"):  # the system reports a size of 0
        read_file("/proc/kallsyms", 1000)


def test_temporary_file_of_a_dead_process_is_left_alone(tmp_path):
    path = tmp_path / "file.yaml"
    path.write_bytes(OLD)
    (tmp_path / f"file.yaml.{os.getpid()}.tmp").write_text("half")
    replace_file(str(path), NEW)
    assert path.read_bytes() == NEW
    assert (tmp_path / f"file.yaml.{os.getpid()}.tmp").read_text() == "half"


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o666])
def test_mode_and_owner_are_kept(tmp_path, mode, monkeypatch):
    path = tmp_path / "file.yaml"
    path.write_bytes(OLD)
    os.chmod(path, mode)
    if os.getuid() == 0:
        os.chown(path, 1234, 4321)
    before, given = os.stat(path), []
    fchown = os.fchown
    monkeypatch.setattr(os, "fchown", lambda *all: (given.append(all[1:]), fchown(*all)))
    with changed(os.umask, 0o077):
        replace_file(str(path), NEW)
    after = os.stat(path)
    assert (after.st_mode, after.st_uid, after.st_gid) == (
        before.st_mode,
        before.st_uid,
        before.st_gid,
    )
    assert given == ([(1234, 4321)] if os.getuid() == 0 else [])


def test_file_is_replaced_even_if_its_owner_cannot_be_kept(tmp_path, monkeypatch):
    path = tmp_path / "file.yaml"
    path.write_bytes(OLD)
    before = os.stat(path)
    tried = []

    def refuse(_file, owner, group):
        tried.append((owner, group))
        raise PermissionError(1, "Operation not permitted")

    other = os.stat_result((*before[:4], 1234, 4321, *before[6:]))
    monkeypatch.setattr(os, "fchown", refuse)
    monkeypatch.setattr("robot_vision.common.files.replaced_file", lambda path: (path, other))
    replace_file(str(path), NEW)
    assert path.read_bytes() == NEW and tried == [(1234, 4321), (-1, 4321)]


def test_new_files_are_made_without_hard_links(tmp_path, monkeypatch):
    def refuse(*_):
        raise PermissionError(1, "Operation not permitted")  # as FAT does

    monkeypatch.setattr(os, "link", refuse)
    create_file(str(tmp_path / "a.png"), NEW)
    assert add_file(str(tmp_path), "a", ".png", b"more") == f"{tmp_path}/a-1.png"
    with pytest.raises(FileExistsError):
        create_file(str(tmp_path / "a.png"), b"other")
    assert (tmp_path / "a.png").read_bytes() == NEW
    assert (tmp_path / "a-1.png").read_bytes() == b"more"
    assert sorted(os.listdir(tmp_path)) == ["a-1.png", "a.png"]


KILLED = """
import itertools, os, signal, sys
from robot_vision.common import files

os.fsync = lambda _: None  # slow, and does not matter to other processes
work, *words = sys.argv[1:]
for deadly in itertools.count(1):
    pid = os.fork()
    if pid == 0:
        calls = itertools.count(1)

        def count(_frame, event, _function):
            if event in ("c_call", "c_return") and next(calls) == deadly:
                os.kill(os.getpid(), signal.SIGKILL)

        try:
            sys.setprofile(count)
            getattr(files, work)(*words, b"new " * 10000)
        finally:
            os._exit(0)
    if os.WIFEXITED(os.waitpid(pid, 0)[1]):
        break
    print("killed", flush=True)
    sys.stdin.readline()
"""


def killed_at_each_call(work, *words):
    """Has a function of files.py write NEW in processes that are killed (-9), each a call later.

    Yields after each death, and returns when the work ends before it is killed. The processes are
    forked from a small one, which this one need not be.
    """
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    words = [sys.executable, "-c", KILLED, work, *map(str, words)]
    with subprocess.Popen(words, bufsize=0, **pipes) as process:
        while process.stdout.readline():
            yield
            process.stdin.write(b"\n")
    assert process.returncode == 0


def test_file_is_the_old_or_the_new_one_when_killed_at_any_call(tmp_path):
    path = tmp_path / "file.yaml"
    path.write_bytes(OLD)
    seen = []
    for _ in killed_at_each_call("replace_file", path):
        seen.append(path.read_bytes())
    assert set(seen) == {OLD, NEW} and len(seen) > 10
    assert seen == sorted(seen, reverse=True)  # first the old one
    assert path.read_bytes() == NEW


@pytest.mark.parametrize("work", ["create_file", "add_file"])
def test_new_file_is_complete_or_missing_when_killed_at_any_call(tmp_path, work):
    words = [tmp_path / "a.png"] if work == "create_file" else [tmp_path, "a", ".png"]
    deaths = 0
    for _ in killed_at_each_call(work, *words):
        deaths += 1
        for path in tmp_path.glob("[!.]*.png"):
            assert path.read_bytes() == NEW
            path.unlink()
    assert deaths > 10 and (tmp_path / "a.png").read_bytes() == NEW


def test_paths_are_checked_before_the_work_without_making_anything(tmp_path):
    file = tmp_path / "file.yaml"
    file.write_bytes(OLD)
    deep = tmp_path / "a" / "b" / "new.yaml"
    require_replaceable(str(file), replace=True)
    require_replaceable(str(deep), replace=False, new_folders=True)
    for path, options, reason in (
        (file, {"replace": False}, "file.yaml is there already; --force replaces it"),
        (deep, {"replace": True}, f"new.yaml cannot be written: {deep.parent} is no folder"),
        (file / "new.yaml", {"replace": True}, "new.yaml cannot be written: Not a directory"),
        (
            file / "a" / "new.yaml",
            {"replace": True, "new_folders": True},
            "new.yaml cannot be written: Not a directory",
        ),
    ):
        with pytest.raises(OSError) as error:
            require_replaceable(str(path), **options)
        assert str(error.value).endswith(reason)
    assert os.listdir(tmp_path) == ["file.yaml"]
    make_folder(str(deep))
    assert os.listdir(deep.parent) == []
