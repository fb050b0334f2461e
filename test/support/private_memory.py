"""What a process has written and alone has, which is what grows when it leaks."""

import pathlib
import re

# An environment in which malloc returns freed frames and networks to the kernel. Otherwise it keeps
# some of them, and other memory for each of the threads that come and go.
GIVES_BACK = {"MALLOC_MMAP_THRESHOLD_": "131072", "MALLOC_ARENA_MAX": "1"}
# The lines by which a script of a test gets private_memory(), wherever it lies.
IMPORT = f"""
import sys
sys.path.append({str(pathlib.Path(__file__).parent)!r})
from private_memory import private_memory
"""


def private_memory(pid: int) -> float:
    """The memory of a process in MiB that it has written and shares with no other.

    The unique set size of psutil holds pages of libraries as well while no other process uses the
    same library: it changes by 100 MiB when another test starts or ends.
    """
    rollup = pathlib.Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="ascii")
    sizes = re.findall(r"^(?:Private_Dirty|Swap): +(\d+) kB", rollup, re.MULTILINE)
    return sum(map(int, sizes)) / 1024
