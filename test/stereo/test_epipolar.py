"""Epipolar lines of pairs whose geometry is known."""

import cv2
import numpy as np
import pytest
import stereo_images
from stereo_images import HEIGHT, WIDTH, Plane

import robot_vision as rv

FOCAL = 300.0  # px
K = np.float64([[FOCAL, 0, WIDTH / 2], [0, FOCAL, HEIGHT / 2], [0, 0, 1]])
TURN = cv2.Rodrigues(np.float64([0.02, -0.1, 0.05]))[0]
MOVE = np.float64([-0.3, 0.05, 0.04])  # m
GREEN, RED = (0, 255, 0), (0, 0, 255)  # BGR


def cross(t):
    return np.float64([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]])


TRUE = np.linalg.inv(K).T @ cross(MOVE) @ TURN @ np.linalg.inv(K)


def seen_points(count=80):
    """Points of a room as both cameras see them, px."""
    rng = np.random.default_rng(3)
    points = rng.uniform((-0.6, -0.4, 1.5), (0.6, 0.4, 4.0), (count, 3))
    left, right = points @ K.T, (points @ TURN.T + MOVE) @ K.T
    return left[:, :2] / left[:, 2:], right[:, :2] / right[:, 2:]


def same_up_to_scale(a, b):
    a, b = (of / np.linalg.norm(of) for of in (a, b))
    return min(np.abs(a - b).max(), np.abs(a + b).max())


def bgr(images):
    return [cv2.cvtColor(image, cv2.COLOR_GRAY2BGR) for image in images]


def test_rows_are_the_lines_of_rectified_images():
    rows = rv.rectified_fundamental()
    line = rows @ (30.0, 40.0, 1.0)
    for x in (0.0, 99.0):
        assert line @ (x, 40.0, 1.0) == 0.0
    left, right = np.float32([[5, 6], [7, 8]]), np.float32([[1, 6.25], [0, 5]])
    assert rv.epipolar_distances(left, right, rows) == [0.25, 3.0]


def test_the_fundamental_matrix_of_exact_points_is_the_true_one():
    left, right = seen_points()
    found, inliers = rv.find_fundamental(left, right)
    assert inliers.all()
    assert same_up_to_scale(found, TRUE) < 1e-3
    assert max(rv.epipolar_distances(left, right, TRUE)) < 1e-2  # of float32
    assert max(rv.epipolar_distances(left, right, found)) < 0.1


def test_matches_that_are_wrong_do_not_agree():
    left, right = seen_points()
    right[::5, 1] += 25.0
    found, inliers = rv.find_fundamental(left, right)
    assert not inliers[::5].any()
    assert inliers[np.arange(len(left)) % 5 > 0].mean() > 0.95
    assert np.median(rv.epipolar_distances(left, right, found)) < 0.5


def test_few_or_random_points_have_no_fundamental_matrix():
    left, right = seen_points(14)
    assert rv.find_fundamental(left, right) is None
    nothing = np.empty((0, 2))
    assert rv.find_fundamental(nothing, nothing) is None
    assert rv.epipolar_distances(nothing, nothing, TRUE) == []
    with pytest.raises(ValueError, match=r"expected two \(n, 2\) arrays of points"):
        rv.find_fundamental(left, right[1:])


def test_distances_from_lines_of_nothing():
    left, right = seen_points(3)
    unknown = np.full((3, 3), np.nan)
    assert np.isnan(rv.epipolar_distances(left, right, unknown)).all()
    assert rv.epipolar_distances(left, right, np.zeros((3, 3))) == [0.0] * 3  # epipoles


def test_what_is_matched_is_the_same_thing():
    left, right = stereo_images.pair_of(Plane(10.0))
    from_left, from_right = rv.match_pair(left, right, "mono8", 300)
    assert len(from_left) == len(from_right) > 30
    off = from_left - from_right - (10.0, 0.0)
    assert (np.hypot(*off.T) < 1.5).mean() > 0.9


def near(image, color):
    """How many pixels are of a color that lines are drawn in, which are blended at their edges."""
    return (np.abs(image.astype(int) - color).max(axis=2) < 60).sum()


def test_rows_and_green_matches_are_drawn_on_a_rectified_pair():
    left, right = bgr(stereo_images.pair_of(Plane(10.0)))
    copies = left.copy(), right.copy()
    params = rv.EpipolarParams()
    params.epipolar_lines = 4
    drawn = rv.draw_rectified_pair(left, right, params)
    assert drawn.shape == (HEIGHT, 2 * WIDTH, 3)
    assert np.array_equal(left, copies[0]) and np.array_equal(right, copies[1])
    rows = [(drawn[y] == (200, 160, 0)).all(axis=1).mean() for y in range(HEIGHT - 30)]
    assert [y for y, share in enumerate(rows) if share > 0.5] == [15, 45, 75]
    params.epipolar_lines = 0
    drawn = rv.draw_rectified_pair(left, right, params)[: HEIGHT - 30]  # without what is written
    assert near(drawn, GREEN) > 10 * near(drawn, RED)
    crooked = np.roll(right, 5, axis=0)
    drawn = rv.draw_rectified_pair(left, crooked, params)[: HEIGHT - 30]
    assert near(drawn, RED) > 10 * near(drawn, GREEN)


def test_images_without_features_are_drawn_too():
    plain = np.full((HEIGHT, WIDTH, 3), 90, np.uint8)
    params = rv.EpipolarParams()
    params.epipolar_lines = 0
    for draw in (rv.draw_rectified_pair, rv.draw_epipolar_lines):
        drawn = draw(plain, plain, params)
        assert np.array_equal(drawn[: HEIGHT - 30], np.hstack([plain, plain])[: HEIGHT - 30])
        assert (drawn != 90).any()  # it is written that there are none
    tiny = np.zeros((1, 1, 3), np.uint8)
    assert rv.draw_epipolar_lines(tiny, tiny).shape == (1, 2, 3)


def test_lines_are_drawn_where_things_of_two_depths_are():
    """Of cameras that look in parallel the epipolar lines are rows, nearly."""
    far, near_by = stereo_images.pair_of(Plane(6.0)), stereo_images.pair_of(Plane(18.0))
    left, right = bgr([np.vstack([a[:60], b[60:]]) for a, b in zip(far, near_by)])
    params = rv.EpipolarParams()
    params.epipolar_lines = 8
    drawn = rv.draw_epipolar_lines(left, right, params)
    assert drawn.shape == (HEIGHT, 2 * WIDTH, 3)
    changed = (drawn != np.hstack([left, right])).any(axis=2)[: HEIGHT - 30]
    for half in (changed[:, :WIDTH], changed[:, WIDTH:]):
        assert 0.05 < half.mean() < 0.5
        for column in (0, WIDTH // 2, WIDTH - 1):  # lines go from side to side
            assert half[:, column].sum() >= 8


def test_images_of_two_sizes_stand_beside_each_other():
    left, right = bgr(stereo_images.pair_of(Plane(6.0)))
    params = rv.EpipolarParams()
    params.epipolar_lines = 0
    drawn = rv.draw_epipolar_lines(left, right[:80, :150], params)
    assert drawn.shape == (HEIGHT, WIDTH + 150, 3)
    assert np.array_equal(drawn[:70, :WIDTH], left[:70])
    assert np.array_equal(drawn[:70, WIDTH:], right[:70, :150])
    assert not drawn[80 : HEIGHT - 30, WIDTH:].any()
    with pytest.raises(ValueError, match="the right image's size is 150x80, must be 200x120"):
        rv.draw_rectified_pair(left, right[:80, :150], params)
    with pytest.raises(ValueError):
        rv.draw_epipolar_lines(left[:, :, 0], right)
    params.epipolar_lines = 999
    with pytest.raises(ValueError, match="epipolar_lines is 999, must be from 0 to 200"):
        rv.draw_epipolar_lines(left, right, params)
