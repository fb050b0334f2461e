"""A tracker of boxes as one writes it with NumPy and SciPy: what BoxTracker is compared with.

It has the Kalman filter of all eight numbers of a box with full covariances, and SciPy's assignment
with all pairs in one table. It takes results in time only, and one class.
"""

from dataclasses import dataclass
from typing import List, Optional, Sequence, Tuple

import numpy as np
from scipy.optimize import linear_sum_assignment
from track_identities import Box, overlaps

INITIAL_GROWTH = 0.5  # sides/s


def to_state(boxes: np.ndarray) -> np.ndarray:
    """(n, 4) corners: (n, 4) centres and sizes."""
    low, high = boxes[:, :2], boxes[:, 2:]
    return np.hstack([(low + high) / 2.0, high - low])


def to_boxes(states: np.ndarray) -> np.ndarray:
    center, half = states[:, :2], states[:, 2:4] / 2.0
    return np.hstack([center - half, center + half])


def sides(states: np.ndarray) -> np.ndarray:
    return np.sqrt(states[:, 2] * states[:, 3])


@dataclass
class Tracks:
    """The tracks' states: centre, size and the rates of both, and all else, in rows."""

    mean: np.ndarray  # (n, 8)
    covariance: np.ndarray  # (n, 8, 8)
    side: np.ndarray  # px, that the noise is in proportion to: of the last result, as seen now
    id: np.ndarray  # 0: not confirmed
    hits: np.ndarray
    seen: np.ndarray  # s
    lost: np.ndarray

    def rows(self, chosen: np.ndarray) -> "Tracks":
        return Tracks(*(value[chosen] for value in vars(self).values()))

    def followed_by(self, others: "Tracks") -> "Tracks":
        both = zip(vars(self).values(), vars(others).values())
        return Tracks(*(np.concatenate(values) for values in both))


class PlainBoxTracker:
    """Has the parameters of BoxTracker; its update() and predict() return ids and boxes."""

    def __init__(self, params) -> None:
        self._params = params
        self._tracks = self._begun(np.zeros((0, 4)), 0.0)
        self._time: Optional[float] = None
        self._last_id = 0

    def update(
        self, time: float, detections: Sequence[Tuple[int, float, Box]], warp: Optional[np.ndarray]
    ) -> List[Tuple[int, Box]]:
        p = self._params
        boxes = np.array([box for _, _, box in detections], float).reshape(-1, 4)
        scores = np.array([score for _, score, _ in detections], float)
        self._move(time, warp)
        tracks = self._tracks
        tracks.lost, was_lost = np.ones(len(tracks.id), bool), tracks.lost
        sure = np.flatnonzero(scores >= p.high_score)
        unsure = np.flatnonzero((scores >= p.low_score) & (scores < p.high_score))
        confirmed = np.flatnonzero(tracks.id > 0)
        sure = self._associate(time, confirmed, sure, boxes, p.min_iou)
        left = np.flatnonzero((tracks.id > 0) & tracks.lost & ~was_lost)
        self._associate(time, left, unsure, boxes, p.min_unsure_iou)
        left = np.flatnonzero(tracks.lost & ~was_lost)
        sure = self._associate(time, left, sure, boxes, p.min_new_iou, self._reach(time)[left])
        tracks.mean[tracks.lost, 6:] = 0.0
        tracks = tracks.rows((tracks.id > 0) | ~tracks.lost)
        self._tracks = tracks = tracks.followed_by(self._begun(to_state(boxes[sure]), time))
        for row in np.flatnonzero((tracks.id == 0) & (tracks.hits >= p.min_hits)):
            self._last_id += 1
            tracks.id[row] = self._last_id
        tracks.side = sides(tracks.mean)
        return self._reported(time)

    def predict(self, time: float, warp: Optional[np.ndarray]) -> List[Tuple[int, Box]]:
        self._move(time, warp)
        return self._reported(time)

    def velocities(self) -> np.ndarray:
        return self._tracks.mean[:, 4:6]

    def _begun(self, states: np.ndarray, time: float) -> Tracks:
        p, count = self._params, len(states)
        deviations = np.repeat([p.measurement_noise, p.initial_speed, INITIAL_GROWTH], [4, 2, 2])
        variances = (deviations * sides(states)[:, None]) ** 2
        mean = np.hstack([states, np.zeros((count, 4))])
        numbers = (np.zeros(count, int), np.ones(count, int), np.full(count, time))
        covariance = variances[:, :, None] * np.eye(8)
        return Tracks(mean, covariance, sides(states), *numbers, np.zeros(count, bool))

    def _move(self, time: float, warp: Optional[np.ndarray]) -> None:
        """Moves all by a similarity and by their own speed."""
        p, tracks = self._params, self._tracks
        elapsed = 0.0 if self._time is None else time - self._time
        self._time = time
        change = np.eye(8)
        if warp is not None:
            turn = np.asarray(warp)[:, :2]
            scale = np.sqrt(np.linalg.det(turn)) * np.eye(2)
            for i, block in enumerate((turn, scale, turn, scale)):
                change[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = block
        tracks.mean = tracks.mean @ change.T
        if warp is not None:
            tracks.mean[:, :2] += np.asarray(warp)[:, 2]
            tracks.side *= scale[0, 0]
        accelerations = np.repeat([p.acceleration, p.growth], 2) * tracks.side[:, None]
        step = np.eye(8) + elapsed * np.eye(8, k=4)
        tracks.mean = tracks.mean @ step.T
        both = step @ change
        of_time = np.array([[elapsed**3 / 3.0, elapsed**2 / 2.0], [elapsed**2 / 2.0, elapsed]])
        noise = np.einsum("ni,ij->nij", accelerations**2, np.eye(4))
        noise = np.einsum("ab,nij->naibj", of_time, noise).reshape(-1, 8, 8)
        tracks.covariance = both @ tracks.covariance @ both.T + noise
        self._tracks = tracks.rows(time - tracks.seen <= p.max_age)

    def _reach(self, time: float) -> np.ndarray:
        """How far a track may be from where it is expected without an overlap, px."""
        tracks, longest = self._tracks, self._params.reach * sides(self._tracks.mean)
        way = np.linalg.norm(tracks.mean[:, 4:6], axis=1) * (time - tracks.seen)
        known = np.minimum(longest, 0.5 * sides(tracks.mean) + 2.0 * way)
        return np.where(tracks.hits < 2, longest, known)

    def _gains(
        self,
        rows: np.ndarray,
        measured: np.ndarray,
        noise: np.ndarray,
        min_iou: float,
        reach: np.ndarray,
    ) -> np.ndarray:
        expected = self._tracks.mean[rows]
        ious = overlaps(to_boxes(expected), to_boxes(measured))
        apart = np.linalg.norm(expected[:, None, :2] - measured[None, :, :2], axis=2)
        deviations = np.sqrt(self._tracks.covariance[rows, 0, 0][:, None] + noise)
        ratios = np.abs(np.log(expected[:, None, 2:4] / measured[None, :, 2:4]))
        alike = (ratios <= np.log(1.5)).all(axis=2)
        explained = alike & (apart <= self._params.gate * deviations)
        near = np.where(alike & (apart < reach[:, None]), 1.0 - apart / reach[:, None], 0.0)
        is_pair = (ious >= min_iou) & ((ious >= 0.5) | explained)
        return np.where(is_pair, ious - min_iou + 1e-9, 1e-9 * near)

    def _associate(
        self,
        time: float,
        rows: np.ndarray,
        found: np.ndarray,
        boxes: np.ndarray,
        min_iou: float,
        reach: Optional[np.ndarray] = None,
    ) -> np.ndarray:
        """Corrects the tracks of these rows, and returns the detections that are left."""
        tracks, measured = self._tracks, to_state(boxes[found])
        noise = (self._params.measurement_noise * sides(measured)) ** 2
        reach = np.full(len(rows), 1e-9) if reach is None else reach
        gains = self._gains(rows, measured, noise, min_iou, reach)
        pairs = np.array(linear_sum_assignment(gains, maximize=True))
        pairs = pairs[:, gains[tuple(pairs)] > 0.0]
        row, detection = rows[pairs[0]], found[pairs[1]]
        measured, noise = measured[pairs[1]], noise[pairs[1]]
        self._begin_again(time, row, measured, noise)
        covariance = tracks.covariance[row]
        innovation = covariance[:, :4, :4] + noise[:, None, None] * np.eye(4)
        gain = covariance[:, :, :4] @ np.linalg.inv(innovation)
        difference = measured - tracks.mean[row, :4]
        tracks.mean[row] += np.einsum("nij,nj->ni", gain, difference)
        tracks.covariance[row] = covariance - gain @ covariance[:, :4, :]
        tracks.lost[row], tracks.seen[row] = False, time
        tracks.hits[row] += 1
        return np.setdiff1d(found, detection)

    def _begin_again(
        self, time: float, rows: np.ndarray, measured: np.ndarray, noise: np.ndarray
    ) -> None:
        """Of what is not where it can be: it is where it is seen, with its mean velocity so far."""
        p, tracks = self._params, self._tracks
        surprise = measured[:, :2] - tracks.mean[rows, :2]
        deviation = np.sqrt(tracks.covariance[rows, 0, 0] + noise)
        elapsed = time - tracks.seen[rows]
        chosen = (np.linalg.norm(surprise, axis=1) > p.gate * deviation) & (elapsed > 1e-3)
        speed = (p.initial_speed * sides(measured)) ** 2
        for i in np.flatnonzero(chosen):
            row, centre = rows[i], [0, 1, 4, 5]
            tracks.mean[row, 4:6] += surprise[i] / elapsed[i]
            tracks.mean[row, :2] = measured[i, :2]
            tracks.covariance[row][centre] = tracks.covariance[row][:, centre] = 0.0
            # It is seen by this detection alone, which is yet to be applied.
            variances = 1e12, 1e12, speed[i], speed[i]
            tracks.covariance[row, centre, centre] = variances

    def _reported(self, time: float) -> List[Tuple[int, Box]]:
        p, tracks = self._params, self._tracks
        shown = (tracks.id > 0) & (~tracks.lost | (time - tracks.seen <= p.max_prediction))
        boxes = to_boxes(tracks.mean[shown])
        return sorted((int(i), tuple(box)) for i, box in zip(tracks.id[shown], boxes))
