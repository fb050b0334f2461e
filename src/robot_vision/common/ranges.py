"""Ranges of numbers."""

import math


def require_range(name: str, value: float, low: float, high: float, zero: str = "") -> None:
    """Raises ValueError for a number out of range; NaN and infinite numbers always are.

    Args:
        name: The name of the number, for the error message.
        value: The number.
        low: The smallest number allowed; -inf together with `high` = inf allows all finite ones.
        high: The largest number allowed.
        zero: What the value 0 means, for the error message.
    """
    if math.isfinite(value) and low <= value <= high:
        return
    meant = f" ({zero})" if zero else ""
    span = f"from {low:g}{meant} to {high:g}" if math.isfinite(low + high) else "finite"
    raise ValueError(f"{name} is {value:g}, must be {span}")
