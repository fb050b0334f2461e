#!/usr/bin/python3
"""What tracking of boxes costs, beside a tracker in NumPy and SciPy and the usual calls of cv2.

Both see the same in turns, so that the noise of a shared machine meets both alike: the ratios are
what counts. Times are of the CPU, medians, in ms. Ours take Python's lists and images as a node has
them. Needs the workspace's environment: tools/env --source .ws/devel/setup.bash PROGRAM
"""

import argparse
import json
import statistics
import sys
import time
from pathlib import Path
from typing import Any, Callable, Dict, List, Sequence

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "support"))

import cv2
import numpy as np
import skimage.data
from moving_boxes import Detection, Detector
from plain_box_tracker import PlainBoxTracker

import robot_vision as rv

RATE = 30.0  # Hz
EVERY = 4  # frames from one result to the next
STEPS = 240  # frames of a round
WARP = np.array([[1.0, -0.002, 1.5], [0.002, 1.0, -0.5]])
AREA = (1920.0, 1080.0)  # px, in which the boxes move
IMAGE_SIZE = (640, 480)


def moving_results(count: int) -> List[List[Detection]]:
    """A detector's results of so many boxes that move, one for each frame that it sees."""
    random = np.random.default_rng(count)
    center = random.uniform(0.1, 0.9, (count, 2)) * AREA
    speed = random.normal(0.0, 40.0, (count, 2))
    half = random.uniform(15.0, 60.0, (count, 2))
    detector = Detector(1, missing=0.0, unsure=0.0, false_boxes=0.0)
    results = []
    for number in range(0, STEPS, EVERY):
        middle = center + speed * number / RATE
        boxes = np.hstack([middle - half, middle + half])
        truth = {i: tuple(map(float, box)) for i, box in enumerate(boxes)}
        results.append(detector.find(number, truth, dict.fromkeys(truth, 0)))
    return results


def timed(work: Callable[..., Any], *arguments: Any) -> float:
    begin = time.process_time()
    work(*arguments)
    return (time.process_time() - begin) * 1e3


def tracker_round(tracker: Any, results: Sequence[List[Detection]]) -> Dict[str, List[float]]:
    times: Dict[str, List[float]] = {"update": [], "predict": []}
    for number in range(STEPS):
        now = number / RATE
        if number % EVERY:
            times["predict"].append(timed(tracker.predict, now, WARP))
        else:
            found = results[number // EVERY]
            times["update"].append(timed(tracker.update, now, found, WARP))
    return {name: values[len(values) // 4 :] for name, values in times.items()}


def compare_trackers(count: int, rounds: int) -> List[Dict[str, Any]]:
    results = moving_results(count)
    makers = {"ours": rv.BoxTracker, "numpy": PlainBoxTracker}
    times: Dict[str, Dict[str, List[float]]] = {name: {} for name in makers}
    for _ in range(rounds):
        for name, make in makers.items():
            for work, values in tracker_round(make(rv.BoxTrackerParams()), results).items():
                times[name].setdefault(work, []).extend(values)
    return [figures(f"{work}, {count} boxes", times, work) for work in ("update", "predict")]


def figures(title: str, times: Dict[str, Dict[str, List[float]]], work: str) -> Dict[str, Any]:
    ours, theirs = (statistics.median(of[work]) for of in times.values())
    names = list(times)
    return {"work": title, names[0]: ours, names[1]: theirs, "ratio": theirs / ours}


class PlainCameraMotion:
    """The usual way: Shi-Tomasi corners of the whole gray image, flow there, RANSAC."""

    def __init__(self) -> None:
        self._last = np.zeros(0)

    def update(self, image: np.ndarray) -> np.ndarray:
        last, self._last = self._last, cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
        if not last.size:
            return np.eye(2, 3)
        points = cv2.goodFeaturesToTrack(last, 80, 0.01, 20.0)
        moved, found, _ = cv2.calcOpticalFlowPyrLK(last, self._last, points, None)
        chosen = found.ravel() > 0
        return cv2.estimateAffinePartial2D(points[chosen], moved[chosen])[0]


def compare_motion(rounds: int) -> Dict[str, Any]:
    photograph = cv2.cvtColor(skimage.data.coffee(), cv2.COLOR_RGB2BGR)
    width, height = IMAGE_SIZE
    photograph = cv2.resize(photograph, (width + 80, height + 80))
    shifts = [(int(20 + 18 * np.sin(i / 3)), int(20 + 18 * np.cos(i / 4))) for i in range(40)]
    images = [np.ascontiguousarray(photograph[y : y + height, x : x + width]) for x, y in shifts]
    times: Dict[str, Dict[str, List[float]]] = {"ours": {"motion": []}, "cv2": {"motion": []}}
    for _ in range(rounds):
        for name, motion in (("ours", rv.CameraMotion()), ("cv2", PlainCameraMotion())):
            spent = [timed(motion.update, image) for image in images]
            times[name]["motion"] += spent[1:]
    return figures("camera motion, {}x{}".format(*IMAGE_SIZE), times, "motion")


def measured(rounds: int) -> List[Dict[str, Any]]:
    """A row for each work: its name, what it takes ours and the other, in ms, and their ratio."""
    cv2.setNumThreads(1)
    rv.set_threads(1)
    rows = [row for count in (10, 50, 200) for row in compare_trackers(count, rounds)]
    return [*rows, compare_motion(rounds)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5)
    for row in measured(parser.parse_args().rounds):
        print(json.dumps({key: round(v, 4) if key != "work" else v for key, v in row.items()}))


if __name__ == "__main__":
    main()
