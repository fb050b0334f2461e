"""The two commands' promises: a clean environment, and a clear word on an unknown system."""

import contextlib
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import time
from importlib.machinery import SourceFileLoader

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


@pytest.mark.skipif(not shutil.which("ccache"), reason="needs ccache")
def test_a_precompiled_header_that_is_made_anew_is_in_the_cache(tmp_path):
    """As it is whenever a file is added; else nothing that reads it is in the cache either."""
    header, product = tmp_path / "a.hxx", tmp_path / "a.hxx.gch"
    header.write_text("inline int f() { return 1; }\n")
    source = tmp_path / "a.hxx.cxx"
    source.write_text("")
    make = ["tools/compile", "g++", "-x", "c++-header", "-include", header, "-o", product]
    cache = {"CCACHE_DIR": str(tmp_path / "cache")}
    made = []
    for _ in range(2):
        result = run(*make, "-c", source, **cache)
        assert result.returncode == 0, result.stderr
        made.append(product.read_bytes())
    assert made[0] == made[1]
    counts = dict(
        line.split("\t") for line in run("ccache", "--print-stats", **cache).stdout.splitlines()
    )
    assert counts["direct_cache_hit"] == "1"


def test_what_is_not_built_yet_can_be_linted(tmp_path):
    checkout = tmp_path / "robot_vision"
    built = shutil.ignore_patterns(".git", ".ws", "build", "transport_plugins.xml", "__pycache__")
    shutil.copytree(str(ROOT), str(checkout), ignore=built)
    (checkout / ".ws").mkdir()
    result = run(checkout / "tools" / "env", checkout / "tools" / "lint", "catkin-lint")
    assert result.stdout + result.stderr == ""
    assert result.returncode == 0


def junit(path, *cases):
    """A result file, of (name, seconds, what is in it)."""
    cases = "".join(
        f'<testcase classname="c" name="{name}" time="{seconds}">{inner}</testcase>'
        for name, seconds, inner in cases
    )
    path.write_text(f"<testsuites><testsuite>{cases}</testsuite></testsuites>")


def summary(tmp_path, checks="", stages="", failed_programs=""):
    """The exit code of tools/test_summary, and its lines."""
    files = {"checks": checks, "stages": stages, "failed": failed_programs}
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "results").mkdir(exist_ok=True)
    paths = (tmp_path / name for name in ("checks", "stages", "results", "failed"))
    result = run("tools/test_summary", *paths)
    assert result.stderr == ""
    return result.returncode, result.stdout.splitlines()


def test_the_summary_of_what_has_passed(tmp_path):
    (tmp_path / "results").mkdir()
    junit(tmp_path / "results" / "pytest-a.xml", ("quick", 0.2, ""), ("slow", 7.5, ""))
    checks = "passed 3.000000 lint a\nskipped 0.000000 leaks\n"
    stages = "1.500 2.000 1.000 build\nline 38: 19903 Killed\n10.000 0.500 0.250 nodes and more\n"
    assert summary(tmp_path, checks, stages) == (
        0,
        [
            "The slowest tests:",
            "     7.5 s  pytest-a: c.slow",
            "     3.0 s  lint a",
            "     0.2 s  pytest-a: c.quick",
            "     0.0 s  leaks",
            "The stages, some of which run at the same time:",
            "     1.5 s  build, 3 s of a core",
            "line 38: 19903 Killed",
            "    10.0 s  nodes and more, 1 s of a core",
            "SKIPPED leaks",
            "          see above",
            "3 passed, 0 failed, 1 skipped",
        ],
    )


def test_the_summary_names_each_failure(tmp_path):
    results = tmp_path / "results"
    results.mkdir()
    lines = "&#10;".join(f"line {number}" for number in range(9))
    junit(
        results / "pytest-a.xml",
        ("fails", 1, f'<failure message="{lines}"/>'),
        ("breaks", 1, "<error>in a text</error>"),
        ("left out", 1, '<skipped message="no display"/>'),
    )
    junit(results / "rostest-b.xml", ("has left results", 1, ""))  # which are in another file
    (results / "gtest-c.xml").write_text("<testsuite><testcase name=")
    code, printed = summary(
        tmp_path,
        checks="failed 2.000000 lint ruff\n",
        failed_programs="3:_ctest_robot_vision_pytest_a\n14:_ctest_robot_vision_gtest_d\n",
    )
    assert code == 1
    assert printed[printed.index("SKIPPED pytest-a: c.left out") + 1] == " " * 10 + "no display"
    at = printed.index("FAILED  lint ruff")
    assert printed[at:] == [
        "FAILED  lint ruff",
        "          see above",
        "FAILED  gtest-c.xml",
        printed[at + 3],  # as the parser says it
        "FAILED  pytest-a: c.fails",
        *(f"          line {number}" for number in range(5)),
        "FAILED  pytest-a: c.breaks",
        "          in a text",
        "FAILED  gtest_d",
        "          failed after its last test, or was ended as it hung",
        "0 passed, 5 failed, 1 skipped",
    ]
    assert printed[at + 3].startswith("          is no result file: ")


def test_the_summary_of_nothing_is_a_failure(tmp_path):
    code, printed = summary(tmp_path, checks="passed 3.000000 lint a\n")
    assert code == 1
    assert printed[-3:] == ["FAILED  tests", "          none has run", "1 passed, 1 failed"]


@pytest.mark.parametrize(
    "command, code, said",
    [
        (["sh", "-c", "echo out; echo err >&2; exit 3"], 3, "err\n"),
        (["sh", "-c", "echo out; kill -9 $$"], 137, "Killed"),
    ],
)
def test_the_times_of_the_stages_are_nothing_else(tmp_path, command, code, said):
    """What bash says of a program that was killed is where it always is."""
    script = '. tools/check.sh; stage "a stage" "$@"'
    times = tmp_path / "times"
    result = run("bash", "-c", script, "bash", *command, STAGE_TIMES=str(times), LC_ALL="C")
    assert result.returncode == code and result.stdout == "out\n"
    assert said in result.stderr
    assert re.fullmatch(r"(\d+\.\d{3} ){3}a stage\n", times.read_text())


@pytest.fixture
def checkout(tmp_path):
    """One with tools/test, where all is built, and ctest has no test of a name."""
    for folder in ("tools", "test/room", "build", ".ws/devel", "bin"):
        (tmp_path / folder).mkdir(parents=True)
    for name in ("tools/test", "tools/check.sh", "tools/test_summary", "tools/env"):
        shutil.copy(str(ROOT / name), str(tmp_path / name))
    shutil.copy(str(ROOT / "test/pytest.ini"), str(tmp_path / "test"))
    (tmp_path / ".ws/devel/setup.bash").touch()
    for program in ("tools/build", "bin/ctest"):
        (tmp_path / program).write_text("#!/bin/sh\n")
        (tmp_path / program).chmod(0o755)
    return tmp_path


def test_a_word_may_be_a_file_that_ctest_does_not_know(checkout):
    path = f"{checkout}/bin:{os.environ['PATH']}"
    test = checkout / "test/room/test_word.py"
    test.write_text("def test_it():\n    pass\n")
    test.with_name("test_others.py").write_text("broken")
    result = run(checkout / "tools/test", "word", PATH=path)
    assert result.returncode == 0, result.stderr
    assert "pytest-python_word: room.test_word.test_it\n" in result.stdout
    assert result.stdout.endswith("\n1 passed, 0 failed\n")

    test.write_text("def test_it():\n    assert False, 'as it is'\n")
    result = run(checkout / "tools/test", "word", PATH=path)
    assert result.returncode == 1
    assert result.stdout.endswith("assert False\n0 passed, 1 failed\n"), result.stdout

    test.write_text("import atexit, os\natexit.register(os._exit, 3)\ndef test_it():\n    pass\n")
    result = run(checkout / "tools/test", "word", PATH=path)
    assert result.returncode == 1
    assert "FAILED  pytest_python_word\n" in result.stdout
    assert result.stdout.endswith("\n1 passed, 1 failed\n")

    test.write_text("def test_it():\n    pass\n")
    test.with_name("test_word_node.py").write_text("def test_node():\n    pass\n")
    result = run(checkout / "tools/test", "word", PATH=path)
    assert "pytest-nodes_word: room.test_word_node.test_node\n" in result.stdout
    assert result.stdout.endswith("\n2 passed, 0 failed\n")

    result = run(checkout / "tools/test", "wort", PATH=path)
    assert result.returncode == 2
    assert "no test has 'wort' in its name" in result.stderr


LISTED = """7: Test command: pytest {root}/test/room/test_word_node.py
  Test #7: _ctest_robot_vision_pytest_nodes_word
"""


def test_a_word_is_also_one_of_files_that_share_a_program(checkout):
    """What ctest has by that name is run by it, and the rest of what has it in other programs."""
    ctest = checkout / "bin/ctest"
    listed = LISTED.format(root=checkout)
    answer = f'case $* in *-N*) echo \'{listed}\';; *) echo ran "$@" of "$GTEST_FILTER";; esac'
    ctest.write_text(f"#!/bin/sh\n{answer}\n")
    (checkout / "test/room/kernels").mkdir()
    for name, text in (
        ("test_word_node.py", "broken"),
        ("test_word.py", "def test_it():\n    pass\n"),
        ("test_words.cpp", "TEST(Words, areRead)\nTEST_F(Letters, areRead)\n"),
        ("test_words_node.cpp", "TEST(Node, runs)\n"),
        ("kernels/test_word.cpp", "TEST_P(Kernel, isExact)\n"),
    ):
        (checkout / "test/room" / name).write_text(text)
    result = run(checkout / "tools/test", "word", PATH=f"{checkout}/bin:{os.environ['PATH']}")
    assert result.returncode == 0, result.stderr
    ran = [line.partition("1800 ")[2] for line in result.stdout.splitlines() if "ran" in line]
    filters = "*Kernel.*:*Kernel/*:*Letters.*:*Letters/*:*Words.*:*Words/*"
    assert ran == ["-R word of ", f"-R gtest_(kernels|test_core) of {filters}"]
    assert result.stdout.endswith("\n1 passed, 0 failed\n")


IN_FOREGROUND = """
import sys
from importlib.machinery import SourceFileLoader
demo = SourceFileLoader("demo", sys.argv[1]).load_module()
sys.exit(demo.run_in_foreground(["sh", "-c", "echo begun; exec sleep 600"]))
"""


def test_the_demo_cannot_be_stopped_in_a_way_that_locks_the_terminal():
    """Ctrl-Z does nothing, and Ctrl-C ends it all the same."""
    process, terminal = pty.fork()
    if process == 0:
        os.execl(sys.executable, "python3", "-c", IN_FOREGROUND, str(ROOT / "tools/demo"))
    command, said = process, bytearray()

    def has_begun():
        if select.select([terminal], [], [], 0.0)[0]:
            said.extend(os.read(terminal, 1000))
        return b"begun" in said

    try:
        wait_until(has_begun)
        wait_until(lambda: os.tcgetpgrp(terminal) not in (0, process))
        command = os.tcgetpgrp(terminal)
        os.write(terminal, b"\x1a\x03")
        wait_until(lambda: os.waitid(os.P_PID, process, os.WEXITED | os.WNOHANG | os.WNOWAIT))
        assert os.waitpid(process, 0) == (process, 0)
    except AssertionError:
        for group in {command, process}:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(group, signal.SIGKILL)
        raise
    finally:
        os.close(terminal)


def wait_until(condition):
    deadline = time.monotonic() + 60.0
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_help_names_every_command():
    printed = run("make", "help").stdout
    targets = re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert {"help", "demo", "test", "fuzz"} < set(targets)
    for target in targets:
        assert f"make {target} " in printed or target == "help"


def test_the_demo_s_source_is_a_path_from_here_or_a_camera_s_name(tmp_path, monkeypatch):
    absolute = SourceFileLoader("demo", str(ROOT / "tools/demo")).load_module().absolute
    monkeypatch.chdir(tmp_path)
    (tmp_path / "some.mp4").touch()
    (tmp_path / "synthetic").mkdir()
    paths = ("some.mp4", "*.mp4", "../x.png", "frames/*.png", "~/usb disk/a.mp4", "a b/../c.png")
    for name in paths:
        path = os.path.abspath(os.path.expanduser(name))
        assert absolute(f"source:={name}") == f"source:={path}"
    for name in ("freenect:0", "c920", "usb-0000:00:14.0-1", "synthetic", "rtsp://host/a", ""):
        assert absolute(f"source:={name}") == f"source:={name}"
    assert absolute("other:=some.mp4") == "other:=some.mp4"
