"""Commands that Ctrl-C ends in the middle: nothing half, and no traceback."""

import os
import sys

import pytest

from robot_vision.commands import INTERRUPTED, run_command
from robot_vision.markers import command as create_marker
from robot_vision.nodes import pick_color

OURS = os.path.dirname(create_marker.__file__).rpartition("/")[0]


def interrupted_at(main, words, call):
    """The exit code and the output of a command that is interrupted at one of our calls.

    Before and after run_command() a signal ends it by the system's own means.
    """
    reader, writer = os.pipe()
    pid = os.fork()
    if pid == 0:
        os.dup2(writer, 1)
        os.dup2(writer, 2)
        sys.stdout, sys.stderr = (os.fdopen(number, "w") for number in (1, 2))
        sys.argv = ["command", *words]
        calls = None  # until the work begins

        def count(frame, event, _):
            nonlocal calls
            if frame.f_code is run_command.__code__ and event in ("call", "return"):
                calls = 0 if event == "call" else None
            elif calls is not None and event == "call" and _is_ours(frame):
                calls += 1
                if calls == call:
                    sys.setprofile(None)
                    raise KeyboardInterrupt

        code = 99
        try:
            sys.setprofile(count)
            code = main()
        finally:
            sys.setprofile(None)
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
    os.close(writer)
    with os.fdopen(reader) as stream:
        output = stream.read()
    return os.WEXITSTATUS(os.waitpid(pid, 0)[1]), output


def _is_ours(frame):
    return frame.f_code.co_filename.startswith(OURS)


@pytest.mark.parametrize("name", ["create_marker", "pick_color"])
def test_interrupted_at_any_call(tmp_path, name):
    path = tmp_path / ("a.png" if name == "create_marker" else "a.yaml")
    main, words = {
        "create_marker": (create_marker.main, ["--output", str(path), "1"]),
        "pick_color": (
            pick_color.main,
            ["--hex", "#1e90ff", "--save", str(path), "--name", "a"],
        ),
    }[name]
    code, output = interrupted_at(main, words, 10**9)
    assert code == 0, output
    whole = path.read_bytes()
    path.unlink()
    call, codes = 0, []
    while not codes or codes[-1]:
        call += 1 if call < 20 else 7
        code, output = interrupted_at(main, words, call)
        assert code in (0, INTERRUPTED) and "Traceback" not in output, (call, output)
        codes.append(code)
        assert os.listdir(tmp_path) in ([], [path.name])
        if path.exists():
            assert path.read_bytes() == whole
            path.unlink()
    assert len(codes) > 10
