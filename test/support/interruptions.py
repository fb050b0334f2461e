"""Shared by tests of commands that Ctrl-C interrupts: at any call of our functions."""

import os
import sys
from typing import Any, Callable, List, Sequence, Tuple

import cv2

from robot_vision.common.commands import run_command

OURS = os.path.dirname(run_command.__code__.co_filename).rpartition("/")[0]
ALL = 10**9  # more calls than a command makes


def interrupted_at(main: Callable[[], int], words: Sequence[str], call: int) -> Tuple[int, str]:
    """The exit code and the output of a command that is interrupted at a call of our functions.

    Only calls within run_command() count; outside of it a signal just ends the process. The last
    line of the output is the number of calls.
    """
    reader, writer = os.pipe()
    pid = os.fork()
    if pid == 0:
        os.dup2(writer, 1)
        os.dup2(writer, 2)
        sys.stdout, sys.stderr = (os.fdopen(number, "w") for number in (1, 2))
        sys.argv = ["command", *words]
        cv2.setNumThreads(0)  # a fork does not have the threads of its parent
        calls, working = 0, False

        def count(frame, event, _):
            nonlocal calls, working
            if frame.f_code is run_command.__code__ and event in ("call", "return"):
                working = event == "call"
            elif working and event == "call" and _is_ours(frame):
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
            print(calls)
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
    os.close(writer)
    with os.fdopen(reader) as stream:
        output = stream.read()
    return os.WEXITSTATUS(os.waitpid(pid, 0)[1]), output


def _is_ours(frame: Any) -> bool:
    return frame.f_code.co_filename.startswith(OURS)


def moments(calls: int) -> List[int]:
    """Some of so many calls, with all of the first and the last ones, which handle files.

    Those between compute: ten of them tell what such a call does.
    """
    step = max(7, calls // 10)
    return sorted({*range(1, 20), *range(20, calls, step), *range(calls - 25, calls + 2)})
