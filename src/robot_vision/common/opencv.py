"""OpenCV's Python module, imported when something of it is first used.

Its import takes 0.2 s and 37 MB, as it loads OpenCV's windows and more; nodes whose work is done by
the core seldom need it. Use it as cv2: from ..common import opencv as cv2.
"""

import importlib
from typing import Any


def __getattr__(name: str) -> Any:
    return getattr(importlib.import_module("cv2"), name)
