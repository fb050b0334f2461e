"""training: what needs it is learned, progress is told, and Ctrl-C loses nothing."""

import contextlib
import hashlib
import io
import json
import re
import sqlite3

import pytest

from robot_vision.recognition import methods, training, training_progress, training_run
from robot_vision.recognition.database import (
    Database,
    Mesh,
    Object,
    Symmetry,
    connection,
    models,
)
from robot_vision.recognition.database.blobs import store_blob
from robot_vision.recognition.training_progress import TrainingProgress

TOTAL = 20
STEP = 3
AXIS = Symmetry((0.0, 0.0, 1.0))


class Views:
    """A trainer whose model is made of all views of a mesh, in their order."""

    def __init__(self, mesh, parameters, state):
        self._mesh, self._seed = mesh, parameters["seed"]
        self._learned = json.loads(state.decode()) if state else []
        self.total = TOTAL
        self.interrupt_at = None

    @property
    def done(self):
        return len(self._learned)

    def step(self):
        if self.done == methods.method_of("LINEMOD").interrupt_at:
            raise KeyboardInterrupt
        for view in range(self.done, min(self.done + STEP, TOTAL)):
            text = b"%s %d %d" % (self._mesh.converted, self._seed, view)
            self._learned.append(hashlib.sha256(text).hexdigest())

    def state(self):
        return json.dumps(self._learned).encode()

    def model(self):
        assert self.done == TOTAL
        return "".join(self._learned).encode()


class Method:
    """A method that learns by Views, and counts from which view trainings began."""

    def __init__(self, name):
        self.name, self.version, self.parameters = name, 1, {"seed": 0}
        self.begun = []
        self.interrupt_at = None

    def complete(self, given):
        if not 0 <= given.get("seed", 0) <= 9:
            raise ValueError(f"seed is {given['seed']}, must be from 0 to 9")
        return {**self.parameters, **given}

    def trainer(self, mesh, parameters, state):
        if mesh.converted == b"bad":
            raise ValueError("the mesh has no triangles")
        made = Views(mesh, parameters, state)
        self.begun.append(made.done)
        return made

    def check_model(self, data):
        if not data.isalnum():
            raise ValueError("the model is damaged")


@pytest.fixture
def method(monkeypatch):
    made = Method("LINEMOD")
    monkeypatch.setattr(methods, "_methods", {"LINEMOD": made, "PPF": Method("PPF")})
    return made


@pytest.fixture
def path(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    return str(tmp_path / "robot_vision_objects.db")


@pytest.fixture
def run(tmp_path, method, path, monkeypatch, capsys):
    """run("word", ..., text=ORK_FILE) runs training: exit code, stdout and stderr."""

    def command(*words, text="pipeline1: {type: LinemodTrainer, object_ids: all}"):
        file = tmp_path / "training.ork"
        file.write_text(text)
        monkeypatch.setattr("sys.argv", ["training", "-c", str(file), *words])
        try:
            code = training.main()
        except SystemExit as error:
            code = error.code
        return (code, *capsys.readouterr())

    return command


def add(path, name, mesh=None, symmetries=()):
    with Database(path, write=True) as database, database.transaction():
        one = database.objects.add(Object(name))
        if mesh is not None:
            database.meshes.set(one.id, Mesh("a.stl", b"file", mesh, symmetries=symmetries))
    return one


def model(path, name, method="LINEMOD"):
    with Database(path) as database:
        return database.models.of(database.objects.find(name).id, method)


def test_what_has_changed_is_learned_and_nothing_else(run, path, method):
    add(path, "coke", b"can")
    code, out, err = run()
    assert (code, err) == (0, "") and method.begun == [0]
    assert out.startswith("coke: LINEMOD: 0 of 20 views\n")
    assert out.endswith("coke: LINEMOD: 20 views learned\n")
    learned = model(path, "coke")
    assert learned.parameters == {"seed": 0} and len(learned.data) == 64 * TOTAL
    code, out, _ = run()
    said = f"coke: LINEMOD: nothing has changed, the model of {learned.added} stays\n"
    assert (code, out, method.begun) == (0, said, [0])
    run(text="pipeline1: {type: LinemodTrainer, seed: 1}")
    assert method.begun == [0, 0] and model(path, "coke").data != learned.data
    run()
    assert method.begun == [0, 0, 0] and model(path, "coke").data == learned.data
    method.version = 2
    run()
    assert len(method.begun) == 4
    with Database(path, write=True) as database, database.transaction():
        one = database.objects.find("coke")
        mesh = Mesh("a.stl", b"file", b"can", symmetries=[Symmetry((0.0, 0.0, 1.0))])
        database.meshes.set(one.id, mesh)
    run()
    assert len(method.begun) == 5
    run("--force")
    assert len(method.begun) == 6 and model(path, "coke").data == learned.data


def test_the_same_mesh_is_learned_once(run, path, method):
    add(path, "coke", b"can")
    add(path, "twin", b"can")
    code, out, _ = run()
    assert code == 0 and method.begun == [0]
    assert re.search("twin: LINEMOD: the model of .* is of the same mesh and parameters\n", out)
    assert model(path, "coke").data == model(path, "twin").data


@pytest.mark.parametrize(
    "changed", [None, Mesh("a.stl", b"", b"box"), Mesh("a.stl", b"", b"can", symmetries=[AXIS])]
)
def test_what_was_changed_meanwhile_gets_no_model_of_another_mesh(path, method, changed):
    one = add(path, "coke", b"can")
    with Database(path, write=True) as database:
        task = training_run.task_of(database, one, method, {})
        with database.transaction():
            database.meshes.delete(one.id)
            if changed is not None:
                database.meshes.set(one.id, changed)
        said = "coke: LINEMOD: what it is learned by was changed just now: train it again"
        with pytest.raises(ValueError, match=said):
            training_run.train(database, task, False)
        assert database.models.of(one.id, "LINEMOD") is None and method.begun == []


@pytest.mark.parametrize("interrupt_at", [0, 3, 18])
def test_ctrl_c_loses_nothing(run, path, method, interrupt_at):
    add(path, "another", b"box")
    add(path, "coke", b"can")
    run("--object_names", "[coke]")
    whole = model(path, "coke").data
    with Database(path, write=True) as database, database.transaction():
        database.models.delete(database.objects.find("coke").id, "LINEMOD")
    method.interrupt_at = interrupt_at
    code, out, err = run("--object_names", "[coke]")
    assert (code, err) == (130, "") and model(path, "coke") is None
    assert out.endswith(
        f"coke: LINEMOD: interrupted; {interrupt_at} of 20 views are stored, from which the next "
        "training goes on\n"
    )
    method.interrupt_at, method.begun = None, []
    assert run()[0] == 0
    assert method.begun == [0, interrupt_at] and model(path, "coke").data == whole
    with Database(path) as database:
        assert database.models.state(model(path, "coke").key) is None


def test_of_trainings_that_nobody_goes_on_with_only_the_newest_are_kept(
    run, path, method, monkeypatch
):
    monkeypatch.setattr(models, "MAX_STATES", 2)
    one = add(path, "coke", b"can")
    method.interrupt_at = 3
    files = [f"pipeline1: {{type: LinemodTrainer, seed: {seed}}}" for seed in range(4)]
    for file in (*files, files[2]):
        assert run(text=file)[0] == 130
    with Database(path) as database:
        keys = [
            training_run.task_of(database, one, method, {"seed": seed}).key for seed in range(4)
        ]
        there = [key for key in keys if database.models.state(key)]
    assert there == keys[2:]
    method.interrupt_at, method.begun = None, []
    assert run(text=files[2])[0] == 0 and method.begun == [3]


def test_what_was_stored_is_not_used_if_it_cannot_be(run, path, method, monkeypatch):
    add(path, "coke", b"can")
    method.interrupt_at = 3
    assert run()[0] == 130
    method.interrupt_at = None
    usual = method.trainer

    def picky(mesh, parameters, state):
        if state:
            raise ValueError("it is of another machine")
        return usual(mesh, parameters, state)

    monkeypatch.setattr(method, "trainer", picky)
    code, out, _ = run()
    assert code == 0 and "coke: LINEMOD: what was done is not used: it is of another mac" in out
    assert model(path, "coke") is not None
    method.interrupt_at = 3
    assert run("--force")[0] == 130
    method.interrupt_at = None
    assert run("--force")[0] == 0 and method.begun[-1] == 0


def test_a_long_training_is_stored_now_and_then(run, path, method, monkeypatch):
    add(path, "coke", b"can")
    monkeypatch.setattr(training_run, "SAVE_PERIOD", 0.0)
    stored = []
    usual = training_run._store

    def store(database, key, trainer):
        stored.append(trainer.done)
        usual(database, key, trainer)

    monkeypatch.setattr(training_run, "_store", store)
    assert run()[0] == 0 and stored == [3, 6, 9, 12, 15, 18, 20]


def test_a_long_training_goes_on_while_another_program_writes(run, path, method, monkeypatch):
    add(path, "coke", b"can")
    monkeypatch.setattr(training_run, "SAVE_PERIOD", 0.0)
    monkeypatch.setattr(connection, "TIMEOUT", 0.0)
    usual = training_run._store

    def store(database, key, trainer):
        with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as other:
            other.execute("BEGIN IMMEDIATE" if trainer.done == 6 else "BEGIN")
            usual(database, key, trainer)

    monkeypatch.setattr(training_run, "_store", store)
    code, out, err = run()
    assert (code, err) == (0, "")
    said = f"coke: LINEMOD: what was done is not stored yet: {path} is being written by another"
    assert out.count(said) == 1 and out.endswith("coke: LINEMOD: 20 views learned\n")
    assert model(path, "coke") is not None


def test_a_model_waits_until_another_program_has_written(run, path, method, monkeypatch):
    add(path, "coke", b"can")
    monkeypatch.setattr(training_run, "SAVE_PERIOD", 0.0)
    monkeypatch.setattr(connection, "TIMEOUT", 0.0)
    store, tell = training_run._store, training_run.TrainingProgress.tell
    other = sqlite3.connect(path, isolation_level=None)

    def store_and_write(database, key, trainer):
        store(database, key, trainer)
        if trainer.done == trainer.total:
            other.execute("BEGIN IMMEDIATE")

    def tell_and_end(progress, text):
        tell(progress, text)
        if "not stored yet" in text:
            other.execute("ROLLBACK")

    monkeypatch.setattr(training_run, "_store", store_and_write)
    monkeypatch.setattr(training_run.TrainingProgress, "tell", tell_and_end)
    with contextlib.closing(other):
        code, out, err = run()
    assert (code, err) == (0, "")
    said = f"coke: LINEMOD: the model is not stored yet: {path} is being written by another"
    assert out.count(said) == 1 and out.endswith("coke: LINEMOD: 20 views learned\n")
    assert model(path, "coke") is not None


def test_objects_without_a_mesh(run, path, method):
    one = add(path, "bare")
    code, _, err = run()
    lack = f"'bare' has no mesh: mesh_add.py {one.id[:8]} FILE --commit adds it"
    assert code == 1 and err == (
        f"left out: {lack}\ntraining: no object in {path} has a mesh that could be learned\n"
    )
    add(path, "coke", b"can")
    code, out, err = run()
    assert (code, err) == (0, f"left out: {lack}\n") and "coke: LINEMOD: 20 views learned" in out
    code, _, err = run("--object_names", "[coke, bare]", "--force")
    told = f"not learned: {lack}\ntraining: not all objects were learned\n"
    assert (code, err, len(method.begun)) == (1, told, 2)
    code, _, err = run("--object_ids", "nothing")
    assert (code, err) == (1, f"training: there is no object 'nothing' in {path}\n")
    assert run("--object_ids", "missing")[0] == 0


def test_what_has_no_mesh_leaves_other_pipelines(run, path):
    one = add(path, "bare")
    add(path, "coke", b"can")
    text = """
pipeline1: {type: LinemodTrainer, object_names: [bare]}
pipeline2: {type: PpfTrainer, object_names: [coke]}
"""
    code, _, err = run(text=text)
    lack = f"'bare' has no mesh: mesh_add.py {one.id[:8]} FILE --commit adds it"
    assert code == 1 and err.splitlines()[0] == f"not learned: {lack}"
    assert model(path, "coke", "PPF") is not None
    with Database(path, write=True) as database, database.transaction():
        database.objects.delete(database.objects.find("coke").id)
    text = "pipeline1: {type: LinemodTrainer}\npipeline2: {type: PpfTrainer}"
    code, _, err = run(text=text)
    assert code == 1 and err.splitlines() == [
        f"left out: {lack}",
        f"left out: {lack}",
        f"training: no object in {path} has a mesh that could be learned",
    ]


@pytest.mark.parametrize("damage", ["blobs SET data = x'00' WHERE sha256 =", "models SET data ="])
def test_a_model_that_cannot_be_used_is_learned_anew(run, path, method, damage):
    """Damaged in the database, or another program's with the right key."""
    for name in ("coke", "twin"):
        add(path, name, b"can")
    assert run()[0] == 0 and len(method.begun) == 1, "the twin has what was learned of the other"
    good = model(path, "coke").data
    with Database(path, write=True) as database, database.transaction():
        other = store_blob(database.models._connection, b"no model")
    stored = hashlib.sha256(good).hexdigest()
    with contextlib.closing(sqlite3.connect(path)) as file, file:
        file.execute(f"UPDATE {damage} ?", [stored if "blobs" in damage else other])
    code, out, err = run()
    assert (code, err) == (0, "") and "LINEMOD: the model that is there is not used: " in out
    assert [model(path, name).data for name in ("coke", "twin")] == [good, good]
    assert "stays" in run()[1]


def test_a_mesh_that_cannot_be_learned(run, path):
    add(path, "coke", b"bad")
    code, out, err = run()
    said = "not learned: coke: LINEMOD: the mesh has no triangles\n"
    assert (code, out, err) == (1, "", f"{said}training: not all objects were learned\n")


def test_what_cannot_be_learned_leaves_the_others(run, path):
    """Also what is damaged in the database."""
    add(path, "bottle", b"bad")
    damaged = add(path, "box", b"box")
    add(path, "coke", b"can")
    with contextlib.closing(sqlite3.connect(path)) as file, file:
        values = "[7]", damaged.id
        file.execute("UPDATE meshes SET symmetries = ? WHERE object_id = ?", values)
    text = "pipeline1: {type: LinemodTrainer}\npipeline2: {type: PpfTrainer}"
    code, _, err = run(text=text)
    titles = [f"not learned: {name}" for name in PIPELINES_OF_BAD]
    assert code == 1 and [": ".join(one.split(": ")[:3]) for one in err.splitlines()[:-1]] == titles
    assert model(path, "coke") is not None and model(path, "coke", "PPF") is not None


def test_where_no_object_can_be_learned_only_the_reasons_are_told(run, path):
    """Of each pipeline: the ones behind it are looked at all the same."""
    damaged = add(path, "box", b"box")
    with contextlib.closing(sqlite3.connect(path)) as file, file:
        values = "[7]", damaged.id
        file.execute("UPDATE meshes SET symmetries = ? WHERE object_id = ?", values)
    code, _, err = run(text="pipeline1: {type: LinemodTrainer}\npipeline2: {type: PpfTrainer}")
    *reasons, end = err.splitlines()
    titles = ["not learned: box: LINEMOD: symmetries", "not learned: box: PPF: symmetries"]
    assert code == 1 and [one.split(" is ")[0] for one in reasons] == titles
    assert end == "training: not all objects were learned"


# What is damaged is told before the trainings of a pipeline begin.
PIPELINES_OF_BAD = ["box: LINEMOD", "bottle: LINEMOD", "box: PPF", "bottle: PPF"]


def test_several_pipelines(run, path, method, tmp_path):
    add(path, "coke", b"can")
    text = """
pipeline1: {type: LinemodTrainer, threshold: 80, colour: red, db: {type: CouchDB, root: "http://a"}}
pipeline2: {type: PpfTrainer, object_ids: all}
pipeline3: {type: TabletopTableDetector}
"""
    code, _, err = run(text=text)
    file = tmp_path / "training.ork"
    assert code == 0 and err.splitlines() == [
        f"warning: {file}: pipeline1: threshold is not used: the threshold of the live parameters "
        "is a probability",
        f"warning: {file}: pipeline1: colour is not known, and not used",
        f"warning: {file}: pipeline1: the CouchDB at http://a is not used: the database is {path}",
    ]
    assert model(path, "coke", "LINEMOD").data == model(path, "coke", "PPF").data


@pytest.mark.parametrize(
    "text, code, said",
    [
        (
            "pipeline1: {type: TodTrainer}",
            1,
            "method is 'TOD', must be one that learns: LINEMOD, P",
        ),
        ("pipeline1: {type: TabletopTableDetector}", 1, "no pipeline in it learns anything"),
        ("pipeline1: {type: LINEMOD, seed: 10}", 1, "pipeline1: seed is 10, must be from 0 to 9"),
        ("pipeline1: {type: LINEMOD, db: {root: 7}}", 1, "root of the database is 7, must be text"),
    ],
)
def test_files_that_cannot_be_used(run, path, text, code, said):
    add(path, "coke", b"can")
    found, _, err = run(text=text)
    assert found == code and said in err and len(err.splitlines()) == 1
    assert model(path, "coke") is None


def test_no_database(run, path):
    code, _, err = run()
    said = f"training: there is no database {path}: object_add.py makes it\n"
    assert (code, err) == (1, said)


def test_another_database(run, tmp_path, method):
    other = str(tmp_path / "other.db")
    add(other, "coke", b"can")
    assert run("--database", other)[0] == 0
    assert run(text=f"pipeline1: {{type: LINEMOD, db: {{type: SQLite, root: {other}}}}}")[0] == 0
    assert method.begun == [0]


def test_an_error_has_a_line_of_its_own_on_a_terminal():
    terminal = Terminal()
    with pytest.raises(ValueError), TrainingProgress("coke: PPF", 0, 200, terminal):
        raise ValueError
    assert terminal.getvalue() == "\r\033[K"


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_progress_on_a_terminal_and_elsewhere(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(training_progress.time, "monotonic", lambda: now[0])
    terminal, lines = Terminal(), io.StringIO()
    progresses = [TrainingProgress("coke: PPF", 40, 200, one) for one in (terminal, lines)]
    for done in range(50, 201, 10):
        now[0] += 0.15
        for progress in progresses:
            progress.update(done)
    for progress in progresses:
        progress.tell("200 views learned")
    told = terminal.getvalue().split("\r")
    assert told[1] == "coke: PPF: 60 of 200 views, 0:03 min left\033[K"
    assert told[-2].startswith("coke: PPF: 200 of 200 views") and len(told) == 10
    assert told[-1] == "\033[Kcoke: PPF: 200 views learned\n"
    assert lines.getvalue().splitlines() == [
        "coke: PPF: 40 of 200 views",
        *(f"coke: PPF: {done} of 200 views, 0:0{left} min left" for done, left in LEFT),
        "coke: PPF: 200 views learned",
    ]


# 20 views in 0.3 s: what is left of 200, rounded up.
LEFT = [(60, 3), (80, 2), (100, 2), (120, 2), (140, 1), (160, 1), (180, 1)]
