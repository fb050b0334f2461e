"""Objects that threads may share: what one thread gets is what it would get alone."""

import concurrent.futures
import inspect
import itertools
import re
import threading

import numpy as np
import pytest

import robot_vision as rv

THREADS = 3
SIZES = ((60, 80), (90, 120), (150, 200))  # px; with another size memory is made anew
RNG = np.random.default_rng(0)
IMAGES = [RNG.integers(0, 256, (*size, 3), dtype=np.uint8) for size in SIZES]


def has_methods(value):
    return isinstance(value, type(rv.FilterChain)) and any(
        callable(member) and not name.startswith("_") and not inspect.isbuiltin(member)
        for name, member in vars(value).items()
    )


@pytest.mark.parametrize("name", [name for name in dir(rv) if has_methods(getattr(rv, name))])
def test_what_has_methods_says_whether_threads_may_share_it(name):
    said = r"[Tt]hreads? ((may|must not) share|at (a time|once))"
    assert re.search(said, getattr(rv, name).__doc__)


def in_threads(call, rounds):
    """What call(image) gives in threads that begin together, with the indices of the images."""
    began = threading.Barrier(THREADS)

    def run(first):
        began.wait()
        indices = [(first + number) % len(IMAGES) for number in range(rounds)]
        return [(index, call(IMAGES[index])) for index in indices]

    with concurrent.futures.ThreadPoolExecutor(THREADS) as pool:
        return [pair for pairs in pool.map(run, range(THREADS)) for pair in pairs]


def test_threads_share_a_filter_chain():
    chain = ["gray", "gaussian", "canny"]
    alone = [rv.FilterChain(chain).apply(image) for image in IMAGES]
    for index, result in in_threads(rv.FilterChain(chain).apply, 60):
        assert np.array_equal(result, alone[index])


def k_means():
    params = rv.SegmenterParams()
    params.method = "k_means"
    return rv.Segmenter(params)


def test_threads_share_a_segmenter():
    segmenter = k_means()

    def segmented(image):
        segmenter.add_point((5, 5))
        labels = segmenter.apply(image).labels
        segmenter.clear_seeds()
        return labels, segmenter.seeds

    for index, (labels, seeds) in in_threads(segmented, 20):
        assert labels.shape == SIZES[index] and len(seeds) <= THREADS


@pytest.mark.parametrize("kind", [rv.MotionDetector, rv.DenseFlow, rv.PhaseCorrelator])
def test_threads_share_what_compares_frames(kind):
    """Each second frame is of another size, and begins anew."""
    comparing = kind()

    def compared(image):
        results = [comparing.update(0.0, image) for _ in range(2)]
        comparing.reset()
        return results

    results = in_threads(compared, 60)
    for index, pair in results:
        for result in pair:
            if kind is rv.MotionDetector:
                assert result.mask.shape == SIZES[index]
            elif kind is rv.DenseFlow:
                assert result is None or result.shape == (*SIZES[index], 2)
            else:
                assert result is None or 0.0 <= result.response <= 1.0
    assert len(results) == 60 * THREADS


def test_threads_share_a_lane_detector():
    ground = rv.GroundParams()
    ground.ground = "points"
    detector = rv.LaneDetector(ground)

    def shape_of_view(image):
        view = detector.update(0.0, image).view.shape
        detector.reset()
        return view

    alone = [rv.LaneDetector(ground).update(0.0, image).view.shape for image in IMAGES]
    for index, shape in in_threads(shape_of_view, 5):
        assert shape == alone[index]


def test_threads_add_templates_while_others_match():
    matcher, places = rv.TemplateMatcher(), itertools.product(range(0, 50, 10), range(0, 70, 10))

    def added(image):
        y, x = next(places)
        index = matcher.add(image[y : y + 9, x : x + 9])
        found = {one.index: one.box for one in matcher.match(image).matches}
        return index, found[index] == (x, y, 9, 9)

    results = [result for _, result in in_threads(added, 6)]
    assert sorted(index for index, _ in results) == list(range(6 * THREADS))
    assert all(is_in_place for _, is_in_place in results)
