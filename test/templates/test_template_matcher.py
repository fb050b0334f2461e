"""Templates against cv2.matchTemplate, and where they were put."""

import cv2
import numpy as np
import pytest

import robot_vision as rv

METHODS = ["sqdiff", "sqdiff_normed", "ccorr", "ccorr_normed", "ccoeff", "ccoeff_normed"]
NUMBERS = {name: getattr(cv2, "TM_" + name.upper()) for name in METHODS}
NORMED = [name for name in METHODS if name.endswith("_normed")]


def texture(seed, shape=(120, 160), channels=3):
    """Smooth noise, of which no part looks like another."""
    rng = np.random.default_rng(seed)
    image = cv2.GaussianBlur(rng.normal(0.0, 1.0, (*shape, channels)), (0, 0), 2.0)
    return cv2.normalize(image, None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)


IMAGE = texture(1)
DISC = np.zeros((24, 30), np.uint8)
cv2.circle(DISC, (15, 12), 10, 255, -1)


def takes_mask(method):
    try:
        cv2.matchTemplate(IMAGE, IMAGE[:24, :30], NUMBERS[method], None, cv2.merge([DISC] * 3))
    except cv2.error:
        return False
    return True


def matcher(*templates, **values):
    params = rv.TemplateParams()
    for name, value in values.items():
        assert hasattr(params, name)
        setattr(params, name, value)
    made = rv.TemplateMatcher(params)
    for template in templates:
        made.add(*template) if isinstance(template, tuple) else made.add(template)
    return made


def found(image, *templates, **values):
    return matcher(*templates, **values).match(image).matches


def gray(image):
    return cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)


def close(ours, theirs):
    return np.allclose(ours, theirs, rtol=1e-4, atol=1e-4 * max(1.0, np.abs(theirs).max()))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("image", [IMAGE, gray(IMAGE)], ids=["color", "gray"])
def test_responses_are_those_of_opencv(method, image):
    template = image[30:54, 40:70].copy()
    response = rv.template_response(image, template, method)
    expected = cv2.matchTemplate(image, template, NUMBERS[method])
    assert response.dtype == np.float32 and np.array_equal(response, expected)
    ours = matcher(template, method=method, color=image.ndim == 3) if image.ndim == 3 else None
    if ours:
        assert np.array_equal(ours.match(image, response=True).response, expected)
        assert ours.match(image).response.size == 0


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("image", [IMAGE, gray(IMAGE)], ids=["color", "gray"])
def test_responses_with_a_mask_are_those_of_opencv(method, image):
    template = image[30:54, 40:70].copy()
    template[DISC == 0] = 7
    if not takes_mask(method):
        with pytest.raises(ValueError, match=f"method is {method}, must be sqdiff or ccorr_normed"):
            rv.template_response(image, template, method, DISC)
        return
    response = rv.template_response(image, template, method, DISC)
    mask = DISC if image.ndim == 2 else cv2.merge([DISC] * 3)
    assert close(response, cv2.matchTemplate(image, template, NUMBERS[method], None, mask))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("size", [(4, 1), (1, 4), (9, 1), (20, 9), (17, 12), (20, 12), (4, 12)])
def test_masks_are_taken_in_every_size(method, size):
    """cv2 fails for some templates or responses of 4x1, which it takes for scalars."""
    if not takes_mask(method):
        pytest.skip("this OpenCV takes no mask with the method")
    image = np.random.default_rng(8).integers(0, 256, (20, 12), np.uint8)
    mask = np.full(size, 255, np.uint8)
    mask[0, 0] = 0
    for rows in (20, size[0] + 3, size[0]):
        for columns in (12, size[1]):
            part = image[:rows, :columns].copy()
            template = image[: size[0], : size[1]].copy()
            response = rv.template_response(part, template, method, mask)
            expected = plain_response(part, template, mask > 0, method)
            assert np.allclose(response, expected, rtol=1e-3, atol=1e-3 * np.abs(expected).max())


def plain_response(image, template, mask, method):
    """What the documentation of cv2.matchTemplate says, place by place."""
    rows, columns = np.subtract(image.shape, template.shape) + 1
    out = np.zeros((rows, columns))
    for y, x in np.ndindex(rows, columns):
        part = image[y : y + template.shape[0], x : x + template.shape[1]]
        a, b = template[mask].astype(float), part[mask].astype(float)
        if method.startswith("ccoeff"):
            a, b = a - a.mean(), b - b.mean()
        out[y, x] = ((a - b) ** 2).sum() if method.startswith("sqdiff") else (a * b).sum()
        if method in NORMED:
            out[y, x] /= np.sqrt((a**2).sum() * (b**2).sum())
    return out


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("level", [0, 90, 255])
def test_no_response_is_nan_where_the_image_is_flat(method, level):
    image = IMAGE.copy()
    image[:, 80:] = level
    image[60:, 80:] ^= np.random.default_rng(1).integers(0, 2, (60, 80, 3), np.uint8)  # nearly flat
    template = IMAGE[30:54, 40:70]
    for mask in (None, DISC):
        if mask is not None and not takes_mask(method):
            continue
        response = rv.template_response(image, template, method, mask)
        assert np.isfinite(response).all()
        if method in NORMED:
            best = response.min() if method == "sqdiff_normed" else response.max()
            assert best == response[30, 40]
            assert response.min() >= -1.001
            assert response.max() <= 1.001 or method == "sqdiff_normed"


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("color", [False, True])
def test_pasted_templates_are_found_where_they_are(method, color):
    image = (texture(2) // 3 + 20).astype(np.uint8)
    templates = [
        np.clip(texture(3 + i, (20, 26)).astype(int) + 60, 0, 255).astype(np.uint8)
        for i in range(2)
    ]
    places = [(15, 30), (90, 70)]  # x, y
    for template, (x, y) in zip(templates, places):
        image[y : y + 20, x : x + 26] = template
    values = {"threshold": 0.05, "overlap": 1.0}  # for ccorr both may be at one bright place
    matches = found(image, *templates, method=method, color=color, **values)
    assert [match.index for match in matches] in ([0, 1], [1, 0])
    for match in matches:
        if method == "ccorr":  # it prefers what is bright
            continue
        x, y = places[match.index]
        assert match.box == (x, y, 26, 20) and match.scale == 1.0
        assert match.center == pytest.approx((x + 12.5, y + 9.5), abs=0.5)
        exact = {"ccoeff": 0.1}.get(method, 0.999)
        assert exact <= match.score <= 1.0


@pytest.mark.parametrize(
    "method, image, score",
    [
        ("sqdiff", 40, 1.0 - 20.0 / 255.0),
        ("sqdiff_normed", 40, 1.0 - 20.0**2 / (40.0 * 60.0)),
        ("ccorr", 51, 0.2),
        ("ccorr_normed", 40, 1.0),
    ],
)
def test_scores_are_what_the_page_says(method, image, score):
    template = np.full((10, 10, 3), 60, np.uint8)
    (match,) = found(np.full((40, 50, 3), image, np.uint8), template, method=method, threshold=0.0)
    assert match.score == pytest.approx(score, abs=1e-3)


def test_the_score_of_ccoeff_is_1_for_the_best_that_there_can_be():
    for color in (False, True):
        template = np.full((10, 10, 3), 100, np.uint8)
        template[:5] = 160
        image = np.zeros((40, 50, 3), np.uint8)
        image[20:25, 20:30] = 255
        (match,) = found(image, template, method="ccoeff", color=color)
        assert match.box == (20, 20, 10, 10) and match.score == pytest.approx(1.0, abs=1e-3)


def several(places, template, shape=(160, 220)):
    image = texture(9, shape) // 2
    for x, y in places:
        image[y : y + template.shape[0], x : x + template.shape[1]] = template
    return image


PLACES = [(10, 12), (150, 20), (60, 100), (120, 110)]
STAR = texture(11, (24, 24))


def test_all_places_are_found_up_to_the_most_wanted():
    image = several(PLACES, STAR)
    matches = found(image, STAR, results="multiple", threshold=0.9)
    assert sorted(match.box[:2] for match in matches) == sorted(PLACES)
    assert len(found(image, STAR, results="multiple", threshold=0.9, max_results=3)) == 3
    assert len(found(image, STAR, results="single", threshold=0.9)) == 1
    assert not found(texture(12), STAR, results="multiple", threshold=0.9)


def test_a_template_whose_best_place_is_anothers_is_not_found_at_its_next_one():
    lit = STAR
    unlit = cv2.addWeighted(lit, 0.7, texture(21, (24, 24)), 0.3, 0)
    image = several([(50, 50)], lit)
    image[100:124, 150:174] = cv2.addWeighted(unlit, 0.6, texture(22, (24, 24)), 0.4, 0)
    (alone,) = found(image, unlit, threshold=0.5)
    assert alone.box == (50, 50, 24, 24)
    matches = found(image, lit, unlit, threshold=0.5)
    assert [(match.index, match.box) for match in matches] == [(0, (50, 50, 24, 24))]
    places = found(image, unlit, threshold=0.5, results="multiple")
    assert (150, 100, 24, 24) in [match.box for match in places]


@pytest.mark.parametrize("overlap, count", [(0.0, 1), (0.2, 1), (0.4, 2), (1.0, 2)])
def test_of_overlapping_results_the_better_stays(overlap, count):
    image = several([(50, 50)], STAR)
    image[50 : 50 + 24, 62 : 62 + 24] = STAR  # half of it is covered by the next: IoU 1/3
    image[50:74, 50:62] = STAR[:, :12]
    matches = found(image, STAR, results="multiple", threshold=0.5, overlap=overlap)
    assert matches[0].box == (62, 50, 24, 24) and matches[0].score > 0.999
    near = [match for match in matches if match.box[:2] in ((62, 50), (50, 50))]
    assert len(near) == count
    assert all(a.score >= b.score for a, b in zip(matches, matches[1:]))


@pytest.mark.parametrize("overlap", [0.0, 0.3])
def test_all_parts_of_a_flat_image_are_found(overlap):
    """Where all places are alike, and those of the first rows are more than are compared."""
    image = np.zeros((340, 240, 3), np.uint8)
    image[20:120, 20:220] = 255
    image[220:320, 20:120] = 255
    template = np.full((20, 20, 3), 255, np.uint8)
    values = {"method": "sqdiff", "threshold": 0.99, "max_results": 1000, "overlap": overlap}
    matches = found(image, template, results="multiple", **values)
    covered = np.zeros(image.shape[:2], bool)
    for x, y, width, height in (match.box for match in matches):
        covered[y : y + height, x : x + width] = True
    assert not covered[image[..., 0] == 0].any()
    # Not all of both, as the responses of OpenCV differ by what its sums are rounded to.
    assert covered[20:120, 20:220].mean() > 0.6 and covered[220:320, 20:120].mean() > 0.6
    places = np.array([match.box[:2] for match in matches])
    common = np.maximum(20 - np.abs(places[:, None] - places), 0).prod(axis=2)
    np.fill_diagonal(common, 0)
    assert (common / (800 - common)).max() <= overlap


def test_the_threshold_is_the_least_score():
    image = several([(50, 50)], cv2.GaussianBlur(STAR, (0, 0), 2.5))
    (match,) = found(image, STAR, threshold=0.0)
    assert 0.3 < match.score < 0.99
    assert len(found(image, STAR, threshold=match.score - 1e-6)) == 1
    assert not found(image, STAR, threshold=match.score + 1e-6)


def smooth_spot(x, y, shape=(80, 100)):
    """A soft bright spot with its middle anywhere."""
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    spot = 40 + 180 * np.exp(-((columns - x) ** 2 + 1.5 * (rows - y) ** 2) / (2 * 5.0**2))
    return cv2.cvtColor(np.rint(spot).astype(np.uint8), cv2.COLOR_GRAY2BGR)


@pytest.mark.parametrize(
    "method", ["sqdiff", "sqdiff_normed", "ccorr_normed", "ccoeff", "ccoeff_normed"]
)
def test_the_centre_of_a_smooth_template_is_good_to_a_tenth_of_a_pixel(method):
    template = smooth_spot(15.0, 15.0, (31, 31))
    for dx, dy in [(0.0, 0.0), (0.3, -0.4), (-0.25, 0.1), (0.45, 0.45)]:
        (match,) = found(smooth_spot(50.0 + dx, 40.0 + dy), template, method=method, threshold=0.3)
        assert match.center == pytest.approx((50.0 + dx, 40.0 + dy), abs=0.1)


def test_a_template_at_the_border_has_its_own_centre():
    image = several([(0, 0)], STAR)
    (match,) = found(image, STAR)
    assert match.box == (0, 0, 24, 24) and match.center == (11.5, 11.5)


@pytest.mark.parametrize("scale", [0.7, 1.0, 1.4])
def test_templates_of_other_sizes_are_found(scale):
    size = round(48 * scale)
    template = cv2.GaussianBlur(texture(13, (48, 48)), (0, 0), 2.0)
    image = several([(80, 60)], cv2.resize(template, (size, size), interpolation=cv2.INTER_AREA))
    scales = {"min_scale": 0.7, "max_scale": 1.4, "scale_steps": 7}
    (match,) = found(image, template, **scales)
    assert match.box == (80, 60, size, size)
    assert match.scale == pytest.approx(scale, rel=0.07) and match.score > 0.9
    if scale != 1.0:
        assert not found(image, template)
        assert not found(image, template, **{**scales, "scale_steps": 1}) or scale == 0.7


def test_transparent_pixels_do_not_count():
    template = STAR.copy()
    mask = np.zeros((24, 24), np.uint8)
    cv2.circle(mask, (12, 12), 11, 128, -1)
    template[mask == 0] = (0, 0, 255)
    image = several([(70, 50)], STAR)
    for method in METHODS[1::2]:
        if takes_mask(method):
            (match,) = found(image, (template, "bgr8", mask), method=method, color=True)
            assert match.box == (70, 50, 24, 24) and match.score > 0.999
            plain = found(image, template, method=method, color=True, threshold=0.0)
            assert plain[0].score < 0.99
    barely = np.full((24, 24), 127, np.uint8)
    with pytest.raises(ValueError, match="the mask's number of pixels that count is 0, must be"):
        matcher((template, "bgr8", barely))
    with pytest.raises(ValueError, match="the mask's size is 16x24, must be the template's, 24x16"):
        matcher((template[:16], "bgr8", mask[:, :16]))  # with as many pixels


@pytest.mark.parametrize("method", METHODS)
def test_templates_that_would_be_everywhere_are_refused(method):
    for level, what in ((0, "root mean square"), (90, "standard deviation")):
        mean = method.startswith("ccoeff")
        template = np.full((20, 20, 3), level, np.uint8)
        if mean or (level == 0 and method != "sqdiff"):
            what = "standard deviation" if mean else "root mean square"
            text = f"the template's {what} is 0, must be at least 1 gray level for {method}"
            with pytest.raises(ValueError, match=text):
                matcher(template, method=method)
        else:
            matcher(template, method=method)


def test_templates_larger_than_the_image_are_named():
    made = matcher(texture(1, (200, 20)), STAR, texture(2, (20, 300)))
    result = made.match(several(PLACES[:1], STAR, (100, 100)), response=True)
    assert result.too_large == [0, 2]
    assert [match.index for match in result.matches] == [1]
    alone = matcher(texture(1, (200, 20))).match(IMAGE, response=True)
    assert alone.too_large == [0] and not alone.matches and alone.response.size == 0
    assert not rv.TemplateMatcher().match(IMAGE).matches
    small = matcher(texture(1, (200, 20)), min_scale=0.25, max_scale=1.0, scale_steps=2)
    assert small.match(IMAGE).too_large == []


def test_too_many_templates_are_refused():
    made = matcher(*[STAR] * 4, min_scale=0.5, max_scale=2.0, scale_steps=50)
    with pytest.raises(
        ValueError, match="number of templates in all scales is 250, must be at most 200"
    ):
        made.add(STAR)
    large = np.tile(STAR, (100, 100, 1))
    with pytest.raises(ValueError, match=r"templates' pixels in all scales is .*, must be at most"):
        matcher(large, max_scale=5.0, scale_steps=4)


def test_an_image_in_which_the_search_would_take_many_seconds_is_refused():
    made = matcher(*[STAR] * 4, color=True, min_scale=0.5, max_scale=2.0, scale_steps=50)
    text = "scale_steps is 50 for 4 templates in color, must be less, or the image of 640x480"
    with pytest.raises(ValueError, match=f"^{text} have at most 106666 pixels$"):
        made.match(np.zeros((480, 640, 3), np.uint8))
    few = matcher(STAR, texture(1, (500, 20)), max_scale=2.0, scale_steps=50)  # one is too large
    assert few.match(np.zeros((40, 60, 3), np.uint8)).too_large == [1]


def test_the_response_as_an_image_is_white_at_the_best_place():
    template = IMAGE[30:54, 40:70]
    for method in METHODS:
        response = rv.template_response(IMAGE, template, method)
        image = rv.response_image(response, method)
        scaled = cv2.normalize(response, None, 0, 255, cv2.NORM_MINMAX)
        expected = 255 - scaled if method.startswith("sqdiff") else scaled
        assert image.dtype == np.uint8 and np.abs(image - expected).max() <= 0.51
        assert image.max() == 255 and image.min() == 0
    assert not rv.response_image(np.full((3, 4), 2.0, np.float32)).any()


@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (50, 1), (7, 9)])
@pytest.mark.parametrize("method", METHODS)
def test_an_image_of_any_size_is_found_in_itself(method, shape):
    image = np.random.default_rng(1).integers(1, 256, (*shape, 3), np.uint8)
    if shape == (1, 1) and method.startswith("ccoeff"):
        return  # a pixel has no contrast
    (match,) = found(image, image, method=method, threshold=0.0, color=True)
    assert match.box == (0, 0, *shape[::-1]) and np.isfinite(match.score)


def test_padded_rows_other_encodings_and_an_unchanged_image():
    padded = np.hstack([IMAGE, IMAGE])
    before = padded.copy()
    template, box = IMAGE[30:54, 40:70], (40, 30, 30, 24)
    assert found(padded[:, :160], template)[0].box == box and np.array_equal(padded, before)
    made = matcher(template)
    assert made.match(gray(IMAGE), "mono8").matches[0].box == box
    wide = gray(IMAGE).astype(np.uint16) * 257
    assert made.match(wide, "mono16").matches[0].box == box


@pytest.mark.parametrize(
    "values, text",
    [
        ({"method": "best"}, "method is best, must be sqdiff, sqdiff_normed, ccorr"),
        ({"results": "all"}, "results is all, must be single or multiple"),
        ({"threshold": 1.5}, "threshold is 1.5, must be from 0 to 1"),
        ({"max_results": 0}, "max_results is 0, must be from 1 to 1000"),
        ({"overlap": -0.1}, "overlap is -0.1, must be from 0 to 1"),
        ({"min_scale": 2.0}, "min_scale is 2, must be at most max_scale, 1"),
        ({"scale_steps": 0}, "scale_steps is 0, must be from 1 to 50"),
    ],
)
def test_bad_parameters_are_refused_in_words(values, text):
    with pytest.raises(ValueError, match=text):
        matcher(**values)


def test_bad_images_are_refused_in_words():
    with pytest.raises(ValueError, match="the template's size is 160x120, must be at most"):
        rv.template_response(IMAGE[:50], IMAGE)
    with pytest.raises(ValueError, match="the template's type is"):
        rv.template_response(IMAGE, gray(IMAGE))
    with pytest.raises(ValueError, match="the image's type is"):
        rv.template_response(gray(IMAGE).astype(np.uint16), gray(IMAGE).astype(np.uint16))
    with pytest.raises(ValueError, match="the mask is 3x2"):
        rv.template_response(IMAGE, IMAGE[:9, :9], "sqdiff", np.ones((2, 3), np.uint8))
    with pytest.raises(ValueError, match="method is x, must be sqdiff"):
        rv.template_response(IMAGE, IMAGE, "x")
