"""Files that are no meshes, or none that can be used."""

import json
import os
import signal
import struct

import numpy as np
import pytest
from mesh_files import PYRAMID, gltf, obj, written

import robot_vision as rv
from robot_vision.meshes import read_mesh, write_mesh


@pytest.mark.parametrize(
    ("scale", "unit", "message"),
    [
        (0.01, None, "0.0030 x 0.0020 x 0.0010 m, must be from 0.005 to 3 m along its longest"),
        (2e4, None, "6.00 x 4.00 x 2.00 m, must be from 0.005 to 3 m along its longest side; is"),
        (1.0, "mm", "0.0003 x 0.0002 x 0.0001 m in mm, must be from 0.005 to 3 m along its long"),
    ],
)
def test_absurd_sizes_are_refused(tmp_path, scale, unit, message):
    path = obj(tmp_path / "a.obj", PYRAMID * scale)
    with pytest.raises(ValueError) as error:
        read_mesh(path, unit)
    assert str(error.value).startswith(f"{path}: its size is {message}")


def test_other_units_are_refused(tmp_path):
    with pytest.raises(ValueError, match=r"unit is 'ft', must be m, cm, mm or inch"):
        read_mesh(obj(tmp_path / "a.obj"), "ft")


def stl(count, size):
    return b"\0" * 80 + struct.pack("<I", count) + b"\0" * size


BAD_FILES = {
    "empty.stl": (b"", "it is empty"),
    "none.stl": (stl(0, 0), ""),
    "text.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", ""),
    "far.obj": (b"v 0 0 0\nv nan 0 0\nv 0 inf 0\nf 1 2 3\n", ""),
    "wrong.obj": (b"v 0 0 0\nv 1 0 0\nf 1 2 9\n", ""),
    "point.obj": (b"v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n", "none of its triangles has an area"),
    "noise.ply": (bytes(range(256)) * 8, ""),
    "noise.3ds": (bytes(range(255, -1, -1)) * 8, ""),
    "cut.ply": (b"ply\nformat ascii 1.0\nelement vertex 3\n", "its header has no end_header"),
    "short.ply": (
        b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n1\n",
        "",
    ),
    "cut.gltf": (json.dumps(gltf("gone.bin")[0]).encode(), ""),
    "mesh.xyz": (b"0 0 0\n1 1 1\n", ""),
}


@pytest.mark.parametrize("name", BAD_FILES)
def test_bad_files_are_refused_in_one_line_with_their_path(tmp_path, name):
    data, words = BAD_FILES[name]
    path = tmp_path / name
    path.write_bytes(data)
    with pytest.raises((ValueError, OSError)) as error:
        read_mesh(str(path))
    message = str(error.value)
    assert message.startswith(str(path)) and words in message
    assert len(message) > len(str(path)) + 10
    assert "\n" not in message and len(message) < 600


def test_a_mesh_of_ten_million_triangles_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "huge.stl"
    with path.open("wb") as file:
        file.write(stl(10_000_000, size=0))
        file.truncate(84 + 50 * 10_000_000)  # takes no room on the disk
    with pytest.raises(ValueError) as error:
        read_mesh(str(path))
    assert str(error.value) == f"{path}: it has 10000000 triangles, must have at most 2000000"
    path = written(
        tmp_path / "huge.ply", "ply\nformat ascii 1.0\nelement face 3000000\nend_header\n"
    )
    with pytest.raises(ValueError, match="it has 3000000 triangles, must have at most 2000000"):
        read_mesh(path)


def test_a_hundred_thousand_triangles_are_taken(tmp_path):
    side = 225
    x, y = np.meshgrid(np.linspace(0, 0.4, side), np.linspace(0, 0.3, side))
    vertices = np.column_stack([x.ravel(), y.ravel(), 0.02 * np.sin(20 * x.ravel())])
    index = np.arange(side * side).reshape(side, side)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    sides = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    write_mesh(str(tmp_path / "wave.ply"), rv.Mesh(vertices, sides))
    loaded = read_mesh(str(tmp_path / "wave.ply"))
    assert len(loaded.mesh.triangles) == len(sides) > 100_000
    assert len(loaded.mesh.vertices) == side * side and not loaded.closed


def test_other_paths_are_refused(tmp_path):
    fifo = tmp_path / "pipe.stl"
    os.mkfifo(fifo)
    for path, words in (
        (tmp_path / "gone.stl", "No such file or directory"),
        (tmp_path, "it is no file"),
        (fifo, "it is no file"),
    ):
        with pytest.raises(OSError, match=f"{path} cannot be read: .*{words}"):
            read_mesh(str(path))


def test_files_are_read_where_nobody_learns_how_a_process_has_ended(tmp_path):
    """A program that ignores SIGCHLD, or was started so, cannot wait for its children."""
    good, bad = obj(tmp_path / "good.obj"), tmp_path / "bad.obj"
    bad.write_bytes(BAD_FILES["wrong.obj"][0])

    def read():
        with pytest.raises(ValueError) as error:
            read_mesh(str(bad))
        return str(error.value), read_mesh(good).mesh.triangles.tolist()

    told = read()
    before = signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    try:
        assert read() == told
    finally:
        signal.signal(signal.SIGCHLD, before)
