"""What is made of the meshes of files: units, normals, and what there is to say of them."""

import pathlib

import numpy as np
import pytest
from mesh_files import PYRAMID, SIDES, obj, shape, written

import robot_vision as rv
from robot_vision.meshes import mesh_sheet, read_mesh, write_mesh

COURSE = pathlib.Path(__file__).resolve().parents[3] / "shared/recognition"


def test_vertices_that_are_the_same_are_merged_and_edges_are_sharp(tmp_path):
    write_mesh(str(tmp_path / "can.stl"), rv.sample_mesh("can").mesh)
    mesh = read_mesh(str(tmp_path / "can.stl")).mesh
    assert len(mesh.vertices) < len(
        mesh.triangles
    )  # of three vertices for each triangle in the file
    side = (np.abs(mesh.vertices[:, 2] - 0.06) < 0.02) & (
        np.hypot(*mesh.vertices[:, :2].T) > 0.0329
    )
    out = mesh.vertices[side] * [1, 1, 0] / 0.033
    assert side.sum() > 100
    assert np.abs(mesh.normals[side] - out).max() < 0.01  # smooth around
    top = (mesh.vertices[:, 2] > 0.1149) & (np.abs(mesh.normals[:, 2]) > 0.99)
    assert top.sum() > 50  # and flat on the rim


def test_points_and_lines_are_left_out(tmp_path):
    path = obj(tmp_path / "more.obj", between="p 1 2\nl 1 2 3")
    assert shape(read_mesh(path).mesh) == shape(rv.Mesh(PYRAMID, SIDES))


def test_what_is_inside_out_is_turned(tmp_path):
    loaded = read_mesh(obj(tmp_path / "a.obj", sides=SIDES[:, ::-1]))
    assert shape(loaded.mesh) == shape(rv.Mesh(PYRAMID, SIDES))


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("winding", ["right", "turned"])
@pytest.mark.parametrize("normals", ["right", "turned"])
def test_normals_point_to_the_outside_whatever_the_file_has(tmp_path, closed, winding, normals):
    sides = SIDES if closed else SIDES[:3]
    if winding == "turned":
        sides = sides[:, ::-1]
    middle = PYRAMID.mean(axis=0)
    out = (PYRAMID - middle) * (1 if normals == "right" else -1)
    lines = ["v " + " ".join(map(str, place)) for place in PYRAMID]
    lines += ["vn " + " ".join(map(str, normal)) for normal in out]
    lines += ["f " + " ".join(f"{i + 1}//{i + 1}" for i in side) for side in sides]
    mesh = read_mesh(written(tmp_path / "a.obj", "\n".join([*lines, ""]))).mesh
    # No side of an open surface is the inside: its normals are those of its triangles.
    sign = 1 if closed or winding == "right" else -1
    assert shape(mesh) == shape(rv.Mesh(PYRAMID, SIDES if closed else sides))
    expected = sign * (PYRAMID - middle)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    for place, normal in zip(mesh.vertices, mesh.normals):
        nearest = np.linalg.norm(PYRAMID - place, axis=1).argmin()
        assert np.allclose(normal, expected[nearest], atol=1e-5)


def test_what_is_not_closed_or_has_no_area_is_told(tmp_path):
    loaded = read_mesh(obj(tmp_path / "a.obj", sides=[*SIDES[:3], [0, 0, 1], [0, 1, 1]]))
    assert not loaded.closed and loaded.open_edges == 3 and loaded.dropped == 2
    assert loaded.warnings == [
        "triangles without an area were left out: 2",
        "the surface is not closed, so both of its sides are seen: 3 edges have a triangle at one "
        "side only",
    ]


def test_vertices_have_the_color_of_their_place_in_a_texture_that_repeats(tmp_path):
    texture = np.zeros((2, 4, 3), np.uint8)
    texture[:, :, 0] = 10 * np.arange(8).reshape(2, 4)  # 10 for each pixel, row by row
    places = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.3), (1.3, 0.6), (-0.2, -0.2), (-1.0, 5.6)]
    pixels = [0, 7, 3, 5, 7, 4]
    vertices = np.array([[0.1 * number, number % 2, 0.0] for number in range(6)], np.float32)
    mesh = rv.Mesh(
        vertices,
        [(0, 1, 2), (3, 4, 5)],
        texture_coordinates=np.array(places, np.float32),
        textures=[texture],
        triangle_textures=[0, 0],
    )
    write_mesh(str(tmp_path / "a.ply"), mesh)
    read = read_mesh(str(tmp_path / "a.ply"), "m").mesh
    for vertex, pixel in zip(vertices, pixels):
        nearest = np.linalg.norm(read.vertices - vertex, axis=1).argmin()
        assert read.colors[nearest].tolist() == [10 * pixel, 0, 0], vertex


@pytest.mark.parametrize(
    ("scale", "unit", "reason"),
    [
        (1.0, "m", "0.300 x 0.200 x 0.100 large, which is taken for m: it is 0.300 x 0.200 x 0.1"),
        (10.0, "m", "3.00 x 2.00 x 1.00 large, which is taken for m (cm would make it 0.0300 x 0."),
        (50.0, "cm", "15.0 x 10.0 x 5.0 large, which is taken for cm (inch would make it 0.381 x "),
        (500.0, "mm", "150 x 100 x 50 large, which is taken for mm (cm would make it 1.50 x 1.00 "),
    ],
)
def test_the_unit_is_what_makes_a_thing_to_be_handled(tmp_path, scale, unit, reason):
    loaded = read_mesh(obj(tmp_path / "a.obj", PYRAMID * scale))
    assert loaded.unit == unit
    assert loaded.unit_reason.startswith(f"its numbers are {reason}")
    metres = {"m": 1.0, "cm": 0.01, "mm": 0.001}[unit] * scale
    assert np.allclose(rv.mesh_extent(loaded.mesh).size, [0.3 * metres, 0.2 * metres, 0.1 * metres])


def test_a_unit_can_be_said(tmp_path):
    loaded = read_mesh(obj(tmp_path / "a.obj", PYRAMID * 10.0), unit="inch")
    assert loaded.unit == "inch" and loaded.unit_reason == (
        "its unit is inch, as was said: it is 0.0762 x 0.0508 x 0.0254 m"
    )
    assert np.allclose(rv.mesh_extent(loaded.mesh).size, [0.0762, 0.0508, 0.0254])


def test_a_sheet_shows_all_sides():
    mesh = rv.sample_mesh("box").mesh
    sheet = mesh_sheet(mesh, columns=4, rows=2, side=120)
    assert sheet.shape[:2] == (2 * 120 + 26, 4 * 120)
    tiles = [
        sheet[120 * i : 120 * i + 120, 120 * k : 120 * k + 120] for i in (0, 1) for k in range(4)
    ]
    for tile in tiles:
        drawn = (tile != tile[0, 0]).any(axis=2)
        rows, columns = np.nonzero(drawn)
        assert 0.1 < drawn.mean() < 0.8
        assert min(rows.min(), columns.min()) > 2 and max(rows.max(), columns.max()) < 117
    assert all((tiles[0] != tile).any() for tile in tiles[1:])
    assert (sheet[240:] > 200).any()  # the words


def test_other_suffixes_cannot_be_written(tmp_path):
    with pytest.raises(ValueError, match=r"the suffix is '\.xyz', must be \.ply, \.stl or \.obj"):
        write_mesh(str(tmp_path / "a.xyz"), rv.sample_mesh("nut").mesh)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not COURSE.is_dir(), reason="the course's meshes are not beside this checkout")
@pytest.mark.parametrize(
    ("name", "size", "textures"),
    [
        ("coke.stl", (0.068, 0.068, 0.121), 0),
        ("coke.obj", (0.068, 0.068, 0.121), 3),
        ("bottle_blend_6k.stl", (0.08, 0.08, 0.26), 0),
    ],
)
def test_the_meshes_of_the_course_are_read(name, size, textures):
    loaded = read_mesh(str(COURSE / name))
    extent = rv.mesh_extent(loaded.mesh)
    assert loaded.unit == "m" and len(loaded.mesh.textures) == textures
    if size:
        assert np.allclose(sorted(extent.size), sorted(size), atol=0.004)
    assert 0.05 < extent.diameter < 0.5
    view = rv.MeshRenderer(loaded.mesh).render(
        np.array([[300.0, 0, 60], [0, 300.0, 60], [0, 0, 1]]),
        np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.5], [0, 0, 0, 1.0]]),
        (0, 0, 120, 120),
        bgr=True,
    )
    assert (~np.isnan(view.depth)).sum() > 500
