"""The records of bags, http://wiki.ros.org/Bags/Format/2.0, read within limits.

Bags may come from anywhere. No message and no definition is looked into here, nothing is unpacked,
and lengths are looked at before memory is taken, so that a damaged or hostile bag is an error.
"""

import struct
from typing import BinaryIO, Dict, NamedTuple

MAGIC = b"#ROSBAG V2.0\n"
MESSAGE, BAG, INDEX, CHUNK, CHUNK_INFO, CONNECTION = 2, 3, 4, 5, 6, 7  # op of records
OPS = (MESSAGE, BAG, INDEX, CHUNK, CHUNK_INFO, CONNECTION)
MAX_HEADER = 1 << 16  # bytes of a record's header, which has a topic's name at most
MAX_TEXT = 256  # characters of names that are shown

Fields = Dict[bytes, bytes]


class Record(NamedTuple):
    """The header of a record."""

    op: int
    fields: Fields
    length: int  # bytes, of the data behind it


def read_record(file: BinaryIO) -> Record:
    """Reads the header of the record at a file's position, and leaves that at its data.

    Raises:
        EOFError: The file ends before the data begins.
        ValueError: It is no record.
    """
    size = _number(_exactly(file, 4))
    if size > MAX_HEADER:
        raise ValueError(f"a record's header has {size} bytes, must have at most {MAX_HEADER}")
    fields = parse_fields(_exactly(file, size))
    op = fields.get(b"op", b"")
    if len(op) != 1 or op[0] not in OPS:
        raise ValueError("a record is of no known kind")
    return Record(op[0], fields, _number(_exactly(file, 4)))


def parse_fields(data: bytes) -> Fields:
    """Returns the fields of a header: `<length><name>=<value>` each.

    Raises:
        ValueError: It is no header.
    """
    fields, position = {}, 0
    while position < len(data):
        end = position + 4 + _number(data[position : position + 4])
        name, equals, value = data[position + 4 : end].partition(b"=")
        if end > len(data) or not equals:
            raise ValueError("a record's header is damaged")
        fields[name] = value
        position = end
    return fields


def number_of(fields: Fields, name: str, size: int = 4) -> int:
    """Returns an unsigned integer of `size` bytes.

    Raises:
        ValueError: The header has no such field.
    """
    return _number(fields.get(name.encode(), b""), size)


def stamp_of(fields: Fields, name: str) -> float:
    """Returns a time in s; raises ValueError if the header has no such field."""
    seconds, nanoseconds = divmod(number_of(fields, name, 8), 1 << 32)[::-1]
    return seconds + nanoseconds * 1e-9


def text_of(fields: Fields, name: str) -> str:
    """Returns a name, cut to what is shown of it, or "" if the header has no such field."""
    return fields.get(name.encode(), b"")[: 4 * MAX_TEXT].decode(errors="replace")[:MAX_TEXT]


def _number(data: bytes, size: int = 4) -> int:
    if len(data) != size:
        raise ValueError("a record's header is damaged")
    return struct.unpack("<I" if size == 4 else "<Q", data)[0]


def _exactly(file: BinaryIO, size: int) -> bytes:
    data = file.read(size)
    if len(data) < size:
        raise EOFError("the file ends within a record")
    return data
