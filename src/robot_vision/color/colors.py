"""Colours in the 8-bit spaces of OpenCV: hues in half degrees, everything else from 0 to 255."""

from typing import List, Sequence, Tuple, Union

import numpy as np

from .._core import ColorRange, HsvRange, color_channels, image_to_space

HUES = 180
TITLES = {"lab": "Lab", "ycrcb": "YCrCb"}  # of the spaces that are not written in capitals

AnyRange = Union[ColorRange, HsvRange]
Color = Tuple[int, ...]


def space_of(colors: AnyRange) -> str:
    """Returns the space of a range."""
    return getattr(colors, "space", "hsv")


def title_of(space: str) -> str:
    """Returns a space's name as people write it: HSV, Lab."""
    return TITLES.get(space, space.upper())


def limit_names(space: str) -> Tuple[Tuple[str, ...], Tuple[str, ...]]:
    """Returns the names of the limits in a space: (l_low, a_low, b_low), (l_high, ...)."""
    names = [name for name, _, _ in color_channels(space)]
    return tuple(f"{name}_low" for name in names), tuple(f"{name}_high" for name in names)


def median_color(bgr_region: np.ndarray, space: str) -> Color:
    """Returns the median colour of a part of an image.

    Args:
        bgr_region: (height, width, 3) uint8, BGR.
        space: The space of the result, one of color_spaces().

    Returns:
        The medians of the channels, rounded down. The median hue is the hue in the region with
        the least sum of distances to all others on the colour circle. Pixels without saturation
        have no hue; if there are no others, the hue is 0.

    Raises:
        ValueError: The region is empty.
    """
    if bgr_region.size == 0:
        raise ValueError("the region is empty")
    bgr = np.ascontiguousarray(bgr_region)
    pixels = image_to_space(bgr, space).reshape(-1, 3)
    medians = [int(median) for median in np.median(pixels, axis=0)]
    meanings = [meaning for _, meaning, _ in color_channels(space)]
    if meanings[0] == "hue":
        colored = pixels[pixels[:, meanings.index("saturation")] > 0, 0]
        medians[0] = _median_hue(colored % HUES)
    return tuple(medians)


def _median_hue(hues: np.ndarray) -> int:
    counts = np.bincount(hues, minlength=HUES)
    apart = np.abs(np.subtract.outer(np.arange(HUES), np.arange(HUES)))
    costs = np.minimum(apart, HUES - apart) @ counts
    return int(np.argmin(np.where(counts > 0, costs, np.inf))) if hues.size else 0


def outside(color: Sequence[int], colors: AnyRange) -> str:
    """Returns why a picked colour does not fit its own range: it is too gray or dark; or "".

    Args:
        color: In the range's space.
        colors: A range around its hue, or around all of its channels.
    """
    limits: List[str] = []
    channels = color_channels(space_of(colors))
    for (_, meaning, _), seen, low, high in zip(channels, color, colors.low, colors.high):
        if meaning == "hue":  # lies in the range, which may go through red
            continue
        if seen < low:
            limits.append(f"{meaning} {seen} is below {low}")
        if seen > high:
            limits.append(f"{meaning} {seen} is above {high}")
    return f"the range does not hold this colour: {', '.join(limits)}" if limits else ""


def as_yaml(colors: AnyRange) -> str:
    """Returns the range as one line of hsv_tracker's parameter file."""
    space = space_of(colors)
    named = "" if space == "hsv" else f"space: {space}, "
    return f"{{{named}low: {list(colors.low)}, high: {list(colors.high)}}}"
