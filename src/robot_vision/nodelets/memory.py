"""Gives the memory of a node that has ended back to the system."""

import ctypes
import gc
from typing import Any

_libc: Any = ctypes.CDLL(None)


def keep_start() -> None:
    """Has the garbage collector leave alone what there is already, which stays until the end.

    It works with the GIL, so that frames wait for it: this makes it much shorter.
    """
    gc.collect()
    gc.freeze()


def give_memory_back() -> None:
    """Frees what ended nodes have left in cycles, and has the allocator keep none of it.

    Topics of rospy are in cycles, which keep their descriptors, too.
    """
    gc.collect()
    if hasattr(_libc, "malloc_trim"):  # of glibc, which otherwise keeps what is free in each arena
        _libc.malloc_trim(0)
