"""python_nodelet.py says what is wrong with its arguments, before it asks anybody."""

import pathlib
import subprocess
import sys

import pytest

PROGRAM = pathlib.Path(__file__).parents[2] / "scripts" / "python_nodelet.py"


def run(*words):
    return subprocess.run(
        [sys.executable, "-X", "importtime", str(PROGRAM), *words],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


@pytest.mark.parametrize(
    "words, says",
    [
        ([], "the command is missing, must be one of load, unload, standalone, list"),
        (["start"], "the command is 'start'"),
        (["x" * 100000], "the command is 'xxxx"),
        (["load"], "load has 0 words, needs TYPE MANAGER"),
        (["load", "hsv_tracker"], "load has 1 words, needs TYPE MANAGER"),
        (["load", "hsv_tracker", "a", "b"], "load has 3 words"),
        (["load", "hsv tracker", "a"], "TYPE is 'hsv tracker', must be hsv_tracker or package/"),
        (["load", "../hsv", "a"], "TYPE is '../hsv'"),
        (["load", "a/b/c", "a"], "TYPE is 'a/b/c'"),
        (["load", "hsv_tracker", ""], "MANAGER is '', must be a name of a node"),
        (["load", "hsv_tracker", "a b"], "MANAGER is 'a b'"),
        (["load", "hsv_tracker", "m" * 300], "MANAGER is 'mmm"),
        (["unload", "hsv"], "unload has 1 words, needs NAME MANAGER"),
        (["unload", "1", "a"], "NAME is '1'"),
        (["unload", "hsv", "a", "--no-bond"], "unload has 3 words"),
        (["standalone"], "standalone has 0 words, needs TYPE"),
        (["list"], "list has 0 words, needs MANAGER"),
    ],
)
def test_wrong_arguments(words, says):
    done = run(*words)
    assert done.returncode == 2
    line = done.stderr.splitlines()[-1]
    assert line.startswith("python_nodelet.py: ") and says in line and len(line) < 300
    assert done.stdout == ""


@pytest.mark.parametrize("option", ["-h", "--help"])
def test_help(option):
    done = run(option)
    assert done.returncode == 0
    assert all(word in done.stdout for word in ("load TYPE", "unload", "standalone", "list"))


def test_it_becomes_another_program_before_it_imports_what_takes_time(tmp_path):
    program = tmp_path / "lib" / "nodelet" / "nodelet"
    program.parent.mkdir(parents=True)
    program.write_text('#!/bin/sh\nprintf "<%s>" "$@"\n')
    program.chmod(0o755)
    words = ["load", "hsv_tracker", "vision", "--no-bond", "__name:=a", "image:=/b c"]
    done = subprocess.run(
        [sys.executable, "-X", "importtime", str(PROGRAM), *words],
        env={"CMAKE_PREFIX_PATH": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    expected = ["load", "robot_vision/hsv_tracker", *words[2:]]
    assert done.stdout == "".join(f"<{word}>" for word in expected)
    imported = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert "re" in imported
    assert not {"rospy", "numpy", "robot_vision", "rosgraph"} & imported
