"""The course's own meshes, learned by its commands, are found among other things."""

import pathlib
import sys

import numpy as np
from course_objects import FILES, FOLDER, CourseTable, needs_course_objects

from robot_vision.recognition import mesh_add, object_add, training
from robot_vision.recognition.known_objects import load_objects
from robot_vision.recognition.recognizer import RecognitionParams, Recognizer
from robot_vision.recognition.straight_images import StraightImages

ROOT = pathlib.Path(__file__).resolve().parents[2]

pytestmark = needs_course_objects


def run(monkeypatch, module, *words):
    monkeypatch.setattr(sys, "argv", [module.PROGRAM, *map(str, words)])
    assert module.main() == 0


def test_they_are_found(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    for name, file in FILES.items():
        run(monkeypatch, object_add, "-n", name, "-d", f"A {name} of the course", "--commit")
        run(monkeypatch, mesh_add, name, FOLDER / file, "--symmetry", "z", "--commit")
    run(monkeypatch, training, "-c", ROOT / "config" / "training.ork")

    loaded = load_objects(str(tmp_path / "robot_vision_objects.db"), (), ["LINEMOD"])
    assert not loaded.problem and not loaded.lacks
    recognizer = Recognizer(loaded.objects, RecognitionParams.defaults())
    table = CourseTable()
    straight = StraightImages(table.camera, None)
    for number in (0, 90):
        found, told = recognizer.recognize(*straight.apply(*table.frame(number)), straight.camera)
        best = {one.object.name: one for one in sorted(found, key=lambda one: one.probability)}
        assert sorted(best) == sorted(FILES), told
        table.require_poses(number, {name: np.asarray(one.pose) for name, one in best.items()})
