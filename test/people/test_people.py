"""People in drawn images, against OpenCV's HOGDescriptor called plainly."""

import math

import cv2
import numpy as np
import pytest
from figures import street

import robot_vision as rv

BOXES = [(60, 40, 80, 160), (230, 70, 75, 150)]  # px, the windows that figures are drawn into
SIZE = 360, 260
STREET = street(SIZE, BOXES)


def params(**values):
    made = rv.PeopleParams()
    for name, value in values.items():
        setattr(made, name, value)
    return made


def detect(image, **values):
    return rv.PeopleDetector(params(**values)).detect(image)


def opencv_detects(image, model="default", hit=0.0, stride=8, padding=8, scale=1.05, **grouping):
    """Boxes and weights of cv2.HOGDescriptor, the largest weight first."""
    if model == "default":
        hog = cv2.HOGDescriptor()
        hog.setSVMDetector(cv2.HOGDescriptor_getDefaultPeopleDetector())
    else:
        hog = cv2.HOGDescriptor((48, 96), (16, 16), (8, 8), (8, 8), 9)
        hog.setSVMDetector(cv2.HOGDescriptor_getDaimlerPeopleDetector())
    group, shift = grouping.get("group", 2.0), grouping.get("shift", False)
    strides, paddings = (stride, stride), (padding, padding)
    boxes, weights = hog.detectMultiScale(image, hit, strides, paddings, scale, group, shift)
    boxes, weights = np.reshape(boxes, (-1, 4)), np.ravel(weights)
    found = sorted(zip(-weights, boxes.tolist()))
    return [(tuple(box), -weight) for weight, box in found]


def clipped(box, size=SIZE):
    """The part of a box in an image."""
    x, y, width, height = box
    left, top = max(x, 0), max(y, 0)
    return left, top, min(x + width, size[0]) - left, min(y + height, size[1]) - top


@pytest.mark.parametrize(
    "ours, theirs",
    [
        ({}, {}),
        ({"model": "daimler"}, {"model": "daimler"}),
        ({"hit_threshold": 0.5}, {"hit": 0.5}),
        ({"hit_threshold": -0.5}, {"hit": -0.5}),
        ({"win_stride": 16}, {"stride": 16}),
        ({"padding": 0}, {"padding": 0}),
        ({"scale": 1.1}, {"scale": 1.1}),
        ({"group_threshold": 0.0, "max_people": 1000}, {"group": 0.0}),
        ({"group_threshold": 12.0}, {"group": 12.0}),
        ({"mean_shift": True, "group_threshold": 0.5}, {"shift": True, "group": 0.5}),
    ],
)
def test_people_are_those_of_opencv(ours, theirs):
    found = detect(STREET, **ours)
    expected = opencv_detects(STREET, **theirs)
    assert sorted(one.box for one in found) == sorted(clipped(box) for box, _ in expected)
    assert [one.weight for one in found] == pytest.approx([weight for _, weight in expected])
    assert not ours or expected != opencv_detects(STREET)  # the parameter has an effect
    for one in found:
        assert one.score == pytest.approx(1.0 / (1.0 + math.exp(-one.weight)))


@pytest.mark.parametrize("model", ["default", "daimler"])
def test_figures_are_found_where_they_are(model):
    sure = [one for one in detect(STREET, model=model) if one.weight > 1.0]
    found = sorted(sure, key=lambda one: one.box[0])
    assert len(found) == len(BOXES)
    for one, (x, y, width, height) in zip(found, BOXES):
        left, top, wide, high = one.box
        assert left + wide / 2 == pytest.approx(x + width / 2, abs=8)
        assert top + high / 2 == pytest.approx(y + height / 2, abs=16)
        assert 0.7 * height < high < 1.3 * height
        assert one.score > 0.7


@pytest.mark.parametrize("model", ["default", "daimler"])
@pytest.mark.parametrize("max_width", [SIZE[0], SIZE[0] - 13])
def test_boxes_of_figures_at_the_border_end_there(model, max_width):
    """Also where the image was shrunk, and a side of it is no whole number of pixels then."""
    for x, border in ((-12, 0), (300, SIZE[0])):
        image = street(SIZE, [(x, 60, 80, 160)])
        found = detect(image, model=model, hit_threshold=-0.5, padding=24, max_width=max_width)
        assert all(one.box == clipped(one.box) for one in found)
        left, _, width, _ = found[0].box
        assert border in (left, pytest.approx(left + width, abs=1))


def test_a_shrunk_image_is_searched_and_boxes_are_those_of_the_whole():
    large = cv2.resize(STREET, None, fx=2.0, fy=2.0, interpolation=cv2.INTER_LINEAR)
    found = detect(large, max_width=SIZE[0])
    small = cv2.resize(large, SIZE, interpolation=cv2.INTER_AREA)
    expected = [(clipped(box), weight) for box, weight in opencv_detects(small)]
    assert len(found) == len(expected) == len(BOXES)
    for one, (box, weight) in zip(found, expected):
        assert one.box == tuple(2 * side for side in box)
        assert one.weight == pytest.approx(weight)
    same = detect(STREET, max_width=SIZE[0])
    wider = detect(STREET, max_width=SIZE[0] + 100)  # is never enlarged
    assert [one.box for one in same] == [one.box for one in wider]


def test_the_image_is_shrunk_to_the_lowest_window():
    factor = 128 / 140
    small = tuple(round(side * factor) for side in SIZE)
    shrunk = cv2.resize(STREET, small, interpolation=cv2.INTER_AREA)
    found = detect(STREET, min_height=140)
    expected = opencv_detects(shrunk)
    assert len(found) == len(expected) == len(BOXES)
    for one, (box, _) in zip(found, expected):
        assert one.box == pytest.approx([side / factor for side in box], abs=2)
        assert one.box[3] >= 140
    assert not detect(STREET, min_height=2 * SIZE[1])


@pytest.mark.parametrize("asked, taken", [(5, 4), (6, 8), (9, 8), (17, 16)])
def test_strides_are_multiples_of_4(asked, taken):
    found = [(one.box, one.weight) for one in detect(STREET, win_stride=asked)]
    assert found == [(one.box, one.weight) for one in detect(STREET, win_stride=taken)]
    assert found


def test_a_search_of_many_seconds_is_refused():
    values = {"scale": 1.02, "win_stride": 4, "max_width": 1920}
    text = "max_width is 1920 with scale 1.02 and win_stride 4, must be less, or the image of"
    with pytest.raises(ValueError, match=rf"^{text} 1920x1080 have at most 1[12]\d{{5}} pixels$"):
        detect(np.zeros((1080, 1920, 3), np.uint8), **values)
    assert len(detect(STREET, **values)) >= len(BOXES)


@pytest.mark.parametrize("model", ["default", "daimler"])
@pytest.mark.parametrize("scale", [1.01, 1.02, 1.05])
def test_people_as_high_as_the_image_are_found_however_fine_the_steps_are(model, scale):
    box = 210, 20, 220, 440
    people = detect(street((640, 480), [box]), model=model, scale=scale, max_width=640)
    places = [(x + width / 2, height) for x, _, width, height in (one.box for one in people)]
    assert any(abs(x - 320) < 30 and height > 250 for x, height in places), places


def test_the_surest_are_kept():
    everything = detect(STREET, group_threshold=0.0, max_people=1000)
    assert len(everything) > 3
    weights = [one.weight for one in everything]
    assert weights == sorted(weights, reverse=True)
    few = detect(STREET, group_threshold=0.0, max_people=3)
    assert [one.weight for one in few] == weights[:3]


def test_of_too_many_windows_the_surest_are_grouped():
    noise = np.random.default_rng(1).integers(0, 256, (240, 320)).astype(np.uint8)
    texture = cv2.equalizeHist(cv2.GaussianBlur(noise, (0, 0), 3.0))
    image = cv2.cvtColor(texture, cv2.COLOR_GRAY2BGR)
    values = {"model": "daimler", "scale": 1.02}
    hits = opencv_detects(image, hit=-1.0, stride=4, group=0.0, **values)
    assert len(hits) > 1500
    expected = opencv_detects(image, hit=hits[999][1], stride=4, group=1.0, **values)
    values.update(win_stride=4, group_threshold=1.0, max_people=1000)
    found = detect(image, hit_threshold=-1.0, **values)
    boxes = sorted(clipped(box, (320, 240)) for box, _ in expected)
    assert found and sorted(one.box for one in found) == boxes
    assert [one.weight for one in found] == pytest.approx([weight for _, weight in expected])


@pytest.mark.parametrize(
    "size, max_width", [((1280, 400), 400), ((320, 400), 64)], ids=["panorama", "small max_width"]
)
def test_no_image_is_shrunk_below_one_and_a_half_windows(size, max_width):
    image = street(size, [(80, 100, 140, 280)])
    small = round(size[0] * 192 / size[1]), 192
    shrunk = cv2.resize(image, small, interpolation=cv2.INTER_AREA)
    ((expected, weight),) = opencv_detects(shrunk)
    (found,) = detect(image, max_width=max_width)
    assert found.weight == pytest.approx(weight) and found.weight > 1.0
    assert found.box == pytest.approx([side * size[1] / 192 for side in expected], abs=2)


@pytest.mark.parametrize("model", ["default", "daimler"])
@pytest.mark.parametrize("seed", range(2))
def test_nobody_is_in_noise(model, seed):
    random = np.random.default_rng(seed)
    assert not detect(random.integers(0, 256, (200, 260, 3)).astype(np.uint8), model=model)
    assert not detect(street(SIZE, []), model=model)


@pytest.mark.parametrize("size", [(1, 1), (1, 500), (127, 63), (128, 63), (127, 64)])
def test_an_image_smaller_than_the_window_has_nobody(size):
    assert not detect(np.zeros((*size, 3), np.uint8))
    assert not detect(np.full((*size, 3), 255, np.uint8), padding=64)


def test_every_encoding_is_taken():
    detector = rv.PeopleDetector()
    expected = [one.box for one in detector.detect(STREET)]
    assert len(expected) == len(BOXES)
    image = STREET.copy()
    image.setflags(write=False)
    padded = np.zeros((SIZE[1], SIZE[0] + 5, 3), np.uint8)
    padded[:, :-5] = STREET
    assert [one.box for one in detector.detect(padded[:, :-5])] == expected
    assert [one.box for one in detector.detect(image[..., ::-1].copy(), "rgb8")] == expected
    deep = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).astype(np.uint16) * 257
    assert len(detector.detect(deep, "mono16")) == len(BOXES)
    with pytest.raises(ValueError, match="mono8"):
        detector.detect(image, "mono8")


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("model", "cat", "model is cat, must be default or daimler"),
        ("win_stride", 0, "win_stride is 0, must be from 4 to 64"),
        ("scale", 1.0, "scale is 1, must be from 1.01 to 2"),
        ("max_people", 0, "max_people is 0, must be from 1 to 1000"),
    ],
)
def test_parameters_out_of_range_are_refused(name, value, text):
    with pytest.raises(ValueError, match=text):
        rv.PeopleDetector(params(**{name: value}))
