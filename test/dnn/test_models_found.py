"""From a model's file and an image to the objects in it, for every head and both runtimes.

What each network finds is known from how it was made: support/networks.py.
"""

import numpy as np
import onnx
import pytest
from network_files import CAFFE, CAFFE_MODEL, DARKNET, darknet_weights
from network_graph import SIZE, Graph
from networks import (
    NAMES,
    ULTRALYTICS,
    Square,
    detr,
    image_of,
    nanodet,
    rtdetr,
    ssd,
    ssd_rows,
    yolov5,
    yolov6,
    yolov8,
    yolov10,
    yolox,
)
from onnx import TensorProto
from runtime_cases import BACKENDS_OF_HEADS, needs_any

from robot_vision.dnn.detector import DetectionSettings, NetworkDetector
from robot_vision.dnn.network import NetworkSettings
from robot_vision.dnn.runtimes import NetworkError

pytestmark = needs_any
RED, GREEN, BLUE = Square(0, 2, 3), Square(1, 5, 1), Square(2, 6, 6)
ALL = (RED, GREEN, BLUE)


def cell_of(square):
    """The corners of a square, px."""
    left, top = square.column * square.stride, square.row * square.stride
    return left, top, left + square.stride, top + square.stride


def box_of(square, width=16.0, height=8.0):
    """The box that the networks give for a square, inside of the image."""
    left, top, right, bottom = cell_of(square)
    x, y = (left + right) / 2, (top + bottom) / 2
    corners = [x - width / 2, y - height / 2, x + width / 2, y + height / 2]
    return np.clip(corners, 0.0, SIZE)


@pytest.fixture
def detector(tmp_path):
    """detector(content, ...) opens a model; settings are those of NetworkSettings."""

    def opened(content, live=None, name="a.onnx", **settings):
        path = tmp_path / name
        path.write_bytes(content)
        return NetworkDetector(NetworkSettings(str(path), **settings), live)

    return opened


def check(found, squares, scores=None, box=box_of, tolerance=1e-3, score_tolerance=1e-5):
    """Asserts that exactly these squares were found, each with its class, its box and its score."""
    found = sorted(found, key=lambda one: one.class_id)
    assert [one.class_id for one in found] == [square.class_id for square in squares]
    for one, square in zip(found, squares):
        np.testing.assert_allclose(one.box, box(square), atol=tolerance)
        assert one.score == pytest.approx(1.0 if scores is None else scores, abs=score_tolerance)


def nanodet_box(square):
    """The centre of a cell is where it begins, and each side is a stride from there."""
    left, top, _, _ = cell_of(square)
    return np.clip([left - 8, top - 8, left + 8, top + 8], 0, SIZE)


def first_nanodet_box(square):
    """The first version has the centres in the middle of the cells."""
    left, top, _, _ = cell_of(square)
    return np.clip([left - 4, top - 4, left + 12, top + 12], 0, SIZE)


# Content, head, task, and where the boxes are if not where most have them.
HEADS = [
    (yolov8(), "yolov8", "detect", {}),
    (yolov8(metadata=ULTRALYTICS), "yolov8", "detect", {}),
    (yolov8("segment"), "yolov8", "segment", {}),
    (
        yolov8("pose", {**ULTRALYTICS, "task": "pose", "kpt_shape": "[2, 3]"}),
        "yolov8",
        "pose",
        {},
    ),
    (yolov5(), "yolov5", "detect", {}),
    (yolov5("segment"), "yolov5", "segment", {}),
    (yolov10(ULTRALYTICS), "yolov10", "detect", {}),
    (yolox(), "yolox", "detect", {}),
    (yolox(decoded=True), "yolov5", "detect", {}),
    (yolov6(), "yolov5", "detect", {}),
    (nanodet(), "nanodet", "detect", {"box": nanodet_box}),
    (nanodet(ULTRALYTICS, strides=(8, 16, 32)), "nanodet", "detect", {"box": first_nanodet_box}),
    (ssd(), "ssd", "detect", {}),
    (ssd_rows(), "ssd", "detect", {}),
    (detr(), "detr", "detect", {}),
    (rtdetr(), "rtdetr", "detect", {}),
    (rtdetr(2, ULTRALYTICS), "rtdetr", "detect", {}),
]


@pytest.mark.parametrize("backend", BACKENDS_OF_HEADS)
@pytest.mark.parametrize(
    "content, head, task, expected", HEADS, ids=list(map(str, range(len(HEADS))))
)
def test_each_head_finds_what_is_there(detector, content, head, task, expected, backend):
    live = DetectionSettings(score_threshold=0.8)
    one = detector(content, live, backend=backend)
    assert (one.network.head.head, one.network.head.task) == (head, task)
    image = image_of(ALL)
    before = image.copy()
    check(one.detect(image), ALL, **expected)
    np.testing.assert_array_equal(image, before)
    check(one.detect(image_of([])), [])
    check(one.detect(image_of([GREEN])), [GREEN], **expected)


SEVERAL = [yolov8("segment"), ssd(), detr(), rtdetr(2, ULTRALYTICS)]


def turned(content):
    """A network with its outputs in the reverse order."""
    model = onnx.ModelProto.FromString(content)
    outputs = list(model.graph.output)[::-1]
    del model.graph.output[:]
    model.graph.output.extend(outputs)
    return model.SerializeToString()


@pytest.mark.parametrize("backend", BACKENDS_OF_HEADS)
@pytest.mark.parametrize(
    "content", [yolov8("segment"), ssd(), detr(), rtdetr(2, ULTRALYTICS)], ids=list("0123")
)
def test_the_order_of_the_outputs_does_not_matter(detector, content, backend):
    one = detector(turned(content), DetectionSettings(score_threshold=0.8), backend=backend)
    check(one.detect(image_of(ALL)), ALL)


@pytest.mark.parametrize("backend", BACKENDS_OF_HEADS)
def test_masks_come_with_their_boxes(detector, backend):
    """The left half of the input is masked: all of the red box, nothing of the others."""
    one = detector(yolov8("segment"), DetectionSettings(score_threshold=0.8), backend=backend)
    red, green, blue = sorted(one.detect(image_of(ALL)), key=lambda found: found.class_id)
    assert red.mask.shape == (8, 16) and (red.mask == 255).all()
    assert green.mask.shape == (8, 16) and not green.mask.any()
    assert blue.mask.shape[0] == 8 and not blue.mask.any()


@pytest.mark.parametrize("backend", BACKENDS_OF_HEADS)
def test_keypoints_come_with_their_boxes(detector, backend):
    content = yolov8("pose", {**ULTRALYTICS, "task": "pose", "kpt_shape": "[2, 3]"})
    one = detector(content, DetectionSettings(score_threshold=0.8), backend=backend)
    for found in one.detect(image_of(ALL)):
        left, top, right, bottom = cell_of(ALL[found.class_id])
        expected = [[left, top, 0.75], [right, bottom, 0.25]]
        np.testing.assert_allclose(found.keypoints, expected, atol=1e-4)


@pytest.mark.parametrize("backend", BACKENDS_OF_HEADS)
def test_oriented_boxes_have_an_outline(detector, backend):
    """A quarter of a turn: what is twice as wide as high is twice as high as wide."""
    content = yolov8("oriented", {**ULTRALYTICS, "task": "obb"})
    one = detector(content, DetectionSettings(score_threshold=0.8), backend=backend)
    assert one.network.head.task == "oriented"
    (found,) = one.detect(image_of([RED]))
    left, top, right, bottom = box_of(RED, 8.0, 16.0)
    corners = {(round(float(x), 2), round(float(y), 2)) for x, y in found.outline}
    assert corners == {(left, top), (right, top), (right, bottom), (left, bottom)}
    np.testing.assert_allclose(found.center, [20.0, 28.0], atol=1e-3)


@pytest.fixture
def two_files(detector, tmp_path):
    def opened(name, text, weights_name, weights, **settings):
        (tmp_path / weights_name).write_bytes(weights)
        return detector(text.encode(), DetectionSettings(0.8), name, **settings)

    return opened


def test_darknet_finds_what_is_there(two_files):
    one = two_files("a.cfg", DARKNET, "a.weights", darknet_weights())
    assert (one.network.head.head, one.network.runtime.name) == ("yolov3", "OpenCV")
    check(one.detect(image_of(ALL)), ALL)
    check(one.detect(image_of([])), [])


def test_caffe_finds_what_is_there(two_files, tmp_path):
    """Of its three classes the first, blue, is no object; its boxes are squares of 16 px."""
    (tmp_path / "a.names").write_text("green\nred\n")
    one = two_files(
        "a.prototxt",
        CAFFE,
        "a.caffemodel",
        CAFFE_MODEL,
        class_names=str(tmp_path / "a.names"),
        mean=(0.0, 0.0, 0.0),
        std=(255.0, 255.0, 255.0),
    )
    assert one.network.head.head == "ssd" and one.names == ("green", "red")
    found = one.detect(image_of(ALL))
    assert sorted(map(one.name_of, found)) == ["green", "red"]
    for each in found:
        square = RED if one.name_of(each) == "red" else GREEN
        np.testing.assert_allclose(each.box, box_of(square, 16.0, 16.0), atol=1e-3)
        assert each.score == 1.0


@pytest.mark.parametrize("backend", BACKENDS_OF_HEADS)
def test_half_precision_finds_the_same(detector, backend):
    content = yolov8(graph=Graph(kind=TensorProto.FLOAT16))
    one = detector(content, DetectionSettings(score_threshold=0.8), backend=backend)
    check(one.detect(image_of(ALL)), ALL, score_tolerance=1e-2)


def test_channels_in_the_wrong_order_find_the_wrong_colors(detector):
    one = detector(yolov8(), DetectionSettings(score_threshold=0.8), order="bgr")
    (found,) = one.detect(image_of([RED]))
    assert found.class_id == BLUE.class_id


def test_boxes_are_of_the_whole_image_in_its_own_pixels(detector):
    """The part has twice the size of the input, and lies somewhere in a larger image."""
    one = detector(yolov8(), DetectionSettings(score_threshold=0.8))
    image = np.zeros((300, 400, 3), np.uint8)
    image[70:198, 30:158] = np.kron(image_of([RED]), np.ones((2, 2, 1), np.uint8))
    (found,) = one.detect(image, (30, 70, 128, 128))
    left, top, right, bottom = 2.0 * box_of(RED)
    np.testing.assert_allclose(found.box, (30 + left, 70 + top, 30 + right, 70 + bottom), atol=0.01)


def test_tiles_find_what_is_too_small_for_the_whole(detector):
    """Each of four tiles has the input's size; in a single one a square is a quarter of a cell."""
    live = DetectionSettings(0.8, tile_rows=2, tile_columns=2, tile_overlap=0.0)
    one = detector(yolov8(), live)
    image = np.zeros((2 * SIZE, 2 * SIZE, 3), np.uint8)
    image[:SIZE, SIZE:] = image_of([RED])
    image[SIZE:, :SIZE] = image_of([BLUE])
    red, blue = sorted(one.detect(image), key=lambda found: found.class_id)
    np.testing.assert_allclose(red.box, box_of(RED) + np.array([SIZE, 0, SIZE, 0]), atol=1e-3)
    np.testing.assert_allclose(blue.box[:2], box_of(BLUE)[:2] + np.array([0, SIZE]), atol=1e-3)
    one.configure(DetectionSettings(0.8))
    assert one.detect(image) == []


def test_thresholds_are_those_of_each_class(detector):
    one = detector(yolov8(metadata=ULTRALYTICS), DetectionSettings(0.8, {"green": 1.0}))
    image = image_of(ALL) // 255 * 230  # scores of 0.9
    assert [found.class_id for found in one.detect(image)] == [0, 2]
    one.configure(DetectionSettings(1.0, {"green": 0.5}))
    assert [found.class_id for found in one.detect(image)] == [1]
    for live, reason in (
        (DetectionSettings(0.8, {"gren": 0.5}), "has 'gren', which is no class, is green meant?"),
        (DetectionSettings(1.5), "score_threshold is 1.5"),
        (DetectionSettings(0.8, {"green": 2.0}), "class_thresholds"),
        (DetectionSettings(tile_rows=0), "tile_rows is 0, must be from 1 to 64"),
        (DetectionSettings(tile_rows=9, tile_columns=9), "tile_rows x tile_columns is 81, must be"),
        (DetectionSettings(tile_overlap=0.95), "tile_overlap is 0.95, must be from 0 to 0.9"),
    ):
        with pytest.raises(ValueError, match=reason):
            one.configure(live)
        assert [found.class_id for found in one.detect(image)] == [1]


def test_names_come_from_the_model_or_a_file(detector, tmp_path):
    one = detector(yolov8(metadata=ULTRALYTICS))
    assert one.names == NAMES
    names = tmp_path / "my.names"
    names.write_text("apple\nleaf\nsky\n")
    one = detector(yolov8(metadata=ULTRALYTICS), DetectionSettings(0.8), class_names=str(names))
    (found,) = one.detect(image_of([GREEN]))
    assert one.name_of(found) == "leaf"
    names.write_text("apple\n")
    with pytest.raises(ValueError, match=r"my\.names has 1 name, but the network has 3 classes"):
        detector(yolov8(), class_names=str(names))


def test_what_a_node_logs_at_start_is_one_line(detector, tmp_path):
    one = detector(yolov8("segment", ULTRALYTICS), backend="opencv")
    assert str(one.network) == (
        f"{tmp_path}/a.onnx: yolov8 (segment) on OpenCV, 64x64 px rgb, 3 classes, for 1x39x84 has "
        "columns of 4 + 3 classes and 32 of a mask for 84 cells"
    )


def test_an_image_or_a_part_that_cannot_be_used_is_refused(detector):
    one = detector(yolov8())
    image = image_of(ALL)
    for bad in (image[:, :, 0], image.astype(np.float32), np.zeros((0, 0, 3), np.uint8)):
        with pytest.raises((TypeError, ValueError)):
            one.detect(bad)
    for part in ((0, 0, 65, 64), (-1, 0, 10, 10), (0, 0, 0, 10), (10, 10, -5, 5)):
        for tiles in (1, 2):
            one.configure(DetectionSettings(tile_columns=tiles))
            with pytest.raises(ValueError):
                one.detect(image, part)


def test_a_network_that_gives_something_else_in_mid_stream_is_told(detector):
    one = detector(yolov8(), DetectionSettings(0.8))
    run = one.network.runtime.run
    for outputs in ([np.zeros((1, 9, 84), np.float32)], []):
        one.network.runtime.run = lambda _values, given=outputs: given
        with pytest.raises(NetworkError, match="something else than at start: "):
            one.detect(image_of(ALL))
    one.network.runtime.run = run
    assert len(one.detect(image_of(ALL))) == 3
