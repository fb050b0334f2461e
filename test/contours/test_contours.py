"""Contours of drawn shapes whose measures are known, and those that cv2 finds and measures."""

import math

import cv2
import numpy as np
import pytest

import robot_vision as rv

WHITE = {"method": "fixed", "blur_size": 1}  # of images that are black and white already
SCENE = rv.Scene(rv.SceneParams()).render(60)
STAR = (80.0, 30.0)  # px, from its middle to its points, and to the corners between them


def params(**values):
    made = rv.ContourParams()
    for name, value in values.items():
        assert hasattr(made, name), name
        setattr(made, name, value)
    return made


def contours_of(image, point=None, template=None, **values):
    finder = rv.ContourFinder(params(**{**WHITE, **values}), template)
    return finder.apply(image, "mono8" if image.ndim == 2 else "bgr8", point).contours


def only(image, **values):
    (contour,) = contours_of(image, **values)
    return contour


def canvas():
    return np.zeros((240, 320), np.uint8)


def polygon(points):
    image = canvas()
    cv2.fillPoly(image, [np.rint(points).astype(np.int32)], 255)
    return image


def regular(corners, radius=80.0, turn=0.3, center=(150.0, 120.0)):
    angles = turn + np.arange(corners) * 2.0 * np.pi / corners
    return np.column_stack([np.cos(angles), np.sin(angles)]) * radius + center


def star():
    """The corners of a star, its points first."""
    outer, inner = regular(5, STAR[0], 0.1), regular(5, STAR[1], 0.1 + np.pi / 5)
    return np.hstack([outer, inner]).reshape(-1, 2)


def turned_box(length, width, degrees, center=(150, 120)):
    return cv2.boxPoints((center, (length, width), degrees))


def ellipse(length, width, degrees, center=(150, 120)):
    """White within an ellipse of these axes, pixel by pixel."""
    y, x = np.mgrid[:240, :320] - np.reshape(center[::-1], (2, 1, 1))
    angle = math.radians(degrees)
    along = x * math.cos(angle) + y * math.sin(angle)
    across = y * math.cos(angle) - x * math.sin(angle)
    return (np.hypot(along / (length / 2), across / (width / 2)) <= 1.0).astype(np.uint8) * 255


def between_directions(a, b):
    """The angle between two directions, rad."""
    return abs(math.remainder(a - b, math.pi))


# ---- one shape


def test_a_box_is_measured():
    image = canvas()
    image[50:91, 100:201] = 255
    box = only(image)
    assert box.box == (100, 50, 101, 41) and box.center == (150.0, 70.0)
    assert box.area == 100 * 40 and box.length == 280.0
    assert box.convex and box.solidity == 1.0 and not box.defects
    assert (box.parent, box.depth, box.hole) == (-1, 0, False)
    corners = {(100, 50), (200, 50), (200, 90), (100, 90)}
    for points in (box.outline, box.approximation, box.hull):
        assert {tuple(point) for point in points.tolist()} == corners and len(points) == 4
    assert box.circle_center == pytest.approx((150, 70), abs=0.01)
    assert box.circle_radius == pytest.approx(math.hypot(50, 20), abs=0.01)
    rectangle = box.rectangle
    assert rectangle.center == pytest.approx((150, 70))
    assert (rectangle.length, rectangle.width) == pytest.approx((100, 40))
    assert rectangle.angle == pytest.approx(0.0, abs=1e-6) and box.ellipse is None
    assert box.shape == "rectangle" and box.match is None and not box.matches
    assert box.point_distance == 0.0


@pytest.mark.parametrize("degrees", [-80, -45, -10, 0, 30, 75, 90])
def test_a_turned_rectangle_s_sides_and_angle(degrees):
    contour = only(polygon(turned_box(140, 50, degrees)))
    rectangle = contour.rectangle
    assert rectangle.center == pytest.approx((150, 120), abs=1.0)
    assert (rectangle.length, rectangle.width) == pytest.approx((140, 50), abs=2.0)
    assert -math.pi / 2 < rectangle.angle <= math.pi / 2
    assert between_directions(rectangle.angle, math.radians(degrees)) < math.radians(1.0)
    assert between_directions(contour.line_angle, math.radians(degrees)) < math.radians(4.0)


@pytest.mark.parametrize("approximation", ["none", "simple"])
@pytest.mark.parametrize("degrees", [-60, 0, 30, 90])
def test_an_ellipse_s_axes_and_angle(degrees, approximation):
    contour = only(ellipse(160, 80, degrees), approximation=approximation)
    fitted = contour.ellipse
    assert fitted.center == pytest.approx((150, 120), abs=1.0)
    assert (fitted.length, fitted.width) == pytest.approx((160, 80), abs=2.0)
    assert -math.pi / 2 < fitted.angle <= math.pi / 2
    assert between_directions(fitted.angle, math.radians(degrees)) < math.radians(1.0)
    assert contour.area == pytest.approx(math.pi * 80 * 40, rel=0.03)
    assert contour.shape == "ellipse"


@pytest.mark.parametrize("degrees", [-70, -20, 0, 45, 90])
def test_the_line_of_a_long_shape_goes_along_it(degrees):
    contour = only(polygon(turned_box(180, 7, degrees)), approximation="none")
    angle = math.radians(degrees)
    assert between_directions(contour.line_angle, angle) < math.radians(0.7)
    assert -math.pi / 2 < contour.line_angle <= math.pi / 2
    away = np.subtract(contour.line_point, (150, 120)) @ (-math.sin(angle), math.cos(angle))
    assert abs(away) < 1.0


def test_the_hull_and_the_defects_of_a_star():
    contour = only(polygon(star()))
    points, between = star()[::2], star()[1::2]
    hull = cv2.contourArea(points.astype(np.float32))
    assert cv2.contourArea(contour.hull) == pytest.approx(hull, rel=0.02)
    assert contour.solidity == pytest.approx(contour.area / hull, rel=0.03) and not contour.convex
    depth = STAR[0] * math.cos(math.pi / 5) - STAR[1]
    assert len(contour.defects) == 5
    for defect in contour.defects:
        assert defect.depth == pytest.approx(depth, abs=1.5)
        assert np.hypot(*(between - defect.farthest).T).min() <= 1.5
        for end in (defect.start, defect.end):
            assert np.hypot(*(points - end).T).min() <= 3.0
    depths = [defect.depth for defect in contour.defects]
    assert depths == sorted(depths, reverse=True)
    assert contour.shape == "concave"


def test_defects_below_the_smallest_depth_are_left_out():
    image = canvas()
    image[50:200, 50:250] = 255
    image[50:80, 100:110] = 0  # notches of 30 and of 8 px
    image[120:130, 50:58] = 0
    depths = [[one.depth for one in only(image, min_defect=least).defects] for least in (5, 20)]
    assert depths[0] == pytest.approx([30, 8], abs=0.1) and depths[1] == pytest.approx(
        [30], abs=0.1
    )
    assert len(only(image, min_defect=100.0).defects) == 0


@pytest.mark.parametrize(
    "image, name",
    [
        (polygon(regular(3)), "triangle"),
        (polygon(regular(4)), "square"),
        (polygon(regular(4, 14.0)), "square"),
        (polygon(turned_box(120, 50, 25)), "rectangle"),
        (polygon([(60, 60), (200, 60), (240, 180), (40, 180)]), "quadrilateral"),
        (polygon(regular(5)), "pentagon"),
        (polygon(regular(6)), "hexagon"),
        (polygon(regular(40)), "circle"),
        (polygon(regular(40, 9.0)), "circle"),
        (ellipse(120, 60, 20), "ellipse"),
        (polygon(star()), "concave"),
        (polygon([(40, 40), (200, 120), (40, 200), (90, 120)]), "concave"),
    ],
)
def test_shapes_are_named(image, name):
    assert only(image).shape == name


def test_a_shape_of_many_corners_that_is_no_ellipse_is_a_polygon():
    image = polygon(regular(60, 100.0))
    image[:100] = 0  # the lower part of a disc is left
    assert only(image, epsilon=0.005).shape == "polygon"


def test_a_coarser_polygon_has_fewer_corners():
    image = polygon(regular(40))
    corners = [len(only(image, epsilon=share).approximation) for share in (0.0, 0.005, 0.02, 0.1)]
    assert corners == sorted(corners, reverse=True) and len(set(corners)) == 4
    assert only(image, epsilon=0.5).shape == "line"


# ---- several, and their hierarchy


def nested():
    """A box with a hole, in it a ring, in its hole a dot, and a second box."""
    image = canvas()
    image[10:230, 10:230] = 255
    image[30:210, 30:210] = 0
    cv2.circle(image, (120, 120), 70, 255, -1)
    cv2.circle(image, (120, 120), 40, 0, -1)
    cv2.circle(image, (120, 120), 12, 255, -1)
    image[100:140, 250:300] = 255
    return image


def places(contours):
    return [(one.parent, one.depth, one.hole) for one in contours]


def test_the_hierarchy_of_a_ring_in_a_ring_in_a_box():
    contours = contours_of(nested())
    assert places(contours) == [
        (-1, 0, False),  # the box, its hole, the ring, its hole, the second box, and the dot
        (0, 1, True),
        (1, 2, False),
        (2, 3, True),
        (-1, 0, False),
        (3, 4, False),
    ]
    assert [one.shape for one in contours[2:]] == ["circle", "circle", "rectangle", "circle"]
    assert [one.area for one in contours[:2]] == [219**2, 181**2 - 2]  # OpenCV cuts its corners


@pytest.mark.parametrize(
    "mode, expected",
    [
        ("external", [(-1, 0, False)] * 2),
        ("list", [(-1, 0, hole) for hole in (False, True, False, True, False, False)]),
        (
            "ccomp",
            [
                (-1, 0, False),
                (0, 1, True),
                (-1, 0, False),
                (2, 1, True),
                (-1, 0, False),
                (-1, 0, False),
            ],
        ),
    ],
)
def test_other_modes_know_less_of_the_hierarchy(mode, expected):
    assert places(contours_of(nested(), mode=mode)) == expected


def test_small_contours_and_those_beyond_the_number_are_left_out():
    assert len(contours_of(nested(), min_area=1000.0)) == 5
    largest = contours_of(nested(), max_contours=3)
    assert places(largest) == places(contours_of(nested()))[:3]


def test_noise_gives_no_more_than_asked_for_and_thin_parts_no_errors():
    noise = np.random.default_rng(1).integers(0, 2, (120, 160), np.uint8) * 255
    for approximation in ("none", "simple", "tc89_l1", "tc89_kcos"):
        for mode in ("list", "tree"):
            values = {"approximation": approximation, "mode": mode, "epsilon": 0.0}
            contours = contours_of(noise, min_area=0.0, min_defect=0.0, max_contours=500, **values)
            assert len(contours) == 500
            areas = [one.area for one in contours]
            assert areas == sorted(areas, reverse=True)


def test_a_line_of_one_pixel_has_no_area_but_a_direction():
    image = canvas()
    cv2.line(image, (50, 50), (150, 50), 255, 1)
    image[200, 200] = 255
    line, dot = sorted(contours_of(image, min_area=0.0), key=lambda one: -one.length)
    assert (line.area, line.length, line.center, line.shape) == (0.0, 200.0, (100.0, 50.0), "line")
    assert line.line_angle == 0.0 and line.rectangle.length == 100.0 and line.solidity == 0.0
    assert (dot.area, dot.center, dot.circle_radius) == (
        0.0,
        (200.0, 200.0),
        pytest.approx(0, abs=0.01),
    )
    assert not contours_of(image)


# ---- comparing


def letter(size, turns=0, mirrored=False):
    """An F-like shape, which looks like no other after turns."""
    image = np.zeros((400, 400), np.uint8)
    for x, y, width, height in ((0, 0, 2, 8), (2, 0, 4, 2), (2, 4, 2, 2)):
        left, top = (100 + size * x, 80 + size * y)
        image[top : top + size * height, left : left + size * width] = 255
    image = np.rot90(image, turns)
    return np.ascontiguousarray(image[:, ::-1] if mirrored else image)


def logarithms(hu):
    return np.array([math.copysign(math.log10(abs(one)), one) for one in hu])


@pytest.mark.parametrize("size, turns", [(12, 0), (25, 0), (16, 1), (16, 2), (20, 3)])
def test_hu_moments_are_the_same_in_any_size_and_turn(size, turns):
    expected, other = only(letter(16)).hu, only(polygon(star())).hu
    hu = only(letter(size, turns)).hu
    assert len(hu) == 7
    assert np.allclose(logarithms(hu)[:6], logarithms(expected)[:6], atol=0.12)
    assert not np.allclose(logarithms(other)[:6], logarithms(expected)[:6], atol=0.12)
    mirrored = only(letter(size, turns, mirrored=True)).hu
    assert np.sign(mirrored[6]) == -np.sign(hu[6])


def bgr(gray):
    return cv2.cvtColor(gray, cv2.COLOR_GRAY2BGR)


@pytest.mark.parametrize("match_method", ["I1", "I2", "I3"])
def test_the_template_s_shape_is_told_from_others(match_method):
    same, other = letter(20, 1), polygon(star())
    values = {"template": bgr(letter(12)), "match_method": match_method}
    method = getattr(cv2, f"CONTOURS_MATCH_{match_method}")
    (pattern, *_), _ = cv2.findContours(letter(12), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    found, wrong = only(same, **values), only(other, **values)
    for one in (found, wrong):
        assert one.match == pytest.approx(cv2.matchShapes(one.outline, pattern, method, 0.0))
    assert found.match < 0.1 < wrong.match and found.matches and not wrong.matches
    assert only(other, max_distance=wrong.match + 0.01, **values).matches
    assert not only(same, max_distance=found.match / 2.0, **values).matches


def test_the_template_is_the_largest_contour_of_its_image_as_the_parameters_show_it():
    image = letter(12)
    image[300:310, 300:310] = 255  # beside it
    dark = 255 - image
    assert only(letter(20), template=bgr(image)).matches
    dark_letter = 255 - letter(20)
    found = contours_of(dark_letter, template=bgr(dark), invert=True)
    assert [one.matches for one in found] == [True]


def test_a_contour_without_area_cannot_be_compared():
    image = canvas()
    cv2.line(image, (50, 50), (150, 50), 255, 1)
    line = only(image, min_area=0.0, template=bgr(letter(12)))
    assert line.match == math.inf and not line.matches


@pytest.mark.parametrize("invert", [False, True])
def test_a_template_that_shows_nothing_is_refused(invert):
    empty = np.full((20, 20, 3), 255 * invert, np.uint8)
    with pytest.raises(ValueError, match="the template has no contour with an area, must show"):
        rv.ContourFinder(params(**WHITE, invert=invert), empty)


@pytest.mark.parametrize(
    "point, distances",
    [
        ((60.0, 100.0), (10.0, -110.0)),
        ((30.0, 100.0), (-20.0, -140.0)),
        ((170.0, 60.0), (-20, 0.0)),
    ],
)
def test_distances_from_a_point_are_positive_inside(point, distances):
    image = canvas()
    image[20:201, 50:151] = 255
    image[60:161, 170:251] = 255
    assert [one.point_distance for one in contours_of(image, point)] == pytest.approx(distances)


# ---- against OpenCV


def gray_of(image, blur_size=5):
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    return cv2.GaussianBlur(gray, (blur_size, blur_size), 0) if blur_size > 1 else gray


MASKS = [
    ({"method": "fixed"}, lambda g: cv2.threshold(g, 128, 255, cv2.THRESH_BINARY)[1]),
    (
        {"method": "fixed", "threshold": 77.0},
        lambda g: cv2.threshold(g, 77, 255, cv2.THRESH_BINARY)[1],
    ),
    (
        {"method": "otsu"},
        lambda g: cv2.threshold(g, 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)[1],
    ),
    (
        {"method": "adaptive_mean"},
        lambda g: cv2.adaptiveThreshold(g, 255, cv2.ADAPTIVE_THRESH_MEAN_C, 0, 51, 5),
    ),
    (
        {"method": "adaptive_gaussian", "block_size": 11, "offset": -3.5},
        lambda g: cv2.adaptiveThreshold(g, 255, cv2.ADAPTIVE_THRESH_GAUSSIAN_C, 0, 11, -3.5),
    ),
    ({"method": "canny"}, lambda g: cv2.Canny(g, 50, 150)),
    (
        {"method": "canny", "canny_low": 30.0, "canny_high": 90.0},
        lambda g: cv2.Canny(g, 30, 90),
    ),
]


@pytest.mark.parametrize("invert", [False, True])
@pytest.mark.parametrize("blur_size", [1, 5, 9])
@pytest.mark.parametrize("values, by_cv2", MASKS)
def test_the_image_in_black_and_white_is_that_of_cv2(values, by_cv2, blur_size, invert):
    used = params(blur_size=blur_size, invert=invert, **values)
    mask = rv.ContourFinder(used).apply(SCENE).mask
    expected = by_cv2(gray_of(SCENE, blur_size))
    assert np.array_equal(mask, 255 - expected if invert else expected)


def corner_set(points):
    return sorted(np.round(points, 3).tolist())


@pytest.mark.parametrize("approximation", ["none", "simple", "tc89_l1", "tc89_kcos"])
def test_what_is_measured_is_what_cv2_measures(approximation):
    """Of all contours of the scene."""
    used = params(approximation=approximation, min_area=50.0, max_contours=1000)
    result = rv.ContourFinder(used).apply(SCENE)
    chain = getattr(cv2, f"CHAIN_APPROX_{approximation.upper()}")
    outlines, _ = cv2.findContours(result.mask, cv2.RETR_TREE, chain)
    large = sorted((o for o in outlines if cv2.contourArea(o) >= 50.0), key=cv2.contourArea)
    assert len(result.contours) == len(large) > 30
    expected = {outline.tobytes(): outline for outline in large}
    for ours in result.contours:
        outline = expected.pop(ours.outline.astype(np.int32).tobytes())
        assert ours.area == cv2.contourArea(outline)
        assert ours.length == pytest.approx(cv2.arcLength(outline, True))
        assert ours.box == cv2.boundingRect(outline)
        assert ours.convex == cv2.isContourConvex(outline)
        polygon = cv2.approxPolyDP(outline, 0.02 * cv2.arcLength(outline, True), True)
        assert np.array_equal(ours.approximation, polygon[:, 0])
        hull = cv2.convexHull(outline)
        assert np.array_equal(ours.hull, hull[:, 0])
        moments = cv2.moments(outline)
        assert ours.center == pytest.approx(
            (moments["m10"] / moments["m00"], moments["m01"] / moments["m00"])
        )
        assert np.allclose(ours.hu, cv2.HuMoments(moments)[:, 0])
        assert ours.solidity == pytest.approx(ours.area / cv2.contourArea(hull))
        assert ours.circle_radius == pytest.approx(cv2.minEnclosingCircle(outline)[1], abs=0.01)
        sides = sorted(cv2.minAreaRect(outline)[1])
        assert [ours.rectangle.width, ours.rectangle.length] == pytest.approx(sides)
        x, y, *_ = cv2.fitLine(outline, cv2.DIST_L2, 0, 0.01, 0.01)[:, 0]
        assert between_directions(ours.line_angle, math.atan2(y, x)) < 1e-6
    assert not expected


@pytest.mark.parametrize("approximation", ["none", "simple", "tc89_l1", "tc89_kcos"])
@pytest.mark.parametrize("mode", ["external", "list", "ccomp", "tree"])
def test_holes_are_what_goes_around_black_pixels(mode, approximation):
    """Also by few points of a thin outline, which may go round the other way."""
    noise = np.random.default_rng(1).integers(0, 2, (60, 80), np.uint8) * 255
    found = contours_of(
        noise, mode=mode, approximation=approximation, min_area=0.0, max_contours=1000
    )
    order = getattr(cv2, f"RETR_{mode.upper()}")
    chain = getattr(cv2, f"CHAIN_APPROX_{approximation.upper()}")
    outlines, _ = cv2.findContours(noise, order, chain)
    borders, _ = cv2.findContours(noise, order, cv2.CHAIN_APPROX_NONE)
    holes = [cv2.contourArea(border, True) > 0 for border in borders]
    expected = [(outline[:, 0].tolist(), hole) for outline, hole in zip(outlines, holes)]
    assert sorted((one.outline.tolist(), one.hole) for one in found) == sorted(expected)
    assert any(holes) == (mode != "external") and len(holes) > 10


def test_approximations_are_different_points_of_the_same_border():
    counts = [
        len(only(polygon(regular(40)), approximation=name).outline)
        for name in ("none", "simple", "tc89_l1")
    ]
    assert counts == sorted(counts, reverse=True) and len(set(counts)) == 3


# ---- refusals


@pytest.mark.parametrize(
    "values, text",
    [
        ({"method": "magic"}, "method is magic, must be fixed, otsu, adaptive_mean, adaptive_g"),
        ({"mode": "forest"}, "mode is forest, must be external, list, ccomp or tree"),
        ({"approximation": "best"}, "approximation is best, must be none, simple, tc89_l1 or"),
        ({"match_method": "I4"}, "match_method is I4, must be I1, I2 or I3"),
        ({"block_size": 50}, "block_size is 50, must be odd and from 3 to 999"),
        ({"epsilon": 0.6}, "epsilon is 0.6, must be from 0 to 0.5"),
        ({"canny_low": 200.0}, "canny_high is 150, must be at least canny_low, 200"),
    ],
)
def test_what_cannot_be_is_refused_in_words(values, text):
    with pytest.raises(ValueError, match=f"^{text}"):
        rv.ContourFinder(params(**values))


def test_a_hierarchy_that_would_take_many_seconds_is_refused():
    stripes = np.tile(np.uint8([0, 255]), (1000, 501))  # 1001 changes in each row
    text = "must be list or external, or blur_size larger: the mask of 1002x1000 changes 1001000 "
    for mode in ("tree", "ccomp"):
        with pytest.raises(ValueError, match=f"^mode is {mode}, {text}"):
            contours_of(stripes, mode=mode)
    for mode, rows in (("list", 1000), ("external", 1000), ("tree", 990)):
        assert len(contours_of(stripes[:rows], mode=mode, min_area=0.0, max_contours=5)) == 5
    # As many changes in a larger image are no noise.
    assert contours_of(np.pad(stripes, ((0, 1200), (0, 1200))), min_area=0.0, max_contours=1)


def test_an_image_of_another_encoding_is_refused_and_of_any_encoding_taken():
    with pytest.raises(ValueError, match="mono8"):
        rv.ContourFinder().apply(SCENE, "mono8")
    deep = nested().astype(np.uint16) * 257
    assert places(rv.ContourFinder(params(**WHITE)).apply(deep, "mono16").contours) == places(
        contours_of(nested())
    )
