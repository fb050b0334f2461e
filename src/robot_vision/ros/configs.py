"""What is made from cfg/: robot_vision.cfg, after what this package arranges for it."""

import importlib
from types import ModuleType


def __getattr__(name: str) -> ModuleType:
    try:
        return importlib.import_module(f"robot_vision.cfg.{name}")
    except ModuleNotFoundError as error:
        raise AttributeError(str(error)) from None
