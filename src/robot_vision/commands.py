"""What all commands that are no nodes do alike."""

import sys
from typing import Any, Callable

INTERRUPTED = 130  # as shells have it


def run_command(program: str, work: Callable[[], Any]) -> int:
    """Runs what a command does; its exit code.

    What is wrong, an OSError or ValueError, is a line on stderr and code 1.
    """
    try:
        work()
    except (OSError, ValueError) as error:
        print(f"{program}: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return INTERRUPTED
    return 0
