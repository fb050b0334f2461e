"""The method TOD: what it learns by, interruptions, and what it says of what it cannot learn."""

import contextlib
import os
import sqlite3

import cv2
import numpy as np
import pytest
from fake_params import use_params
from textured_boxes import CAMERA, box

from robot_vision import PlaneParams, TabletopParams, TextureModel
from robot_vision.meshes import MeshRenderer
from robot_vision.recognition import object_source, training
from robot_vision.recognition.database import (
    Database,
    Mesh,
    Model,
    Object,
    Observation,
    Session,
    Symmetry,
)
from robot_vision.recognition.known_objects import load_objects
from robot_vision.recognition.mesh_data import pack_mesh
from robot_vision.recognition.observed_views import ObservationSource, extent_of, seen_by
from robot_vision.recognition.recognition_settings import Settings
from robot_vision.recognition.recognizer import RecognitionParams
from robot_vision.recognition.texture_method import TEXTURES, box_around
from robot_vision.recognition.training_run import task_of, train

SIZE = np.array([0.10, 0.15, 0.06])  # m
FAST = {"subdivisions": 0, "scales": 2}
ORK = "pipeline1: {type: TodTrainer, object_ids: all, parameters: {subdivisions: 0, scales: 2}}"


@pytest.fixture(scope="module")
def mesh():
    return box(SIZE, 5)


@pytest.fixture
def path(tmp_path):
    return str(tmp_path / "objects.db")


@pytest.fixture
def run(tmp_path, path, monkeypatch, capsys):
    """run("word", ...) runs training: exit code, stdout and stderr."""
    file = tmp_path / "training.ork"
    file.write_text(ORK)

    def command(*words):
        monkeypatch.setattr("sys.argv", ["training", "--database", path, "-c", str(file), *words])
        return (training.main(), *capsys.readouterr())

    return command


def add(path, name, mesh=None):
    with Database(path, write=True) as database, database.transaction():
        one = database.objects.add(Object(name))
        if mesh is not None:
            database.meshes.set(one.id, Mesh("a.ply", b"file", pack_mesh(mesh)))
    return one


def png(pixels):
    return cv2.imencode(".png", pixels)[1].tobytes()


def observe(path, one, mesh, count, **changes):
    """Adds observations from around an object."""
    renderer = MeshRenderer(mesh)
    with Database(path, write=True) as database, database.transaction():
        session = database.observations.add_session(Session(one.id, "test"))
        for number in range(count):
            pose = np.eye(4)
            turn = cv2.Rodrigues(np.array([0.0, 2.0 * np.pi * number / count, 0.0]))[0]
            pose[:3, :3] = cv2.Rodrigues(np.array([-0.5, 0.0, 0.0]))[0] @ turn
            pose[:3, 3] = 0.0, 0.0, 0.5
            view = renderer.render(CAMERA, pose, (0, 0, CAMERA.width, CAMERA.height), bgr=True)
            seen = np.isfinite(view.depth)
            depth = np.where(seen, np.rint(1000.0 * np.nan_to_num(view.depth)), 1500.0)
            parts = {
                "rgb": png(view.bgr),
                "depth": png(depth.astype(np.uint16)),
                "mask": png(np.where(seen, 255, 0).astype(np.uint8)),
                **changes,
            }
            new = Observation(session.id, number, matrix=CAMERA.K, pose=pose, **parts)
            database.observations.add(new)


def model_of(path, name):
    with Database(path) as database:
        return database.models.of(database.objects.find(name).id, "TOD").data


def test_a_mesh_is_learned_the_same_each_time(run, path, mesh):
    add(path, "tea", mesh)
    code, out, err = run()
    assert (code, err) == (0, "") and out.endswith("tea: TOD: 12 views learned\n")
    first = model_of(path, "tea")
    assert len(TextureModel.from_bytes(first)) > 300
    assert "nothing has changed" in run()[1]
    assert run("--force")[0] == 0
    assert model_of(path, "tea") == first


def test_observations_are_learned_rather_than_a_mesh_and_anew_when_there_are_more(run, path, mesh):
    one = add(path, "tea", mesh)
    observe(path, one, mesh, 10)
    assert run()[1].endswith("tea: TOD: 10 views learned\n")
    by_observations = TextureModel.from_bytes(model_of(path, "tea"))
    assert np.abs(by_observations.positions).max() < 0.08
    # Nothing is known of the side that was never seen, as the camera stayed on one level.
    heights = by_observations.positions[:, 1]
    on_sides = [(np.abs(heights - end) < 0.001).sum() for end in (-SIZE[1] / 2, SIZE[1] / 2)]
    assert min(on_sides) == 0 and max(on_sides) > 0
    assert "nothing has changed" in run()[1]
    observe(path, one, mesh, 3)
    assert run()[1].endswith("tea: TOD: 13 views learned\n")


def test_observations_that_were_changed_meanwhile_are_not_learned(path, mesh):
    one = add(path, "tea")
    observe(path, one, mesh, 2)
    with Database(path, write=True) as database:
        task = task_of(database, one, TEXTURES, FAST)
        observe(path, one, mesh, 1)
        with pytest.raises(ValueError, match="tea: TOD: what it is learned by was changed just"):
            train(database, task, False)
        assert database.models.of(one.id, "TOD") is None


def test_a_training_that_was_interrupted_ends_with_the_same_bytes(path, mesh):
    one = add(path, "tea")
    observe(path, one, mesh, 10)
    with Database(path) as database:
        source = ObservationSource(database, one.id)
        parameters = TEXTURES.complete(FAST)
        for begin in (
            lambda state: TEXTURES.trainer_of_observations(source, parameters, state),
            lambda state: TEXTURES.trainer(Mesh("", b"", pack_mesh(mesh)), parameters, state),
        ):
            whole, part = begin(None), begin(None)
            part._learn(0)
            part._learn(1)
            rest = begin(part.state())
            assert rest.done == 2 and rest.total == whole.total
            for trainer in (whole, rest):
                while trainer.done < trainer.total:
                    trainer.step()
            assert whole.model() == rest.model()


def test_a_state_of_something_else_is_refused(path, mesh):
    stored = Mesh("", b"", pack_mesh(mesh))
    state = TEXTURES.trainer(stored, TEXTURES.complete(FAST), None).state()
    with pytest.raises(ValueError, match="it is of other parameters"):
        TEXTURES.trainer(stored, TEXTURES.complete({}), state)
    with pytest.raises(ValueError, match="the beginning of a trained model"):
        TEXTURES.trainer(stored, TEXTURES.complete(FAST), b"something else")


def test_what_has_no_texture_says_so_and_the_others_are_learned(run, path, mesh):
    add(path, "plain", box(SIZE, 0, plain=True))
    add(path, "tea", mesh)
    code, out, err = run()
    assert code == 1 and err.startswith("not learned: plain: TOD: the number of keypoints of the ")
    assert "it has too little texture, and needs a method that knows shapes" in err
    assert out.endswith("tea: TOD: 12 views learned\n")
    with Database(path) as database:
        assert database.models.of(database.objects.find("plain").id, "TOD") is None


def test_observations_that_cannot_be_used_say_which(run, path, mesh):
    one = add(path, "tea")
    observe(path, one, mesh, 1, depth=png(np.zeros((48, 64), np.uint16)))
    code, _, err = run()
    assert code == 1 and "must have 16 bits, and all its images the same size" in err
    assert "tea: TOD: observation " in err


def test_nothing_seen_is_told(run, path, mesh):
    one = add(path, "tea")
    observe(path, one, mesh, 2, mask=png(np.zeros((CAMERA.height, CAMERA.width), np.uint8)))
    code, _, err = run()
    assert code == 1 and "no depth of the object is in its observations" in err


def test_views_that_are_spread_best_are_taken(path, mesh):
    one = add(path, "tea")
    observe(path, one, mesh, 12)
    with Database(path) as database:
        source = ObservationSource(database, one.id)
        numbers = [source.of(number).frame_number for number in source.spread(4)]
        assert numbers in ([0, 3, 6, 9], [0, 2, 6, 9], [0, 3, 6, 10], [0, 4, 6, 9], [0, 3, 6, 8])
        assert len(source.spread(100)) == 12
        assert ObservationSource(database, "nobody").spread(3) == []


def test_the_extent_is_that_of_what_is_seen(path, mesh):
    one = add(path, "tea")
    observe(path, one, mesh, 12)
    with Database(path) as database:
        source = ObservationSource(database, one.id)
        center, size = extent_of(source.of(number) for number in source.spread(12))
        seen = seen_by(source.of(source.spread(1)[0]))
    assert np.abs(center).max() < 0.006
    assert np.abs(size - SIZE).max() < 0.012
    assert set(np.unique(seen.mask)) == {0, 255}


def test_a_box_stands_for_what_has_no_mesh(path, mesh, run):
    one = add(path, "tea")
    observe(path, one, mesh, 10)
    assert run()[0] == 0
    stands = box_around({"TOD": model_of(path, "tea")})
    low, high = stands.vertices.min(axis=0), stands.vertices.max(axis=0)
    assert np.abs(high - low - SIZE).max() < 0.015 and len(stands.triangles) == 12
    with pytest.raises(ValueError, match="it has no mesh"):
        box_around({"LINEMOD": b""})


def cup(path, data=None, parameters=None, mesh=None):
    """Stores another model or mesh of the cup than it has, as a file of others may have them."""
    with Database(path, write=True) as database, database.transaction():
        one = database.objects.find("cup")
        model = database.models.of(one.id, "TOD")
        given = model.parameters if parameters is None else parameters
        database.models.set(Model(one.id, "TOD", given, model.key, data or model.data))
        if mesh is not None:
            database.meshes.set(one.id, Mesh("a.ply", b"file", mesh))


@pytest.mark.parametrize(
    "changes, said",
    [
        ({"data": b"no model"}, "by TOD: the beginning of a trained model is"),
        ({"parameters": {"foo": 1}}, "by TOD: 'foo' is no parameter, must be one of "),
        ({"parameters": {"scales": 10**30}}, "by TOD: scales is 1000000000000000000000000000000"),
        ({"parameters": {"scales": [1]}}, "by TOD: scales is [1], must be of the type int"),
        ({"parameters": {"scales": 99}}, "by TOD: scales is 99, must be from 1 to 4"),
        ({"parameters": [1]}, "is damaged: parameters is [1]"),
        ({"mesh": b"no mesh"}, ": it is no mesh: "),
    ],
)
def test_what_of_an_object_cannot_be_used_is_told_and_the_others_are_there(
    run, path, mesh, changes, said
):
    for name in ("tea", "cup"):
        add(path, name, mesh)
    assert run()[0] == 0
    cup(path, **changes)
    loaded = load_objects(path, [], ["TOD"])
    assert ([one.name for one in loaded.objects], loaded.problem) == (["tea"], "")
    (told,) = [line for line in loaded.lacks if said in line]
    assert told.startswith("'cup' is not recognized")
    assert load_objects(path, ["cup"], ["TOD"]) == (
        [],
        [],
        f"no object in {path} can be used: {told}",
    )


def test_what_cannot_be_learned_is_no_lack_where_another_method_knows_it(run, path, mesh):
    """It has been captured without a mesh, or the mesh that was learned is no more."""
    tea = add(path, "tea")
    observe(path, tea, mesh, 10)
    assert run()[0] == 0
    with Database(path, write=True) as database, database.transaction():
        database.models.set(Model(tea.id, "PPF", {}, "key", b"of a mesh that is no more"))
    loaded = load_objects(path, [], ["LINEMOD", "PPF", "TOD"])
    assert [sorted(one.models) for one in loaded.objects] == [["TOD"]]
    assert (loaded.lacks, loaded.problem) == ([], "")
    said = f"no object in {path} has a mesh to learn it by: mesh_add.py adds them"
    assert load_objects(path, [], ["LINEMOD"]) == ([], [], said)
    add(path, "cup", mesh)
    loaded = load_objects(path, [], ["LINEMOD"])
    assert loaded.problem == f"no object in {path} was learned by LINEMOD: training does it"


def test_names_that_are_not_there_leave_the_others(run, path, mesh):
    tea = add(path, "tea", mesh)
    assert run()[0] == 0
    loaded = load_objects(path, ["tea", "nothing", tea.id], ["TOD"])
    assert ([one.name for one in loaded.objects], loaded.problem) == (["tea"], "")
    assert loaded.lacks == [f"there is no object 'nothing' in {path}"]
    alone = load_objects(path, ["nothing"], ["TOD"])
    assert (alone.objects, alone.problem) == ([], f"there is no object 'nothing' in {path}")


def test_an_object_is_kept_until_something_of_it_changes(run, path, mesh):
    """Also while others are added, trained, observed and deleted."""
    tea = add(path, "tea", mesh)
    assert run()[0] == 0
    (first,) = load_objects(path, [], ["TOD"]).objects

    def kept():
        loaded = load_objects(path, [], ["TOD"], [first])
        return [one is first for one in loaded.objects if one.id == tea.id], loaded.lacks

    cup = add(path, "cup", mesh)
    observe(path, cup, mesh, 10)
    assert run()[0] == 0
    assert kept() == ([True], [])
    observe(path, tea, mesh, 10)
    assert kept() == ([True], ["'tea' has changed since TOD has learned it: training does it"])
    assert run()[0] == 0
    assert kept() == ([False], [])


@pytest.mark.parametrize("change", ["name", "mesh", "symmetries", "model"])
def test_an_object_is_loaded_anew_if_it_has_changed(run, path, mesh, change):
    tea = add(path, "tea", mesh)
    assert run()[0] == 0
    before = load_objects(path, [], ["TOD"]).objects
    with contextlib.closing(sqlite3.connect(path)) as file, file:
        if change == "name":
            file.execute("UPDATE objects SET name = 'coffee'")
        elif change == "model":
            file.execute("UPDATE models SET key = ?", ("0" * 64,))
    with Database(path, write=True) as database, database.transaction():
        if change == "mesh":
            database.meshes.set(tea.id, Mesh("a.ply", b"", pack_mesh(box(2.0 * SIZE, 6))))
        elif change == "symmetries":
            turns = [Symmetry((0.0, 1.0, 0.0), 2)]
            database.meshes.set(tea.id, Mesh("a.ply", b"", pack_mesh(mesh), symmetries=turns))
    (after,) = load_objects(path, [], ["TOD"], before).objects
    assert after is not before[0] and after.id == before[0].id
    assert (after.name == "coffee") == (change == "name")
    assert (after.corners.max() > 0.1) == (change == "mesh")


ODD = {  # values of columns, and what is said of them
    "models.parameters": [
        ("[" * 100000, "parameters is no JSON: it is nested too deeply"),
        (b"{}", "parameters is no JSON: it is b'{}'"),
    ],
    "models.data": [(b"\x1b[2J", r"its data b'\x1b[2J' is not as stored")],
    "meshes.symmetries": [
        ("[" * 100000, "symmetries is no JSON: it is nested too deeply"),
        ('[{"fold": 2, "axis": [0, 0, 1%s]}]' % ("0" * 400), "axis is 1000"),
    ],
    "observations.matrix": [(b"[]", "an observation has b'[]'")],
}


def test_odd_rows_of_some_objects_leave_the_others(run, path, mesh):
    odd = [(column, *one) for column, several in ODD.items() for one in several]
    ids = [add(path, name, mesh).id for name in ("tea", *map(str, range(len(odd))))]
    assert run()[0] == 0
    with contextlib.closing(sqlite3.connect(path)) as file, file:
        for (column, value, _), number in zip(odd, ids[1:]):
            table, name = column.split(".")
            if table == "observations":
                add_observation(file, number, value)
            else:
                file.execute(f"UPDATE {table} SET {name} = ? WHERE object_id = ?", (value, number))
    loaded = load_objects(path, [], ["TOD"])
    assert ([one.name for one in loaded.objects], loaded.problem) == (["tea"], "")
    for number, (_, _, said) in enumerate(odd):
        assert any(line.startswith(f"'{number}' is not") and said in line for line in loaded.lacks)


def add_observation(file, number, matrix):
    file.execute("INSERT INTO sessions VALUES ('s', ?, '', '')", (number,))
    values = "o", "s", 0, *["0" * 64] * 3, matrix, "[]", "[]"
    file.execute("INSERT INTO observations VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)", values)


class Report:
    """Keeps what the report of a node would be told."""

    def __init__(self):
        self.told = []

    def set_problem(self, problem, lacks=()):
        self.told.append((problem, list(lacks)))


@pytest.fixture
def source_of(path, monkeypatch):
    """source_of(Settings, ["TOD"]) makes the ObjectSource of a node: it, and how often it loads."""
    use_params(monkeypatch, {"~database": path})
    monkeypatch.setattr(object_source, "CHECK_PERIOD", 0.0)
    loads = []

    def load(*words):
        loads.append(words)
        return load_objects(*words)

    monkeypatch.setattr(object_source, "load_objects", load)

    def make(settings, methods):
        return object_source.ObjectSource(methods, settings, Report()), loads

    return make


def settings_with(**changes):
    defaults = RecognitionParams.defaults()
    made = Settings(defaults, (), None, False, PlaneParams(), TabletopParams(), "", False, True)
    return made._replace(**changes)


def test_objects_are_loaded_anew_only_if_they_or_the_choice_have_changed(
    run, path, mesh, source_of
):
    add(path, "tea", mesh)
    assert run()[0] == 0
    settings = [settings_with()]
    source, loads = source_of(lambda: settings[0], ["TOD"])
    first = source.recognizer()
    assert first is not None and len(loads) == 1
    with Database(path) as database:  # which makes a log beside it while it is open
        assert database.objects.all() and os.path.exists(f"{path}-wal")
        assert source.recognizer() is first
    settings[0] = settings_with(publish_tf=False, on_tables=True)
    assert source.recognizer() is first and len(loads) == 1
    params = RecognitionParams.defaults()
    params.decision.threshold = 0.9
    settings[0] = settings_with(params=params)
    second = source.recognizer()
    assert second not in (None, first) and len(loads) == 1
    settings[0] = settings_with(params=params, objects=("tea",))
    assert source.recognizer() not in (None, second) and len(loads) == 2
    add(path, "cup", mesh)
    assert source.recognizer() is not None and len(loads) == 3
    assert source.reload() == (True, "tea") and len(loads) == 4


def test_matchers_are_kept_until_something_of_theirs_changes(run, path, mesh, source_of):
    add(path, "tea", mesh)
    assert run()[0] == 0
    params = [RecognitionParams.defaults() for _ in range(3)]
    params[1].decision.threshold = 0.9
    params[2].textures.texture_ratio = 0.5
    settings = [settings_with(params=params[0])]
    source, _ = source_of(lambda: settings[0], ["TOD"])
    matchers = []
    for one in (*params, params[2]):
        settings[0] = settings_with(params=one)
        matchers.append(source.recognizer()._textures)
        add(path, "cup", mesh)  # which nothing has learned
    assert matchers[1] is matchers[0] and matchers[2] is not matchers[1]
    assert matchers[3] is matchers[2]
    assert run()[0] == 0
    assert source.recognizer()._textures is not matchers[3]


def test_objects_that_could_not_be_loaded_are_tried_again(run, path, mesh, source_of, monkeypatch):
    add(path, "tea", mesh)
    assert run()[0] == 0
    source, _ = source_of(settings_with, ["TOD"])
    first, load = source.recognizer(), object_source.load_objects
    add(path, "cup", mesh)
    monkeypatch.setattr(object_source, "load_objects", lambda *_: 1 // 0)
    for _ in range(2):
        with pytest.raises(ZeroDivisionError):
            source.recognizer()
    monkeypatch.setattr(object_source, "load_objects", load)
    assert source.recognizer() not in (None, first)
    assert source.recognizer() is not None


def test_without_methods_nothing_is_a_problem(path, source_of):
    source, _ = source_of(settings_with, [])
    assert source.recognizer() is None and source._report.told == [("", [])]
    assert source.reload() == (False, "methods names none")
