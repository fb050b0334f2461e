"""Points and colours of a sensor_msgs/PointCloud2, as many as somebody wants to see."""

from typing import Any, Dict, Optional, Tuple

import numpy as np

from ..common.plain_text import brief, printable

SAMPLES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}  # by datatype
GRAY = 200  # of points without colour
MAX_FIELDS = 256


class CloudPoints:
    """The points of a cloud that are shown.

    Attributes:
        xyz: (n, 3) float32, in m; all are finite.
        colors: (n, 4) uint8, red, green, blue and 255.
    """

    def __init__(self, xyz: np.ndarray, colors: np.ndarray):
        self.xyz = xyz
        self.colors = colors

    def payload(self) -> bytes:
        """Returns x, y, z of all points, then the colours of all."""
        return self.xyz.tobytes() + self.colors.tobytes()


def points_of(cloud: Any, max_points: int) -> CloudPoints:
    """Returns at most `max_points` points of a cloud, every n-th of it that is finite.

    Args:
        cloud: A sensor_msgs/PointCloud2; its fields may have any order and types. A field rgb or
            rgba has a colour in its four bytes, as PCL packs it; else intensity is shown as gray.
        max_points: The largest number that is wanted.

    Raises:
        ValueError: Its fields, sizes and bytes do not agree, or it has no x, y and z.
    """
    records = _records(cloud)
    fields = _fields(cloud)
    for name in "xyz":
        if name not in fields:
            raise ValueError(f"a cloud has no field {name}, only {_names(fields)}")
    step = max(1, -(-records.shape[0] * records.shape[1] // max_points))
    chosen = _chosen(records, step)
    big = bool(cloud.is_bigendian)
    with np.errstate(over="ignore"):  # What is too large becomes infinite, and is left out.
        axes = [_column(chosen, fields[name], big).astype(np.float32) for name in "xyz"]
    xyz = np.stack(axes, axis=1)
    good = np.isfinite(xyz).all(axis=1)
    return CloudPoints(xyz[good], _colors(chosen[good], fields, big))


def _records(cloud: Any) -> np.ndarray:
    """Returns the points' bytes without the padding of rows: (height, width, point_step) uint8."""
    height, width = cloud.height, cloud.width
    point, row, size = cloud.point_step, cloud.row_step, len(cloud.data)
    if not height or not width:
        return np.zeros((0, 0, max(point, 1)), np.uint8)
    if not point:
        raise ValueError("a cloud's point_step is 0, must be the bytes of a point")
    # Of a single row some publishers leave row_step out.
    row = row if row or height > 1 else width * point
    if row < width * point:
        raise ValueError(f"a cloud's row_step is {row}, must be at least {width}*{point}")
    if size < (height - 1) * row + width * point:
        raise ValueError(f"a cloud of {width}x{height} points has {size} bytes, which is too few")
    return np.lib.stride_tricks.as_strided(
        np.frombuffer(cloud.data, np.uint8),
        (height, width, point),
        (row, point, 1),
        writeable=False,
    )


def _fields(cloud: Any) -> Dict[str, Any]:
    if len(cloud.fields) > MAX_FIELDS:
        raise ValueError(f"a cloud has {len(cloud.fields)} fields, must have {MAX_FIELDS} at most")
    return {field.name: field for field in cloud.fields}


def _names(fields: Dict[str, Any]) -> str:
    return printable(", ".join(fields) or "none", 200)


def _chosen(records: np.ndarray, step: int) -> np.ndarray:
    """Returns every step-th point, (n, point_step)."""
    height, width, _ = records.shape
    if height == 1 or step == 1:
        return records.reshape(-1, records.shape[2])[::step] if height == 1 else _flat(records)
    at = np.arange(0, height * width, step)
    return records[at // width, at % width]


def _flat(records: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(records).reshape(-1, records.shape[2])


def _column(points: np.ndarray, field: Any, big: bool, kind: Optional[str] = None) -> np.ndarray:
    """Returns the first number of a field of all points."""
    kind = kind or SAMPLES.get(field.datatype)
    if kind is None:
        raise ValueError(
            f"the field {brief(field.name)} of a cloud has the datatype {field.datatype}, "
            "must be from 1 to 8"
        )
    dtype = np.dtype(kind).newbyteorder(">" if big else "<")
    end = field.offset + dtype.itemsize
    if end > points.shape[1]:
        raise ValueError(
            f"the field {brief(field.name)} of a cloud ends at byte {end} of a point, which has "
            f"{points.shape[1]}"
        )
    return np.ascontiguousarray(points[:, field.offset : end]).view(dtype)[:, 0]


def _colors(points: np.ndarray, fields: Dict[str, Any], big: bool) -> np.ndarray:
    colors = np.full((len(points), 4), 255, np.uint8)
    packed = next((fields[name] for name in ("rgb", "rgba") if name in fields), None)
    if packed is not None:
        if packed.datatype not in (5, 6, 7):
            raise ValueError(
                f"the field {packed.name} of a cloud has the datatype {packed.datatype}, must have "
                "four bytes: 5, 6 or 7"
            )
        # A number 0x00RRGGBB, which may be called a float.
        numbers = _column(points, packed, big, "u4")
        for channel, shift in enumerate((16, 8, 0)):
            colors[:, channel] = numbers >> shift & 255
    elif "intensity" in fields and len(points):
        colors[:, :3] = _gray(_column(points, fields["intensity"], big))[:, np.newaxis]
    else:
        colors[:, :3] = GRAY
    return colors


def _gray(values: np.ndarray) -> np.ndarray:
    """Returns gray levels: the least value is dark, the largest white."""
    values = np.nan_to_num(values.astype(np.float64), nan=0.0, posinf=0.0, neginf=0.0)
    low, high = _limits(values)
    return (55 + 200 * (np.clip(values, low, high) - low) / max(high - low, 1e-300)).astype(
        np.uint8
    )


def _limits(values: np.ndarray) -> Tuple[float, float]:
    return float(values.min()), float(values.max())
