"""The two commands' promises: a clean environment, and a clear word on an unknown system."""

import os
import pathlib
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def run(*command, **environment):
    return subprocess.run(
        list(map(str, command)),
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )


def test_nothing_of_the_caller_s_workspace_gets_in(tmp_path):
    fake = tmp_path / "python3"
    fake.write_text("#!/bin/sh\necho a fake python3\n")
    fake.chmod(0o755)
    (tmp_path / "cv2.py").write_text("raise ImportError('a fake cv2')\n")
    result = run(
        "tools/env",
        "python3",
        "-c",
        "import cv2, os, sys; print(sys.executable); print(*os.environ)",
        PATH=f"{tmp_path}:{os.environ['PATH']}",
        PYTHONPATH=str(tmp_path),
        ROS_MASTER_URI="http://elsewhere:11311",
        ROS_PACKAGE_PATH=str(tmp_path),
        CMAKE_PREFIX_PATH=str(tmp_path),
        LD_LIBRARY_PATH=str(tmp_path),
    )
    assert result.returncode == 0, result.stderr
    executable, names = result.stdout.splitlines()
    assert executable == "/usr/bin/python3"
    unwanted = {"PYTHONPATH", "ROS_MASTER_URI", "CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH"}
    if not os.path.exists("/opt/ros/noetic"):  # which sets its own
        assert not unwanted & set(names.split())


def mount_namespaces_can_be_made():
    """By root, and in a chroot only if its root folder is a mount point."""
    return shutil.which("unshare") and run("unshare", "-m", "true").returncode == 0


@pytest.mark.skipif(not mount_namespaces_can_be_made(), reason="needs a mount namespace")
@pytest.mark.parametrize(
    "os_release, said",
    [
        (
            'ID=fedora\nVERSION_ID=40\nPRETTY_NAME="Fedora Linux 40"\n',
            "Fedora Linux 40 is not known",
        ),
        (
            'ID=ubuntu\nVERSION_ID="22.04"\nPRETTY_NAME="Ubuntu 22.04"\n',
            "Ubuntu 22.04 is not known",
        ),
        ("", "this system is not known"),
    ],
)
def test_an_unknown_system_is_told_in_one_sentence(tmp_path, os_release, said):
    fake = tmp_path / "os-release"
    fake.write_text(os_release)
    script = 'mount --bind "$1" /etc/os-release || exit 99; exec tools/deps run'
    result = run("unshare", "-m", "sh", "-c", script, "sh", fake)
    if result.returncode == 99:
        pytest.skip("mounts are not allowed here: " + result.stderr)
    assert result.returncode == 2
    assert result.stdout == ""
    assert said in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1


def test_warnings_are_errors_where_they_are_asked_for_only(tmp_path):
    source, product = tmp_path / "a.cpp", tmp_path / "a.o"
    note = tmp_path / "a.o.warned"
    compile_it = ["tools/compile", "g++", "-Wall", "-Wpedantic", "-o", product, "-c", source]
    source.write_text("int f() {}\n")
    result = run(*compile_it)
    assert result.returncode == 0 and product.exists()
    assert "-Wreturn-type" in result.stderr and note.read_text() == result.stderr
    product.unlink()
    result = run(*compile_it, WARNINGS="errors")
    assert result.returncode != 0 and not product.exists()
    assert "-Werror=return-type" in result.stderr
    source.write_text("int f() { return 0; }\n")
    for warnings in ("", "errors"):
        result = run(*compile_it, WARNINGS=warnings)
        assert (result.returncode, result.stderr) == (0, "")
        assert product.exists() and not note.exists()
        product.unlink()


def test_what_is_not_built_yet_can_be_linted(tmp_path):
    checkout = tmp_path / "robot_vision"
    built = shutil.ignore_patterns(".git", ".ws", "build", "transport_plugins.xml", "__pycache__")
    shutil.copytree(str(ROOT), str(checkout), ignore=built)
    (checkout / ".ws").mkdir()
    result = run(checkout / "tools" / "env", checkout / "tools" / "lint", "catkin-lint")
    assert result.stdout + result.stderr == ""
    assert result.returncode == 0


def test_help_names_every_command():
    result = run("make", "help")
    for command in ("demo", "test", "build", "lint", "bench", "install", "deps", "clean"):
        assert f"make {command}" in result.stdout
