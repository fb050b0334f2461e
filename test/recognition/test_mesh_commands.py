"""Meshes in the database: mesh_add.py, mesh_view.py, pages, and the formats of others."""

import base64
import io
import json
import os
import pathlib
import re
import subprocess
import sys
import zipfile

import cv2
import numpy as np
import pytest

import robot_vision as rv
from robot_vision.meshes import write_mesh
from robot_vision.recognition import (
    mesh_add,
    mesh_intake,
    mesh_view,
    object_add,
    object_export,
    object_import,
    object_list,
)
from robot_vision.recognition.database import (
    Database,
    Mesh,
    Object,
    Observation,
    Session,
    Symmetry,
)
from robot_vision.recognition.mesh_data import pack_mesh, unpack_mesh
from robot_vision.recognition.symmetries import from_bop, parse_symmetries, to_bop, turns_of

MATRIX = np.array([[525.0, 0, 319.5], [0, 525, 239.5], [0, 0, 1]])
POSE = np.array([[0.0, -1, 0, 0.1], [1, 0, 0, -0.2], [0, 0, 1, 0.7], [0, 0, 0, 1]])


@pytest.fixture
def path(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    return str(tmp_path / "robot_vision_objects.db")


@pytest.fixture
def run(path, monkeypatch, capsys):
    """run(module, "word", ...) runs a command: exit code, stdout and stderr."""

    def command(module, *words):
        monkeypatch.setattr("sys.argv", [module.PROGRAM, *map(str, words)])
        try:
            code = module.main()
        except SystemExit as error:
            code = error.code
        return (code, *capsys.readouterr())

    return command


@pytest.fixture(scope="module")
def box():
    """A mesh with textures, and corners that are not in the middle."""
    return rv.sample_mesh("box").mesh


@pytest.fixture
def box_file(box, tmp_path):
    path = tmp_path / "box.obj"
    write_mesh(str(path), box)
    return path


def add(run, name, *words, commit=("--commit",)):
    assert run(object_add, "-n", name, "--commit")[0] == 0
    if words:
        code, out, err = run(mesh_add, name, *words, *commit)
        assert code == 0, err
        return out
    return ""


def stored(path, name):
    """The mesh of an object, as the database has it, and as it is drawn."""
    with Database(path) as database:
        mesh = database.meshes.of(database.objects.find(name).id)
    return mesh, unpack_mesh(mesh.converted)


def scaled(mesh, factor):
    return rv.Mesh(mesh.vertices * np.float32(factor), mesh.triangles, mesh.normals)


def same_shape(one, other, tolerance=1e-5):
    """Whether two meshes have the same triangles, in whatever order their vertices are."""

    def middles(mesh):
        found = np.asarray(mesh.vertices, float)[mesh.triangles].mean(axis=1)
        return found[np.lexsort(np.round(found, 4).T)]

    first, second = middles(one), middles(other)
    return first.shape == second.shape and np.abs(first - second).max() < tolerance


def test_a_mesh_with_all_that_it_names(run, path, box, box_file):
    told = add(run, "box", box_file, "--symmetry", "z:2, x:2")
    size = np.asarray(rv.mesh_extent(box).size)
    assert "is taken for m" in told and "symmetry: z:2\nsymmetry: x:2\n" in told
    assert "it is {:.1f} x {:.1f} x {:.1f} mm".format(*(1000.0 * size)) in told
    mesh, drawn = stored(path, "box")
    assert mesh.file_name == "box.obj" and mesh.original == box_file.read_bytes()
    beside = {one.name: one.read_bytes() for one in box_file.parent.glob("box*") if one != box_file}
    assert dict(mesh.files) == beside and any(name.endswith(".png") for name in beside)
    assert list(mesh.symmetries) == [Symmetry((0.0, 0.0, 1.0), 2), Symmetry((1.0, 0.0, 0.0), 2)]
    assert same_shape(drawn, box) and len(drawn.textures) == len(box.textures)
    for one, other in zip(drawn.textures, box.textures):
        assert np.array_equal(one, other)


def test_packed_meshes_are_the_same_bytes(box):
    packed = pack_mesh(box)
    again = unpack_mesh(packed)
    assert pack_mesh(again) == packed
    for name in ("vertices", "triangles", "normals", "texture_coordinates", "triangle_textures"):
        assert np.array_equal(getattr(again, name), getattr(box, name)), name
    assert again.color == box.color and all(map(np.array_equal, again.textures, box.textures))


@pytest.mark.parametrize("spoil", [b"", b"hello", "half", "bit", "bomb"])
def test_what_is_no_packed_mesh(box, spoil):
    packed = pack_mesh(box)
    if spoil == "half":
        spoil = packed[: len(packed) // 2]
    elif spoil == "bit":  # the first triangle has a vertex that is not there
        at = packed.index(np.asarray(box.triangles, "<i4").tobytes())
        spoil = packed[: at + 3] + b"\x7f" + packed[at + 4 :]
    elif spoil == "bomb":
        file = io.BytesIO()
        np.savez_compressed(file, vertices=np.zeros((10**6, 3), np.float32))
        spoil = file.getvalue()
    with pytest.raises(ValueError):
        unpack_mesh(spoil)


@pytest.mark.parametrize(
    "changes",
    [
        {"vertices": np.zeros(3, np.float32)},
        {"vertices": np.zeros((1, 1, 3), np.float32)},
        {"vertices": np.zeros((9, 2), np.float32)},
        {"color": np.zeros(4, np.uint8)},
        {"color": np.zeros((1, 3), np.uint8)},
        {"color": np.uint8(7)},
        {"triangle_textures": np.zeros((2, 3), np.int32)},
        {"triangle_textures": np.int32(0)},
        {"texture_0": np.zeros((2, 2))},
        {"texture_\u00b2": np.zeros(9, np.uint8)},
    ],
)
def test_arrays_that_no_mesh_has(box, changes):
    with np.load(io.BytesIO(pack_mesh(box))) as arrays:
        changed = {**arrays, **changes}
    file = io.BytesIO()
    np.savez(file, **changed)
    with pytest.raises(ValueError):
        unpack_mesh(file.getvalue())


@pytest.mark.parametrize("name", ["vertices", "color", "texture_0", "another"])
def test_members_of_a_packed_mesh_that_are_no_arrays(box, name):
    file = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(pack_mesh(box))) as packed, zipfile.ZipFile(file, "w") as made:
        for member in packed.namelist():
            if member != f"{name}.npy":
                made.writestr(member, packed.read(member))
        made.writestr(f"{name}.npy", b"hello")
    with pytest.raises(ValueError, match=f"it is no mesh: '{name}' is no array"):
        unpack_mesh(file.getvalue())


@pytest.mark.parametrize(
    "factor, words, unit",
    [
        (1000.0, [], 0.001),
        (100.0, ["--unit", "cm"], 0.01),
        (1.0 / 0.0254, ["--unit", "inch"], 0.0254),
        (500.0, ["--unit", "mm", "--scale", "2"], 0.001),
        (100.0, ["--unit", "m", "--scale", "0.01"], 1.0),
        (4e3, ["--scale", "0.00025"], 1.0),
    ],
)
def test_units(run, path, box, tmp_path, factor, words, unit):
    write_mesh(str(tmp_path / "part.stl"), scaled(box, factor))
    add(run, "part", tmp_path / "part.stl", *words)
    mesh, drawn = stored(path, "part")
    assert mesh.unit == unit and mesh.scale == (float(words[-1]) if "--scale" in words else 1.0)
    assert same_shape(drawn, box)


def test_the_origin_is_the_mesh_s_own_or_its_middle(run, path, box, tmp_path):
    moved = rv.Mesh(box.vertices + np.float32([0.3, 0.0, -0.1]), box.triangles)
    write_mesh(str(tmp_path / "part.stl"), moved)
    add(run, "part", tmp_path / "part.stl")
    mesh, drawn = stored(path, "part")
    assert mesh.offset == (0.0, 0.0, 0.0) and same_shape(drawn, moved)
    assert run(mesh_add, "part", tmp_path / "part.stl", "--center", "--commit")[0] == 0
    mesh, drawn = stored(path, "part")
    assert np.allclose(mesh.offset, rv.mesh_extent(moved).center, atol=1e-6)
    assert np.allclose(rv.mesh_extent(drawn).center, 0.0, atol=1e-6)


def test_without_commit_it_is_told_and_nothing_is_done(run, path, box_file):
    add(run, "box")
    code, out, _ = run(mesh_add, "box", box_file)
    assert code == 0 and out.endswith(
        "would give 'box' the mesh box.obj\n"
        "Use the --commit option to commit the proposed change.\n"
    )
    with Database(path) as database:
        assert database.meshes.entry(database.objects.find("box").id) is None


def written(tmp_path, kind):
    """A file that mesh_add.py cannot take."""
    path = tmp_path / {"no format": "a.xyz", "truncated": "a.ply"}.get(kind, "a.stl")
    if kind == "huge":
        write_mesh(str(path), scaled(rv.sample_mesh("box").mesh, 1e3))
    elif kind == "truncated":
        write_mesh(str(path), rv.sample_mesh("box").mesh)
        path.write_bytes(path.read_bytes()[:300])
    elif kind != "none":
        path.write_bytes({"empty": b"", "text": b"hello\n" * 99, "no format": b"x"}[kind])
    return path


@pytest.mark.parametrize("kind", ["none", "empty", "text", "no format", "truncated", "huge"])
def test_files_that_cannot_be_taken(run, path, tmp_path, kind):
    add(run, "thing")
    file = written(tmp_path, kind)
    words = ["--unit", "m"] if kind == "huge" else []
    code, out, err = run(mesh_add, "thing", file, *words, "--commit")
    assert (code, out, len(err.splitlines())) == (1, "", 1)
    assert err.startswith(f"mesh_add.py: {file}")
    with Database(path) as database:
        assert database.meshes.entry(database.objects.find("thing").id) is None


@pytest.mark.parametrize(
    "before",
    [
        "\n" * 10**6 + "#\n",
        "# <init_from>" + " " * 10**5 + "\n",
        "# " + "<init_from> " * 10**5 + "\n",
    ],
    ids=["empty lines", "white space", "openings"],
)
def test_names_are_found_at_once_in_a_file_made_to_take_for_ever(box_file, before):
    box_file.write_text(before + box_file.read_text())
    script = """
import sys
from robot_vision.recognition.mesh_intake import take_mesh
print(*sorted(take_mesh(sys.argv[1]).stored.files))
"""
    command = [sys.executable, "-c", script, str(box_file)]
    told = subprocess.run(command, stdout=subprocess.PIPE, check=True, timeout=60).stdout.decode()
    beside = sorted(one.name for one in box_file.parent.glob("box*") if one != box_file)
    assert told.split() == beside and "box.mtl" in beside


def test_names_that_are_no_utf_8(run, path, box, box_file, tmp_path):
    """Those of the mesh, of its materials and of their texture; files keep their bytes."""
    latin = os.fsdecode(b"caf\xe9")
    for name in ("box.mtl", "box_0.png"):
        (tmp_path / name).rename(tmp_path / name.replace("box", latin))
    for file in (tmp_path / f"{latin}.mtl", box_file):
        file.write_bytes(re.sub(rb"\bbox(_0|\.mtl)", b"caf\xe9\\1", file.read_bytes()))
    file = box_file.rename(tmp_path / f"{latin}.obj")
    assert "would give 'box' the mesh caf\\udce9.obj\n" in add(run, "box", file, commit=[])
    assert run(mesh_add, "box", file, "--commit")[0] == 0
    mesh, drawn = stored(path, "box")
    assert mesh.file_name == "caf?.obj" and mesh.original == file.read_bytes()
    assert {"caf?.mtl", "caf?_0.png"} <= set(mesh.files)
    assert same_shape(drawn, box) and len(drawn.textures) == len(box.textures)
    assert run(object_export, tmp_path / "folder")[0] == 0
    sheet = tmp_path / f"{latin}.png"
    code, out, err = run(mesh_view, file, "--output", sheet)
    assert (code, err) == (0, "") and "caf\\udce9.png\n" in out and sheet.exists()
    for bad in (f"{latin}.stl", latin):
        code, _, err = run(mesh_view, bad, "--output", tmp_path / "x.png")
        assert code == 1 and "mesh_view.py: there is no object 'caf\\udce9" in err


@pytest.mark.parametrize(
    "names, taken",
    [
        ("mtllib a.mtl\r\n", ["a.mtl"]),
        ("  mtllib\ta b.mtl  \nmtllib\nv 1 2 3\n", ["a b.mtl"]),
        ("map_Kd -s 2 -o 1 c.png\nbump d.png\n", ["c.png", "d.png"]),
        ("map_Kd -s 1 -1.5 1 -clamp on c.png\nbump -bm 0.2 d.png\n", ["c.png", "d.png"]),
        ("map_Kd tex/h.png\nmap_Ks C:\\\\work\\\\c.png\n", ["c.png", "h.png"]),
        ('{"uri": "./tex/h.png"}, {"uri": "a%20b.mtl"}', ["a b.mtl", "h.png"]),
        ('{"uri": "../mesh/tex/h.png"}, {"uri": "/etc/passwd"}', []),
        ('{"uri" : "e.bin"}, {"uri":"../f.bin"}', ["e.bin"]),
        ("<init_from>\n g.png </init_from><init_from> </init_from>", ["g.png"]),
    ],
)
def test_files_that_a_mesh_names(tmp_path, names, taken):
    folder = tmp_path / "mesh"
    (folder / "tex").mkdir(parents=True)
    for name in ("a.mtl", "a b.mtl", "c.png", "d.png", "e.bin", "g.png", "tex/h.png", "other"):
        (folder / name).write_bytes(b"x")
    told = []
    found = mesh_intake.files_beside(str(folder / "a.obj"), names.encode(), told.append)
    assert sorted(found) == taken and told == []


def test_of_two_files_with_one_name_the_first_is_taken_and_the_other_is_told(tmp_path):
    for name in ("body/skin.png", "lid/skin.png", "copy/skin.png"):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_bytes(b"red" if name.startswith("lid") else b"blue")
    (tmp_path / "skin.png").write_bytes(b"green")
    names = [b"map_Kd %s/skin.png" % name for name in (b"body", b"lid", b"copy", b"body")]
    told = []
    found = mesh_intake.files_beside(str(tmp_path / "a.obj"), b"\n".join(names), told.append)
    assert found == {"skin.png": b"blue"}
    assert told == ["lid/skin.png is left out: another file is stored as skin.png"]


@pytest.mark.parametrize(
    "words, said",
    [
        (
            ["--symmetry", "w"],
            "a symmetry is 'w', must be x, y or z, for any turn about it, or x:N",
        ),
        (["--symmetry", "z:4,x"], "the axis of a symmetry is neither along nor across one with"),
        (["--symmetry", "z:4,x:3"], "make together is more than 120, must be less: their axes"),
        (["--symmetry", "z:1"], "fold is 1, must be 0 (any turn), or from 2 to 120"),
        (["--symmetry", "z:"], "a symmetry is 'z:'"),
        (["--unit", "furlong"], "invalid choice: 'furlong'"),
        (["--scale", "0"], "0 must be from 1e-06 to 1e+06"),
    ],
)
def test_usage_errors(run, box_file, words, said):
    code, _, err = run(mesh_add, "box", box_file, *words, "--commit")
    assert code == 2 and said in err


def test_an_object_that_is_not_there(run, path, box_file):
    add(run, "box")
    said = f"mesh_add.py: there is no object 'bix' in {path}\n"
    assert run(mesh_add, "bix", box_file, "--commit") == (1, "", said)


def test_a_table_and_a_page(run, path, box_file, tmp_path):
    add(run, "box", box_file, "--symmetry", "z:2")
    add(run, "<b>bare</b>")
    code, out, _ = run(object_list)
    head, bare, row = out.splitlines()
    assert code == 0 and head.split()[:3] == ["id", "name", "mesh"]
    assert re.search(r"<b>bare</b>  -  +-  +-  +-  +-$", bare)
    assert re.search(r"box  +box\.obj  \d+ x \d+ x \d+  +z:2  +-  +-$", row)
    page = tmp_path / "new" / "page.html"
    assert run(object_list, "--html", page)[0] == 0
    text = page.read_text()
    assert "<b>bare" not in text and "&lt;b&gt;bare" in text and "<code>" in text
    (image,) = re.findall('src="data:image/jpeg;base64,([^"]*)"', text)
    pixels = cv2.imdecode(np.frombuffer(base64.b64decode(image), np.uint8), cv2.IMREAD_COLOR)
    assert pixels.shape[1] > 400 and pixels.std() > 10
    code, _, err = run(object_list, "--html", page)
    assert code == 1 and f"{page} is there already; --force replaces it" in err


def test_a_damaged_mesh_leaves_the_others_in_the_list(run, path, box_file, tmp_path):
    for name in ("box", "can"):
        add(run, name, box_file)
    with Database(path, write=True) as database, database.transaction():
        can = database.objects.find("can")
        database.meshes.set(can.id, Mesh("a.ply", b"file", b"no mesh"))
    code, out, err = run(object_list)
    _, box, row = out.splitlines()
    assert code == 1 and re.search(r"box  +box\.obj  \d+ x", box)
    assert row.split() == [can.id, "can", "damaged", "-", "-", "-", "-"]
    said = f"'can' {can.id[:8]}: it is no mesh: "
    assert err.startswith(f"object_list.py: {said}") and len(err.splitlines()) == 1
    page = tmp_path / "page.html"
    code, _, err = run(object_list, "--html", page)
    assert code == 1 and err.startswith(f"object_list.py: {said}")
    text = page.read_text()
    assert text.count("data:image/jpeg") == 1 and "<th>damaged</th><td>it is no mesh: " in text


def test_a_sheet_of_views(run, path, box, box_file, tmp_path):
    add(run, "box", box_file)
    add(run, "bare")
    for source in ("box", box_file):
        output = tmp_path / f"{pathlib.Path(str(source)).name}.png"
        assert run(mesh_view, source, "--output", output, "--side", 100)[0] == 0
        expected = rv.meshes.mesh_sheet(box, side=100)
        difference = cv2.absdiff(cv2.imread(str(output)), expected)
        assert difference.mean() < 1.0
    code, _, err = run(mesh_view, "bare", "--output", tmp_path / "bare.png")
    assert (code, err) == (1, "mesh_view.py: 'bare' has no mesh: mesh_add.py adds it\n")


def observe(path, name, depth):
    with Database(path, write=True) as database, database.transaction():
        one = database.objects.find(name)
        session = database.observations.add_session(Session(one.id, "turn"))
        images = [
            cv2.imencode(".png", image)[1].tobytes()
            for image in (np.full((4, 6, 3), 7, np.uint8), depth, np.full((4, 6), 255, np.uint8))
        ]
        database.observations.add(Observation(session.id, 5, *images, MATRIX, POSE))


@pytest.mark.parametrize(
    "text, count", [("x:2,y:2", 3), ("z:4,x:2", 7), ("x:4,y:4,z:4", 23), ("z:24,x:2", 47)]
)
def test_a_data_set_has_all_turns_that_look_the_same(text, count):
    middle = np.array([0.02, -0.03, 0.01])
    known = parse_symmetries(text)
    info = to_bop(known, middle)
    turns = [np.reshape(one, (4, 4)) for one in info["symmetries_discrete"]]
    assert len(turns) == count and "symmetries_continuous" not in info
    for one in turns:
        assert np.allclose(one[:3, :3] @ (1000.0 * middle) + one[:3, 3], 1000.0 * middle)
    again = turns_of(from_bop(info, middle, 0.1))
    assert len(again) == count + 1
    for one in turns:
        assert min(np.abs(one[:3, :3] - other).max() for other in again) < 1e-6


def test_symmetries_of_a_data_set_that_no_object_has():
    axes = [[0, 0, 1], [0, np.sin(0.1), np.cos(0.1)]]
    turns = [np.eye(4) for _ in axes]
    for one, axis in zip(turns, axes):
        one[:3, :3] = cv2.Rodrigues(np.array(axis) * 2.0 * np.pi / 3.0)[0]
    info = {"symmetries_discrete": [one.ravel().tolist() for one in turns]}
    with pytest.raises(ValueError, match="their axes do not belong to one object"):
        from_bop(info, np.zeros(3), 0.1)


def test_a_data_set_of_bop_and_back(run, path, box, box_file, tmp_path):
    add(run, "box", box_file, "--symmetry", "z,x:2")
    add(run, "bare")
    depth = np.arange(24, dtype=np.uint16).reshape(4, 6) * 100
    observe(path, "box", depth)
    folder = tmp_path / "bop"
    code, _, err = run(object_export, folder, "--bop")
    assert code == 0 and err.endswith(" bare\n") and "left out, as it has no mesh: " in err
    info = json.loads((folder / "models" / "models_info.json").read_text())["1"]
    extent = rv.mesh_extent(box)
    assert info["diameter"] == pytest.approx(1000.0 * extent.diameter, rel=1e-5)
    assert [info[f"size_{axis}"] for axis in "xyz"] == pytest.approx(
        [1000.0 * side for side in extent.size], rel=1e-5
    )
    assert len(info["symmetries_discrete"]) == 1 and len(info["symmetries_continuous"]) == 1
    for turn in info["symmetries_discrete"]:  # each takes the middle to itself
        middle = [*(1000.0 * value for value in extent.center), 1.0]
        assert np.allclose(np.reshape(turn, (4, 4)) @ middle, middle, atol=1e-3)
    scene = folder / "train_real" / "000001"
    (truth,) = json.loads((scene / "scene_gt.json").read_text())["0"]
    assert truth["cam_t_m2c"] == pytest.approx([100.0, -200.0, 700.0]) and truth["obj_id"] == 1
    loaded = rv.read_mesh(str(folder / "models" / "obj_000001.ply"), "mm").mesh
    assert same_shape(loaded, box) and tuple(loaded.color) == tuple(box.textures[0][0, 0])

    other = ["--database", tmp_path / "other.db", "--commit"]
    code, out, err = run(object_import, folder, "--split", "train_real", *other)
    assert (code, err) == (0, "") and out.endswith("1 object added\n")
    with Database(str(tmp_path / "other.db")) as database, Database(path) as before:
        (one,) = database.objects.all()
        assert one.id == before.objects.find("box").id and one.name == "box"
        mesh = database.meshes.of(one.id)
        (along, across) = mesh.symmetries
        assert along == Symmetry((0.0, 0.0, 1.0)) and across.fold == 2
        assert across.axis[2] == pytest.approx(0.0, abs=1e-6)
        (session,) = database.observations.sessions(one.id)
        (seen,) = database.observations.of(session.id)
    assert session.source == "train_real/000001"
    assert np.allclose(seen.pose, POSE) and np.allclose(seen.matrix, MATRIX)
    pixels = cv2.imdecode(np.frombuffer(seen.depth, np.uint8), cv2.IMREAD_UNCHANGED)
    assert np.array_equal(pixels, depth)
    code, out, _ = run(object_import, folder, *other)
    assert code == 0 and "is there already, and stays as it is" in out
    assert out.endswith("0 objects added\n")


def test_a_data_set_has_no_distortion(run, path, box_file, tmp_path):
    """As a camera without it would have seen what the camera of the observation has seen."""
    add(run, "box", box_file)
    width, height = 96, 64
    matrix = np.array([[80.0, 0.0, 47.5], [0.0, 80.0, 31.5], [0.0, 0.0, 1.0]])
    lens = np.array([0.3, 0.1, 0.0, 0.0])
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    image = np.dstack([2 * columns, 3 * rows, columns + rows]).astype(np.uint8)
    mask = np.where(np.hypot(columns - 60, rows - 30) < 20, 255, 0).astype(np.uint8)
    depth = np.full((height, width), 700, np.uint16)
    with Database(path, write=True) as database, database.transaction():
        session = database.observations.add_session(Session(database.objects.find("box").id))
        images = [cv2.imencode(".png", one)[1].tobytes() for one in (image, depth, mask)]
        new = Observation(session.id, 0, *images, matrix, POSE, lens)
        database.observations.add(new)
    assert run(object_export, tmp_path / "bop", "--bop")[0] == 0
    scene = tmp_path / "bop" / "train_real" / "000001"
    maps = cv2.initUndistortRectifyMap(matrix, lens, None, matrix, (width, height), cv2.CV_32FC1)
    inside = (maps[0] > 1) & (maps[0] < width - 2) & (maps[1] > 1) & (maps[1] < height - 2)
    assert inside.mean() > 0.5 and np.abs(maps[0] - columns).max() > 5
    straight = cv2.remap(image, *maps, cv2.INTER_LINEAR)
    found = cv2.imread(str(scene / "rgb" / "000000.png"))
    assert cv2.absdiff(found, straight)[inside].max() <= 2
    there = cv2.imread(str(scene / "mask_visib" / "000000_000000.png"), cv2.IMREAD_UNCHANGED)
    expected = cv2.remap(mask, *maps, cv2.INTER_LINEAR)
    assert (there[(expected > 160) & inside] == 255).all() and there.ndim == 2
    assert (there[(expected < 96) & inside] == 0).all()
    depths = cv2.imread(str(scene / "depth" / "000000.png"), cv2.IMREAD_UNCHANGED)
    assert depths.dtype == np.uint16 and (depths[inside] == 700).mean() > 0.95
    camera = json.loads((scene / "scene_camera.json").read_text())["0"]
    assert np.allclose(camera["cam_K"], matrix.ravel())


def test_a_data_set_of_others(run, path, box, tmp_path):
    """Depths in tenths of mm, an axis that passes the middle, and no names."""
    folder = tmp_path / "lm"
    (folder / "models").mkdir(parents=True)
    write_mesh(str(folder / "models" / "obj_000005.ply"), scaled(box, 1000.0))
    far = {"symmetries_continuous": [{"axis": [0, 0, 1], "offset": [500, 0, 0]}]}
    (folder / "models" / "models_info.json").write_text(json.dumps({"5": far}))
    scene = folder / "test" / "000002"
    for kind in ("rgb", "depth", "mask_visib"):
        (scene / kind).mkdir(parents=True)
    cv2.imwrite(str(scene / "rgb" / "000003.jpg"), np.zeros((4, 6, 3), np.uint8))
    cv2.imwrite(str(scene / "depth" / "000003.png"), np.full((4, 6), 7000, np.uint16))
    cv2.imwrite(str(scene / "mask_visib" / "000003_000001.png"), np.zeros((4, 6), np.uint8))
    pose = {"cam_R_m2c": np.eye(3).ravel().tolist(), "cam_t_m2c": [0.0, 0.0, 700.0]}
    truth = [{**pose, "obj_id": 9}, {**pose, "obj_id": 5}]
    (scene / "scene_gt.json").write_text(json.dumps({"3": truth}))
    camera = {"cam_K": MATRIX.ravel().tolist(), "depth_scale": 0.1}
    (scene / "scene_camera.json").write_text(json.dumps({"3": camera}))
    code, out, err = run(object_import, folder, "--split", "test", "--commit")
    assert (code, err) == (0, "") and "added: 'obj_000005'" in out
    assert "object 5 has no symmetries here: an axis of symmetry is 500.0 mm from the mid" in out
    with Database(path) as database:
        one = database.objects.find("obj_000005")
        (session,) = database.observations.sessions(one.id)
        (seen,) = database.observations.of(session.id)
    depth = cv2.imdecode(np.frombuffer(seen.depth, np.uint8), cv2.IMREAD_UNCHANGED)
    assert seen.frame_number == 3 and (depth == 700).all()
    code, out, _ = run(object_import, folder, "--split", "test", "--commit")
    assert code == 0 and out.startswith(
        f"{one.id} is there already, and stays as it is, its observations are left out\n"
    )
    assert out.endswith("0 objects added\n")
    code, out, _ = run(object_import, folder, "--replace", "--commit")
    assert code == 0 and out.endswith("1 object added\n")
    with Database(path) as database:
        assert [known.id for known in database.objects.all()] == [one.id]
        assert database.observations.sessions(one.id) == []
    (folder / "models").rename(folder / "models_cad")
    code, out, _ = run(object_import, folder, "--models", "models_cad", "--commit")
    assert code == 0 and out.startswith(f"{one.id} is there already")
    (folder / "models_cad").rename(folder / "models")
    (scene / "scene_camera.json").write_text("{}")
    words = [folder, "--split", "test", "--database", tmp_path / "x.db", "--commit"]
    code, _, err = run(object_import, *words)
    assert code == 1 and "frame 3: scene_camera.json has no camera of it" in err
    with Database(str(tmp_path / "x.db")) as database:
        assert database.objects.all() == []


def test_a_split_that_is_not_there_is_told_before_anything_is_added(
    run, path, box, box_file, tmp_path
):
    folder = tmp_path / "lm"
    (folder / "models").mkdir(parents=True)
    write_mesh(str(folder / "models" / "obj_000005.ply"), scaled(box, 1000.0))
    (folder / "train" / "000001").mkdir(parents=True)
    for split in ("trian", "train", "models"):
        code, out, err = run(object_import, folder, "--split", split, "--commit")
        said = f"{folder / split} has no scenes, which have a scene_gt.json each"
        assert (code, out, err) == (1, "", f"object_import.py: {said}\n")
    add(run, "box", box_file)
    assert run(object_export, tmp_path / "ours")[0] == 0
    file = tmp_path / "couch.json"
    file.write_text(json.dumps(couch(box_file)))
    for source in (tmp_path / "ours", file):
        code, _, err = run(object_import, source, "--split", "train", "--replace", "--commit")
        assert code == 1 and f"--split is of BOP data sets, {source} is none: no models" in err
    for source in (folder, file):
        code, _, err = run(object_import, source, "--models", "models_cda", "--commit")
        assert code == 1 and f"--models is of BOP data sets, {source} is none: no models_cda" in err
    with Database(path) as database:
        assert [one.name for one in database.objects.all()] == ["box"]


def couch(box_file, **changes):
    """What _all_docs of a CouchDB of object_recognition_core gives."""
    data = base64.b64encode(box_file.read_bytes()).decode()
    thing = {
        "_id": "4680aac58c1d263b9449d57bd2000f27",
        "Type": "Object",
        "object_name": "coke ",
        "description": "A universal can of coke",
        "tags": ["can"],
        "author_name": "Ada",
        "author_email": "",
        "added": "2014-05-01T10:00:00Z",
    }
    model = {
        "_id": "f" * 32,
        "Type": "Model",
        "method": "mesh",
        "object_id": thing["_id"],
        "_attachments": {
            "mesh.stl": {"data": "AAAA"},
            "original.obj": {"data": data},
        },
    }
    learned = {"_id": "e" * 32, "Type": "Model", "method": "LINEMOD", "object_id": thing["_id"]}
    documents = [{"_id": "_design/objects"}, {**thing, **changes}, model, learned]
    return {"total_rows": 4, "rows": [{"id": one["_id"], "doc": one} for one in documents]}


def test_the_documents_of_a_couchdb(run, path, box, box_file, tmp_path):
    file = tmp_path / "couch.json"
    file.write_text(json.dumps(couch(box_file)))
    code, out, err = run(object_import, file, "--commit")
    assert (code, err) == (0, "") and out.endswith("1 object added\n")
    with Database(path) as database:
        one = database.objects.find("4680")
        assert one == Object(
            "coke",
            "A universal can of coke",
            ["can"],
            "Ada",
            "",
            "4680aac58c1d263b9449d57bd2000f27",
            "2014-05-01T10:00:00Z",
        )
    mesh, drawn = stored(path, "coke")
    assert mesh.file_name == "original.obj" and same_shape(drawn, box)


def test_the_documents_of_a_couchdb_may_be_large(run, path, tmp_path):
    """Of 65 MB, above what any of our own JSON files has: what was learned is in it, too."""
    row = {"id": "e" * 32, "doc": {"_id": "e" * 32, "method": "LINEMOD", "data": "A" * (65 << 20)}}
    file = tmp_path / "couch.json"
    file.write_text(json.dumps({"rows": [row]}))
    assert run(object_import, file, "--commit")[:2] == (0, "0 objects added\n")
    with open(file, "ab") as more:
        more.truncate((1 << 30) + 1)  # of zeros that take no place
    code, _, err = run(object_import, file, "--commit")
    assert code == 1 and f"{file} cannot be read: it has 1024 MB, must have at most 1024" in err


@pytest.mark.parametrize(
    "spoil, said",
    [
        (lambda values: values.pop("rows"), "rows is None, must be a list, as _all_docs"),
        (lambda values: [row.pop("doc") for row in values["rows"]], "is include_docs=true missing"),
        (
            lambda values: values["rows"][2]["doc"]["_attachments"]["original.obj"].pop("data"),
            "the meshes have no data: is attachments=true missing?",
        ),
    ],
)
def test_documents_with_something_wrong(run, path, box_file, tmp_path, spoil, said):
    values = couch(box_file)
    spoil(values)
    file = tmp_path / "couch.json"
    file.write_text(json.dumps(values))
    code, _, err = run(object_import, file, "--commit")
    assert code == 1 and said in err and len(err.splitlines()) == 1
    with Database(path) as database:
        assert database.objects.all() == []


@pytest.mark.parametrize(
    "object_id, name, data, said",
    [
        ("x", "mug", None, "object x is left out: its id must have 32 hexadecimal digits"),
        ("b" * 32, "", None, f"object {'b' * 32} is left out: the name of an object is ''"),
        ("b" * 32, "mug", None, "can add another one: its data is None, must be text"),
        ("b" * 32, "mug", "?", "can add another one: its data cannot be read: "),
        ("b" * 32, "mug", "AAAA", "can add another one: original.stl"),
    ],
)
def test_documents_that_cannot_be_taken_leave_the_others(
    run, path, box_file, tmp_path, object_id, name, data, said
):
    values = couch(box_file)
    attached = {"original.stl": {} if data is None else {"data": data}}
    other = {"_id": object_id, "Type": "Object", "object_name": name}
    model = {"_id": "c" * 32, "method": "mesh", "object_id": object_id, "_attachments": attached}
    values["rows"][:0] = [{"doc": other}, {"doc": model}]
    file = tmp_path / "couch.json"
    file.write_text(json.dumps(values))
    code, _, err = run(object_import, file, "--commit")
    first, last = err.splitlines()
    assert code == 1 and said in first and last.endswith(f"not all of {file} can be taken")
    with Database(path) as database:
        meshes = {one.name: database.meshes.entry(one.id) for one in database.objects.all()}
    assert meshes.pop("coke").file_name == "original.obj"
    assert meshes == ({} if "object" in said else {"mug": None})


def test_what_cannot_be_taken_replaces_nothing(run, path, box_file, tmp_path):
    file = tmp_path / "couch.json"
    for name, code in (("coke", 0), ("", 1)):
        file.write_text(json.dumps(couch(box_file, object_name=name)))
        assert run(object_import, file, "--replace", "--commit")[0] == code
    values = couch(box_file, object_name="other")
    (attached,) = (
        row["doc"]["_attachments"] for row in values["rows"] if "_attachments" in row["doc"]
    )
    for content in attached.values():
        content["data"] = "AAAA"
    file.write_text(json.dumps(values))
    code, _, err = run(object_import, file, "--replace", "--commit")
    assert code == 1 and "is left out, the object stays as it is: original.obj" in err
    with Database(path) as database:
        (one,) = database.objects.all()
        assert one.name == "coke" and database.meshes.entry(one.id) is not None


def test_a_folder_is_tried_before_it_is_imported(run, path, box_file, tmp_path):
    add(run, "box", box_file)
    folder = tmp_path / "folder"
    assert run(object_export, folder)[0] == 0
    other = ["--database", tmp_path / "other.db"]
    code, _, err = run(object_import, folder, *other)
    assert code == 1 and "yet: --commit makes it" in err
    assert run(object_add, "-n", "first", "--commit", *other)[0] == 0
    code, out, _ = run(object_import, folder, *other)
    assert code == 0 and "would add 1 object\n" in out
    with Database(str(tmp_path / "other.db")) as database:
        assert [one.name for one in database.objects.all()] == ["first"]
    assert run(object_import, folder, *other, "--commit")[0] == 0
    with Database(str(tmp_path / "other.db")) as database, Database(path) as before:
        one = database.objects.find("box")
        assert database.meshes.of(one.id) == before.meshes.of(one.id)
