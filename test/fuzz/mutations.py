"""Inputs as cables, disks and enemies make them of good ones, the same for the same seed."""

import random
import struct
from typing import List

MAX_SIZE = 1 << 20  # bytes: what is damaged stays small, or it would test the pipe
# Numbers that sizes, counts and stamps go wrong with.
NUMBERS = (0, 1, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 30000, 0x10000, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)
TEXTS = (
    *(b"nan", b"inf", b"1e300", b"-1", b"0", b"null", b"[]", b"{}", b'""', b"\n", b"\0"),
    *(b"\x1b[2J", b"\xff\xfe", b"- ", b": ", b"&a ", b"*a", b"!!binary ", b"?" * 500),
    *(b"[" * 3000, b"{a: " * 3000, b"- " * 3000),
)
# Nine names, each ten times the one before.
BOMB = b"a0: &a0 [x,x,x,x,x,x,x,x,x,x]\n" + b"".join(
    b"a%d: &a%d [%s]\n" % (i, i, b",".join([b"*a%d" % (i - 1)] * 10)) for i in range(1, 9)
)


def mutated(rng: random.Random, seeds: List[bytes]) -> bytes:
    """One of the seeds with a few changes."""
    data = bytearray(rng.choice(seeds))
    for _ in range(rng.choice((0, 1, 1, 1, 2, 3, 8))):
        rng.choice(CHANGES)(rng, data, seeds)
    return bytes(data[:MAX_SIZE])


def _at(rng: random.Random, data: bytearray) -> int:
    """Mostly near the ends, where headers and lengths are."""
    near = min(len(data), 64)
    return (
        rng.choice((rng.randint(0, near), len(data) - rng.randint(0, near)))
        if (rng.random() < 0.7)
        else rng.randint(0, len(data))
    )


def _bit(rng: random.Random, data: bytearray, _: List[bytes]) -> None:
    if data:
        data[_at(rng, data) % len(data)] ^= 1 << rng.randrange(8)


def _byte(rng: random.Random, data: bytearray, _: List[bytes]) -> None:
    if data:
        data[_at(rng, data) % len(data)] = rng.randrange(256)


def _number(rng: random.Random, data: bytearray, _: List[bytes]) -> None:
    """A number as headers have it, over what is there."""
    number, kind = rng.choice(NUMBERS), rng.choice(("<H", ">H", "<I", ">I"))
    packed = struct.pack(kind, number & (0xFFFF if kind[1] == "H" else 0xFFFFFFFF))
    at = _at(rng, data)
    data[at : at + len(packed)] = packed


def _two_numbers(rng: random.Random, data: bytearray, _: List[bytes]) -> None:
    """A size, or a time: two numbers side by side."""
    kind = rng.choice(("<II", ">II", ">HH", "<HH"))
    limit = 0xFFFF if kind[1] == "H" else 0xFFFFFFFF
    number = rng.choice(NUMBERS) & limit
    at = _at(rng, data)
    data[at : at + struct.calcsize(kind)] = struct.pack(kind, number, number)


def _text(rng: random.Random, data: bytearray, _: List[bytes]) -> None:
    at = _at(rng, data)
    data[at : at + rng.choice((0, 0, 3))] = rng.choice(TEXTS)


def _bomb(rng: random.Random, data: bytearray, _: List[bytes]) -> None:
    if rng.random() < 0.1:
        data[:] = BOMB + bytes(data)


def _cut(rng: random.Random, data: bytearray, _: List[bytes]) -> None:
    at = _at(rng, data)
    del data[at : at + rng.choice((1, 4, 30, len(data)))]


def _repeat(rng: random.Random, data: bytearray, _: List[bytes]) -> None:
    at = _at(rng, data)
    data[at:at] = data[at : at + 64] * rng.choice((1, 2, 100))


def _splice(rng: random.Random, data: bytearray, seeds: List[bytes]) -> None:
    other = rng.choice(seeds)
    data[_at(rng, data) :] = other[rng.randint(0, len(other)) :]


CHANGES = (_bit, _byte, _number, _number, _two_numbers, _text, _bomb, _cut, _repeat, _splice)
