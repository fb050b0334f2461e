"""The scene of meshes on a table: its images and depths show what its truth says."""

import functools

import cv2
import numpy as np
import pytest

import robot_vision as rv

TABLE_HEIGHT = 0.72  # m
PERIOD = 600  # frames
LAMP = np.array([-0.45, 0.45, 0.77])  # the direction to it, in the world


@functools.lru_cache(maxsize=None)
def scene():
    params = rv.SceneParams()
    params.noise = 0.0
    return rv.TabletopScene(params)


@functools.lru_cache(maxsize=None)
def renderers():
    return {name: rv.MeshRenderer(rv.sample_mesh(name).mesh) for name in rv.sample_mesh_names()}


@functools.lru_cache(maxsize=None)
def camera(view="color"):
    return rv.MeshCamera(scene().view_camera(view))


def drawn(frame, view="color", names=None):
    """The meshes of the truth, as a renderer draws them through the lens of a view."""
    offset = np.linalg.inv(scene().view_pose(view))
    objects = [one for one in scene().truth(frame).objects if names is None or one.name in names]
    model = scene().view_camera(view)
    return rv.render_meshes(
        [renderers()[one.name] for one in objects],
        [offset @ one.pose for one in objects],
        camera(view),
        (0, 0, model.width, model.height),
        ids=True,
    )


def table_plane(frame, view="color"):
    """z of the table's plane at each pixel, and whether that point is on the table."""
    model = scene().view_camera(view)
    pose = scene().truth(frame).camera @ scene().view_pose(view)
    pixels = np.stack(np.meshgrid(np.arange(model.width), np.arange(model.height)), -1)
    rays = model.rays(pixels.reshape(-1, 2).astype(float))
    directions = np.column_stack([rays, np.ones(len(rays))]) @ pose[:3, :3].T
    z = (TABLE_HEIGHT - pose[2, 3]) / directions[:, 2]
    place = pose[:3, 3] + directions * z[:, np.newaxis]
    on_it = (np.abs(place[:, 0] - 1.0) < 0.35) & (np.abs(place[:, 1]) < 0.5) & (z > 0.0)
    return z.reshape(model.height, -1), on_it.reshape(model.height, -1)


def test_objects_are_the_samples_and_stand_still_on_the_table():
    first = scene().truth(0)
    assert [one.name for one in first.objects] == rv.sample_mesh_names()
    in_world = [first.camera @ one.pose for one in first.objects]
    for pose in in_world:
        assert np.allclose(pose[2], [0, 0, 1, TABLE_HEIGHT], atol=5e-4)
    for frame in (100, 250, 431):
        truth = scene().truth(frame)
        for one, pose in zip(truth.objects, in_world):
            assert np.allclose(truth.camera @ one.pose, pose, atol=1e-9)


def test_the_camera_moves_slowly_around_the_table():
    places = np.array([scene().truth(frame).camera[:3, 3] for frame in range(0, PERIOD, 3)])
    around = np.degrees(np.arctan2(-places[:, 1], 1.0 - places[:, 0]))
    assert around.min() < -39 and around.max() > 39 and np.abs(around).max() < 41
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() * 10.0 < 0.2  # m/s
    params = rv.SceneParams()
    params.still = True
    still = rv.TabletopScene(params)
    assert np.array_equal(still.truth(200).camera, still.truth(0).camera)


@pytest.mark.parametrize("view", ["color", "depth", "right"])
def test_depth_is_that_of_the_meshes_of_the_truth_and_of_the_table(view):
    for frame in (0, 140):
        depth = scene().render_depth(frame, view)
        view_of_meshes = drawn(frame, view)
        mesh = view_of_meshes.ids > 0
        assert 0.05 < mesh.mean() < 0.4
        assert np.allclose(depth[mesh], view_of_meshes.depth[mesh], rtol=1e-6)
        z, on_it = table_plane(frame, view)
        table = ~mesh & (np.abs(depth - z) < 1e-5)
        assert 0.2 < table.mean() < 0.9
        assert (table == (on_it & ~mesh)).mean() > 0.9999


def test_colors_are_where_the_meshes_are():
    params = rv.SceneParams()
    params.noise = 0.0
    vertices = rv.sample_mesh("mug").mesh.vertices
    mesh = rv.Mesh(vertices, rv.sample_mesh("mug").mesh.triangles, color=(0, 0, 255))
    one = rv.TabletopScene(params, [("thing", mesh)])
    for frame in (0, 150):
        (thing,) = one.truth(frame).objects
        image = one.render(frame).astype(int)
        redness = image[..., 2] - image[..., :2].max(axis=2)
        region = (0, 0, 640, 480)
        view = rv.MeshRenderer(mesh).render(rv.MeshCamera(one.camera), thing.pose, region)
        inside = (~np.isnan(view.depth)).astype(np.uint8)
        assert (redness[cv2.erode(inside, np.ones((3, 3))) > 0] > 70).all()
        outside = cv2.dilate(inside, np.ones((3, 3))) == 0
        assert (redness[outside] < 50).all()
        # Of the pixels at its outline it covers what it covers of their quarters.
        to_fine = np.array([[2.0, 0, 0.5], [0, 2.0, 0.5], [0, 0, 1.0]])
        fine = rv.MeshCamera(rv.CameraModel(1280, 960, to_fine @ one.camera.K, one.camera.D))
        lamp = np.linalg.inv(one.truth(frame).camera)[:3, :3] @ LAMP
        region = (0, 0, 1280, 960)
        quarters = rv.MeshRenderer(mesh).render(fine, thing.pose, region, bgr=True, to_light=lamp)
        covered = ~np.isnan(quarters.depth)
        share = covered.reshape(480, 2, 640, 2).mean(axis=(1, 3))
        red = quarters.bgr[..., 2].reshape(480, 2, 640, 2).mean(axis=(1, 3))
        border = (share > 0.0) & (share < 1.0)
        assert border.sum() > 80
        around = np.median(redness[(share == 0.0) & (cv2.dilate(inside, np.ones((9, 9))) > 0)])
        assert np.abs(redness - red - (1.0 - share) * around)[border].max() < 10


def test_outlines_are_those_of_the_hulls_of_the_silhouettes():
    for one in scene().truth(60).objects:
        alone = drawn(60, names=[one.name]).ids > 0
        if not one.visible or not alone.any():
            continue
        points = np.argwhere(alone)[:, ::-1].astype(np.int32)
        hull = cv2.convexHull(points)
        mine = np.float32(one.outline)
        area = cv2.contourArea(cv2.convexHull(mine))
        both, _ = cv2.intersectConvexConvex(np.float32(hull), cv2.convexHull(mine))
        assert abs(cv2.contourArea(hull) / area - 1.0) < 0.06, one.name  # by pixels' middles
        assert both / cv2.contourArea(hull) > 0.995, one.name
        center, _ = scene().camera.project(one.pose[np.newaxis, :3, 3])
        assert np.allclose(one.center, center[0])


def test_what_is_visible_is_completely_seen():
    seen = {}
    for frame in (0, 75, 150, 300, 450):
        together = drawn(frame).ids
        for index, one in enumerate(scene().truth(frame).objects):
            alone = drawn(frame, names=[one.name]).ids > 0
            if one.visible:
                assert (together[alone] == index + 1).all(), (frame, one.name)
                border = np.concatenate([alone[0], alone[-1], alone[:, 0], alone[:, -1]])
                assert alone.any() and not border.any(), (frame, one.name)
            seen[one.name] = seen.get(one.name, 0) + one.visible
    assert sum(count > 0 for count in seen.values()) >= 6  # of eight
    assert any(count < 5 for count in seen.values())


def test_frames_are_the_same_in_any_order():
    other = rv.TabletopScene(scene_params())
    for frame in (77, 5):
        assert np.array_equal(other.render(frame), scene().render(frame))
    assert np.array_equal(scene().render(5 + PERIOD), scene().render(5))


def scene_params():
    params = rv.SceneParams()
    params.noise = 0.0
    return params


NUT = rv.sample_mesh("nut").mesh


def test_the_tallest_things_stay_before_the_camera():
    box = rv.sample_mesh("box").mesh
    low, high = box.vertices.min(axis=0), box.vertices.max(axis=0)
    vertices = (box.vertices - high) / (high - low) * np.float32([0.14, 0.14, 0.5])
    tall = rv.Mesh(vertices, box.triangles)  # whose origin is at its top
    table = rv.TabletopScene(scene_params(), [(name, tall) for name in "abcdefgh"])
    for frame in range(0, PERIOD, 25):
        for one in table.truth(frame).objects:
            assert (vertices @ one.pose[2, :3] + one.pose[2, 3]).min() > 0.05
            assert np.isfinite(one.center).all()


def test_vertices_that_no_triangle_has_are_not_there():
    more = rv.Mesh(np.vstack([NUT.vertices, [[0.5, 0.0, 0.6]]]), NUT.triangles)
    truths = [rv.TabletopScene(scene_params(), [("a", mesh)]).truth(0) for mesh in (NUT, more)]
    first, second = (truth.objects[0] for truth in truths)
    assert np.array_equal(first.outline, second.outline)
    assert first.visible and second.visible


@pytest.mark.parametrize(
    ("meshes", "message"),
    [
        ([], "the number of meshes is 0, must be from 1 to 50"),
        (
            [("a", NUT), ("a", NUT)],
            "the name of a mesh is 'a', must be one that no other mesh has, and not empty",
        ),
        (
            [("", NUT)],
            "the name of a mesh is '', must be one that no other mesh has, and not empty",
        ),
        (
            [("a", rv.Mesh(20.0 * NUT.vertices, NUT.triangles))],
            "mesh a is 1.2 m across, must be small enough for the room that is left on the table",
        ),
        (
            [("a", rv.Mesh(NUT.vertices * np.float32([1.0, 1.0, 30.0]), NUT.triangles))],
            "mesh a is 0.66 m tall, must be at most 0.5 m",
        ),
    ],
)
def test_what_cannot_stand_on_the_table_is_refused(meshes, message):
    with pytest.raises(ValueError) as error:
        rv.TabletopScene(rv.SceneParams(), meshes)
    assert str(error.value) == message
