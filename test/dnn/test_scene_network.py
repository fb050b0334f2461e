"""The network that comes with the package, in frames of the scenes that it was not trained with.

cv2.dnn runs it, and NumPy decodes what it says. See tools/detector for how it was trained, and for
what counts as found.
"""

import ast
import hashlib
import pathlib
import sys

import cv2
import numpy as np
import onnx
import pytest
import skimage.data
from average_precision import Boxes, average_precision

import robot_vision

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tools"))

from detector import evaluation, frames, geometry, patterns, things, views  # noqa: E402

NETWORK = ROOT / "config" / "networks" / "scene.onnx"
SEED = 2026  # the walls, tables, colors and noise of this seed were not used for the network
SURE = 0.5  # score of what a user would be told of


@pytest.fixture(scope="module")
def net():
    return cv2.dnn.readNetFromONNX(str(NETWORK))


@pytest.fixture(scope="module")
def held_out():
    return evaluation.held_out_frames(SEED, scenes=4, frames=8)


def boxes(rows, scores=(), unclear=()):
    """Boxes of class 0."""
    array = np.array(rows, float).reshape(-1, 4)
    unknown = np.zeros(len(array), bool)
    unknown[list(unclear)] = True
    return Boxes(np.zeros(len(array), int), array, np.array(scores, float), unknown)


def test_the_file_is_the_one_that_was_trained():
    line = f"{hashlib.sha256(NETWORK.read_bytes()).hexdigest()}  {NETWORK.name}\n"
    assert line == (NETWORK.parent / "SHA256SUMS").read_text()
    assert NETWORK.stat().st_size < 1_000_000


def test_the_file_says_what_it_is():
    model = onnx.load(str(NETWORK))
    said = {entry.key: entry.value for entry in model.metadata_props}
    assert ast.literal_eval(said["names"]) == dict(enumerate(things.NAMES))
    assert (said["task"], said["stride"], said["license"]) == ("detect", "32", "BSD-3-Clause")
    assert ast.literal_eval(said["imgsz"]) == [views.INPUT[1], views.INPUT[0]]
    assert int(said["training_seed"]) >= 0
    assert float(said["ap50"]) == pytest.approx(
        np.mean(list(ast.literal_eval(said["ap50_of_classes"]).values())), abs=1e-4
    )
    numbers = sum(int(np.prod(each.dims)) for each in model.graph.initializer)
    assert 100_000 < numbers < 300_000


def test_the_average_precision_in_unseen_frames_and_colors(net, held_out):
    found = evaluation.precisions(net, evaluation.examples_of(held_out, SEED))
    assert np.mean(found) >= 0.95, dict(zip(things.NAMES, found))
    assert min(found) >= 0.85, dict(zip(things.NAMES, found))


def test_the_average_precision_in_frames_as_they_are(net, held_out):
    found = evaluation.precisions(net, evaluation.examples_of(held_out[::2], SEED, recolor=False))
    assert np.mean(found) >= 0.97, dict(zip(things.NAMES, found))


def test_a_photograph_on_the_wall_is_a_poster_as_well(net):
    photograph = cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2BGR)
    scene = frames.room(SEED, photograph)
    shown = [frames.frame_of(scene, number) for number in range(140, 600, 150)]
    found = evaluation.precisions(net, evaluation.examples_of(shown, SEED, recolor=False))
    assert found[things.NAMES.index("poster")] >= 0.95


def test_little_is_found_where_nothing_is(net):
    rng = np.random.default_rng(SEED)
    images = [patterns.pattern(rng, *views.INPUT) for _ in range(40)]
    counts = [np.sum(evaluation.found_by(net, image).scores >= SURE) for image in images]
    assert np.mean(counts) <= 0.25


def test_an_output_is_of_the_layout_of_yolov8(net):
    net.setInput(np.zeros((1, 3, views.INPUT[1], views.INPUT[0]), np.float32))
    output = net.forward()
    count = sum(views.INPUT[0] * views.INPUT[1] // stride**2 for stride in (8, 16, 32))
    assert output.shape == (1, 4 + len(things.NAMES), count)
    assert output[0, 4:].min() >= 0 and output[0, 4:].max() <= 1
    assert output[0, 2:4].min() >= 0


THINGS = [[0, 0, 10, 10], [20, 0, 30, 10]]
AWAY = [50, 50, 60, 60]


@pytest.mark.parametrize(
    ("found", "truth", "expected"),
    [
        (boxes(THINGS, [0.9, 0.8]), boxes(THINGS), 1.0),
        (boxes([], []), boxes(THINGS), 0.0),
        (boxes([AWAY], [0.9]), boxes(THINGS), 0.0),
        # Half of the recalls are reached with the precision 1: those from 0 to 0.5.
        (boxes(THINGS[:1], [0.9]), boxes(THINGS), 51 / 101),
        # The other half needs three detections, of which two are right.
        (boxes([THINGS[0], AWAY, THINGS[1]], [0.9, 0.8, 0.7]), boxes(THINGS), (51 + 100 / 3) / 101),
        # What comes after all has been found costs nothing; what comes before costs half.
        (boxes([THINGS[0], AWAY], [0.9, 0.8]), boxes(THINGS[:1]), 1.0),
        (boxes([AWAY, THINGS[0]], [0.9, 0.8]), boxes(THINGS[:1]), 0.5),
        # A thing is found once.
        (boxes([THINGS[0], THINGS[0], THINGS[1]], [3, 2, 1]), boxes(THINGS), (51 + 100 / 3) / 101),
        # An IoU of 1/2 is enough, and one of 4/10 is not.
        (boxes([[0, 0, 10, 5]], [0.9]), boxes(THINGS[:1]), 1.0),
        (boxes([[0, 0, 10, 4]], [0.9]), boxes(THINGS[:1]), 0.0),
        # What is unclear need not be found, and may be.
        (boxes(THINGS[1:], [0.9]), boxes(THINGS, unclear=[0]), 1.0),
        (boxes(THINGS, [0.9, 0.8]), boxes(THINGS, unclear=[0]), 1.0),
        (boxes([[0, 0, 5, 5], THINGS[1]], [0.9, 0.8]), boxes(THINGS, unclear=[0]), 1.0),
        (boxes([[-9, 0, 9, 9], THINGS[1]], [2, 1]), boxes(THINGS, unclear=[0]), 1.0),
        (boxes([[-9, 0, 5, 9], THINGS[1]], [2, 1]), boxes(THINGS, unclear=[0]), 0.5),
    ],
)
def test_the_average_precision_is_that_of_its_definition(found, truth, expected):
    assert average_precision([found], [truth], 0) == pytest.approx(expected)
    nothing = boxes([])
    assert average_precision([nothing, found], [nothing, truth], 0) == pytest.approx(expected)


def test_without_a_thing_of_a_class_there_is_no_precision():
    assert np.isnan(average_precision([boxes(THINGS, [1, 1])], [boxes([])], 0))
    assert np.isnan(average_precision([], [], 0))


def moved(outline, x, y):
    return outline + np.array([x, y])


def test_the_share_of_a_thing_in_view_is_that_of_its_area():
    view, square = geometry.rectangle(100, 80), geometry.rectangle(40, 40)
    assert geometry.visible_share(square, view, []) == 1
    assert geometry.visible_share(square[::-1], view, []) == 1
    assert geometry.visible_share(moved(square, 80, 0), view, []) == pytest.approx(0.5)
    assert geometry.visible_share(moved(square, 80, 60), view, []) == pytest.approx(0.25)
    assert geometry.visible_share(moved(square, 100, 0), view, []) == 0
    half, other = geometry.rectangle(20, 40), geometry.rectangle(40, 10)
    assert geometry.visible_share(square, view, [half]) == pytest.approx(0.5)
    assert geometry.visible_share(square, view, [half, other]) == pytest.approx(0.375, abs=0.02)


def test_what_is_half_hidden_need_not_be_found():
    def thing(name, outline, distance):
        return things.Thing(name, outline, outline, distance, True)

    view, square = geometry.rectangle(100, 80), geometry.rectangle(40, 40)
    shown = [
        thing("ball", moved(square, 75, 20), 1),  # 5/8 of it
        thing("box", moved(square, -25, 20), 2),  # 3/8 of it
        thing("poster", moved(square, 200, 20), 2),
        thing("tag", moved(square / 5, 45, 20), 2),  # 8 px wide
    ]
    labels = things.labels_of(shown, view)
    assert [things.NAMES[kind] for kind in labels.classes] == ["ball", "box", "tag"]
    assert labels.unclear.tolist() == [False, True, True]
    assert labels.boxes[:2].tolist() == [[75, 20, 100, 60], [0, 20, 15, 60]]
    hidden = things.labels_of([thing("ball", square, 2), thing("box", square * 0.9, 1)], view)
    assert hidden.unclear.tolist() == [True, False]


def test_frames_kept_for_tests_are_of_other_moments():
    numbers = range(frames.RATE * frames.PERIOD)
    kept = [number for number in numbers if frames.is_held_out(number)]
    assert len(kept) == len(numbers) // frames.HELD_OUT
    assert {number % (frames.HELD_OUT * frames.RATE) // frames.RATE for number in kept} == {4}


def test_what_the_network_finds_has_the_names_of_the_scenes_truth():
    names = {one.name for one in frames.room(1, None).truth(0).objects}
    names |= {one.name for one in robot_vision.TabletopScene().truth(0).objects}
    assert {things.class_of(name) for name in names} == {*things.NAMES, ""}
    assert [name for name in names if not things.class_of(name)] == ["line"]


def test_a_margin_is_that_of_the_scenes_boards():
    corners = np.array([[10, 60], [60, 60], [60, 10], [10, 10]], float)
    assert np.allclose(
        things.with_margin("tag", corners),
        [[3.75, 66.25], [66.25, 66.25], [66.25, 3.75], [3.75, 3.75]],
    )
    assert things.with_margin("ball", corners) is corners
