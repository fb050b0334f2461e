"""The course's own meshes, learned by its commands, are found among other things.

They are not in this package: the test runs where they are, in ../shared/recognition.
"""

import pathlib
import sys

import numpy as np
import pytest

import robot_vision as rv
from robot_vision.recognition import mesh_add, object_add, training
from robot_vision.recognition.known_objects import load_objects
from robot_vision.recognition.recognizer import RecognitionParams, Recognizer
from robot_vision.recognition.straight_images import StraightImages

HERE = pathlib.Path(__file__).resolve()
FOLDERS = (parent / "shared" / "recognition" for parent in HERE.parents)
FOLDER = next((folder for folder in FOLDERS if folder.is_dir()), None)
FILES = {"coke": "coke.stl", "bottle": "bottle_blend_6k.stl"}
CLUTTER = ("box", "drill", "bracket", "duck")
FRAMES = (0, 90)

pytestmark = pytest.mark.skipif(FOLDER is None, reason="the course's meshes are not here")


def run(monkeypatch, module, *words):
    monkeypatch.setattr(sys, "argv", [module.PROGRAM, *map(str, words)])
    assert module.main() == 0


def test_they_are_found(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    for name, file in FILES.items():
        run(monkeypatch, object_add, "-n", name, "-d", f"A {name} of the course", "--commit")
        run(monkeypatch, mesh_add, name, FOLDER / file, "--symmetry", "z", "--commit")
    run(monkeypatch, training, "-c", HERE.parents[2] / "config" / "training.ork")

    loaded = load_objects(str(tmp_path / "robot_vision_objects.db"), (), ["LINEMOD"])
    assert not loaded.problem and not loaded.lacks
    recognizer = Recognizer(loaded.objects, RecognitionParams.defaults())
    meshes = [(name, rv.read_mesh(str(FOLDER / file)).mesh) for name, file in FILES.items()]
    meshes += [(name, rv.sample_mesh(name).mesh) for name in CLUTTER]
    scene = rv.TabletopScene(rv.SceneParams(), meshes)
    own, camera = scene.view_camera("depth"), scene.view_camera("color")
    registration = rv.DepthRegistration(own, camera, scene.view_pose("depth"))
    noise, straight = rv.DepthNoise("kinect", own), StraightImages(camera, None)
    for frame in FRAMES:
        depth = registration.apply(noise.apply(frame, scene.render_depth(frame)))
        found, told = recognizer.recognize(
            *straight.apply(scene.render(frame), depth), straight.camera
        )
        best = {one.object.name: one for one in sorted(found, key=lambda one: one.probability)}
        assert sorted(best) == sorted(FILES), told
        truth = {one.name: np.asarray(one.pose) for one in scene.truth(frame).objects}
        for one in best.values():
            pose, true = one.pose, truth[one.object.name]
            middle = [*rv.mesh_extent(one.object.mesh).center, 1.0]
            assert np.linalg.norm((pose - true) @ middle) < 0.01
            assert abs(pose[:3, 2] @ true[:3, 2]) > np.cos(np.radians(5.0))
