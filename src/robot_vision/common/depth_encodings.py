"""Which images hold depths."""

from .plain_text import printable

ENCODINGS = ("16UC1", "mono16", "32FC1")  # mono16 is what some transports make of 16UC1


def require_depths(encoding: str) -> None:
    """Raises ValueError unless images of this encoding of sensor_msgs/Image hold depths."""
    if encoding not in ENCODINGS:
        raise ValueError(
            f"the encoding of a depth image is '{printable(encoding)}', "
            "must be 16UC1 (mm) or 32FC1 (m)"
        )
