"""What is in a bag, by the index at its end: it takes no time, however large the bag is."""

import os
import struct
from typing import Any, BinaryIO, Dict, List, Tuple

from .bag_format import (
    BAG,
    CHUNK_INFO,
    CONNECTION,
    MAGIC,
    Record,
    number_of,
    parse_fields,
    read_record,
    stamp_of,
    text_of,
)

MAX_INDEX = 64 << 20  # bytes; that of a bag of 100 GB with some topics has 20 MB
MAX_RECORDS = 1_000_000  # of the index, and counts in them: some seconds
MAX_CONNECTIONS = 10_000
NO_INDEX = "it was not finished, or is damaged: rosbag reindex may help"


def summary_of(file: BinaryIO) -> Dict[str, Any]:
    """Returns the start (s), duration (s) and topics of a bag.

    The topics are a list of name, type and count, sorted by name. A bag without messages begins
    at 0.

    Raises:
        ValueError: It is no bag, has no index, or more of one than can be read; one line.
        OSError: It cannot be read.
    """
    try:
        return _summary(file)
    except EOFError:
        raise ValueError(NO_INDEX) from None


def _summary(file: BinaryIO) -> Dict[str, Any]:
    if file.read(len(MAGIC)) != MAGIC:
        raise ValueError("it is no bag of version 2.0")
    header = read_record(file)
    size = os.fstat(file.fileno()).st_size
    position = number_of(header.fields, "index_pos", 8) if header.op == BAG else 0
    if not file.tell() <= position <= size:
        raise ValueError(NO_INDEX)
    if size - position > MAX_INDEX:
        raise ValueError(f"its index has {(size - position) >> 20} MB, more than is read")
    file.seek(position)
    index = _Index()
    while file.tell() < size:
        index.add(read_record(file), file, size)
    return index.summary()


class _Index:
    def __init__(self) -> None:
        self._records = 0
        self._topics: Dict[int, Tuple[str, str]] = {}  # by connection: name and type
        self._counts: Dict[int, int] = {}
        self._start, self._end = float("inf"), 0.0

    def add(self, record: Record, file: BinaryIO, size: int) -> None:
        self._records += 1 + record.length // 8 * (record.op == CHUNK_INFO)
        if self._records > MAX_RECORDS or len(self._topics) > MAX_CONNECTIONS:
            raise ValueError("its index has more entries than are read")
        if record.length > size - file.tell():
            raise EOFError
        data = file.read(record.length)
        if record.op == CONNECTION:
            kind = text_of(parse_fields(data), "type")
            self._topics[number_of(record.fields, "conn")] = text_of(record.fields, "topic"), kind
        elif record.op == CHUNK_INFO:
            self._start = min(self._start, stamp_of(record.fields, "start_time"))
            self._end = max(self._end, stamp_of(record.fields, "end_time"))
            self._count(data)

    def _count(self, data: bytes) -> None:
        for connection, count in struct.iter_unpack("<II", data[: len(data) // 8 * 8]):
            if connection in self._topics:  # All connections come before what counts them.
                self._counts[connection] = self._counts.get(connection, 0) + count

    def summary(self) -> Dict[str, Any]:
        counts: Dict[Tuple[str, str], int] = {}
        for connection, topic in self._topics.items():  # A topic has one for each publisher.
            counts[topic] = counts.get(topic, 0) + self._counts.get(connection, 0)
        topics: List[Dict[str, Any]] = [
            {"name": name, "type": kind, "count": count}
            for (name, kind), count in sorted(counts.items())
        ]
        start = self._start if self._end else 0.0
        return {"start": start, "duration": max(self._end - start, 0.0), "topics": topics}
