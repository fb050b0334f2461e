"""Depth images as the standard compressedDepth transport sends and reads them, by other code."""

import struct
from typing import Iterator, List, Tuple

import cv2
import numpy as np
from sensor_msgs.msg import CompressedImage

QUANTIZATION, MAX_DEPTH = 100.0, 10.0  # m, the transport's defaults


def header_of(encoding: str) -> Tuple[float, float]:
    """What turns z (m) into a code, numerator / z + offset; of millimetres 0."""
    if encoding != "32FC1":
        return 0.0, 0.0
    numerator = QUANTIZATION * (QUANTIZATION + 1.0)
    return numerator, 1.0 - numerator / MAX_DEPTH


def codes_of(depth: np.ndarray) -> np.ndarray:
    """(height, width) uint16: millimetres as they are, metres by their inverse; 0 for no depth."""
    if depth.dtype == np.uint16:
        return np.where(depth > 1000 * MAX_DEPTH, 0, depth).astype(np.uint16)
    numerator, offset = header_of("32FC1")
    seen = (depth > 0) & (depth < MAX_DEPTH)
    return np.where(seen, numerator / np.where(seen, depth, 1.0) + offset, 0).astype(np.uint16)


def groups_of(number: int) -> Iterator[int]:
    """Groups of three bits, the lowest first; 8 is added to those that others follow."""
    while True:
        number, group = number >> 3, number & 7
        yield group | (8 if number else 0)
        if not number:
            return


def numbers_of(codes: List[int]) -> Iterator[int]:
    """What RVL writes: runs of zeros and of others, and the differences of these, folded."""
    at, previous = 0, 0
    while at < len(codes):
        seen = next((i for i in range(at, len(codes)) if codes[i]), len(codes))
        end = next((i for i in range(seen, len(codes)) if not codes[i]), len(codes))
        yield from (seen - at, end - seen)
        for code in codes[seen:end]:
            difference, previous = code - previous, code
            yield 2 * difference if difference >= 0 else -2 * difference - 1
        at = end


def rvl_of(codes: np.ndarray) -> bytes:
    digits = "".join(f"{g:x}" for n in numbers_of(codes.ravel().tolist()) for g in groups_of(n))
    digits += "0" * (-len(digits) % 8)
    words = [int(digits[i : i + 8], 16) for i in range(0, len(digits), 8)]
    return struct.pack(f"<{2 + len(words)}I", *codes.shape[::-1], *words)


def compressed(depth: np.ndarray, codec: str) -> CompressedImage:
    """What the standard publisher makes of uint16 (mm) or float32 (m); `codec` is png or rvl."""
    encoding = "16UC1" if depth.dtype == np.uint16 else "32FC1"
    codes = codes_of(depth)
    stream = rvl_of(codes) if codec == "rvl" else cv2.imencode(".png", codes)[1].tobytes()
    head = struct.pack("<iff", 0, *header_of(encoding))
    return CompressedImage(format=f"{encoding}; compressedDepth {codec}", data=head + stream)


def decompressed(message: CompressedImage) -> np.ndarray:
    """What the standard subscriber makes of a message with a PNG."""
    encoding = message.format.partition(";")[0]
    assert message.format == f"{encoding}; compressedDepth png"
    kind, numerator, offset = struct.unpack("<iff", message.data[:12])
    assert kind == 0
    codes = cv2.imdecode(np.frombuffer(message.data[12:], np.uint8), cv2.IMREAD_UNCHANGED)
    if encoding != "32FC1":
        return codes
    with np.errstate(divide="ignore"):
        metres = numerator / (codes.astype(np.float32) - np.float32(offset))
    return np.where(codes == 0, np.nan, metres).astype(np.float32)
