"""Commands on the database that Ctrl-C interrupts: all of what they do is there, or nothing."""

import os
import shutil

import pytest
from interruptions import ALL, interrupted_at

import robot_vision as rv
from robot_vision.common.commands import INTERRUPTED
from robot_vision.meshes import write_mesh
from robot_vision.recognition import (
    mesh_add,
    object_add,
    object_delete,
    object_export,
    object_import,
    training,
)
from robot_vision.recognition.database import Database

MOMENTS = 12  # at which each command is interrupted, besides the first and the last ones


def contents(path):
    """What is in a database, but for times."""
    if not os.path.lexists(path):
        return []
    with Database(str(path), write=True) as database:
        return [
            (
                one.name,
                database.meshes.entry(one.id) is not None,
                [model.key for model in database.models.entries_of(one.id)],
            )
            for one in database.objects.all()
        ]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A database with an object that has a mesh; its mesh, a folder of it, and an .ork file."""
    folder = tmp_path_factory.mktemp("files")
    write_mesh(str(folder / "nut.stl"), rv.sample_mesh("nut").mesh)
    database = "--database", str(folder / "objects.db")
    for main, words in (
        (object_add.main, ["-n", "nut", "--commit"]),
        (mesh_add.main, ["nut", str(folder / "nut.stl"), "--symmetry", "z:6,x:2", "--commit"]),
        (object_export.main, [str(folder / "folder")]),
    ):
        assert interrupted_at(main, [*words, *database], ALL)[0] == 0
    (folder / "training.ork").write_text("pipeline1: {type: LinemodTrainer, subdivisions: 0}\n")
    return folder


COMMANDS = {
    "object_add": (object_add.main, lambda files: ["-n", "bolt", "--commit"]),
    "mesh_add": (mesh_add.main, lambda files: ["nut", str(files / "nut.stl"), "--commit"]),
    "object_delete": (object_delete.main, lambda files: ["nut", "--commit"]),
    "object_import": (
        object_import.main,
        lambda files: [str(files / "folder"), "--replace", "--commit"],
    ),
    "training": (training.main, lambda files: ["-c", str(files / "training.ork")]),
}


def moments_of(calls):
    """Some of so many calls, with the first and the last ones, which open and close the file."""
    some = range(6, calls, max(7, calls // MOMENTS))
    return sorted({*range(1, 6), *some, *range(max(1, calls - 8), calls + 2)})


@pytest.mark.parametrize("name", COMMANDS)
def test_interrupted_at_any_call(files, tmp_path, name):
    main, words_of = COMMANDS[name]
    path = tmp_path / "objects.db"
    words = [*words_of(files), "--database", str(path)]

    def interrupt(call):
        shutil.copy(str(files / "objects.db"), str(path))
        code, output = interrupted_at(main, words, call)
        assert "Traceback" not in output, (call, output)
        return code, output, contents(path)

    before = contents(files / "objects.db")
    code, output, after = interrupt(ALL)
    assert code == 0, output
    calls = int(output.split()[-1])
    codes = []
    for call in moments_of(calls):
        code, output, there = interrupt(call)
        assert code in (0, INTERRUPTED), (call, output)
        assert there in (before, after), (call, there)
        assert code or there == after, call
        codes.append(code)
        assert set(os.listdir(str(tmp_path))) <= {path.name + end for end in ("", "-wal", "-shm")}
    assert codes.count(INTERRUPTED) > 10 and codes[-1] == 0


def test_a_folder_is_whole_or_not_there(files, tmp_path):
    words = [str(tmp_path / "made"), "--database", str(files / "objects.db")]
    calls = int(interrupted_at(object_export.main, words, ALL)[1].split()[-1])
    whole = sorted(one.name for one in (tmp_path / "made").rglob("*"))
    for call in moments_of(calls)[:-2]:
        shutil.rmtree(str(tmp_path / "made"), ignore_errors=True)
        code, output = interrupted_at(object_export.main, words, call)
        assert code == INTERRUPTED and "Traceback" not in output
        there = os.listdir(str(tmp_path))
        assert there in ([], ["made"])
        if there:
            assert sorted(one.name for one in (tmp_path / "made").rglob("*")) == whole
