"""The modules generated from cfg/. This package must be imported first: see robot_vision.ros."""

import importlib
from types import ModuleType


def __getattr__(name: str) -> ModuleType:
    try:
        return importlib.import_module(f"robot_vision.cfg.{name}")
    except ModuleNotFoundError as error:
        raise AttributeError(str(error)) from None
