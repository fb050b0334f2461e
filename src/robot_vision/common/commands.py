"""What all commands have in common: exit codes, Ctrl-C and the end of the process."""

import atexit
import contextlib
import os
import signal
import sys
from typing import Any, Callable, Optional

INTERRUPTED = 130  # exit code after Ctrl-C, as shells report it


def run_command(program: str, work: Callable[[], Any]) -> int:
    """Runs `work`, the main function of a command that is not a node, and returns the exit code.

    An OSError or a ValueError is printed as one line on stderr, and the exit code is 1.
    """
    # Ctrl-C has to raise KeyboardInterrupt, so that `work` tidies up. Shells start background jobs
    # with the signal ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        work()
    except (OSError, ValueError) as error:
        print(f"{program}: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return INTERRUPTED
    finally:
        signal.signal(signal.SIGINT, before or signal.SIG_DFL)
    return 0


def end_process(code: Optional[int]) -> None:
    """Ends the process as the interpreter would, but leaves threads alone that run callbacks.

    CPython ends such threads by unwinding their stacks. C++ code in them, for instance OpenCV's,
    does not survive that.

    Args:
        code: The exit code; None is 0.
    """
    with contextlib.suppress(Exception):
        atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):  # The reader may have closed the stream.
            stream.flush()
    os._exit(code or 0)
