"""object_add.py, object_search.py and object_delete.py, as object_recognition_core has them."""

import contextlib
import os
import re
import sqlite3

import pytest

from robot_vision.meshes import sample_mesh
from robot_vision.recognition import object_add, object_delete, object_list, object_search
from robot_vision.recognition.database import Database, Mesh, Model, Session
from robot_vision.recognition.mesh_data import pack_mesh

COMMIT = "Use the --commit option to commit the proposed change."


@pytest.fixture
def path(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_HOME", str(tmp_path / "ros"))
    return str(tmp_path / "ros" / "robot_vision_objects.db")


@pytest.fixture
def run(path, monkeypatch, capsys):
    """run(module, "word", ...) runs a command: exit code, stdout and stderr."""

    def command(module, *words):
        monkeypatch.setattr("sys.argv", [module.PROGRAM, *words])
        try:
            code = module.main()
        except SystemExit as error:
            code = error.code
        return (code, *capsys.readouterr())

    return command


@pytest.fixture
def add(run):
    """add("-n", "coke", ...) adds an object, and returns its id."""

    def added(*words):
        code, out, err = run(object_add, *words, "--commit")
        assert (code, err) == (0, "")
        return re.fullmatch("Stored new object with id: ([0-9a-f]{32})\n", out)[1]

    return added


def test_as_the_course_types_it(run, add, path):
    one = add("-n", "coke ", "-d", "A universal can of coke")
    code, out, err = run(object_search)
    assert (code, err) == (0, "")
    assert f"db id: {one}\n" in out and "Object Name: coke\nDescription: A universal can" in out
    with Database(path) as database:
        assert database.objects.find("coke").id == one


def test_without_commit_it_is_told_and_nothing_is_done(run, add, path):
    code, out, _ = run(object_add, "-n", "coke", "-t", "can,red")
    assert code == 0 and not os.path.exists(os.path.dirname(path))
    told = "would add the object 'coke', tags: can, red"
    assert out == f"would make the database {path}\n{told}\n{COMMIT}\n"
    one = add("-n", "coke")
    code, out, _ = run(object_add, "-n", "bottle")
    assert (code, out) == (0, f"would add the object 'bottle'\n{COMMIT}\n")
    code, out, _ = run(object_delete, "coke")
    assert (code, out) == (0, f"would delete the object {one} 'coke'\n{COMMIT}\n")
    with Database(path) as database:
        assert [found.id for found in database.objects.all()] == [one]


def test_tags_and_authors(run, add, path):
    add(
        "-n",
        "coke",
        "-t",
        "can,red",
        "-t",
        "drink",
        "-a",
        "Ada",
        "-e",
        "ada@example.com",
        "tin",
        "red",
    )
    add("-n", "bottle", "-d", "of Glass", "glass")
    assert "Tags: can,red,drink,tin\nAuthor: Ada\nemail: ada@example.com\n" in run(object_search)[1]
    for words, names in (
        (["-t", "can"], ["coke"]),
        (["glass"], ["bottle"]),
        (["GLASS", "bott"], ["bottle"]),
        ([], ["bottle", "coke"]),
    ):
        code, out, _ = run(object_search, *words)
        assert code == 0 and re.findall("Object Name: (.*)", out) == names
    code, out, err = run(object_search, "-t", "ca")
    assert (code, out, err) == (1, "", f"object_search.py: no such object in {path}\n")


def test_a_name_that_is_there_is_not_added_by_accident(run, add, path):
    one = add("-n", "coke")
    for words in ([], ["--commit"]):
        code, _, err = run(object_add, "-n", " coke", *words)
        assert code == 1 and err == (
            f"object_add.py: there is an object 'coke' already, {one}; --another adds one more of "
            "this name\n"
        )
    assert add("-n", "coke", "--another") != one
    code, _, err = run(object_delete, "coke", "--commit")
    assert code == 1 and "'coke' may be one of 2 objects" in err
    assert run(object_delete, one, "--commit")[0] == 0
    assert run(object_delete, "coke", "--commit")[0] == 0
    code, _, err = run(object_search)
    assert (code, err) == (1, f"object_search.py: no such object in {path}\n")


def test_all_that_is_of_an_object_is_deleted_and_told(run, add, path):
    one, other = add("-n", "coke"), add("-n", "bottle")
    with Database(path, write=True) as database, database.transaction():
        database.meshes.set(one, Mesh("coke.stl", b"file", b"mesh"))
        database.models.set(Model(one, "LINEMOD", {}, "key", b"learned"))
    said = f"the object {one} 'coke' with the mesh coke.stl, the model LINEMOD"
    assert run(object_delete, one[:6], "nothing", "--commit") == (
        *(1, ""),
        f"object_delete.py: there is no object 'nothing' in {path}\n",
    )
    assert "mesh: coke.stl\nmodels: LINEMOD\n" in run(object_search, "coke")[1]
    code, out, _ = run(object_delete, one[:6], "coke", "--commit")
    assert (code, out) == (0, f"Deleted {said}\n")
    with Database(path) as database:
        assert [found.id for found in database.objects.all()] == [other]


def test_text_of_others_does_not_reach_the_terminal_as_it_is(run, add, path):
    one = add("-n", "coke")
    with Database(path, write=True) as database, database.transaction():
        database.meshes.set(one, Mesh("\x1b[2J.stl", b"", pack_mesh(sample_mesh("nut").mesh)))
        database.models.set(Model(one, "\x1b[3J", {}, "key", b"learned"))
        database.observations.add_session(Session(one, id="\x1b[4J"))
    with contextlib.closing(sqlite3.connect(path)) as file, file:
        file.execute("UPDATE objects SET added = ?", ("\x1b[5J",))
    for module, words, parts in (
        (object_list, [], "23"),
        (object_search, [], "2345"),
        (object_delete, ["coke"], "23"),
        (object_delete, ["coke", "--commit"], "23"),
    ):
        code, out, _ = run(module, *words)
        assert code == 0 and "\x1b" not in out
        assert all(f"\\x1b[{part}J" in out for part in parts)


@pytest.mark.parametrize(
    "words, used, said",
    [
        (["--database", "{}/own.db"], "own.db", ""),
        (["--db_root", "{}/own.db"], "own.db", ""),
        (["--db_type", "SQLite", "--db_root", "file://{}/own%20one.db"], "own one.db", ""),
        (
            ["--db_type", "CouchDB", "--db_root", "http://localhost:5984"],
            "ros/robot_vision_objects.db",
            "warning: the CouchDB at http://localhost:5984 is not used: the database is {}\n",
        ),
        (
            ["--db_root", "http://a:5984", "--db_collection", "object_recognition"],
            "ros/robot_vision_objects.db",
            "warning: the server at http://a:5984 is not used: the database is {}\n",
        ),
        (
            ["--db_collection", "kitchen"],
            "ros/robot_vision_objects.db",
            "warning: there are no collections, as 'kitchen': all of {} is used\n",
        ),
    ],
)
def test_which_database_is_meant(run, path, tmp_path, words, used, said):
    words = [word.format(tmp_path) for word in words]
    code, _, err = run(object_add, "-n", "coke", "--commit", *words)
    assert (code, err) == (0, said.format(tmp_path / used))
    with Database(str(tmp_path / used)) as database:
        assert len(database.objects.all()) == 1


@pytest.mark.parametrize(
    "module, words, said",
    [
        (object_add, [], "the following arguments are required: -n/--object_name"),
        (object_add, ["-n", " "], "the name of an object is ' ', must be a name of 1 to 255"),
        (object_add, ["-n", "a", "-t", "b\x1b"], r"a tag is 'b\x1b', must be a name"),
        (object_delete, [], "the following arguments are required: OBJECT"),
    ],
)
def test_usage_errors(run, path, module, words, said):
    code, _, err = run(module, *words, "--commit")
    assert code == 2 and said in err and not os.path.exists(path)


@pytest.mark.parametrize(
    "module, words", [(object_search, []), (object_delete, ["coke", "--commit"])]
)
def test_no_database_is_told(run, path, module, words):
    said = f"{module.PROGRAM}: there is no database {path}: object_add.py makes it\n"
    assert run(module, *words) == (1, "", said)
    assert not os.path.exists(os.path.dirname(path))
