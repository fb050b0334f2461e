"""Meshes that a DepthVolume makes of exact depth images: the surface, and what is refused."""

import numpy as np
import pytest

from robot_vision import CameraModel, DepthVolume
from robot_vision.meshes import Mesh, MeshRenderer, mesh_extent

K = np.array([[300.0, 0.0, 99.5], [0.0, 300.0, 99.5], [0.0, 0.0, 1.0]])
CAMERA = CameraModel(200, 200, K)
RADIUS = 0.05  # m
VOXEL = 0.003  # m


def ball():
    """A ball of radius RADIUS that stands on z = 0, red above its middle and blue below."""
    rings, sectors = 24, 32
    vertices = [
        RADIUS * np.array([np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)])
        for p in np.linspace(0.0, np.pi, rings + 1)
        for a in 2.0 * np.pi * np.arange(sectors) / sectors
    ]
    triangles = []
    for ring in range(rings):
        for sector in range(sectors):
            after = (sector + 1) % sectors
            a, b = ring * sectors + sector, ring * sectors + after
            triangles += [(a, a + sectors, b), (b, a + sectors, b + sectors)]
    vertices = np.array(vertices)
    colors = np.where(vertices[:, 2:] > 0.0, [[30, 30, 220]], [[220, 30, 30]]).astype(np.uint8)
    return Mesh(vertices + np.array([0.0, 0.0, RADIUS]), np.array(triangles), colors=colors)


def views(count=12, elevation=0.5, distance=0.4):
    """Poses of an object around which a camera goes, which looks at its middle."""
    for angle in 2.0 * np.pi * np.arange(count) / count:
        flat = np.array([np.cos(angle), np.sin(angle), 0.0])
        away = -(np.cos(elevation) * flat + np.sin(elevation) * np.array([0.0, 0.0, 1.0]))
        right = np.array([-flat[1], flat[0], 0.0])
        axes = np.column_stack([right, np.cross(away, right), away])
        pose = np.eye(4)
        pose[:3, :3] = axes.T
        pose[:3, 3] = -axes.T @ (np.array([0.0, 0.0, RADIUS]) - distance * away)
        yield pose


@pytest.fixture(scope="module")
def mesh():
    renderer = MeshRenderer(ball())
    low, high = (-0.06, -0.06, 0.0), (0.06, 0.06, 0.115)
    volume = DepthVolume(low, high, VOXEL)
    for elevation in (0.2, 0.9):
        for pose in views(elevation=elevation):
            view = renderer.render(CAMERA, pose, (0, 0, 200, 200), bgr=True)
            mask = np.isfinite(view.depth).astype(np.uint8)
            volume.add(view.bgr, view.depth, mask, CAMERA, pose)
    return volume.mesh()


def test_the_surface_is_where_it_is(mesh):
    distances = np.linalg.norm(mesh.vertices - [0.0, 0.0, RADIUS], axis=1) - RADIUS
    seen = mesh.vertices[:, 2] > 0.025  # Below, the ball hides itself.
    assert np.median(np.abs(distances[seen])) < 0.0005
    assert np.abs(distances[seen]).max() < 0.003
    size = np.asarray(mesh_extent(mesh).size)
    assert size == pytest.approx([2.0 * RADIUS] * 3, abs=0.006)


def test_it_is_closed_and_its_triangles_look_outside(mesh):
    edges = np.concatenate([mesh.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    there, counts = np.unique(edges, axis=0, return_counts=True)
    back, back_counts = np.unique(edges[:, ::-1], axis=0, return_counts=True)
    assert np.array_equal(there, back) and np.array_equal(counts, back_counts)
    a, b, c = (mesh.vertices[mesh.triangles[:, i]].astype(float) for i in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0
    assert volume == pytest.approx(4.0 / 3.0 * np.pi * RADIUS**3, rel=0.1)
    up = mesh.vertices - [0.0, 0.0, RADIUS]
    seen = mesh.vertices[:, 2] > 0.03
    cosines = np.einsum("ij,ij->i", mesh.normals, up)[seen] / np.linalg.norm(up[seen], axis=1)
    assert np.median(cosines) > 0.99 and cosines.min() > 0.7


def test_it_has_the_colors_of_the_images(mesh):
    heights, colors = mesh.vertices[:, 2], mesh.colors.astype(float)
    above, below = colors[heights > 0.06], colors[(heights < 0.04) & (heights > 0.02)]
    assert (above[:, 2] > 1.5 * above[:, 0]).mean() > 0.95
    assert (below[:, 0] > 1.5 * below[:, 2]).mean() > 0.95


def test_what_is_below_the_floor_is_as_what_is_above_it():
    renderer = MeshRenderer(ball())
    volume = DepthVolume((-0.06, -0.06, 0.0), (0.06, 0.06, 0.115), 0.004, floor=RADIUS)
    for pose in views():
        view = renderer.render(CAMERA, pose, (0, 0, 200, 200), bgr=True)
        seen = np.isfinite(view.depth)
        depth = np.where(seen, view.depth, np.float32(0.0))
        volume.add(view.bgr, depth, seen.astype(np.uint8), CAMERA, pose)
    made = volume.mesh()
    low = made.vertices[(made.vertices[:, 2] > 0.008) & (made.vertices[:, 2] < 0.04)]
    assert np.median(np.linalg.norm(low[:, :2], axis=1)) == pytest.approx(RADIUS, abs=0.003)
    assert made.vertices[:, 2].min() == pytest.approx(0.0, abs=0.003)


def test_nothing_seen_is_no_mesh():
    volume = DepthVolume((0.0, 0.0, 0.0), (0.1, 0.1, 0.1), 0.01)
    depth, image = np.full((200, 200), 5.0, np.float32), np.zeros((200, 200, 3), np.uint8)
    pose = np.eye(4)
    pose[2, 3] = 1.0
    for _ in range(3):
        volume.add(image, depth, np.zeros((200, 200), np.uint8), CAMERA, pose)
    with pytest.raises(ValueError, match="the surface of the object is not to be seen"):
        volume.mesh()


@pytest.mark.parametrize(
    "low, high, voxel, message",
    [
        ((0, 0, 0), (0.1, 0.1, -0.1), 0.01, "a corner of the volume is -0.1"),
        ((0, 0, 0), (0.1, 0.1, 0.1), 0.0, "voxel is 0"),
        ((0, 0, 0), (1, 1, 1), 0.001, "the number of voxels"),
        ((0, 0, 0), (0.1, 0.1, 0.01), 0.01, "the smallest side of the volume is 1"),
        ((0, 0, np.nan), (0.1, 0.1, 0.1), 0.01, "a corner of the volume is nan"),
    ],
)
def test_a_box_that_cannot_be_is_refused(low, high, voxel, message):
    with pytest.raises(ValueError, match=message):
        DepthVolume(low, high, voxel)


def test_images_that_do_not_belong_together_are_refused():
    volume = DepthVolume((0.0, 0.0, 0.0), (0.1, 0.1, 0.1), 0.01)
    image, mask = np.zeros((200, 200, 3), np.uint8), np.zeros((200, 200), np.uint8)
    depth = np.ones((200, 200), np.float32)
    for bgr, depths, own, pose, what in (
        (image[1:], depth, mask, np.eye(4), "size of the image is 200x199"),
        (image, depth[1:], mask, np.eye(4), "200x200"),
        (image, depth, mask[1:], np.eye(4), "the mask is 200x199"),
        (image, depth, mask, 2.0 * np.eye(4), "the pose of the object"),
    ):
        with pytest.raises(ValueError, match=what):
            volume.add(bgr, depths, own, CAMERA, pose)
