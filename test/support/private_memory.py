"""What a process has written and alone has, which is what grows when it leaks."""

import pathlib
import re


def private_memory(pid: int) -> float:
    """The memory of a process in MiB that it has written and shares with no other.

    The unique set size of psutil holds pages of libraries as well while no other process uses the
    same library: it changes by 100 MiB when another test starts or ends.
    """
    rollup = pathlib.Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="ascii")
    sizes = re.findall(r"^(?:Private_Dirty|Swap): +(\d+) kB", rollup, re.MULTILINE)
    return sum(map(int, sizes)) / 1024
