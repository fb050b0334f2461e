"""The tables of the database, and its versions."""

from typing import Dict, Sequence

APPLICATION = 0x52564F42  # "RVOB", by which the file is known
VERSION = 1

TABLES = (
    """CREATE TABLE blobs (
         sha256 TEXT PRIMARY KEY,
         data BLOB NOT NULL)""",
    """CREATE TABLE objects (
         id TEXT PRIMARY KEY,
         name TEXT NOT NULL,
         description TEXT NOT NULL,
         author TEXT NOT NULL,
         email TEXT NOT NULL,
         added TEXT NOT NULL)""",
    """CREATE TABLE tags (
         object_id TEXT NOT NULL REFERENCES objects ON DELETE CASCADE,
         tag TEXT NOT NULL,
         PRIMARY KEY (object_id, tag))""",
    """CREATE TABLE meshes (
         object_id TEXT PRIMARY KEY REFERENCES objects ON DELETE CASCADE,
         file_name TEXT NOT NULL,
         original TEXT NOT NULL REFERENCES blobs,
         converted TEXT NOT NULL REFERENCES blobs,
         unit REAL NOT NULL,
         scale REAL NOT NULL,
         origin_offset TEXT NOT NULL,
         symmetries TEXT NOT NULL,
         added TEXT NOT NULL)""",
    """CREATE TABLE mesh_files (
         object_id TEXT NOT NULL REFERENCES meshes ON DELETE CASCADE,
         name TEXT NOT NULL,
         data TEXT NOT NULL REFERENCES blobs,
         PRIMARY KEY (object_id, name))""",
    """CREATE TABLE sessions (
         id TEXT PRIMARY KEY,
         object_id TEXT NOT NULL REFERENCES objects ON DELETE CASCADE,
         source TEXT NOT NULL,
         added TEXT NOT NULL)""",
    """CREATE TABLE observations (
         id TEXT PRIMARY KEY,
         session_id TEXT NOT NULL REFERENCES sessions ON DELETE CASCADE,
         frame_number INTEGER NOT NULL,
         rgb TEXT NOT NULL REFERENCES blobs,
         depth TEXT NOT NULL REFERENCES blobs,
         mask TEXT NOT NULL REFERENCES blobs,
         matrix TEXT NOT NULL,
         distortion TEXT NOT NULL,
         pose TEXT NOT NULL)""",
    """CREATE TABLE models (
         object_id TEXT NOT NULL REFERENCES objects ON DELETE CASCADE,
         method TEXT NOT NULL,
         parameters TEXT NOT NULL,
         key TEXT NOT NULL,
         data TEXT NOT NULL REFERENCES blobs,
         added TEXT NOT NULL,
         PRIMARY KEY (object_id, method))""",
    # What a training has done that was interrupted; the key is that of the model that it makes.
    """CREATE TABLE training (
         key TEXT PRIMARY KEY,
         done INTEGER NOT NULL,
         state TEXT NOT NULL REFERENCES blobs)""",
    "CREATE INDEX models_key ON models (key)",
    "CREATE INDEX observations_session ON observations (session_id, frame_number)",
)

# What makes a database of the version before out of that of each version.
MIGRATIONS: Dict[int, Sequence[str]] = {}

# Each column that names a blob; blobs that none of them names are removed.
BLOBS = (
    ("meshes", "original"),
    ("meshes", "converted"),
    ("mesh_files", "data"),
    ("observations", "rgb"),
    ("observations", "depth"),
    ("observations", "mask"),
    ("models", "data"),
    ("training", "state"),
)
