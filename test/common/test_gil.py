"""Calls that take a while release the GIL, so that other Python threads run meanwhile."""

import itertools
import subprocess
import sys
import threading
import time
from functools import partial

import cv2
import numpy as np
import pytest
from tags import CAMERAS, SIZE, corners_of, matrix

import robot_vision as rv

CAMERA = CAMERAS["plumb_bob"]
TAG = rv.single_tag(3, SIZE)
CORNERS = corners_of(matrix(np.diag([1.0, -1.0, -1.0]), [0.05, -0.1, 1.0]), CAMERA)
GRAY = np.full((480, 640), 128, np.uint8)
CELLS = rv.tag_cells("tag36h11", 3)
TRIES = 2000
DEADLINE = 60.0  # s; on a busy machine few calls are long enough for another thread to wake up


@pytest.fixture
def never_switching():
    """Threads are switched only where the GIL is released."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e3)
    yield
    sys.setswitchinterval(before)


def lets_others_run(function, tries=sys.maxsize):
    """Whether another thread, which waits only for the GIL, runs during a call."""
    ran, blocked = [], threading.Lock()

    def run():
        with blocked:
            ran.append(True)

    with blocked:
        thread = threading.Thread(target=run)
        thread.start()
    end = time.monotonic() + DEADLINE
    while not ran and tries > 0 and time.monotonic() < end:
        function()
        tries -= 1
    let = bool(ran)
    thread.join()
    return let


def searching(detector):
    """Makes a detector begin a search in the background."""
    detector.update(0.0, GRAY, "mono8")
    detector.update(10.0, GRAY, "mono8")
    return detector


SCENE = rv.Scene()
BGR = SCENE.render(60)
MASK = np.where(BGR[:, :, 0] > 128, 255, 0).astype(np.uint8)
BALL = next(thing for thing in SCENE.truth(60).objects if thing.name == "ball")
BOX = tuple(cv2.boundingRect(BALL.outline.astype(np.float32)))
DEPTH = np.full((480, 640), 1.5, np.float32)
PINHOLE = rv.CameraModel(640, 480, [500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0])
TRACKER = rv.TagPoseTracker(TAG)
DETECTOR = rv.TagDetector()
CALLS = {
    "estimate_pose": lambda: rv.estimate_pose(TAG, {3: CORNERS}, CAMERA),
    "TagPoseTracker.update": lambda: TRACKER.update(0.0, {3: CORNERS}, CAMERA),
    "measure_corners": lambda: rv.measure_corners(GRAY, CELLS, 8, CORNERS, CAMERA),
    "without_bent_edges": lambda: rv.without_bent_edges(CORNERS, CAMERA),
    "tag_cells": lambda: rv.tag_cells("tagStandard52h13", 3),
    "TagDetector.detect": lambda: DETECTOR.detect(GRAY, "mono8"),
}


def updated(worker, *select):
    """Gives a worker one frame after the other, with something selected in the first one."""
    times = itertools.count()
    worker.update(float(next(times)), BGR)
    if select:
        worker.select(*select)
    return lambda: worker.update(float(next(times)), BGR)


# What the nodes in Python do with each frame, so that those of one process do it side by side.
CALLS.update(
    {
        "find_edges": partial(rv.find_edges, BGR),
        "HsvMask.apply": partial(rv.HsvMask().apply, BGR),
        "RegionFinder.apply": partial(rv.RegionFinder().apply, MASK),
        "FilterChain.apply": partial(rv.FilterChain(["median"]).apply, BGR),
        "MotionDetector.update": updated(rv.MotionDetector()),
        "FaceDetector.update": updated(rv.FaceDetector()),
        "CodeReader.update": updated(rv.CodeReader()),
        "HoughTransform.apply": partial(rv.HoughTransform().apply, BGR),
        "ContourFinder.apply": partial(rv.ContourFinder().apply, MASK, "mono8"),
        "LaneDetector.update": partial(rv.LaneDetector().update, 0.0, BGR, "bgr8", PINHOLE),
        "DenseFlow.update": updated(rv.DenseFlow()),
        "WindowTracker.update": updated(rv.WindowTracker(), BOX),
        "ObjectTracker.update": updated(rv.ObjectTracker(), BOX),
        "Segmenter.apply": partial(rv.Segmenter().apply, BGR),
        "PeopleDetector.detect": partial(rv.PeopleDetector().detect, BGR),
        "KeypointMatcher.update": partial(rv.KeypointMatcher().update, BGR),
        "StereoMatcher.match": partial(rv.StereoMatcher().match, BGR, BGR),
        "PlaneFinder.find": partial(rv.PlaneFinder(PINHOLE).find, DEPTH),
        "Scene.render": partial(SCENE.render, 60),
    }
)


@pytest.mark.parametrize("name", CALLS)
def test_call_lets_others_run(never_switching, name):
    assert lets_others_run(CALLS[name])


def test_python_code_lets_nobody_run(never_switching):
    assert not lets_others_run(lambda: None, TRIES)


@pytest.mark.parametrize(
    "detector, params",
    [(rv.TagDetector, rv.TagDetectorParams()), (rv.FaceDetector, rv.FaceParams())],
)
def test_destroying_a_searching_detector_lets_others_run(never_switching, detector, params):
    params.background = True

    def lets_others_run_once():
        detectors = [searching(detector(params))]
        return lets_others_run(detectors.pop, tries=1)

    assert any(lets_others_run_once() for _ in range(TRIES))


AT_THE_END = """
import threading
import numpy as np
import robot_vision as rv

began = threading.Barrier(5)

def work(side):
    image = np.zeros((side, side, 3), np.uint8)
    rv.find_edges(image)
    began.wait()
    while True:
        rv.find_edges(image)

for side in (300, 1000, 2000, 5000):
    threading.Thread(target=work, args=(side,), daemon=True).start()
began.wait()
rv.find_edges(np.zeros((2000, 2000), np.uint8), "mono8")
"""


@pytest.mark.parametrize("run", range(5))
def test_process_ends_cleanly_during_calls(run):
    command = [sys.executable, "-c", AT_THE_END]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr) == (0, "")
