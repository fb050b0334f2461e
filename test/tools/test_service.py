"""config/robot_vision@.service, which starts the nodes with the machine."""

import pathlib
import shlex
import shutil
import subprocess

import pytest

SERVICE = pathlib.Path(__file__).resolve().parents[2] / "config" / "robot_vision@.service"


def settings(name):
    """The values of a setting, as systemd reads them."""
    lines = SERVICE.read_text().splitlines()
    return [line.partition("=")[2] for line in lines if line.startswith(name + "=")]


@pytest.mark.skipif(not shutil.which("systemd-analyze"), reason="needs systemd-analyze")
def test_systemd_finds_no_fault_with_it():
    result = subprocess.run(
        ["systemd-analyze", "verify", str(SERVICE)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
        text=True,
    )
    assert (result.returncode, result.stdout) == (0, "")


@pytest.mark.parametrize(
    "given, started",
    [
        ({}, "robot_vision camera.launch"),
        ({"LAUNCH": "my_robot eyes.launch rate:=15"}, "my_robot eyes.launch rate:=15"),
        ({"PREFIX": "env IN=prefix"}, "prefix robot_vision camera.launch"),
    ],
)
def test_it_sources_the_setup_and_runs_roslaunch(tmp_path, given, started):
    roslaunch = tmp_path / "roslaunch"
    roslaunch.write_text('#!/bin/sh\necho ${IN:+"$IN"} "$@"\n')
    roslaunch.chmod(0o755)
    (tmp_path / "setup.bash").write_text(f'PATH="{tmp_path}:$PATH"\n')
    environment = dict(shlex.split(value)[0].split("=", 1) for value in settings("Environment"))
    assert environment["SETUP"] == "/opt/robot_vision/setup.bash"  # of make install
    environment.update(SETUP=str(tmp_path / "setup.bash"), PATH="/usr/bin:/bin", **given)
    (command,) = settings("ExecStart")
    result = subprocess.run(
        shlex.split(command.replace("$$", "$")),
        env=environment,
        stdout=subprocess.PIPE,
        check=True,
        text=True,
    )
    assert result.stdout == started + "\n"
