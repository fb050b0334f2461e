"""How wrong the depths of a sensor are, by things whose distance is known otherwise."""

import collections
from typing import Deque, NamedTuple, Tuple

import numpy as np

STEPS = 5  # of the robust fit
HUBER_LIMIT = 1.345  # standard deviations
MEDIAN_TO_SIGMA = 1.4826
# Of the scale, and of the bias in m, before anything was measured. It only counts as long as the
# measurements tell nothing, as one alone tells nothing of the scale.
PRIOR = 1.0
SIGNIFICANT = 3.0  # standard errors


class DepthErrors(NamedTuple):
    """What the depths of a sensor are of the true ones: scale times depth, plus bias.

    Attributes:
        scale: 1 if it is right.
        bias: In m.
        covariance: 2x2, of scale and bias.
        nearest: m, the least true depth that was measured.
        farthest: m, the largest one.
    """

    scale: float
    bias: float
    covariance: np.ndarray
    nearest: float
    farthest: float

    @property
    def scale_error(self) -> float:
        """The standard error of the scale."""
        return float(np.sqrt(self.covariance[0, 0]))

    @property
    def bias_error(self) -> float:
        """The standard error of the bias in m."""
        return float(np.sqrt(self.covariance[1, 1]))

    def at(self, depth: float) -> Tuple[float, float]:
        """Returns by how much a true depth is measured wrong, and its standard error, in m."""
        row = np.array([depth, 1.0])
        error = (self.scale - 1.0) * depth + self.bias
        return error, float(np.sqrt(row @ self.covariance @ row))

    def worst(self, limit: float) -> Tuple[float, float]:
        """Returns the depth among those measured that is wrong most, and its error, in m.

        The error is 0 if it is nowhere above `limit`, or not significantly: three standard errors.
        """
        found = self.nearest, 0.0
        for depth in (self.nearest, (self.nearest + self.farthest) / 2.0, self.farthest):
            error, deviation = self.at(depth)
            if abs(error) > max(limit, SIGNIFICANT * deviation, abs(found[1])):
                found = depth, error
        return found


class DepthErrorEstimate:
    """Estimates the scale and the bias of depths from the last measurements, without outliers.

    Args:
        size: The number of measurements that are kept.
    """

    def __init__(self, size: int = 200):
        self._measured: Deque[Tuple[float, float, float]] = collections.deque(maxlen=size)

    def __len__(self) -> int:
        return len(self._measured)

    def add(self, true: float, measured: float, deviation: float) -> None:
        """Adds a measurement.

        Args:
            true: The depth that is known otherwise, in m.
            measured: That of the sensor, in m.
            deviation: The standard deviation of the difference of the two, in m.
        """
        self._measured.append((true, measured, deviation))

    def clear(self) -> None:
        self._measured.clear()

    def ratio(self) -> float:
        """Returns the median of measured to true depths; there must be any."""
        true, measured, _ = np.array(self._measured).T
        return float(np.median(measured / true))

    def errors(self) -> DepthErrors:
        """Returns what the measurements say; there must be any."""
        true, measured, deviation = np.array(self._measured).T
        rows = np.column_stack([true, np.ones_like(true)]) / deviation[:, None]
        values = (measured - true) / deviation
        weights = np.ones_like(true)
        for _ in range(STEPS):
            information = rows.T @ (weights[:, None] * rows) + np.eye(2) / PRIOR**2
            covariance = np.linalg.inv(information)
            found = covariance @ (rows.T @ (weights * values))
            residuals = np.abs(values - rows @ found)
            # The deviations may be larger than they were said to be.
            scatter = max(MEDIAN_TO_SIGMA * float(np.median(residuals)), 1.0)
            limit = HUBER_LIMIT * scatter
            weights = np.where(residuals <= limit, 1.0, limit / np.maximum(residuals, limit))
        return DepthErrors(
            1.0 + float(found[0]),
            float(found[1]),
            scatter**2 * covariance,
            float(true.min()),
            float(true.max()),
        )
