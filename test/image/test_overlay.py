"""Drawing from Python changes the array in place, or is refused. The gtests test what is drawn."""

import numpy as np
import pytest

import robot_vision as rv

SQUARE = [(10, 10), (30, 10), (30, 30), (10, 30)]
DRAW = {
    "outline": lambda image: rv.draw_outline(image, SQUARE, "ball", (255, 0, 0)),
    "ball": lambda image: rv.draw_ball(image, (20.5, 20.0), 9.0),
    "prediction": lambda image: rv.draw_ball(image, (20.5, 20.0), 9.0, predicted=True),
    "text": lambda image: rv.draw_text(image, "ball", (5, 20)),
    "trail": lambda image: rv.draw_trail(image, [(5, 5), (20, 20), (30, 5)]),
}


@pytest.fixture(params=DRAW.values(), ids=list(DRAW))
def draw(request):
    return request.param


def test_drawing_changes_the_array_itself(draw):
    whole = np.zeros((60, 80, 3), np.uint8)
    expected = np.zeros((40, 50, 3), np.uint8)
    draw(expected)
    draw(whole[10:50, 20:70])  # its rows are not adjacent in memory
    assert expected.any()
    assert np.array_equal(whole[10:50, 20:70], expected)
    assert whole.any(axis=2).sum() == expected.any(axis=2).sum()


@pytest.mark.parametrize(
    "points, error, match",
    [
        (np.full((4, 2), 1.5), TypeError, "expected points of whole pixels, got float64"),
        (
            [(1, 2), (3, 2**40)],
            ValueError,
            r"expected points in an image, got \(3, 1099511627776\)",
        ),
        (np.array([(2**63, 5)], np.uint64), ValueError, "expected points in an image"),
        (np.array([(5, -(2**63))]), ValueError, "expected points in an image"),
        ([1, 2, 3], ValueError, r"expected an \(n, 2\) array of points"),
    ],
)
def test_invalid_outline_is_refused(points, error, match):
    with pytest.raises(error, match=match):
        rv.draw_outline(np.zeros((8, 8, 3), np.uint8), points)


def test_array_that_cannot_be_drawn_on_is_refused(draw):
    shown = np.zeros((40, 50, 3), np.uint8)
    shown.setflags(write=False)
    for wrong in (shown, np.zeros((40, 100, 3), np.uint8)[:, ::2], np.zeros((40, 50), np.uint8)):
        with pytest.raises(ValueError):
            draw(wrong)
        assert not wrong.any()


def test_array_without_pixels_cannot_be_drawn_on(draw):
    with pytest.raises(ValueError, match="cannot draw on an array without pixels"):
        draw(np.zeros((0, 0, 3), np.uint8))


def test_empty_trail_and_outline_draw_nothing():
    image = np.zeros((40, 50, 3), np.uint8)
    rv.draw_trail(image, [])
    rv.draw_outline(image, np.zeros((0, 2), int))
    assert not image.any()
    with pytest.raises(ValueError):
        rv.draw_trail(image, [(1, 2, 3)])


def test_masking_keeps_the_pixels_in_the_mask():
    random = np.random.RandomState(1)
    image = random.randint(0, 256, (48, 64, 3), np.uint8)
    mask = random.randint(0, 2, (48, 64), np.uint8) * 255
    before = image.copy(), mask.copy()
    assert np.array_equal(rv.mask_picture(image, mask), image * (mask[:, :, None] > 0))
    assert np.array_equal(image, before[0]) and np.array_equal(mask, before[1])
    with pytest.raises(ValueError):
        rv.mask_picture(image, mask[:40])
