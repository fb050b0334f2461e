"""evaluate_bop.py, on a small data set that is drawn."""

import csv
import json

import cv2
import numpy as np
import pytest

import robot_vision as rv
from robot_vision.meshes.mesh_files import ply_of
from robot_vision.recognition import evaluate_bop
from robot_vision.recognition.database.folder_files import write_data, write_json

SIZE = (320, 240)
K = np.array([[525.0, 0.0, 159.5], [0.0, 525.0, 119.5], [0.0, 0.0, 1.0]])


@pytest.fixture
def folder(tmp_path):
    """The bracket before a wall in frame 0, and in frame 1 a truth that is not where it is."""
    mesh = rv.sample_mesh("bracket").mesh
    pose = np.eye(4)
    pose[:3, :3] = cv2.Rodrigues(np.array([2.0, 0.4, 0.2]))[0]
    pose[:3, 3] = [0.01, -0.01, 0.7] - pose[:3, :3] @ np.asarray(rv.mesh_extent(mesh).center)
    corners = [(2.0 * x, 2.0 * y, 0.9) for y in (-1, 1) for x in (-1, 1)]
    wall = rv.Mesh(corners, [(0, 1, 2), (1, 3, 2)], color=(120, 150, 160))
    renderers = [rv.MeshRenderer(wall), rv.MeshRenderer(mesh)]
    view = rv.render_meshes(renderers, [np.eye(4), pose], K, (0, 0, *SIZE), bgr=True)
    root = tmp_path / "small"
    scene = str(root / "test" / "000003")
    write_data(ply_of(mesh, 1000.0), str(root / "models"), "obj_000005.ply")
    depth = np.rint(np.nan_to_num(view.depth) * 1e4).astype(np.uint16)
    truths = {}
    for frame in range(2):
        write_data(cv2.imencode(".png", view.bgr)[1].tobytes(), scene, "rgb", f"{frame:06d}.png")
        write_data(cv2.imencode(".png", depth)[1].tobytes(), scene, "depth", f"{frame:06d}.png")
        place = 1e3 * (pose[:3, 3] + [0.2 * frame, 0.0, 0.0])
        turn = pose[:3, :3].ravel().tolist()
        truths[frame] = [{"cam_R_m2c": turn, "cam_t_m2c": place.tolist(), "obj_id": 5}]
    write_json(truths, scene, "scene_gt.json")
    camera = {"cam_K": K.ravel().tolist(), "depth_scale": 0.1}
    write_json({0: camera, 1: camera}, scene, "scene_camera.json")
    return root, pose


@pytest.fixture
def run(monkeypatch, capsys):
    def command(*words):
        monkeypatch.setattr("sys.argv", [evaluate_bop.PROGRAM, *map(str, words)])
        return (evaluate_bop.main(), *capsys.readouterr())

    return command


def test_figures_and_results_are_those_of_the_truth(folder, run, tmp_path):
    root, pose = folder
    output = tmp_path / "results.csv"
    code, out, err = run(root, "--output", output)
    assert code == 0, err
    assert "object 5: 1 of 2 found, 50.0%; 1 false\n2 images, " in out
    rows = list(csv.DictReader(output.read_text().splitlines()))
    assert [(row["scene_id"], row["im_id"], row["obj_id"]) for row in rows] == [
        ("3", "0", "5"),
        ("3", "1", "5"),
    ]
    for row in rows:
        place = np.array(row["t"].split(), float)
        assert np.linalg.norm(place - 1e3 * pose[:3, 3]) < 3.0
        turn = np.array(row["R"].split(), float).reshape(3, 3)
        assert np.linalg.norm(cv2.Rodrigues(turn @ pose[:3, :3].T)[0]) < 0.03
        assert 0.5 < float(row["score"]) <= 1.0 and float(row["time"]) > 0.0


def test_what_the_truth_of_a_scene_does_not_name_is_not_false(folder, run):
    """Also models in another folder."""
    root, _ = folder
    (root / "models").rename(root / "models_cad")
    path = root / "test" / "000003" / TRUTH
    path.write_text(path.read_text().replace('"obj_id": 5', '"obj_id": 9'))
    code, out, err = run(root, "--models", "models_cad")
    assert code == 0, err
    assert out.startswith("object 5: 0 of 0 found, -; 0 false\n2 found of objects that the truth ")
    assert "no BOP data set: no models/obj_000001.ply or such" in run(root)[2]


class Learned:
    """In place of a training, which takes long."""

    done = total = 0

    def __init__(self, *_):
        pass

    def model(self):
        return b""


def test_an_object_whose_symmetries_cannot_be_used_is_symmetric(folder, monkeypatch):
    models = str(folder[0] / "models")
    monkeypatch.setattr(evaluate_bop, "ViewTraining", Learned)
    assert not evaluate_bop._models(models)[5].is_symmetric
    far = {"axis": [0, 0, 1], "offset": [500, 0, 0]}
    write_json({5: {"symmetries_continuous": [far]}}, models, "models_info.json")
    assert evaluate_bop._models(models)[5].is_symmetric


def test_depths_of_tenths_of_a_millimetre_are_kept(folder):
    root, _ = folder
    file = root / "test" / "000003" / "depth" / "000000.png"
    written = cv2.imread(str(file), cv2.IMREAD_UNCHANGED)
    (frame, _) = evaluate_bop._frames(str(root / "test"), "000003")
    depth = evaluate_bop._seen(frame)[1]
    assert depth.dtype == np.float32 and np.array_equal(np.isnan(depth), written == 0)
    assert np.abs(depth - 1e-4 * written)[written > 0].max() < 1e-6


def test_what_is_wrong_is_told(folder, run, tmp_path):
    root, _ = folder
    assert "is no BOP data set" in run(tmp_path)[2]
    (root / "test" / "000003" / "rgb" / "000001.png").unlink()
    code, _, err = run(root)
    assert code == 1 and "000001.png" in err and err.count("\n") == 1


def test_results_that_cannot_be_written_are_told_before_anything_is_learned(
    folder, run, tmp_path, monkeypatch
):
    root, _ = folder
    there = tmp_path / "results.csv"
    there.write_text("those of yesterday")
    with monkeypatch.context() as patch:
        patch.setattr(evaluate_bop, "ViewTraining", None)
        code, _, err = run(root, "--output", there)
        said = f"evaluate_bop.py: {there} is there already; --force replaces it\n"
        assert (code, err) == (1, said)
        assert "Not a directory" in run(root, "--output", there / "x.csv")[2]
    assert there.read_text() == "those of yesterday"
    for words in ((there, "--force"), (tmp_path / "new" / "results.csv",)):
        assert run(root, "--output", *words)[0] == 0
        assert words[0].read_text().startswith("scene_id,")


TRUTH, CAMERA = "scene_gt.json", "scene_camera.json"


@pytest.mark.parametrize(
    "file, change, told",
    [
        (TRUTH, lambda _: [1], "it is [1], must be an object of JSON"),
        (TRUTH, lambda all_: {"a": all_["0"]}, "a frame is 'a', must be a number"),
        (TRUTH, lambda _: {"0": 5}, "frame 0: it is 5, must be a list of poses"),
        (TRUTH, lambda _: {"0": [{}]}, "frame 0: obj_id is None, must be a whole number"),
        (TRUTH, lambda _: {"0": [{"obj_id": 5}]}, "frame 0: cam_R_m2c is None, must be 3 rows"),
        (TRUTH, lambda _: {}, "no frames in "),
        (CAMERA, lambda all_: {"0": all_["0"]}, "frame 1: scene_camera.json has no camera of it"),
        (
            CAMERA,
            lambda _: {"0": {"cam_K": [1, "x"]}},
            "frame 0: cam_K is [1, 'x'], must be 3 rows",
        ),
        (
            CAMERA,
            lambda all_: {"0": {**all_["0"], "depth_scale": 1e300}},
            "frame 0: depth_scale is",
        ),
        (
            CAMERA,
            lambda all_: {"0": {**all_["0"], "depth_scale": -1}},
            "frame 0: depth_scale is -1",
        ),
    ],
)
def test_damaged_json_is_told_before_anything_is_learned(
    folder, run, monkeypatch, file, change, told
):
    root, _ = folder
    path = root / "test" / "000003" / file
    path.write_text(json.dumps(change(json.loads(path.read_text()))))
    monkeypatch.setattr(evaluate_bop, "ViewTraining", None)
    code, _, err = run(root)
    assert code == 1 and told in err and err.count("\n") == 1


@pytest.mark.parametrize("text", ["", "{", "[" * 100000, "\xff", "NaN"])
def test_what_is_no_json_is_told(folder, run, text):
    root, _ = folder
    path = root / "test" / "000003" / TRUTH
    path.write_text(text, "latin-1")
    code, _, err = run(root)
    assert code == 1 and str(path) in err and err.count("\n") == 1
