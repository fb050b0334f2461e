"""Meshes of files, in each format."""

import json
import struct

import cv2
import numpy as np
import pytest
from mesh_files import PYRAMID, SIDES, gltf, shape, written

import robot_vision as rv
from robot_vision.meshes import read_mesh, write_mesh


def area_normals(mesh):
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


@pytest.mark.parametrize("suffix", ["ply", "stl", "obj"])
@pytest.mark.parametrize("name", ["drill", "box"])
def test_what_was_written_is_read(tmp_path, name, suffix):
    mesh = rv.sample_mesh(name).mesh
    path = str(tmp_path / f"{name}.{suffix}")
    write_mesh(path, mesh)
    loaded = read_mesh(path, "m")
    assert shape(loaded.mesh) == shape(mesh)
    assert loaded.closed and loaded.open_edges == 0 and loaded.warnings == []
    normals = loaded.mesh.normals[loaded.mesh.triangles[:, 0]]
    assert np.sum(normals * area_normals(loaded.mesh), axis=1).min() > 0.2
    if suffix == "stl":
        assert len(loaded.mesh.colors) == 0 and tuple(loaded.mesh.color) == (160, 160, 160)
    elif name == "drill":
        assert sorted(map(tuple, loaded.mesh.colors)) == sorted(map(tuple, mesh.colors))


@pytest.mark.parametrize("stem", ["-s 1 box", " box"])
def test_textures_of_obj_files_may_have_any_name(tmp_path, stem):
    path = str(tmp_path / f"{stem}.obj")
    write_mesh(path, rv.sample_mesh("box").mesh)
    loaded = read_mesh(path)
    assert len(loaded.mesh.textures) == 6 and loaded.warnings == []


def test_textures_of_obj_files_come_along(tmp_path):
    mesh = rv.sample_mesh("box").mesh
    write_mesh(str(tmp_path / "box.obj"), mesh)
    loaded = read_mesh(str(tmp_path / "box.obj")).mesh
    assert len(loaded.textures) == 6
    pose = np.eye(4)
    pose[:3, :3] = [[0.8, 0.6, 0], [0.2, -0.3, -0.93], [-0.56, 0.74, -0.36]]
    u, _, v = np.linalg.svd(pose[:3, :3])
    pose[:3, :3] = u @ v
    pose[:3, 3] = 0.0, 0.03, 0.5
    camera = np.array([[300.0, 0, 80], [0, 300.0, 60], [0, 0, 1]])
    first, second = (
        rv.MeshRenderer(one).render(camera, pose, (0, 0, 160, 120), bgr=True).bgr
        for one in (mesh, loaded)
    )
    assert np.abs(first.astype(int) - second).max() <= 2
    assert first.std() > 20


def test_an_obj_file_has_its_materials(tmp_path):
    image = np.zeros((8, 4, 3), np.uint8)
    image[:4] = 10, 20, 200
    cv2.imwrite(str(tmp_path / "skin.png"), image)
    written(
        tmp_path / "two.mtl", "newmtl red\nKd 1 0 0\nnewmtl skin\nKd 0.2 0.2 0.2\nmap_Kd skin.png\n"
    )
    path = written(
        tmp_path / "two.obj",
        """
        mtllib two.mtl
        v 0 0 0
        v 0.3 0 0
        v 0 0.2 0
        v 0 0 0.1
        vt 0 0
        vt 1 0
        vt 0 1
        usemtl red
        f 1 3 2
        f 1 2 4
        usemtl skin
        f 1/1 4/2 3/3
        f 2/1 3/2 4/3
        """,
    )
    mesh = read_mesh(path).mesh
    textured = mesh.triangle_textures >= 0
    assert textured.sum() == 2 and (mesh.textures[0] == image).all()
    corner = mesh.triangles[textured][0]
    # v of a file grows up from the bottom, and ours down from the top.
    assert sorted(map(tuple, mesh.texture_coordinates[corner])) == [(0, 0), (0, 1), (1, 1)]
    assert (mesh.colors[mesh.triangles[~textured]] == (0, 0, 255)).all()


def test_a_texture_that_is_missing_is_a_warning(tmp_path):
    written(tmp_path / "a.mtl", "newmtl skin\nKd 0 1 0\nmap_Kd C:\\\\work\\\\skin.png\n")
    vertices = "v 0 0 0\nv 0.3 0 0\nv 0 0.2 0\nv 0 0 0.1\nvt 0 0\nvt 1 0\nvt 0 1\n"
    faces = "f 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3\n"
    path = written(tmp_path / "a.obj", "mtllib a.mtl\n" + vertices + "usemtl skin\n" + faces)
    loaded = read_mesh(path)
    assert len(loaded.warnings) == 1 and "skin.png cannot be read" in loaded.warnings[0]
    assert len(loaded.mesh.textures) == 0 and tuple(loaded.mesh.color) == (0, 255, 0)
    cv2.imwrite(str(tmp_path / "skin.png"), np.full((2, 2, 3), 7, np.uint8))  # beside the mesh
    loaded = read_mesh(path)
    assert loaded.warnings == [] and (loaded.mesh.textures[0] == 7).all()
    (tmp_path / "skin.png").write_bytes(b"no image")
    assert "skin.png cannot be read" in read_mesh(path).warnings[0]


def test_a_texture_with_several_names_is_read_once(tmp_path):
    cv2.imwrite(str(tmp_path / "skin.png"), np.full((2, 2, 3), 7, np.uint8))
    names = [f"{'./' * number}skin.png" for number in range(4)]
    materials = [f"newmtl skin{number}\nmap_Kd {name}\n" for number, name in enumerate(names)]
    written(tmp_path / "a.mtl", "".join(materials))
    vertices = "v 0 0 0\nv 0.3 0 0\nv 0 0.2 0\nv 0 0 0.1\nvt 0 0\nvt 1 0\nvt 0 1\n"
    faces = ["f 1/1 3/2 2/3\n", "f 1/1 2/2 4/3\n", "f 1/1 4/2 3/3\n", "f 2/1 3/2 4/3\n"]
    used = "".join(f"usemtl skin{number}\n{face}" for number, face in enumerate(faces))
    mesh = read_mesh(written(tmp_path / "a.obj", "mtllib a.mtl\n" + vertices + used)).mesh
    assert len(mesh.textures) == 1 and mesh.triangle_textures.tolist() == [0, 0, 0, 0]


def test_a_collada_file_keeps_its_axes_and_has_its_unit_and_places(tmp_path):
    numbers = " ".join(map(str, (PYRAMID * 1000.0).ravel()))
    sides = " ".join(map(str, SIDES.ravel()))
    path = written(
        tmp_path / "pyramid.dae",
        f"""\
        <?xml version="1.0"?>
        <COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
          <asset><unit name="millimetre" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
          <library_geometries><geometry id="g"><mesh>
            <source id="p"><float_array id="a" count="12">{numbers}</float_array>
              <technique_common><accessor source="#a" count="4" stride="3">
                <param name="X" type="float"/><param name="Y" type="float"/>
                <param name="Z" type="float"/>
              </accessor></technique_common></source>
            <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
            <triangles count="4">
              <input semantic="VERTEX" source="#v" offset="0"/><p>{sides}</p></triangles>
          </mesh></geometry></library_geometries>
          <library_visual_scenes><visual_scene id="s"><node>
            <translate>1000 0 0</translate><rotate>0 0 1 90</rotate><instance_geometry url="#g"/>
          </node></visual_scene></library_visual_scenes>
          <scene><instance_visual_scene url="#s"/></scene>
        </COLLADA>
        """,
    )
    loaded = read_mesh(path)
    assert loaded.unit == "m" and loaded.unit_reason.startswith(
        "its unit is m, as files of its format say"
    )
    moved = np.column_stack([1.0 - PYRAMID[:, 1], PYRAMID[:, 0], PYRAMID[:, 2]])
    assert shape(loaded.mesh) == shape(rv.Mesh(moved, SIDES))


@pytest.mark.parametrize("binary", [False, True])
def test_a_gltf_file_has_its_scene_and_materials(tmp_path, binary):
    document, data = gltf()
    if binary:
        del document["buffers"][0]["uri"]
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        data += b"\0" * (-len(data) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
        path = tmp_path / "pyramid.glb"
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    else:
        path = tmp_path / "pyramid.gltf"
        path.write_text(json.dumps(document))
    loaded = read_mesh(str(path))
    moved = PYRAMID * [2, 2, -2] + [0, 0, 2]
    assert shape(loaded.mesh) == shape(
        rv.Mesh(moved, SIDES[:, ::-1])
    )  # mirrored, and outside still out
    assert loaded.closed and loaded.unit == "m"
    assert tuple(loaded.mesh.color) == (255, 0, 0)


@pytest.mark.parametrize("of_vertices", [False, True])
def test_colors_of_a_gltf_file_are_linear(tmp_path, of_vertices):
    document, data = gltf()
    color = [0.0, 0.262, 1.0, 1.0]  # a green of 0.55 as it is shown
    if of_vertices:
        colors = np.float32([color] * 4).tobytes()
        view = {"buffer": 0, "byteOffset": len(data), "byteLength": len(colors)}
        document["bufferViews"].append(view)
        accessor = {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC4"}
        document["accessors"].append(accessor)
        document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 2
        data += colors
        document["materials"] = [{}]
    else:
        document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = color
    (tmp_path / "a.bin").write_bytes(data)
    document["buffers"] = [{"byteLength": len(data), "uri": "a.bin"}]
    (tmp_path / "a.gltf").write_text(json.dumps(document))
    mesh = read_mesh(str(tmp_path / "a.gltf")).mesh
    colors = mesh.colors if len(mesh.colors) else [mesh.color]
    assert {tuple(one) for one in colors} == {(255, 140, 0)}


@pytest.mark.parametrize("chosen", [0, 1, 5])
def test_a_texture_of_a_gltf_file_has_the_coordinates_that_it_names(tmp_path, chosen):
    cv2.imwrite(str(tmp_path / "skin.png"), np.full((2, 2, 3), 7, np.uint8))
    document, data = gltf()
    sets = [np.full((4, 2), value, "<f4") for value in (0.25, 0.75)]
    for number, coordinates in enumerate(sets):
        document["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(data), "byteLength": coordinates.nbytes}
        )
        document["accessors"].append(
            {"bufferView": 2 + number, "componentType": 5126, "count": 4, "type": "VEC2"}
        )
        document["meshes"][0]["primitives"][0]["attributes"][f"TEXCOORD_{number}"] = 2 + number
        data += coordinates.tobytes()
    (tmp_path / "a.bin").write_bytes(data)
    document["buffers"] = [{"byteLength": len(data), "uri": "a.bin"}]
    document["images"], document["textures"] = [{"uri": "skin.png"}], [{"source": 0}]
    texture = {"index": 0, "texCoord": chosen}
    document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": texture}}]
    (tmp_path / "a.gltf").write_text(json.dumps(document))
    mesh = read_mesh(str(tmp_path / "a.gltf")).mesh
    assert (mesh.triangle_textures == 0).all()
    # The first set stands in for one that is not there.
    assert np.unique(mesh.texture_coordinates).tolist() == [0.75 if chosen == 1 else 0.25]


def test_what_a_scene_mirrors_keeps_its_outside(tmp_path):
    path = tmp_path / "open.gltf"  # not closed, so that only the file can tell
    path.write_text(json.dumps(gltf(sides=SIDES[:3])[0]))
    loaded = read_mesh(str(path))
    assert not loaded.closed
    assert shape(loaded.mesh) == shape(rv.Mesh(PYRAMID * [2, 2, -2] + [0, 0, 2], SIDES[:3, ::-1]))
