"""Frames of tf: their poses in one of them, against matrices."""

import math

import numpy as np
import pytest
from geometry_msgs.msg import TransformStamped
from scipy.spatial.transform import Rotation

from robot_vision.dashboard.frame_feature import frames_of
from robot_vision.dashboard.frame_tree import MAX_FRAMES, FrameTree


def transform(parent, child, position=(0, 0, 0), turn=(0, 0, 0, 1)):
    made = TransformStamped()
    made.header.frame_id, made.child_frame_id = parent, child
    move, rotation = made.transform.translation, made.transform.rotation
    move.x, move.y, move.z = position
    rotation.x, rotation.y, rotation.z, rotation.w = turn
    return made


def matrix(position, turn):
    made = np.eye(4)
    made[:3, :3] = Rotation.from_quat(turn).as_matrix()
    made[:3, 3] = position
    return made


def poses(tree, root):
    return {name: matrix(pose.position, pose.orientation) for name, _, pose in tree.poses(root)}


def test_poses_are_the_products_of_the_transforms():
    random = np.random.default_rng(5)
    tree = FrameTree()
    names = ["map", "odom", "base", "camera", "eye"]
    expected = {"map": np.eye(4)}
    for parent, child in zip(names, names[1:]):
        position = random.normal(size=3)
        turn = Rotation.random(random_state=int(random.integers(1000))).as_quat()
        tree.add([transform(parent, child, position, 2.0 * turn)])  # of any length
        expected[child] = expected[parent] @ matrix(position, turn)
    for root in names:
        found = poses(tree, root)
        back = np.linalg.inv(expected[root])
        assert set(found) == set(names)
        for name in names:
            assert np.allclose(found[name], back @ expected[name]), (root, name)


def test_the_newest_transform_counts():
    tree = FrameTree()
    assert tree.add([transform("a", "b", (1, 0, 0))])
    assert tree.add([transform("a", "b", (2, 0, 0))])
    assert poses(tree, "a")["b"][0, 3] == 2.0
    assert tree.add([transform("c", "b", (3, 0, 0))])  # another parent
    assert set(poses(tree, "c")) == {"b", "c"} and tree.poses("a") == []


def test_roots_are_sorted_by_their_frames():
    tree = FrameTree()
    tree.add([transform("x", "y"), transform("map", "a"), transform("map", "b")])
    assert tree.roots() == ["map", "x"]
    made = frames_of(tree, "")
    assert made["root"] == "map" and made["roots"] == ["map", "x"]
    assert [frame["name"] for frame in made["frames"]] == ["a", "b", "map"]
    assert [frame["parent"] for frame in made["frames"]] == ["map", "map", ""]


def test_nothing_is_known_of_an_unknown_root():
    tree = FrameTree()
    assert frames_of(tree, "") == {"root": "", "frames": [], "roots": []}
    assert frames_of(tree, "<b>")["frames"] == []


@pytest.mark.parametrize(
    "bad",
    [
        transform("a", "b", (math.nan, 0, 0)),
        transform("a", "b", (0, 0, 0), (0, 0, 0, 0)),
        transform("a", "b", (0, 0, 0), (math.inf, 0, 0, 0)),
        transform("a", "a"),
        transform("a", ""),
        transform("", "b"),
        transform("a", "b\n"),
    ],
)
def test_transforms_that_are_none_are_left_out(bad):
    tree = FrameTree()
    assert not tree.add([bad]) and tree.roots() == []


def test_a_quaternion_may_have_any_length():
    tree = FrameTree()
    far = transform("a", "b", (0, 0, 0), (0, 0, 1e200, 1e200))
    assert tree.add([far, transform("a", "c")])
    assert np.allclose(poses(tree, "a")["b"][:3, 0], (0, 1, 0)) and "c" in poses(tree, "a")


def test_rings_end():
    tree = FrameTree()
    tree.add([transform("a", "b"), transform("b", "c"), transform("c", "a"), transform("c", "d")])
    assert tree.roots() == ["a"]
    assert {name for name, _, _ in tree.poses("a")} == {"a", "b", "c", "d"}


def test_slashes_of_tf_prefixes_are_left_out():
    tree = FrameTree()
    tree.add([transform("/a", "/b")])
    assert tree.roots() == ["a"]


def test_frames_are_bounded():
    tree = FrameTree()
    tree.add([transform("root", f"f{index}") for index in range(MAX_FRAMES + 100)])
    assert len(tree.poses("root")) == MAX_FRAMES + 1
    assert tree.add([transform("root", "f0", (1, 0, 0))])  # one that is known


def test_a_long_chain_is_no_recursion():
    tree = FrameTree()
    tree.add([transform(f"f{index}", f"f{index + 1}") for index in range(MAX_FRAMES)])
    assert tree.roots() == ["f0"] and len(tree.poses("f0")) == MAX_FRAMES + 1
