"""The database of objects: what it holds, who may write, and files that are none."""

import contextlib
import os
import pathlib
import sqlite3
import subprocess
import sys
import tempfile
import threading

import numpy as np
import pytest
from unprivileged import NOBODY, needs_root

from robot_vision.recognition.database import (
    Database,
    Mesh,
    Model,
    Object,
    Observation,
    Session,
    Symmetry,
    connection,
    default_path,
    schema,
)
from robot_vision.recognition.database.blobs import digest_of
from robot_vision.recognition.database.folder_export import export_folder
from robot_vision.recognition.database.folder_import import import_folder

CAN = Object("coke", "A universal can of coke", ["can", "red"], "Ada", "ada@example.com")
POSE = np.array([[0.0, -1, 0, 0.1], [1, 0, 0, -0.2], [0, 0, 1, 0.7], [0, 0, 0, 1]])
MATRIX = np.array([[525.0, 0, 319.5], [0, 525, 239.5], [0, 0, 1]])


SYMMETRIES = (Symmetry((0.0, 0.0, 1.0)), Symmetry((1.0, 0.0, 0.0), 2))


def mesh_of(text=b"mesh"):
    files = {"label.png": b"png", "coke.mtl": b"mtl"}
    return Mesh("coke.obj", b"file", text, files, 0.001, 2.0, (0.0, 0.1, 0.0), SYMMETRIES)


def fill(database, name="coke"):
    """Adds an object with all that there can be of one, and returns it."""
    with database.transaction():
        one = database.objects.add(Object(name, CAN.description, CAN.tags, CAN.author, CAN.email))
        database.meshes.set(one.id, mesh_of())
        session = database.observations.add_session(Session(one.id, "turn.bag"))
        for frame in (7, 3):
            images = (b"rgb%d" % frame, b"depth", b"mask")
            database.observations.add(
                Observation(session.id, frame, *images, MATRIX, POSE, (0.1, -0.2, 0.0, 0.0))
            )
        database.models.set(Model(one.id, "LINEMOD", {"views": 3}, "key", b"learned"))
    return one


def blobs_of(path):
    with contextlib.closing(sqlite3.connect(path)) as file:
        return {data for (data,) in file.execute("SELECT data FROM blobs")}


@pytest.fixture
def path(tmp_path):
    return str(tmp_path / "new" / "objects.db")


def test_it_is_in_the_folder_of_ros(monkeypatch):
    monkeypatch.setenv("ROS_HOME", "/somewhere")
    assert default_path() == "/somewhere/robot_vision_objects.db"
    monkeypatch.delenv("ROS_HOME")
    monkeypatch.setenv("HOME", "/home/ada")
    assert default_path() == "/home/ada/.ros/robot_vision_objects.db"


def test_what_was_stored_is_there_again(path):
    with Database(path, write=True) as database:
        one = fill(database)
    assert os.listdir(os.path.dirname(path)) == ["objects.db"]  # it is one file
    with Database(path) as database:
        (there,) = database.objects.all()
        assert there == one and len(one.id) == 32 and int(one.id, 16) >= 0
        assert (there.name, there.tags, there.author) == ("coke", ["can", "red"], "Ada")
        mesh, expected = database.meshes.of(one.id), mesh_of()
        expected.added = mesh.added
        assert (dict(mesh.files), list(mesh.symmetries)) == (expected.files, [*expected.symmetries])
        mesh.files, mesh.symmetries = expected.files, expected.symmetries
        assert mesh == expected
        (session,) = database.observations.sessions(one.id)
        assert session.source == "turn.bag"
        first, second = database.observations.of(session.id)
        assert (first.frame_number, second.frame_number) == (3, 7)
        assert (first.rgb, second.rgb, first.depth, first.mask) == (
            *(b"rgb3", b"rgb7", b"depth"),
            b"mask",
        )
        assert np.array_equal(first.pose, POSE) and np.array_equal(first.matrix, MATRIX)
        assert list(first.distortion) == [0.1, -0.2, 0.0, 0.0]
        model = database.models.of(one.id, "LINEMOD")
        assert (model.data, model.parameters, model.key) == (b"learned", {"views": 3}, "key")
        assert database.models.with_key("key") == model
        assert database.models.of(one.id, "PPF") is None and database.meshes.of("f" * 32) is None


@pytest.mark.parametrize(
    "column, value, said",
    [
        ("meshes.origin_offset", "5", "origin_offset is 5, must be a list of 3 numbers"),
        ("observations.matrix", "[[1, 2], [3, 4]]", "matrix is .*, must be 3 rows of 3 numbers"),
        ("observations.pose", "{}", "pose is {}, must be 4 rows of 4 numbers"),
        ("observations.distortion", '"none"', "distortion is 'none', must be a list"),
    ],
)
def test_documents_of_another_form_are_told(path, column, value, said):
    with Database(path, write=True) as database:
        one = fill(database)
        (session,) = database.observations.sessions(one.id)
    table, name = column.split(".")
    with contextlib.closing(sqlite3.connect(path)) as file, file:
        file.execute(f"UPDATE {table} SET {name} = ?", (value,))
    with Database(path) as database, pytest.raises(ValueError, match=said):
        database.meshes.of(one.id)
        database.observations.of(session.id)


def test_objects_are_found_by_id_name_and_first_digits(path):
    with Database(path, write=True) as database, database.transaction():
        one, other = (
            database.objects.add(Object(name, id=digits * 8))
            for name, digits in (("coke", "abc1"), (" a bottle ", "abc2"))
        )
        assert database.objects.find(one.id) is not one and database.objects.find(one.id) == one
        assert database.objects.find("ABC1") == one and database.objects.find("abc2a") == other
        assert database.objects.find("a bottle") == other
        with pytest.raises(
            ValueError, match=f"'abc' may be one of 2 objects: {other.id}, {one.id}"
        ):
            database.objects.find("abc")
        for unknown in ("ab", "cok", "", "coke\x1b", "d" * 40, "%", "_"):
            with pytest.raises(ValueError, match=r"there is no object '.*' in .*objects\.db"):
                database.objects.find(unknown)
        third = database.objects.add(Object("coke"))
        with pytest.raises(ValueError, match="'coke' may be one of 2 objects"):
            database.objects.find("coke")
        database.objects.delete(third.id)
        assert [found.name for found in database.objects.tagged("can")] == []
        assert [found.name for found in database.objects.all()] == ["a bottle", "coke"]


@pytest.mark.parametrize(
    "values, said",
    [
        ({"name": ""}, "the name of an object is '', must be a name of 1 to 255 printable"),
        ({"name": "a\nb"}, r"the name of an object is 'a\\nb'"),
        ({"name": "n" * 256}, "the name of an object is 'nnn"),
        ({"name": "a", "tags": ["ok", "\x07"]}, r"a tag is '\\x07'"),
        ({"name": "a", "id": "xyz"}, "an id is 'xyz', must have 32 hexadecimal digits"),
        ({"name": "a", "description": "d" * 10001}, "the description is 'ddd"),
        ({"name": "a", "author": "\udcff"}, "the author is"),
    ],
)
def test_objects_that_cannot_be(path, values, said):
    with Database(path, write=True) as database:
        with pytest.raises(ValueError, match=said), database.transaction():
            database.objects.add(Object(**values))
        assert database.objects.all() == []


def test_what_nobody_needs_any_more_is_removed(path):
    with Database(path, write=True) as database:
        one = fill(database)
        other = fill(database, "other")  # of the same data, which is there once
        before = blobs_of(path)
        with database.transaction():
            database.objects.delete(other.id)
        assert blobs_of(path) == before >= {b"learned", b"rgb3", b"mesh", b"png"}
        with database.transaction():
            database.models.set_state("k", 2, b"half")
            database.models.set(Model(one.id, "LINEMOD", {}, "k2", b"learned anew"))
            database.meshes.set(one.id, mesh_of(b"another mesh"))
        assert b"learned" not in blobs_of(path) and b"mesh" not in blobs_of(path)
        assert database.models.state("k") == (2, b"half")
        with database.transaction():
            database.models.set(Model(one.id, "LINEMOD", {}, "k", b"whole"))
            database.objects.delete(one.id)
        assert blobs_of(path) == set() and database.models.state("k") is None
        large = os.path.getsize(path)
        with database.transaction():
            database.models.set_state("k", 0, bytes(10**6))
        third = fill(database)
        with database.transaction():
            database.models.set(Model(third.id, "PPF", {}, "k", b""))
    assert os.path.getsize(path) < large + 10**5


def test_nothing_is_there_of_what_failed(path):
    with Database(path, write=True) as database:
        fill(database)
        for error in (ValueError("no"), KeyboardInterrupt()):
            with pytest.raises(type(error)), database.transaction():
                database.objects.add(Object("second"))
                raise error
        said = "the object is not there any more"
        with pytest.raises(ValueError, match=said), database.transaction():
            database.meshes.set("0" * 32, mesh_of())
        assert [one.name for one in database.objects.all()] == ["coke"]
        refused = pytest.raises(PermissionError, match=r"objects\.db was opened to be read")
        with Database(path) as reader, refused, reader.transaction():
            pass


def test_who_writes_while_another_one_does_waits(path):
    with Database(path, write=True) as database:
        begun, done = threading.Event(), threading.Event()

        def write_too():
            with Database(path, write=True) as other:
                begun.set()
                with other.transaction():
                    other.objects.add(Object("second"))
            done.set()

        with database.transaction():
            thread = threading.Thread(target=write_too)
            thread.start()
            assert begun.wait(60.0)
            database.objects.add(Object("first"))
            with Database(path) as reader:  # who reads does not wait
                assert reader.objects.all() == [] and not done.is_set()
        thread.join(60.0)
        assert done.is_set()
        assert [one.name for one in database.objects.all()] == ["first", "second"]


def test_who_has_waited_long_is_told(path, monkeypatch):
    monkeypatch.setattr(connection, "TIMEOUT", 0.2)
    said = f"{path} is being written by another program, for more than 0.2 s"
    with Database(path, write=True) as database, Database(path, write=True) as other:
        refused = pytest.raises(OSError, match=said)
        with database.transaction(), refused, other.transaction():
            raise AssertionError("two write at a time")


def test_who_reads_sees_what_was_there_when_it_began(path, tmp_path):
    with Database(path, write=True) as database:
        one = fill(database)
        with Database(path) as reader:
            with database.transaction():
                database.objects.delete(one.id)
            assert reader.objects.all() == [one] and database.objects.all() == []
            entry = reader.meshes.entry(one.id)
            assert digest_of(reader.meshes.converted(one.id)) == entry.converted
            export_folder(reader, reader.objects.all(), str(tmp_path / "folder"))
        assert len(contents(tmp_path / "folder" / one.id / "sessions")) == 7
        with pytest.raises(ValueError, match=f"has no mesh of {one.id} any more"):
            database.meshes.converted(one.id)
        with Database(path) as reader:
            assert reader.objects.all() == []


def test_a_full_disk_is_told_and_leaves_what_was_there(path):
    with Database(path, write=True) as database:
        one = fill(database)
        pages = database._connection.rows("PRAGMA page_count")[0][0]
        database._connection.execute(f"PRAGMA max_page_count = {pages + 2}")
        said = r"objects\.db cannot be written: No space left on device"
        with pytest.raises(OSError, match=said), database.transaction():
            database.models.set(Model(one.id, "LINEMOD", {}, "k", os.urandom(10**6)))
        assert database.models.of(one.id, "LINEMOD").data == b"learned"


@contextlib.contextmanager
def as_nobody():
    os.setegid(NOBODY)
    os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(0)
        os.setegid(0)


@needs_root
@pytest.mark.parametrize("folder_mode", [0o755, 0o777], ids=["locked folder", "open folder"])
def test_a_file_that_may_only_be_read(folder_mode):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "objects.db")
        with Database(path, write=True) as database:
            fill(database)
        os.chmod(folder, folder_mode)
        with as_nobody():
            with Database(path) as database:
                assert database.objects.find("coke").author == "Ada"
            refused = pytest.raises(OSError, match=r"objects\.db cannot be written: it may only")
            with refused, Database(path, write=True) as database, database.transaction():
                database.objects.add(Object("second"))
        os.chmod(path, 0o600)
        with as_nobody(), pytest.raises(OSError, match="Permission denied"):
            Database(path)
        with Database(path) as database:
            assert len(database.objects.all()) == 1


@needs_root
def test_a_folder_where_none_may_be_made(tmp_path):
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)
        path = os.path.join(folder, "deep", "objects.db")
        with as_nobody(), pytest.raises(OSError, match="deep cannot be made: Permission denied"):
            Database(path, write=True)
        assert os.listdir(folder) == []


def spoiled(path, how):
    """Makes something else of a database."""
    data = pathlib.Path(path).read_bytes()
    os.unlink(path)
    if how == "of another application":
        with contextlib.closing(sqlite3.connect(path)) as file:
            file.execute("CREATE TABLE objects (id)")
    elif how == "pipe":
        os.mkfifo(path)
    elif how == "folder":
        os.mkdir(path)
    elif how != "nothing":
        contents = {"empty": b"", "text": b"hello\n" * 999, "half": data[: len(data) // 2]}
        pathlib.Path(path).write_bytes(contents[how])


@pytest.mark.parametrize(
    "how, said",
    [
        ("empty", "is no database of objects"),
        ("text", "is no database of objects"),
        ("of another application", "is no database of objects"),
        ("half", "is damaged: database disk image is malformed"),
        ("pipe", "cannot be read: it is no file"),
        ("folder", "cannot be read: it is no file"),
    ],
)
@pytest.mark.parametrize("write", [False, True])
def test_what_is_no_database(path, how, said, write):
    with Database(path, write=True) as database:
        fill(database)
    spoiled(path, how)
    refused = pytest.raises((OSError, ValueError), match=rf"objects\.db {said}")
    with refused, Database(path, write) as database:
        one = database.objects.all()[0]
        database.models.of(one.id, "LINEMOD")


def test_none_is_told_to_those_who_read(path):
    with pytest.raises(FileNotFoundError, match=r"there is no database .*: object_add\.py makes"):
        Database(path)
    assert not os.path.exists(os.path.dirname(path))


def test_data_that_was_changed_is_not_used(path):
    with Database(path, write=True) as database:
        one = fill(database)
        with contextlib.closing(sqlite3.connect(path)) as file, file:
            file.execute("UPDATE blobs SET data = ? WHERE data = ?", (b"learnt", b"learned"))
        with pytest.raises(ValueError, match=r"is damaged: its data .* is not as stored"):
            database.models.of(one.id, "LINEMOD")
        with database.transaction():  # what is stored anew is right again
            database.models.set(Model(one.id, "LINEMOD", {}, "key", b"learned"))
        assert database.models.of(one.id, "LINEMOD").data == b"learned"


def test_names_that_others_have_put_into_it_are_looked_at(path):
    with Database(path, write=True) as database:
        fill(database)
        with contextlib.closing(sqlite3.connect(path)) as file, file:
            file.execute("UPDATE objects SET name = ?", ("\x1b[2Jcoke",))
        with pytest.raises(ValueError, match=r"is damaged: the name of an object is '\\x1b\[2J"):
            database.objects.all()


def test_text_that_is_no_utf8_is_damaged(path):
    with Database(path, write=True) as database:
        one = fill(database)
        with contextlib.closing(sqlite3.connect(path)) as file, file:
            file.execute("UPDATE meshes SET file_name = CAST(? AS TEXT)", (b"\xff\x1b",))
        with pytest.raises(ValueError, match=r"is damaged: Could not decode to UTF-8") as error:
            database.meshes.entry(one.id)
        assert str(error.value).isprintable()


def set_version(path, version):
    with contextlib.closing(sqlite3.connect(path)) as file:
        file.execute(f"PRAGMA user_version = {version}")


def test_a_newer_version_is_refused(path):
    with Database(path, write=True) as database:
        fill(database)
    before = pathlib.Path(path).read_bytes()
    set_version(path, schema.VERSION + 1)
    changed = pathlib.Path(path).read_bytes()
    for write in (False, True):
        said = f"is a database of version {schema.VERSION + 1}, must be of 1 to {schema.VERSION}"
        with pytest.raises(ValueError, match=said):
            Database(path, write)
    assert pathlib.Path(path).read_bytes() == changed
    set_version(path, schema.VERSION)
    assert len(pathlib.Path(path).read_bytes()) == len(before)
    with Database(path) as database:
        assert len(database.objects.all()) == 1


@pytest.mark.parametrize("fails", [False, True])
def test_an_older_version_is_brought_up_to_date(path, monkeypatch, fails):
    with Database(path, write=True) as database:
        fill(database)
    steps = ["ALTER TABLE objects ADD COLUMN color TEXT", "UPDATE objects SET color = 'red'"]
    monkeypatch.setattr(connection, "VERSION", schema.VERSION + 1)
    monkeypatch.setitem(schema.MIGRATIONS, schema.VERSION + 1, steps + ["nonsense"] * fails)
    with pytest.raises(ValueError, match="of version 1, and cannot be brought to 2 while it may"):
        Database(path)
    if fails:
        with pytest.raises(OSError, match="nonsense"):
            Database(path, write=True)
    else:
        with Database(path, write=True) as database:
            assert database.objects.find("coke").author == "Ada"
    with contextlib.closing(sqlite3.connect(path)) as file:
        (version,) = file.execute("PRAGMA user_version").fetchone()
        columns = [row[1] for row in file.execute("PRAGMA table_info(objects)")]
    assert (version, "color" in columns) == ((1, False) if fails else (2, True))


def test_what_a_killed_process_has_begun_is_not_there(path):
    with Database(path, write=True) as database:
        fill(database)
    script = """
import os, sys
from robot_vision.recognition.database import Database, Object
database = Database(sys.argv[1], write=True)
with database.transaction():
    database.objects.add(Object("whole"))
with database.transaction():
    database.objects.add(Object("half"))
    os.kill(os.getpid(), 9)
"""
    subprocess.run([sys.executable, "-c", script, path], check=False, timeout=60)
    with Database(path) as database:
        assert [one.name for one in database.objects.all()] == ["coke", "whole"]


def test_a_path_of_any_bytes(tmp_path):
    for name in ("a b?mode=ro#x%41.db", "\udcff\udcfe.db", "ü/ß.db"):
        path = str(tmp_path / name)
        with Database(path, write=True) as database:
            fill(database)
        with Database(path) as database:
            assert len(database.objects.all()) == 1
        assert os.path.exists(path)


def contents(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def test_a_folder_of_it_gives_the_same_database(path, tmp_path):
    folder, again = tmp_path / "folder", tmp_path / "again"
    with Database(path, write=True) as database:
        one = fill(database)
        export_folder(database, database.objects.all(), str(folder))
        with pytest.raises(FileExistsError, match="folder is there already"):
            export_folder(database, database.objects.all(), str(folder))
    lines, checked = [], []
    with Database(str(tmp_path / "other.db"), write=True) as database:

        def imported(replace):
            with database.transaction():
                return import_folder(database, str(folder), replace, checked.append, lines.append)

        assert imported(False) == 1 and checked == [b"mesh"]
        export_folder(database, database.objects.all(), str(again))
        assert imported(False) == 0 and imported(True) == 1
        assert len(database.objects.all()) == 1
    assert lines == [
        f"{one.id} added",
        f"{one.id} is there already, and stays as it is",
        f"{one.id} replaced",
    ]
    assert contents(folder) == contents(again)
    assert (folder / one.id / "mesh" / "files" / "coke.obj").read_bytes() == b"file"
    assert sorted(os.listdir(tmp_path)) == ["again", "folder", "new", "other.db"]


def test_a_folder_gets_its_name_when_all_of_it_is_on_the_disk(path, tmp_path, monkeypatch):
    synced, usual = set(), os.fsync

    def fsync(file):
        assert not (tmp_path / "folder").exists()
        synced.add(os.fstat(file).st_ino)
        usual(file)

    with Database(path, write=True) as database:
        fill(database)
        monkeypatch.setattr(os, "fsync", fsync)
        export_folder(database, database.objects.all(), str(tmp_path / "folder"))
    files = [one for one in (tmp_path / "folder").rglob("*") if one.is_file()]
    assert {one.stat().st_ino for one in files} <= synced and len(files) > 10


@pytest.mark.parametrize(
    "name, old, new, said",
    [
        (
            "database.json",
            "robot_vision objects",
            "x",
            "database.json: it is of .*, must be 'robot",
        ),
        ("database.json", '"objects": [', '"objects": [1, ', "objects is .*, must be a list of te"),
        ("*/object.json", '"coke"', "7", "object.json: object_name is 7, must be a text"),
        ("*/object.json", "{", "[" * 100000, "object.json: it is nested too deeply"),
        ("*/mesh/mesh.json", '"coke.obj"', '"../../x"', "must be a name without a folder"),
        ("*/mesh/mesh.json", '"unit": 0.001', '"unit": NaN', "unit is nan, must be a number"),
        ("*/mesh/mesh.json", '"fold": 0', '"fold": 1', "fold is 1, must be 0 .*or from 2"),
        ("*/mesh/mesh.json", '"label.png"', '"gone.png"', "gone.png cannot be read: No such file"),
        ("*/sessions/*/session.json", "525.0", '"x"', "observation 0: K is 'x', must be a number"),
        ("*/sessions/*/session.json", '"_id": "', '"_id": "/', "session.json: _id is '/.*, must"),
        ("*/sessions/*/session.json", '_id": "', '_id": "../', r"session.json: _id is '\.\./"),
        ("*/sessions/*/session.json", '3,\n   "K"', '3,\n   "_id": "x",\n   "K"', "0: _id is 'x'"),
        (
            "*/mesh/mesh.json",
            '"coke.obj"',
            r'"\udce9.obj"',
            r"mesh.json: original is '\\udce9.obj'",
        ),
        (
            "*/mesh/mesh.json",
            '"label.png"',
            r'"\ud800.png"',
            "mesh.json: files is .*, must be a list",
        ),
        ("*/models/LINEMOD.json", '"views": 3', '"views": [', "LINEMOD.json: "),
    ],
)
def test_a_folder_with_something_wrong_adds_nothing(path, tmp_path, name, old, new, said):
    folder = tmp_path / "folder"
    with Database(path, write=True) as database:
        fill(database)
        export_folder(database, database.objects.all(), str(folder))
    (spoilt,) = folder.glob(name)
    text = spoilt.read_text()
    assert old in text
    spoilt.write_text(text.replace(old, new, 1))
    with Database(str(tmp_path / "other.db"), write=True) as database:
        refused = pytest.raises((OSError, ValueError), match=said)
        with refused, database.transaction():
            import_folder(database, str(folder), False, lambda data: None)
        assert database.objects.all() == []


@pytest.mark.parametrize("name", ["{}/taken", "../../../taken", "..", "a/b", ""])
@pytest.mark.parametrize(
    "changes",
    [
        ["UPDATE sessions SET id = ?", "UPDATE observations SET session_id = ?"],
        ["UPDATE meshes SET file_name = ?"],
        ["UPDATE mesh_files SET name = ? WHERE name = 'label.png'"],
        ["UPDATE models SET method = ? || '/x'"],
    ],
    ids=["session", "mesh", "texture", "method"],
)
def test_names_of_others_lead_to_no_file_outside_of_the_folder(path, tmp_path, name, changes):
    with Database(path, write=True) as database:
        fill(database)
    with contextlib.closing(sqlite3.connect(path)) as file, file:
        for change in changes:
            file.execute(change, (name.format(tmp_path),))
    said = "'coke': a file is '.*', must be a name without a folder"
    with Database(path) as database, pytest.raises(ValueError, match=said):
        export_folder(database, database.objects.all(), str(tmp_path / "folder"))
    assert os.listdir(tmp_path) == ["new"]


def test_a_folder_that_cannot_be_finished_is_not_there(path, tmp_path):
    with Database(path, write=True) as database:
        fill(database)

        def interrupt(_line):
            raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            export_folder(
                database, database.objects.all(), str(tmp_path / "folder"), tell=interrupt
            )
    assert os.listdir(tmp_path) == ["new"]
