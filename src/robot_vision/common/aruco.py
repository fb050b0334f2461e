"""The dictionaries of markers of OpenCV's ArUco module, whose interface changed with 4.7."""

import numpy as np

from . import opencv as cv2


def aruco_dictionary(name: str) -> "cv2.aruco.Dictionary":
    """Returns the dictionary of a name such as 4x4_50.

    Raises:
        ValueError: OpenCV has no such dictionary, or no ArUco module.
    """
    if not hasattr(cv2, "aruco"):
        raise ValueError(
            f"OpenCV {cv2.__version__} has no aruco, which ChArUco boards need: "
            "it is one of the contrib modules"
        )
    number = getattr(cv2.aruco, "DICT_" + name.upper(), None)
    if number is None:
        known = [key[5:].lower() for key in sorted(vars(cv2.aruco)) if key.startswith("DICT_")]
        raise ValueError(f"dictionary is '{name}', must be one of {', '.join(known)}")
    return cv2.aruco.getPredefinedDictionary(number)


def require_markers(name: str, count: int) -> "cv2.aruco.Dictionary":
    """Returns a dictionary; raises ValueError if it has fewer markers than a board needs."""
    found = aruco_dictionary(name)
    there = len(found.bytesList)
    if count > there:
        raise ValueError(f"dictionary {name} has {there} markers, the board {count}")
    return found


def aruco_cells(dictionary: "cv2.aruco.Dictionary", number: int) -> np.ndarray:
    """Returns the cells of a marker with its black border, (n, n) bool, True for black."""
    side = dictionary.markerSize + 2
    new = hasattr(cv2.aruco, "generateImageMarker")
    draw = cv2.aruco.generateImageMarker if new else cv2.aruco.drawMarker
    return draw(dictionary, number, side) == 0
