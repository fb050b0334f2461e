"""sample_mesh.py: the meshes of the demo's table in files."""

from robot_vision.recognition.sample_mesh import main


def test_the_command_writes_samples(tmp_path, monkeypatch, capsys):
    path = tmp_path / "nut.stl"
    monkeypatch.setattr("sys.argv", ["sample_mesh.py", "nut", str(path)])
    assert main() == 0
    assert capsys.readouterr().out == f"{path}: 0.060 x 0.052 x 0.022 m, 72 triangles\n"
    before = path.read_bytes()
    assert main() == 1
    assert capsys.readouterr().err == (
        f"sample_mesh.py: {path} is there already; --force replaces it\n"
    )
    assert path.read_bytes() == before
    monkeypatch.setattr("sys.argv", ["sample_mesh.py", "can", str(path), "--force"])
    assert main() == 0 and path.read_bytes() != before
