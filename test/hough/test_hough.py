"""Lines, segments and circles: drawn ones, those of the scene, and those that cv2 finds."""

import math

import cv2
import numpy as np
import pytest

import robot_vision as rv

SCENE = rv.Scene(rv.SceneParams())
FRAME = 60  # of the scene
IMAGE = SCENE.render(FRAME)
HAS_ALT = hasattr(cv2, "HOUGH_GRADIENT_ALT")
NEEDS_ALT = pytest.mark.skipif(not HAS_ALT, reason="OpenCV 4.3 and later have HOUGH_GRADIENT_ALT")


def params(**values):
    made = rv.HoughParams()
    for name, value in values.items():
        assert hasattr(made, name), name
        setattr(made, name, value)
    return made


def found(image, **values):
    return rv.HoughTransform(params(**values)).apply(image, "bgr8" if image.ndim == 3 else "mono8")


def half_plane(rho, theta, size=(150, 200)):
    """White where x cos(theta) + y sin(theta) > rho, with a smooth edge; theta in degrees."""
    y, x = np.mgrid[: size[0], : size[1]]
    angle = math.radians(theta)
    distance = x * math.cos(angle) + y * math.sin(angle) - rho
    return (np.clip(distance + 0.5, 0.0, 1.0) * 255).astype(np.uint8)


def disc(x, y, radius, size=(160, 220)):
    """White within a circle, with a smooth edge."""
    rows, columns = np.mgrid[: size[0], : size[1]]
    distance = radius - np.hypot(columns - x, rows - y)
    return (np.clip(distance + 0.5, 0.0, 1.0) * 255).astype(np.uint8)


def distance_to_line(point, rho, theta):
    angle = math.radians(theta)
    return abs(point[0] * math.cos(angle) + point[1] * math.sin(angle) - rho)


# ---- lines


@pytest.mark.parametrize(
    "rho, theta",
    [(70.0, 0.0), (60.3, 20.0), (110.0, 45.0), (75.5, 90.0), (5.0, 135.0), (-90.0, 170.0)],
)
def test_a_line_is_found_within_the_bins(rho, theta):
    (line, *_) = found(half_plane(rho, theta), threshold=60).lines
    for end in (line.begin, line.end):
        assert distance_to_line(end, rho, theta) < 2.0  # px: half a bin of both, and the edge
        assert 0 <= end[0] <= 199 and 0 <= end[1] <= 149
        assert min(end[0], 199 - end[0], end[1], 149 - end[1]) < 0.02  # it reaches the border
    turned = (math.degrees(line.theta) - theta + 90.0) % 180.0 - 90.0
    assert abs(turned) <= 1.01
    assert 0.0 <= line.theta < math.pi and line.score == 1.0
    normal = math.cos(line.theta), math.sin(line.theta)
    for end in (line.begin, line.end):
        assert np.dot(end, normal) == pytest.approx(line.rho, abs=0.05)


def votes_of(edges, line):
    """The edge pixels in the cell of a line, by another way than OpenCV's table."""
    y, x = np.nonzero(edges)
    return (np.rint(x * math.cos(line.theta) + y * math.sin(line.theta)) == line.rho).sum()


def test_scores_are_shares_of_the_votes_of_the_strongest_line():
    result = found(IMAGE, threshold=80)
    strongest = votes_of(result.edges, result.lines[0])
    assert len(result.lines) == 50  # max_results
    for line in result.lines:
        assert line.votes == pytest.approx(votes_of(result.edges, line), abs=2)
        assert line.score == pytest.approx(line.votes / strongest, abs=0.01)
    assert [line.votes for line in result.lines] == sorted(
        (line.votes for line in result.lines), reverse=True
    )


def test_lines_of_cells_that_lie_beside_the_image_end_within_it():
    """Cells of 7 px are so coarse that those of edges along the border are 3.5 px outside."""
    image = np.zeros((60, 80), np.uint8)
    image[1:-1, 1:-1] = 255
    result = found(image, rho=7.0, theta=15.0, threshold=20, blur="none")
    assert len(result.lines) == len(cv2.HoughLines(result.edges, 7.0, math.radians(15.0), 20))
    (left,) = (line for line in result.lines if (line.rho, line.theta) == (-3.5, 0.0))
    assert sorted([left.begin, left.end]) == [(0.0, 0.0), (0.0, 59.0)]
    for line in result.lines:
        for x, y in (line.begin, line.end):
            assert 0.0 <= x <= 79.0 and 0.0 <= y <= 59.0


# ---- against OpenCV


def smoothed(image, blur="gaussian", blur_size=5):
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    if blur == "gaussian":
        return cv2.GaussianBlur(gray, (blur_size, blur_size), 0)
    return cv2.medianBlur(gray, blur_size) if blur == "median" else gray


def lines_by_cv2(image, rho=1.0, theta=1.0, threshold=100, canny=(50, 150), **blur):
    edges = cv2.Canny(smoothed(image, **blur), *canny)
    return edges, cv2.HoughLines(edges, rho, math.radians(theta), threshold)


def as_cv2(values):
    """Our parameters as those of the functions here."""
    canny = values.pop("canny_low", 50.0), values.pop("canny_high", 150.0)
    return {**values, "canny": canny}


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"blur": "none"},
        {"blur": "median", "blur_size": 7},
        {"blur_size": 9},
        {"canny_low": 20.0},
        {"canny_high": 300.0},
        {"rho": 2.0},
        {"theta": 3.0},
        {"threshold": 140},
    ],
)
def test_lines_are_those_of_cv2(values):
    edges, expected = lines_by_cv2(IMAGE, **as_cv2(dict(values)))
    result = found(IMAGE, max_results=1000, **values)
    assert np.array_equal(result.edges, edges)
    polar = np.array([(line.rho, line.theta) for line in result.lines])
    assert np.allclose(polar, expected[:1000, 0], atol=1e-6) and len(polar) >= 1
    if values:
        default = [(line.rho, line.theta) for line in found(IMAGE, max_results=1000).lines]
        assert len(default) != len(polar) or not np.array_equal(default, polar)


def ends_of(lines):
    return [(*line.begin, *line.end) for line in lines]


@pytest.mark.parametrize(
    "values",
    [{}, {"threshold": 30}, {"rho": 3.0}, {"theta": 5.0}, {"min_length": 20.0}, {"max_gap": 2.0}],
)
def test_segments_are_those_of_cv2_the_longest_first(values):
    edges = cv2.Canny(smoothed(IMAGE), 50, 150)
    used = {"rho": 1.0, "theta": 1.0, "threshold": 100, "min_length": 50.0, "max_gap": 10.0}
    used.update(values)
    expected = cv2.HoughLinesP(
        edges,
        used["rho"],
        math.radians(used["theta"]),
        used["threshold"],
        minLineLength=used["min_length"],
        maxLineGap=used["max_gap"],
    )[:, 0]
    lengths = np.hypot(*(expected[:, 2:] - expected[:, :2]).T)
    order = np.argsort(-lengths, kind="stable")
    segments = found(IMAGE, method="segments", max_results=1000, **values).lines
    assert ends_of(segments) == [tuple(ends) for ends in expected[order]]
    scores = [segment.score for segment in segments]
    assert np.allclose(scores, lengths[order] / lengths.max())
    if values:
        assert ends_of(segments) != ends_of(found(IMAGE, method="segments", max_results=1000).lines)


def circles_by_cv2(gray, method, dp, min_distance, canny_high, criterion, radii):
    found = cv2.HoughCircles(
        gray,
        method,
        dp,
        min_distance,
        param1=canny_high,
        param2=criterion,
        minRadius=radii[0],
        maxRadius=radii[1],
    )
    return np.zeros((0, 3)) if found is None else found[0][:, :3]


GRADIENT = {
    "dp": 1.0,
    "min_distance": 20.0,
    "canny_high": 150.0,
    "accumulator_threshold": 30,
    "min_radius": 20,
    "max_radius": 70,
}


def circle_rows(result):
    return np.array([(*circle.center, circle.radius) for circle in result.circles]).reshape(-1, 3)


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"dp": 2.0},
        {"min_distance": 90.0},
        {"canny_high": 260.0},
        {"accumulator_threshold": 36},
        {"min_radius": 40},
        {"max_radius": 50},
    ],
)
def test_circles_are_those_of_cv2(changed):
    used = {**GRADIENT, **changed}
    dp, distance, canny, votes, *radii = used.values()
    expected = circles_by_cv2(
        smoothed(IMAGE), cv2.HOUGH_GRADIENT, dp, distance, canny, votes, radii
    )
    result = found(IMAGE, method="circles", max_results=1000, **used)
    assert np.array_equal(circle_rows(result), expected) and len(expected) >= 1
    low = int(canny) // 2
    assert np.array_equal(result.edges, cv2.Canny(smoothed(IMAGE), low, canny))
    votes = [circle.votes for circle in result.circles]
    assert min(votes) > used["accumulator_threshold"]
    assert np.allclose([circle.score for circle in result.circles], np.array(votes) / votes[0])
    if changed:
        default = found(IMAGE, method="circles", max_results=1000, **GRADIENT)
        assert not np.array_equal(circle_rows(default), expected)


@NEEDS_ALT
@pytest.mark.parametrize(
    "changed", [{}, {"perfectness": 0.5}, {"canny_high": 600.0}, {"dp": 3.0}, {"max_radius": 40}]
)
def test_circles_of_the_alternative_are_those_of_cv2(changed):
    used = {"dp": 1.5, "canny_high": 300.0, "perfectness": 0.9, "max_radius": 100, **changed}
    radii = 10, used["max_radius"]
    smooth = smoothed(IMAGE)
    method = cv2.HOUGH_GRADIENT_ALT if HAS_ALT else None
    expected = circles_by_cv2(
        smooth, method, used["dp"], 20, used["canny_high"], used["perfectness"], radii
    )
    result = found(IMAGE, method="circles", circle_method="gradient_alt", **used)
    assert np.array_equal(circle_rows(result), expected)
    scharr = [cv2.Scharr(smooth, cv2.CV_16S, *direction) for direction in ((1, 0), (0, 1))]
    high = used["canny_high"]
    assert np.array_equal(result.edges, cv2.Canny(*scharr, high / 2, high, L2gradient=True))
    if changed:
        default = {**used, "dp": 1.5, "canny_high": 300.0, "perfectness": 0.9, "max_radius": 100}
        before = found(IMAGE, method="circles", circle_method="gradient_alt", **default)
        assert not np.array_equal(circle_rows(before), expected)


# ---- segments and circles of known places


def test_segments_end_where_they_were_drawn():
    drawn = [((20, 30), (150, 30)), ((40, 60), (170, 130)), ((15, 60), (15, 140))]
    image = np.zeros((160, 200), np.uint8)
    for begin, end in drawn:
        cv2.line(image, begin, end, 255, 3)
    segments = found(image, method="segments", threshold=40, min_length=60.0, max_gap=6.0).lines
    assert len(segments) >= len(drawn)
    for ends in drawn:  # the edges run around a line, 2 px beside its middle
        best = min(
            max(math.dist(a, b) for a, b in zip(pair, ends))
            for segment in segments
            for pair in ((segment.begin, segment.end), (segment.end, segment.begin))
        )
        assert best <= 4.0
    for segment in segments:
        begin, end = map(np.array, (segment.begin, segment.end))
        normal = math.cos(segment.theta), math.sin(segment.theta)
        assert begin @ normal == pytest.approx(segment.rho, abs=1e-6)
        assert end @ normal == pytest.approx(segment.rho, abs=1e-6)
        assert 0.0 <= segment.theta <= math.pi and segment.votes == 0


def test_an_edge_s_segment_ends_within_two_pixels():
    image = np.zeros((120, 160), np.uint8)
    image[40:, 20:131] = 255  # its upper edge is between rows 39 and 40
    (segment, *_) = found(
        image, method="segments", blur="none", threshold=50, min_length=90.0
    ).lines
    (x1, y1), (x2, y2) = sorted([segment.begin, segment.end])
    assert abs(x1 - 20) <= 2 and abs(x2 - 130) <= 2 and abs(y1 - 39.5) <= 1 and abs(y2 - 39.5) <= 1


@pytest.mark.parametrize("method", ["gradient", pytest.param("gradient_alt", marks=NEEDS_ALT)])
@pytest.mark.parametrize("circle", [(100.0, 80.0, 40.0), (61.5, 77.25, 25.5), (150.2, 90.7, 55.3)])
def test_a_disc_is_found_within_a_pixel(method, circle):
    values = {"canny_high": 300.0, "dp": 1.5} if method == "gradient_alt" else {}
    result = found(disc(*circle), method="circles", circle_method=method, **values)
    (one, *_) = result.circles
    assert math.dist(one.center, circle[:2]) <= 1.0
    assert abs(one.radius - circle[2]) <= 1.0
    assert one.score == 1.0


@NEEDS_ALT
@pytest.mark.parametrize("frame", [60, 100, 200])
def test_the_ball_of_the_scene_is_found(frame):
    ball = next(one for one in SCENE.truth(frame).objects if one.name == "ball")
    center, radius = cv2.minEnclosingCircle(np.float32(ball.outline))
    result = found(
        SCENE.render(frame),
        method="circles",
        circle_method="gradient_alt",
        canny_high=300.0,
        dp=1.5,
        perfectness=0.8,
    )
    near = [one for one in result.circles if math.dist(one.center, center) <= 4.0]
    assert len(near) == 1 and len(result.circles) <= 6
    assert abs(near[0].radius - radius) <= 2.0


def test_the_ball_is_among_the_circles_of_the_gradient():
    ball = next(one for one in SCENE.truth(FRAME).objects if one.name == "ball")
    center, radius = cv2.minEnclosingCircle(np.float32(ball.outline))
    result = found(IMAGE, method="circles", accumulator_threshold=30, min_radius=25, max_radius=40)
    (best, *_) = sorted(result.circles, key=lambda one: math.dist(one.center, center))
    assert math.dist(best.center, center) <= 2.0 and abs(best.radius - radius) <= 2.0


# ---- the same from run to run, bounded, and refused


@pytest.mark.parametrize("method", ["lines", "segments", "circles"])
def test_results_are_the_same_whatever_random_numbers_were_drawn(method):
    transform = rv.HoughTransform(params(method=method, accumulator_threshold=30))
    results = []
    for seed in (1, 2, 3):
        cv2.setRNGSeed(seed)
        result = transform.apply(IMAGE)
        results.append((ends_of(result.lines), circle_rows(result).tolist()))
    assert results[0] == results[1] == results[2] and any(results[0])


@pytest.mark.parametrize("method", ["lines", "segments", "circles"])
def test_there_are_no_more_results_than_asked_for(method):
    values = {"method": method, "threshold": 30, "accumulator_threshold": 25, "min_length": 10.0}
    all_of_them = found(IMAGE, max_results=1000, **values)
    few = found(IMAGE, max_results=5, **values)
    assert len(few.lines) + len(few.circles) == 5
    assert len(all_of_them.lines) + len(all_of_them.circles) > 15
    assert ends_of(few.lines) == ends_of(all_of_them.lines)[:5]
    assert np.array_equal(circle_rows(few), circle_rows(all_of_them)[:5])


def test_circles_are_not_looked_for_in_noise():
    noise = np.random.default_rng(1).integers(0, 256, (160, 220), np.uint8)
    result = found(noise, method="circles", blur="none")
    assert result.too_many_edges and not result.circles
    assert (result.edges > 0).mean() > 0.2
    few = found(noise, method="circles", blur="none", accumulator_threshold=1000)
    assert not few.too_many_edges
    assert not found(IMAGE, method="circles").too_many_edges
    assert not found(noise, method="lines", blur="none").too_many_edges


@NEEDS_ALT
def test_circles_of_the_alternative_are_not_looked_for_in_so_many_edges_that_it_takes_seconds():
    noise = np.random.default_rng(1).integers(0, 256, (360, 480), np.uint8)
    values = {"method": "circles", "circle_method": "gradient_alt", "canny_high": 300.0}
    larger = np.random.default_rng(1).integers(0, 256, (600, 800), np.uint8)
    close = found(larger, min_distance=1.0, **values)
    assert close.too_many_edges and not close.circles
    assert (close.edges > 0).mean() > 0.2
    assert not found(noise, **values).too_many_edges
    assert found(disc(110.0, 80.0, 40.0), min_distance=1.0, **values).circles
    rows = np.zeros((1440, 2560), np.uint8)
    rows[::16] = 255  # An eighth of the pixels are edges: no image of a camera has more.
    assert not found(rows, **values).too_many_edges


def test_radius_0_is_that_of_the_image():
    image = disc(110.0, 80.0, 75.0)
    assert not found(image, method="circles", max_radius=60).circles
    (circle, *_) = found(image, method="circles", max_radius=0).circles
    assert abs(circle.radius - 75.0) <= 1.0


def test_edges_are_left_out_when_nobody_asks_for_them():
    for method in ("lines", "segments", "circles"):
        result = rv.HoughTransform(params(method=method)).apply(IMAGE, with_edges=False)
        assert result.edges.size == 0


@pytest.mark.parametrize(
    "values, text",
    [
        ({"method": "ellipses"}, "method is ellipses, must be lines, segments or circles"),
        ({"blur": "box"}, "blur is box, must be none, gaussian or median"),
        ({"blur_size": 4}, "blur_size is 4, must be odd and from 3 to 31"),
        ({"theta": 0.0}, "theta is 0, must be from 0.05 to 45"),
        ({"canny_low": 200.0}, "canny_high is 150, must be at least canny_low, 200"),
        ({"max_radius": 10}, "max_radius is 10, must be 0 or above min_radius, 10"),
        ({"circle_method": "alt"}, "circle_method is alt, must be gradient or gradient_alt"),
    ],
)
def test_what_cannot_be_is_refused_in_words(values, text):
    with pytest.raises(ValueError, match=f"^{text}$"):
        rv.HoughTransform(params(**values))


def test_circles_need_no_canny_low():
    result = rv.HoughTransform(params(method="circles", canny_low=200.0)).apply(IMAGE)
    assert np.array_equal(
        result.edges, rv.HoughTransform(params(method="circles")).apply(IMAGE).edges
    )


@pytest.mark.skipif(HAS_ALT, reason="this OpenCV has HOUGH_GRADIENT_ALT")
def test_the_alternative_is_refused_where_opencv_does_not_have_it():
    with pytest.raises(ValueError, match="circle_method is gradient_alt, must be gradient: "):
        rv.HoughTransform(params(circle_method="gradient_alt"))


@pytest.mark.parametrize("method", ["lines", "segments"])
def test_an_accumulator_that_is_too_large_is_refused_before_it_is_made(method):
    transform = rv.HoughTransform(params(method=method, rho=0.25, theta=0.05))
    with pytest.raises(
        ValueError, match=r"^rho is 0\.25, must be larger, or theta, 0\.05: the accumulator of an"
    ):
        transform.apply(np.zeros((1000, 1000), np.uint8), "mono8")
    assert not transform.apply(np.zeros((100, 100), np.uint8), "mono8").lines


@pytest.mark.parametrize("method", ["lines", "segments"])
def test_so_many_edges_that_they_vote_for_seconds_are_refused(method):
    noise = np.random.default_rng(1).integers(0, 256, (480, 640), np.uint8)
    text = (
        r"^theta is 0\.05, must be larger, or canny_high, 150: the \d+ edge pixels of an image of"
    )
    with pytest.raises(ValueError, match=f"{text} 640x480 would vote for many seconds$"):
        found(noise, method=method, theta=0.05)
    found(noise, method=method, threshold=10000)
    found(half_plane(320, 10, (480, 640)), method=method, theta=0.05)


@pytest.mark.parametrize("method", ["lines", "segments"])
@pytest.mark.parametrize("size", [(1, 90), (90, 1), (30, 90)])
def test_steps_that_are_too_coarse_for_opencv_are_refused(method, size):
    white = np.full(size, 255, np.uint8)
    transform = rv.HoughTransform(params(method=method, rho=10.5))
    with pytest.raises(
        ValueError, match=r"^rho is 10\.5, must be at most 1, or a third of the smaller"
    ):
        transform.apply(white, "mono8")
    rv.HoughTransform(params(method=method, rho=1.0, threshold=1)).apply(white, "mono8")


def test_an_image_of_another_encoding_is_refused():
    with pytest.raises(ValueError, match="mono8"):
        rv.HoughTransform().apply(IMAGE, "mono8")
