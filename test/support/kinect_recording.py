"""Shared by tests of the Kinect: recordings as fakenect-record makes them, which fakenect plays."""

import glob
import os
import pathlib
from typing import Dict, Iterable, Tuple

import numpy as np

import robot_vision as rv

WIDTH, HEIGHT = 640, 480  # px, of both images
FOCAL_LENGTH = 120.0 / (2 * 0.1042)  # px, of the infrared camera
BASELINE = 0.075  # m, to the projector
REFERENCE = 1.2  # m, of the plane whose shift is ZERO_SHIFT
ZERO_SHIFT = 4 * 200.375  # eighths of a pixel
NONE = 2047  # the shift where there is no depth
TICK_RATE = 60e6  # Hz, of the Kinect's clock
PERIOD = 0.1  # s, from one moment of a recording to the next
GAP = 0.005  # s, from a color image to the depth image of the same moment

(*_, LIBRARY) = "", *sorted(glob.glob("/usr/lib/*/fakenect/libfreenect.so.?.?"))


def available() -> bool:
    """Whether there is fakenect, and this build opens a Kinect."""
    params = rv.CaptureParams()
    params.source = "freenect:0"
    try:
        rv.validate(params)
    except ValueError:
        return False
    return bool(LIBRARY)


def library_path(folder: str) -> Dict[str, str]:
    """The environment in which libraries are looked for in a folder first."""
    return {"LD_LIBRARY_PATH": f"{folder}:{os.environ.get('LD_LIBRARY_PATH', '')}"}


def playing(folder: pathlib.Path) -> Dict[str, str]:
    """The environment in which a recording is the first Kinect."""
    return {**library_path(os.path.dirname(LIBRARY)), "FAKENECT_PATH": str(folder)}


def shifts_of(metres: np.ndarray) -> np.ndarray:
    """What a Kinect sends for depths in m (NaN: none), in uint16."""
    disparity = FOCAL_LENGTH * BASELINE * (1 / REFERENCE - 1 / metres)  # px, less than on the plane
    shifts = np.rint(ZERO_SHIFT + 8 * disparity)
    seen = np.isfinite(shifts) & (shifts >= 0) & (shifts < NONE)
    return np.where(seen, shifts, NONE).astype(np.uint16)


def depths_of(shifts: np.ndarray) -> np.ndarray:
    """The depths of shifts in m, NaN where there is none or more than 10 m."""
    at_plane = FOCAL_LENGTH * BASELINE / REFERENCE
    disparity = at_plane - (shifts - ZERO_SHIFT) / 8
    with np.errstate(divide="ignore"):
        metres = FOCAL_LENGTH * BASELINE / disparity
    return np.where((shifts < NONE) & (disparity > 0) & (metres < 10), metres, np.nan)


def write_recording(
    folder: pathlib.Path, moments: Iterable[Tuple[np.ndarray, np.ndarray]]
) -> pathlib.Path:
    """Writes color images (BGR) and shifts, and between them what the accelerometer has said."""
    folder.mkdir()
    names = []
    for number, (bgr, shifts) in enumerate(moments, 1):
        header = f"P6 {WIDTH} {HEIGHT} 255\n".encode()
        depth_header = f"P5 {WIDTH} {HEIGHT} 65535\n".encode()
        for kind, seconds, ending, data in (
            ("r", 0.0, "ppm", header + bgr[:, :, ::-1].tobytes()),
            ("a", 0.0, "dump", bytes(12)),
            ("d", GAP, "pgm", depth_header + shifts.astype("<u2").tobytes()),
        ):
            time = number * PERIOD + seconds
            names.append(f"{kind}-{1e9 + time:.6f}-{int(time * TICK_RATE)}.{ending}")
            (folder / names[-1]).write_bytes(data)
    (folder / "INDEX.txt").write_text("".join(name + "\n" for name in names))
    return folder
