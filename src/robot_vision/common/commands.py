"""What all commands do alike."""

import atexit
import contextlib
import os
import signal
import sys
from typing import Any, Callable, Optional

INTERRUPTED = 130  # as shells have it


def run_command(program: str, work: Callable[[], Any]) -> int:
    """Runs what a command that is no node does; its exit code.

    What is wrong, an OSError or ValueError, is a line on stderr and code 1.
    """
    # To tidy up; shells start their background jobs with it ignored.
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
    """Ends the process as its interpreter would, but for threads that still work in callbacks.

    CPython kills those by unwinding their stacks, which C++ in them, OpenCV's, does not survive.
    """
    with contextlib.suppress(Exception):
        atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):  # nobody reads it any more
            stream.flush()
    os._exit(code or 0)
