"""TagLocator: the poses of the tags and bundles of a layout, from frame to frame."""

from types import SimpleNamespace

import numpy as np
from tags import SIZE, K, corners_of, matrix, turned

from robot_vision import CameraModel, TagPoseParams
from robot_vision.tags.tag_layout import TagLayout
from robot_vision.tags.tag_poses import TagLocator

CAMERA = CameraModel(640, 480, K)
FACING = np.diag([1.0, -1.0, -1.0])
BODY = {"name": "body", "layout": [{"id": 1, "size": SIZE}, {"id": 2, "size": SIZE, "x": 0.4}]}


def tag(number, pose):
    return SimpleNamespace(family="tag36h11", id=number, corners=corners_of(pose, CAMERA))


def place(x, y, z, turn=(0.3, 0.2, 0.0)):
    return matrix(FACING @ turned(turn), [x, y, z])


def layout():
    return TagLayout("tag36h11", SIZE, [], [BODY])


def test_tags_and_their_bundle():
    body = place(-0.1, 0.0, 1.5)
    other = body.copy()
    other[:3, 3] = (body @ [0.4, 0.0, 0.0, 1.0])[:3]
    locator = TagLocator(layout(), TagPoseParams())
    tags, (bundle,) = locator.locate(0.0, [tag(1, body), tag(2, other)], CAMERA)
    assert len(tags) == 2
    for located, truth in zip(tags, (body, other)):
        assert located.unique and np.allclose(located.poses.best.pose, truth, atol=1e-4)
    assert (bundle.name, bundle.ids) == ("body", [1, 2])
    assert np.allclose(bundle.poses.best.pose, body, atol=1e-5)


def test_without_a_camera_there_are_only_tags():
    tags, bundles = TagLocator(layout(), TagPoseParams()).locate(
        0.0, [tag(1, place(0, 0, 1))], None
    )
    assert tags[0].poses is None and bundles == []


def test_a_tag_without_a_pose_does_not_take_its_bundle_along():
    body = place(-0.1, 0.0, 1.5)
    broken = SimpleNamespace(family="tag36h11", id=2, corners=np.full((4, 2), 100.0))
    locator = TagLocator(layout(), TagPoseParams())
    tags, (bundle,) = locator.locate(0.0, [tag(1, body), broken], CAMERA)
    assert [located.poses is None for located in tags] == [False, True]
    assert bundle.ids == [1]


def test_twins_are_in_no_bundle():
    twins = [tag(1, place(-0.3, 0.0, 1.5)), tag(1, place(0.3, 0.0, 1.5))]
    tags, bundles = TagLocator(layout(), TagPoseParams()).locate(0.0, twins, CAMERA)
    assert bundles == [] and len(tags) == 2
    for located, x in zip(tags, (-0.3, 0.3)):
        assert not located.unique
        assert abs(located.poses.best.pose[0, 3] - x) < 1e-3


def test_another_camera_starts_anew():
    rng = np.random.default_rng(1)
    locator = TagLocator(layout(), TagPoseParams())
    pose = place(0.0, 0.0, 1.5)

    def spread(camera, time):
        seen = tag(1, pose)
        seen.corners = seen.corners + rng.normal(0.0, 0.3, (4, 2))
        (located,), _ = locator.locate(time, [seen], camera)
        return located.poses.best.covariance[2, 2]

    alone = spread(CAMERA, 0.0)
    for frame in range(1, 60):
        averaged = spread(CAMERA, frame / 30.0)
    assert averaged < 0.5 * alone
    equal = type(CAMERA)(640, 480, CAMERA.K, CAMERA.D)
    assert spread(equal, 2.0) > 1.5 * averaged


def test_a_single_image_changes_no_state():
    locator = TagLocator(layout(), TagPoseParams())
    pose, far = place(0.0, 0.0, 1.5), place(0.3, 0.2, 3.0)
    locator.locate(0.0, [tag(1, pose)], CAMERA)
    ((alone,), _) = locator.locate_at_once([tag(1, far)], CAMERA)
    assert np.allclose(alone.poses.best.pose, far, atol=1e-3)
    ((again,), _) = locator.locate(1 / 30, [tag(1, pose)], CAMERA)
    assert np.allclose(again.poses.best.pose, pose, atol=1e-4)
