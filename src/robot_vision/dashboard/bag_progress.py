"""How many messages a bag has that is being written."""

import os
from typing import BinaryIO, Dict

from .bag_format import CHUNK, CONNECTION, MAGIC, MESSAGE, number_of, read_record, text_of

MAX_RECORDS = 50_000  # that are looked at at a time: some tenths of a second


class BagProgress:
    """Counts the messages of each topic as they are written.

    What is in a chunk that is not compressed are records as well, so that all of the file is one
    row of records, of which only the headers are read.

    Args:
        file: The bag, read without a buffer: what is at its end changes.
    """

    def __init__(self, file: BinaryIO):
        self._file = file
        self._position = len(MAGIC)
        self._topics: Dict[int, str] = {}
        self.counts: Dict[str, int] = {}  # by topic
        self.known = True  # whether the file has been understood so far

    def update(self) -> None:
        """Counts what is new; where the file has not been written any further, it ends."""
        try:
            for _ in range(MAX_RECORDS):
                self._step()
        except EOFError:
            pass
        except (OSError, ValueError):
            self.known = False

    def size(self) -> int:
        """Returns the size of the file in bytes."""
        return os.fstat(self._file.fileno()).st_size

    def _step(self) -> None:
        self._file.seek(self._position)
        record = read_record(self._file)
        if record.op == CONNECTION:
            topic = text_of(record.fields, "topic")
            self._topics[number_of(record.fields, "conn")] = topic
            self.counts.setdefault(topic, 0)
        elif record.op == MESSAGE:
            topic = self._topics.get(number_of(record.fields, "conn"), "")
            self.counts[topic] = self.counts.get(topic, 0) + 1
        self._position = self._file.tell() + (0 if record.op == CHUNK else record.length)
