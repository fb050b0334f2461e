"""Where onnxruntime is found: in the system, or in the folder that `make onnxruntime` makes.

pip would bring a NumPy of its own, which Debian's OpenCV cannot use. So it is kept in a folder of
its own, without what it depends on, and that folder is the last of sys.path: NumPy and OpenCV stay
those of the system.
"""

import importlib
import os
import sys
from typing import Any, Iterator, Tuple

VARIABLE = "ROBOT_VISION_ONNXRUNTIME"  # of the environment: another folder
FOLDER = os.path.join("robot_vision", "onnxruntime")


def find_onnxruntime() -> Tuple[Any, str]:
    """Returns the module onnxruntime, or None and the reason why it cannot be used."""
    reason = "onnxruntime is not installed"
    try:
        return importlib.import_module("onnxruntime"), ""
    except ModuleNotFoundError as error:
        if error.name != "onnxruntime":
            reason = f"onnxruntime cannot be imported: {error}"
    except Exception as error:  # of another NumPy or system than it was built for
        reason = f"onnxruntime cannot be imported: {_line(error)}"
    for folder in _folders():
        if not os.path.isdir(os.path.join(folder, "onnxruntime")) or folder in sys.path:
            continue
        sys.path.append(folder)
        importlib.invalidate_caches()
        try:
            return importlib.import_module("onnxruntime"), ""
        except Exception as error:
            sys.path.remove(folder)
            reason = f"onnxruntime of {folder} cannot be imported: {_line(error)}"
    return None, reason


def _folders() -> Iterator[str]:
    """Yields the folders of packages in which it may be, for this version of Python."""
    python = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    homes = [os.environ.get(VARIABLE, "")]
    # ROS_HOME is where ROS keeps its files; a terminal without it has the other.
    for home in (os.environ.get("ROS_HOME", ""), os.path.expanduser(os.path.join("~", ".ros"))):
        homes.append(os.path.join(home, FOLDER) if home else "")
    for home in filter(None, homes):
        yield os.path.join(home, "lib", python, "site-packages")


def _line(error: Exception) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__
