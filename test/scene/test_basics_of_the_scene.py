"""What basic operations find in the scene, against its truth: where things are, and how they move.

Those of the other nodes are beside their other tests: keypoints, circles, faces, lanes, ...
"""

import functools
import pathlib

import cv2
import numpy as np
import pytest
import skimage.data
import yaml

import robot_vision as rv
from robot_vision import filters

BLUE = pathlib.Path(__file__).resolve().parents[2] / "config/colors/blue.yaml"
PORTRAIT = cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2BGR)
SIZE = 320, 240  # px
BALLS = [60, 200, 400]  # frames in which all of the ball is seen
MOVES = [(200, 220), (480, 500)]  # frames between which the camera turns by some pixels
WALL = ["poster", "checkerboard", "qr_code", "tag_0"]


@functools.lru_cache(maxsize=None)
def scene():
    params = rv.SceneParams()
    params.width, params.height = SIZE
    return rv.Scene(params, PORTRAIT)


def outline_of(name, frame):
    (found,) = (one.outline for one in scene().truth(frame).objects if one.name == name)
    return np.float32(found)


def box_of(name, frame):
    return cv2.boundingRect(np.rint(outline_of(name, frame)).astype(np.int32))


def pixels_of(name, frame, margin=0):
    """Which pixels show a thing, but for those near its border."""
    mask = np.zeros(SIZE[::-1], np.uint8)
    cv2.fillPoly(mask, [np.rint(outline_of(name, frame)).astype(np.int32)], 255)
    return cv2.erode(mask, np.ones((2 * margin + 1,) * 2)) > 0


def params_of(kind, **values):
    made = kind()
    for name, value in values.items():
        assert hasattr(made, name)
        setattr(made, name, value)
    return made


@pytest.mark.parametrize("frame", BALLS)
def test_a_range_of_colors_is_the_ball(frame):
    limits = yaml.safe_load(BLUE.read_text())
    values = {
        f"color_range_{end}_{number}": limits[f"{channel}_{end}"]
        for end in ("low", "high")
        for number, channel in enumerate("hsv", 1)
    }
    mask = filters.chain(scene().render(frame), ["color_range", "open"], **values) > 0
    ball = pixels_of("ball", frame)
    assert mask[ball].mean() > 0.9 and ball[mask].mean() > 0.99


@pytest.mark.parametrize("frame", BALLS)
def test_the_colors_of_a_part_of_the_ball_are_found_in_all_of_it(frame):
    image, (x, y, width, height) = scene().render(frame), box_of("ball", frame)
    part = x + width // 3, y + height // 3, width // 3, height // 3
    counts = rv.hue_saturation_histogram(image, region=part)
    found = rv.back_project(image, counts, "bgr8", rv.HueSaturationParams()) > 60
    ball = pixels_of("ball", frame)
    assert found[ball].mean() > 0.95 and found[~ball].mean() < 0.005


@pytest.mark.parametrize("frame", BALLS)
def test_the_segment_in_a_rectangle_is_the_ball(frame):
    x, y, width, height = box_of("ball", frame)
    segmenter = rv.Segmenter(params_of(rv.SegmenterParams, method="grab_cut", scale=1.0))
    segmenter.add_region((x - 6, y - 6, width + 12, height + 12))
    segment = segmenter.apply(scene().render(frame)).labels == 1
    ball = pixels_of("ball", frame)
    assert (segment & ball).sum() > 0.9 * (segment | ball).sum()


@pytest.mark.parametrize("first, second", MOVES)
def test_a_part_of_the_image_is_where_the_thing_has_gone(first, second):
    x, y, width, height = box_of("qr_code", first)
    matcher = rv.TemplateMatcher(rv.TemplateParams())
    matcher.add(np.ascontiguousarray(scene().render(first)[y : y + height, x : x + width]))
    best, *_ = matcher.match(scene().render(second)).matches
    moved = np.subtract(best.center, (x + (width - 1) / 2, y + (height - 1) / 2))
    truth = outline_of("qr_code", second).mean(axis=0) - outline_of("qr_code", first).mean(axis=0)
    assert np.linalg.norm(truth) > 2.0
    assert moved == pytest.approx(truth, abs=0.7)


@pytest.mark.parametrize("method", ["dis", "farneback"])
@pytest.mark.parametrize("first, second", MOVES)
def test_pixels_of_the_poster_move_as_the_truth_says(first, second, method):
    finder = rv.DenseFlow(params_of(rv.DenseFlowParams, method=method, scale=1.0))
    finder.update(0.0, scene().render(first))
    flow = finder.update(1.0, scene().render(second))
    outlines = [outline_of("poster", frame) for frame in (first, second)]
    places = np.argwhere(pixels_of("poster", first, margin=7))[:, ::-1]
    homography = np.float64(cv2.getPerspectiveTransform(*outlines))
    truth = cv2.perspectiveTransform(np.float64(places)[None], homography)[0] - places
    assert np.linalg.norm(truth, axis=1).min() > 1.0
    errors = np.linalg.norm(flow[places[:, 1], places[:, 0]] - truth, axis=1)
    assert np.median(errors) < 0.1 and np.percentile(errors, 95) < 0.25


@pytest.mark.parametrize("first, second", MOVES)
def test_the_shift_of_the_image_is_that_of_its_wall(first, second):
    correlator = rv.PhaseCorrelator(rv.SpectrumParams())
    correlator.update(0.0, scene().render(first))
    shift = correlator.update(1.0, scene().render(second))
    moves = [outline_of(name, second) - outline_of(name, first) for name in WALL]
    assert shift.found
    assert (shift.x, shift.y) == pytest.approx(np.mean(moves, axis=(0, 1)), abs=0.5)
