"""The course's own meshes, placed among other things as a camera with depths sees them.

They are not in this package: what needs them runs where they are, in ../shared/recognition.
"""

import pathlib
from typing import Dict, Tuple

import numpy as np
import pytest

import robot_vision as rv

_FOLDERS = (
    parent / "shared" / "recognition" for parent in pathlib.Path(__file__).resolve().parents
)
FOLDER = next((folder for folder in _FOLDERS if folder.is_dir()), pathlib.Path())
FILES = {"coke": "coke.stl", "bottle": "bottle_blend_6k.stl"}
CLUTTER = ("box", "drill", "bracket", "duck")

needs_course_objects = pytest.mark.skipif(
    not (FOLDER / FILES["coke"]).is_file(), reason="the course's meshes are not here"
)


class CourseTable:
    """A table with these objects and clutter on it, seen with the noise of a Kinect."""

    def __init__(self) -> None:
        self._meshes = {name: rv.read_mesh(str(FOLDER / FILES[name])).mesh for name in FILES}
        clutter = [(name, rv.sample_mesh(name).mesh) for name in CLUTTER]
        self._scene = rv.TabletopScene(rv.SceneParams(), [*self._meshes.items(), *clutter])
        own, self.camera = self._scene.view_camera("depth"), self._scene.view_camera("color")
        self._registration = rv.DepthRegistration(own, self.camera, self._scene.view_pose("depth"))
        self._noise = rv.DepthNoise("kinect", own)

    def frame(self, number: int) -> Tuple[np.ndarray, np.ndarray]:
        """The image, BGR, and the depths (m) of its pixels."""
        depth = self._registration.apply(
            self._noise.apply(number, self._scene.render_depth(number))
        )
        return self._scene.render(number), depth

    def require_poses(self, number: int, poses: Dict[str, np.ndarray]) -> None:
        """Asserts that these are the poses, 4x4, of the course's objects in a frame.

        Both are turned about their z axis by whom nobody can see.
        """
        assert sorted(poses) == sorted(FILES)
        for one in self._scene.truth(number).objects:
            if one.name not in poses:
                continue
            pose, true = poses[one.name], np.asarray(one.pose)
            middle = [*rv.mesh_extent(self._meshes[one.name]).center, 1.0]
            assert np.linalg.norm((pose - true) @ middle) < 0.01
            assert abs(pose[:3, 2] @ true[:3, 2]) > np.cos(np.radians(5.0))
