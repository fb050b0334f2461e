"""learn_samples.py: the samples in a database, with their symmetries, learned once."""

import numpy as np
import pytest

from robot_vision import mesh_extent, sample_mesh
from robot_vision.recognition import learn_samples
from robot_vision.recognition.database import Database
from robot_vision.recognition.mesh_data import unpack_mesh
from robot_vision.recognition.view_method import VIEWS


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """run("word", ...) runs the command on a database: exit code, stdout and stderr."""

    def command(*words):
        path = str(tmp_path / "objects.db")
        monkeypatch.setattr("sys.argv", ["learn_samples.py", "--database", path, *words])
        try:
            code = learn_samples.main()
        except SystemExit as error:
            code = error.code
        return (code, *capsys.readouterr())

    return command


def test_samples_are_added_and_learned_once(run, tmp_path):
    code, out, err = run("can", "nut", "__name:=learn_samples", "__log:=/dev/null")
    assert (code, err) == (0, "")
    assert "can: LINEMOD: 17 views learned" in out and "nut: LINEMOD: 18 views learned" in out
    with Database(str(tmp_path / "objects.db")) as database:
        models = {}
        for name in ("can", "nut"):
            one = database.objects.find(name)
            sample, stored = sample_mesh(name), database.meshes.of(one.id)
            sizes = [
                mesh_extent(mesh).size for mesh in (unpack_mesh(stored.converted), sample.mesh)
            ]
            np.testing.assert_allclose(*sizes, rtol=1e-4)
            symmetries = [(tuple(turn.axis), turn.fold) for turn in stored.symmetries]
            assert symmetries == [(tuple(axis), fold) for axis, fold in sample.symmetries]
            models[name] = database.models.of(one.id, VIEWS.name)
    code, out, err = run("can", "nut")
    assert (code, err) == (0, "") and out.count("nothing has changed") == 2
    with Database(str(tmp_path / "objects.db")) as database:
        assert [one.name for one in database.objects.all()] == ["can", "nut"]
        for name, model in models.items():
            assert database.models.of(database.objects.find(name).id, VIEWS.name).key == model.key


def test_an_object_of_that_name_stays_as_it_is(run, tmp_path):
    assert run("can")[0] == 0
    with Database(str(tmp_path / "objects.db"), write=True) as database:
        one = database.objects.find("can")
        with database.transaction():
            database.meshes.delete(one.id)
    code, _, err = run("can")
    assert code == 1
    assert err == f"learn_samples.py: 'can' of {tmp_path / 'objects.db'} has no mesh\n"


def test_unknown_names_are_usage_errors(run, tmp_path):
    code, out, err = run("can", "spoon")
    assert (code, out) == (2, "")
    assert "there is no 'spoon', only bottle, box, bracket, can," in err
    assert not (tmp_path / "objects.db").exists()
