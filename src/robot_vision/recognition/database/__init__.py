"""The database of objects: one file, which needs no server."""

from .database import Database
from .documents import Mesh, Model, Object, Observation, Session, Symmetry
from .location import default_path

__all__ = [
    "Database",
    "Mesh",
    "Model",
    "Object",
    "Observation",
    "Session",
    "Symmetry",
    "default_path",
]
