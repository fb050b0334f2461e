"""Meshes as they are drawn: where rays meet them, with their normals and colors."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from rays import cast, looking_at, pixel_rays

import robot_vision as rv

K = np.array([[70.0, 0.0, 31.4], [0.0, 72.0, 22.7], [0.0, 0.0, 1.0]])
IMAGE = (0, 0, 64, 48)
NEARER = np.diag([3.0, 3.0, 1.0]) @ K
LARGE = (0, 0, 190, 140)
AMBIENT = 0.35  # of all light


def grid(values):
    return np.asarray(values).reshape(IMAGE[3], IMAGE[2], -1).squeeze()


def square(texture=None, uv=((0, 1), (1, 1), (1, 0), (0, 0)), color=(160, 160, 160)):
    """A square of 0.2 m in the plane of x and y, seen from +z; x to the right, y up."""
    vertices = np.array([[-0.1, -0.1, 0], [0.1, -0.1, 0], [0.1, 0.1, 0], [-0.1, 0.1, 0]])
    textured = {}
    if texture is not None:
        textured = {"textures": [texture], "texture_coordinates": uv, "triangle_textures": [0, 0]}
    return rv.Mesh(vertices, [[0, 1, 2], [0, 2, 3]], color=color, **textured)


def tilted(angle, distance=0.3):
    """The pose of such a square in front of the camera, its upper side turned away."""
    sine, cosine = np.sin(angle), np.cos(angle)
    pose = np.eye(4)
    pose[:3, :3] = [[1, 0, 0], [0, -cosine, -sine], [0, sine, -cosine]]
    pose[:3, 3] = 0.01, -0.01, distance
    return pose


def ball(radius, rings=24):
    """A ball whose vertices have its normals."""
    heights, angles = np.meshgrid(
        np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings + 1), indexing="ij"
    )
    points = np.stack(
        [np.sin(heights) * np.cos(angles), np.sin(heights) * np.sin(angles), np.cos(heights)], -1
    )
    index = np.arange(points[..., 0].size).reshape(heights.shape)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    normals = points.reshape(-1, 3)
    return rv.Mesh(radius * normals, triangles, normals=normals)


@pytest.mark.parametrize("name", ["bottle", "mug", "drill", "duck"])
def test_depth_is_that_of_the_ray_through_the_middle_of_each_pixel(name):
    mesh = rv.sample_mesh(name).mesh
    renderer = rv.MeshRenderer(mesh)
    pose = looking_at(renderer.extent.center, 0.7, 0.5, 3.0 * renderer.extent.radius)
    drawn = renderer.render(K, pose, IMAGE).depth
    depths, _, weights = cast(mesh, pose, pixel_rays(K, IMAGE))
    met = np.isfinite(grid(depths))
    near_a_side = grid(weights.min(axis=1)) < 1e-3
    assert 300 < met.sum() < 2500
    wrong = np.isnan(drawn) == met
    wrong[met] |= ~np.isclose(drawn[met], grid(depths)[met], rtol=1e-5)
    assert not wrong[~near_a_side].any()
    assert wrong.sum() <= 3  # at outlines, where a ray passes a side within rounding


def test_normals_are_those_of_the_triangles_of_a_mesh_that_has_none():
    mesh = rv.sample_mesh("nut").mesh
    renderer = rv.MeshRenderer(mesh)
    pose = looking_at(renderer.extent.center, 0.3, 0.6, 3.5 * renderer.extent.radius)
    view = renderer.render(K, pose, IMAGE, normals=True)
    rays = pixel_rays(K, IMAGE)
    _, triangles, weights = cast(mesh, pose, rays)
    corners = (mesh.vertices @ pose[:3, :3].T + pose[:3, 3])[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    sure = (triangles >= 0) & (weights.min(axis=1) > 1e-3)
    drawn = view.normals.reshape(-1, 3)
    assert sure.sum() > 500
    assert np.allclose(drawn[sure], normals[triangles[sure]], atol=1e-5)
    assert (np.isnan(drawn).all(axis=1) == np.isnan(view.depth.ravel())).all()


def test_normals_of_vertices_are_mixed_along_the_surface():
    radius, distance = 0.05, 0.25
    pose = np.eye(4)
    pose[2, 3] = distance
    view = rv.MeshRenderer(ball(radius)).render(K, pose, IMAGE, normals=True)
    seen = ~np.isnan(view.depth.ravel())
    rays = np.column_stack([pixel_rays(K, IMAGE), np.ones(seen.size)])[seen]
    out = rays * view.depth.ravel()[seen, np.newaxis] - [0, 0, distance]
    normals = view.normals.reshape(-1, 3)[seen]
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-5)
    # The surface is up to a hundredth of the radius below that of the ball.
    angles = np.arccos(np.clip(np.sum(normals * out, axis=1) / np.linalg.norm(out, axis=1), -1, 1))
    inner = np.sum(normals * rays, axis=1) / np.linalg.norm(rays, axis=1) < -0.3
    assert inner.sum() > 500
    assert np.degrees(angles[inner].max()) < 1.0


def test_no_normal_points_away_from_the_camera():
    pose = np.eye(4)
    pose[2, 3] = 0.25
    # The corners of coarse triangles at the outline are beyond it, and so have normals that do.
    view = rv.MeshRenderer(ball(0.1, rings=4)).render(NEARER, pose, LARGE, normals=True)
    seen = ~np.isnan(view.depth.ravel())
    rays = np.column_stack([pixel_rays(NEARER, LARGE), np.ones(seen.size)])[seen]
    away = np.sum(view.normals.reshape(-1, 3)[seen] * rays, axis=1)
    assert away.max() < 1e-5
    assert (away > -1e-5).sum() > 100  # were turned to the side
    assert np.allclose(np.linalg.norm(view.normals.reshape(-1, 3)[seen], axis=1), 1.0, atol=1e-5)


def test_a_texture_lies_where_its_coordinates_say_in_perspective():
    ramp = np.zeros((256, 256, 3), np.uint8)
    ramp[..., 0] = np.arange(256)  # blue grows to the right
    ramp[..., 1] = np.arange(256)[:, np.newaxis]  # green down
    pose = tilted(1.0)
    view = rv.MeshRenderer(square(ramp)).render(NEARER, pose, LARGE, bgr=True)
    rays = np.column_stack([pixel_rays(NEARER, LARGE), np.ones(LARGE[2] * LARGE[3])])
    seen = ~np.isnan(view.depth.ravel())
    points = (rays * view.depth.reshape(-1, 1))[seen] - pose[:3, 3]
    place = points @ pose[:3, :3]  # in the square's frame
    share = np.column_stack([(place[:, 0] + 0.1) / 0.2, (0.1 - place[:, 1]) / 0.2])
    direction = rays[seen] / np.linalg.norm(rays[seen], axis=1, keepdims=True)
    light = AMBIENT + (1.0 - AMBIENT) * np.abs(direction @ pose[:3, 2])
    inner = ((share > 0.02) & (share < 0.98)).all(axis=1)
    expected = (share * 256.0 - 0.5) * light[:, np.newaxis]
    assert inner.sum() > 3000
    assert np.abs(view.bgr.reshape(-1, 3)[seen][inner, :2] - expected[inner]).max() < 1.6


def test_a_texture_finer_than_pixels_is_its_mean():
    fine = np.zeros((1024, 1024, 3), np.uint8)
    fine[::2, ::2] = fine[1::2, 1::2] = 200
    view = rv.MeshRenderer(square(fine)).render(K, tilted(0.0), IMAGE, bgr=True)
    inner = view.bgr[12:36, 14:50].astype(float)
    assert (np.abs(inner - 100.0) < 4.0).all()


def test_a_texture_repeats_beyond_its_borders():
    texture = np.zeros((2, 2, 3), np.uint8)
    texture[0, 0] = texture[1, 1] = 240
    renderer = rv.MeshRenderer(square(texture, uv=((0, 2), (2, 2), (2, 0), (0, 0))))
    view = renderer.render(NEARER, tilted(0.0), LARGE, bgr=True)
    rows, columns = np.nonzero(~np.isnan(view.depth))
    tile = view.bgr[rows.min() + 4 : rows.max() - 4, columns.min() + 4 : columns.max() - 4, 0]
    half = tile.shape[0] // 2, tile.shape[1] // 2
    assert tile.max() > 180 and tile.min() < 60
    left, right = tile[:, : half[1] - 4], tile[:, -(half[1] - 4) :]
    assert np.abs(left.astype(int) - right).mean() < 25  # 2 of its 4 columns, and so again


def test_light_comes_from_the_camera_or_from_a_lamp():
    pose = tilted(0.8)
    renderer = rv.MeshRenderer(square(color=(50, 100, 200)))
    normal = pose[:3, 2]
    for lamp in (None, (0.0, -1.0, -0.3), (0.0, 1.0, 1.0)):
        view = renderer.render(K, pose, IMAGE, bgr=True, to_light=lamp)
        seen = ~np.isnan(view.depth.ravel())
        rays = np.column_stack([pixel_rays(K, IMAGE), np.ones(seen.size)])[seen]
        to_lamp = -rays if lamp is None else np.broadcast_to(lamp, rays.shape)
        facing = to_lamp @ normal / np.linalg.norm(to_lamp, axis=1)
        light = AMBIENT + (1.0 - AMBIENT) * np.maximum(facing, 0.0)
        expected = light[:, np.newaxis] * [50, 100, 200]
        assert np.abs(view.bgr.reshape(-1, 3)[seen] - expected).max() <= 0.51
        assert (view.bgr.reshape(-1, 3)[~seen] == 0).all()


def test_colors_of_vertices_are_mixed():
    mesh = square()
    colors = [[0, 0, 0], [200, 0, 0], [200, 100, 0], [0, 100, 0]]
    mesh = rv.Mesh(mesh.vertices, mesh.triangles, colors=colors)
    pose = tilted(0.0)
    view = rv.MeshRenderer(mesh).render(K, pose, IMAGE, bgr=True, to_light=-pose[:3, 2] * -1.0)
    seen = ~np.isnan(view.depth.ravel())
    rays = np.column_stack([pixel_rays(K, IMAGE), np.ones(seen.size)])[seen]
    place = (rays * 0.3 - pose[:3, 3]) @ pose[:3, :3]
    expected = np.column_stack([(place[:, 0] + 0.1) * 1000.0, (place[:, 1] + 0.1) * 500.0])
    assert np.abs(view.bgr.reshape(-1, 3)[seen, :2] - expected).max() <= 0.6


def test_of_several_meshes_the_nearest_are_seen():
    names = ["can", "mug", "bracket"]
    renderers = [rv.MeshRenderer(rv.sample_mesh(name).mesh) for name in names]
    poses = [looking_at(renderer.extent.center, 1.0, 0.4, 0.35) for renderer in renderers]
    for pose, shift in zip(poses, (-0.02, 0.01, 0.03)):
        pose[0, 3] += shift
    together = rv.render_meshes(renderers, poses, K, IMAGE, bgr=True, normals=True, ids=True)
    alone = [
        renderer.render(K, pose, IMAGE, bgr=True, normals=True)
        for renderer, pose in zip(renderers, poses)
    ]
    depths = np.array([np.nan_to_num(view.depth, nan=np.inf) for view in alone])
    nearest = np.where(np.isinf(depths.min(axis=0)), 0, 1 + depths.argmin(axis=0))
    assert (together.ids == nearest).all()
    assert set(np.unique(nearest)) == {0, 1, 2, 3}
    for index, view in enumerate(alone):
        mine = nearest == index + 1
        assert np.allclose(together.depth[mine], view.depth[mine], rtol=1e-6)
        assert (together.bgr[mine] == view.bgr[mine]).all()
        assert (together.normals[mine] == view.normals[mine]).all()


def test_both_sides_of_a_surface_that_is_not_closed_are_seen():
    front = rv.MeshRenderer(square()).render(K, tilted(0.4), IMAGE, bgr=True, normals=True)
    turned = tilted(0.4) @ np.diag([-1.0, 1.0, -1.0, 1.0])
    back = rv.MeshRenderer(square()).render(K, turned, IMAGE, bgr=True, normals=True)
    assert np.array_equal(front.depth, back.depth, equal_nan=True)
    assert np.allclose(front.normals, back.normals, atol=1e-6, equal_nan=True)
    assert (front.bgr == back.bgr).all()


def test_the_inside_of_a_closed_surface_is_not_seen():
    mesh = rv.sample_mesh("box").mesh
    pose = np.eye(4)
    pose[:3, 3] = -np.array(rv.mesh_extent(mesh).center)
    assert np.isnan(rv.MeshRenderer(mesh).render(K, pose, IMAGE).depth).all()
    turned = rv.Mesh(mesh.vertices, mesh.triangles[:, ::-1])  # its inside is out
    pose = looking_at(rv.mesh_extent(mesh).center, 0.5, 0.3, 0.3)
    views = [rv.MeshRenderer(one).render(K, pose, IMAGE).depth for one in (mesh, turned)]
    assert (~np.isnan(views[0])).sum() > 500
    assert np.array_equal(*views, equal_nan=True)


def test_what_is_behind_the_camera_is_not_seen():
    pose = tilted(0.3, distance=-0.3)
    assert np.isnan(rv.MeshRenderer(square()).render(K, pose, IMAGE).depth).all()


def test_a_view_through_a_lens_has_the_rays_of_its_pixels():
    camera = rv.CameraModel(64, 48, K, [-0.25, 0.1, 0.003, -0.002, 0.0])
    mesh = rv.sample_mesh("mug").mesh
    renderer = rv.MeshRenderer(mesh)
    pose = looking_at(renderer.extent.center, 0.6, 0.4, 2.2 * renderer.extent.radius)
    view = renderer.render(rv.MeshCamera(camera), pose, IMAGE, normals=True)
    pixels = np.stack(np.meshgrid(np.arange(64), np.arange(48)), -1).reshape(-1, 2).astype(float)
    depths, _, weights = cast(mesh, pose, camera.rays(pixels))
    met = np.isfinite(grid(depths))
    wrong = np.isnan(view.depth) == met
    wrong[met] |= ~np.isclose(view.depth[met], grid(depths)[met], rtol=1e-5)
    assert not wrong[grid(weights.min(axis=1)) > 1e-3].any() and wrong.sum() <= 3
    assert np.array_equal(renderer.render(camera, pose, IMAGE).depth, view.depth, equal_nan=True)


def test_a_fisheye_lens_shows_what_is_far_from_the_axis():
    wide = np.array([[28.0, 0, 31.5], [0, 28.0, 23.5], [0, 0, 1]])
    camera = rv.CameraModel(64, 48, wide, [0.01, 0, 0, 0], "equidistant")
    renderer = rv.MeshRenderer(square())
    pose = tilted(0.0, distance=0.05)
    depth = renderer.render(camera, pose, IMAGE).depth
    pixels = np.stack(np.meshgrid(np.arange(64), np.arange(48)), -1).reshape(-1, 2).astype(float)
    rays = camera.rays(pixels)
    place = 0.05 * rays - pose[:2, 3]
    inside = (np.abs(place) < 0.1).all(axis=1)
    assert 300 < inside.sum() < 3000
    assert (grid(inside) == ~np.isnan(depth)).all()


def test_threads_share_a_renderer():
    renderer = rv.MeshRenderer(rv.sample_mesh("duck").mesh)
    poses = [looking_at(renderer.extent.center, 0.4 * i, 0.5, 0.3) for i in range(16)]

    def render(pose):
        return renderer.render(K, pose, IMAGE, bgr=True).bgr

    alone = [render(pose) for pose in poses]
    with ThreadPoolExecutor(4) as pool:
        assert np.array_equal(alone, list(pool.map(render, poses)))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"camera": np.zeros((3, 3))}, "K is 0 everywhere, must be that of a calibrated camera"),
        ({"camera": np.eye(2)}, "expected a MeshCamera, a CameraModel or a 3x3 matrix K"),
        ({"pose": np.full((4, 4), np.nan)}, "pose is nan, must be finite and at most 1e6"),
        ({"pose": np.eye(3)}, "expected a 4x4 pose"),
        ({"region": (0, 0, 0, 5)}, "region is 0x5, must be from 1x1 to 16384x16384"),
        ({"region": (0, 0, 5, 20000)}, "region is 5x20000, must be from 1x1 to 16384x16384"),
        (
            {"camera": rv.CameraModel(64, 48, K, [0.1, 0, 0, 0]), "region": (30, 0, 40, 48)},
            "region is 40x48, must be within the image of 64x48 of a camera with distortion",
        ),
    ],
)
def test_what_cannot_be_drawn_is_refused(change, message):
    arguments = {"camera": K, "pose": np.eye(4), "region": IMAGE, **change}
    with pytest.raises(ValueError) as error:
        rv.MeshRenderer(square()).render(**arguments)
    assert str(error.value) == message


def test_renderers_are_no_none():
    with pytest.raises(ValueError) as error:
        rv.render_meshes([rv.MeshRenderer(square()), None], [np.eye(4)] * 2, K, IMAGE)
    assert str(error.value) == "expected renderers, not None"


@pytest.mark.parametrize(
    ("part", "message"),
    [
        ({"triangles": [[0, 1, 2**32 + 2]]}, "from -2147483648 to 2147483647 as triangles"),
        ({"triangles": [[0.0, 0.9, 2.0]]}, "from -2147483648 to 2147483647 as triangles"),
        ({"colors": [[0, 0, 300]] * 3}, "from 0 to 255 as colors"),
        ({"colors": np.full((3, 3), 0.5)}, "from 0 to 255 as colors"),
    ],
)
def test_numbers_that_do_not_fit_are_refused(part, message):
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    with pytest.raises(ValueError) as error:
        rv.Mesh(**{"vertices": corners, "triangles": [[0, 1, 2]], **part})
    assert str(error.value) == "expected whole numbers " + message


def test_a_mesh_keeps_what_it_was_made_of():
    texture = np.arange(12, dtype=np.uint8).reshape(2, 2, 3)
    mesh = rv.Mesh(
        vertices=[[0, 0, 0], [1, 0, 0], [0, 1, 0]],
        triangles=[[0, 1, 2]],
        normals=np.tile([0.0, 0.0, 1.0], (3, 1)),
        colors=[[1, 2, 3], [4, 5, 6], [7, 8, 9]],
        texture_coordinates=[[0, 0], [1, 0], [0, 1]],
        textures=[texture],
        triangle_textures=[0],
        color=(9, 8, 7),
    )
    assert mesh.vertices.dtype == np.float32 and mesh.vertices.tolist()[1] == [1, 0, 0]
    assert mesh.triangles.tolist() == [[0, 1, 2]] and mesh.normals.tolist() == [[0, 0, 1]] * 3
    assert mesh.colors.tolist()[2] == [7, 8, 9] and mesh.texture_coordinates.tolist()[1] == [1, 0]
    assert (mesh.textures[0] == texture).all() and mesh.triangle_textures.tolist() == [0]
    assert tuple(mesh.color) == (9, 8, 7)
    with pytest.raises(ValueError, match="a vertex of a triangle is 3, must be from 0 to 2"):
        rv.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]])
