"""Data of any size in the database, stored once whoever names it, and checked when it is read."""

import hashlib

from ...common.plain_text import brief
from .connection import Connection


def digest_of(data: bytes) -> str:
    """Returns the sha256 of data, by which it is stored."""
    return hashlib.sha256(data).hexdigest()


def store_blob(connection: Connection, data: bytes) -> str:
    """Stores data within a transaction, unless it is there, and returns its sha256."""
    digest = digest_of(data)
    connection.execute(
        "INSERT INTO blobs (sha256, data) VALUES (?, ?) ON CONFLICT (sha256) "
        "DO UPDATE SET data = excluded.data WHERE data <> excluded.data",  # if it was damaged
        (digest, data),
    )
    return digest


def read_blob(connection: Connection, digest: str) -> bytes:
    """Returns the data of this sha256.

    Raises:
        ValueError: It is not what was stored.
    """
    found = connection.row("SELECT data FROM blobs WHERE sha256 = ?", (digest,))
    data = found[0] if found else None
    if not isinstance(data, bytes) or digest_of(data) != digest:
        raise ValueError(
            f"{connection.path} is damaged: its data {brief(digest, 15)} is not as stored"
        )
    return data
