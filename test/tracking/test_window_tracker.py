"""The tracker by colours follows drawn ellipses, whose places are known, and the scene's ball."""

import cv2
import numpy as np
import pytest
import skimage.data

import robot_vision as rv
from robot_vision.tracking.tracks import draw_window

RATE = 30.0  # Hz
SIZE = (320, 240)
BACKGROUND = cv2.resize(cv2.cvtColor(skimage.data.coffee(), cv2.COLOR_RGB2BGR), SIZE)
BLUE, GREEN = (200, 90, 20), (60, 190, 40)
GRAIN = np.random.default_rng(3).integers(-6, 7, (*BACKGROUND.shape,))
FRACTION = 4  # bits of positions in cv2


def params(**values):
    made = rv.WindowTrackerParams()
    for name, value in values.items():
        setattr(made, name, value)
    return made


def view(center=None, axes=(30, 16), angle=0.0, color=BLUE, background=BACKGROUND):
    """The background with an ellipse of these half axes (px), turned clockwise by `angle` (rad)."""
    image = background.copy()
    if center is not None:
        fixed = [[round(value * 2**FRACTION) for value in pair] for pair in (center, axes)]
        turn = np.degrees(angle)
        cv2.ellipse(image, *fixed, turn, 0, 360, color, cv2.FILLED, cv2.LINE_AA, FRACTION)
    return np.clip(image + GRAIN, 0, 255).astype(np.uint8)


def box(center, axes=(30, 16)):
    """The box (x, y, width, height) around an ellipse that is not turned."""
    (x, y), (a, b) = center, axes
    return int(x - a), int(y - b), 2 * int(a) + 1, 2 * int(b) + 1


def selected(image, where, **values):
    """A tracker that has selected a box of an image at the time 0."""
    tracker = rv.WindowTracker(params(**values))
    tracker.update(0.0, image)
    tracker.select(where)
    return tracker


def sides(outline):
    """The lengths of the longer and the shorter side, and the direction of the longer (rad)."""
    first, second = outline[1] - outline[0], outline[2] - outline[1]
    long, short = sorted((first, second), key=lambda side: -np.hypot(*side))
    return np.hypot(*long), np.hypot(*short), np.arctan2(long[1], long[0])


def turn_between(a, b):
    """The angle between two lines, rad."""
    return abs((a - b + np.pi / 2) % np.pi - np.pi / 2)


def test_an_ellipse_that_moves_turns_and_grows_is_followed():
    tracker = None
    for number in range(120):
        t = number / RATE
        center = 100.0 + 35.0 * t, 100.0 + 12.0 * np.sin(2.0 * t)
        axes, angle = (24.0 + 4.0 * t, 12.0 + 2.0 * t), 0.7 * t
        image = view(center, axes, angle)
        if tracker is None:
            tracker = selected(image, box(center, axes))
        (found,) = tracker.update(t, image)
        length, width, direction = sides(found.outline)
        assert found.tracked and not found.predicted and found.id == 1
        assert found.center == pytest.approx(center, abs=0.6)
        assert found.outline.mean(axis=0) == pytest.approx(center, abs=1.5)
        assert (length, width) == pytest.approx((2 * axes[0], 2 * axes[1]), abs=2.0)
        assert turn_between(direction, angle) < np.radians(3.0)
        assert found.confidence > 0.7
    assert found.angle == pytest.approx(0.7 * t, abs=0.06)  # more than a quarter of a turn
    assert found.scale == pytest.approx(axes[0] / 24.0, rel=0.04)
    speed = 12.0 * 2.0 * np.cos(2.0 * t)
    assert found.velocity == pytest.approx((35.0, speed), abs=8.0)


def test_meanshift_keeps_the_window_s_size():
    center = (80.0, 90.0)
    tracker = selected(view(center), box(center), method="meanshift")
    for number in range(1, 40):
        center = 80.0 + 3.0 * number, 90.0 + number
        (found,) = tracker.update(number / RATE, view(center))
    x, y, width, height = found.window
    assert (width, height) == (61, 33) and (found.scale, found.angle) == (1.0, 0.0)
    assert (x + 30, y + 16) == pytest.approx(center, abs=1.5)
    assert found.outline[0] == pytest.approx((x - 0.5, y - 0.5))
    assert found.outline[2] == pytest.approx((x + width - 0.5, y + height - 0.5))
    assert found.velocity == pytest.approx((90.0, 30.0), abs=5.0)
    assert found.confidence == pytest.approx(np.pi / 4, abs=0.1)  # of an ellipse in its box


@pytest.mark.parametrize("methods", [("camshift", "meanshift"), ("meanshift", "camshift")])
def test_another_method_is_no_growth_and_no_turn(methods):
    center, axes, angle = (160.0, 120.0), (45, 15), np.radians(30.0)
    image = view(center, axes, angle)
    tracker = selected(image, (116, 92, 89, 57), method=methods[0])
    for number in range(1, 9):
        tracker.configure(params(method=methods[number // 2 % 2]))
        (found,) = tracker.update(number / RATE, image)
        assert found.tracked and found.angle == pytest.approx(0.0, abs=0.02)
        assert found.scale == pytest.approx(1.0, abs=0.02)


def test_the_scale_goes_on_and_the_angle_begins_anew_with_another_method():
    tracker = selected(view((160.0, 120.0)), box((160.0, 120.0)))
    steps = [(1.2, 0.2, "camshift"), (1.4, 0.4, "camshift"), (1.4, 0.4, "meanshift")]
    steps += [(1.4, 0.4, "camshift"), (1.5, 0.6, "camshift"), (1.6, 0.8, "camshift")]
    scales, angles = [], []
    for number, (scale, angle, method) in enumerate(steps, 1):
        tracker.configure(params(method=method))
        image = view((160.0, 120.0), (30 * scale, 16 * scale), angle)
        (found,) = tracker.update(number / RATE, image)
        scales.append(found.scale)
        angles.append(found.angle)
    assert scales == pytest.approx([1.2, 1.4, 1.4, 1.4, 1.5, 1.6], rel=0.05)
    assert angles == pytest.approx([0.2, 0.4, 0.0, 0.0, 0.2, 0.4], abs=0.04)


def projection_of(image, where, channels, hue_bins=16, saturation_bins=8, background=False):
    """The back projection as cv2 makes it."""
    hsv = cv2.cvtColor(image, cv2.COLOR_BGR2HSV)
    mask = cv2.inRange(hsv, (0, 60, 32), (255, 255, 255))
    bins = [hue_bins, saturation_bins][: len(channels)]
    ranges = [0, 180, 0, 256][: 2 * len(channels)]

    def counted(part):
        (x, y, width, height) = part
        there = slice(y, y + height), slice(x, x + width)
        return cv2.calcHist([hsv[there]], channels, mask[there], bins, ranges)

    histogram = counted(where)
    if background:
        x, y, width, height = where
        around = counted((x - width, y - height, 3 * width, 3 * height)) - histogram
        share = around / 8.0  # of as many pixels as the region has
        histogram = np.maximum(0.0, histogram - share).astype(np.float32)
    histogram *= 255.0 / histogram.max()
    return lambda other: cv2.bitwise_and(
        cv2.calcBackProject(
            [cv2.cvtColor(other, cv2.COLOR_BGR2HSV)], channels, histogram, ranges, 1
        ),
        cv2.inRange(cv2.cvtColor(other, cv2.COLOR_BGR2HSV), (0, 60, 32), (255, 255, 255)),
    )


@pytest.mark.parametrize("background", [False, True])
@pytest.mark.parametrize("channels, numbers", [("hue", [0]), ("hue_saturation", [0, 1])])
@pytest.mark.parametrize("method", ["meanshift", "camshift"])
def test_each_step_is_that_of_opencv(method, channels, numbers, background):
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 10, 1.0)
    image, window = view((120.0, 100.0)), box((120.0, 100.0))
    project = projection_of(image, window, numbers, background=background)
    settings = {"method": method, "channels": channels, "subtract_background": background}
    tracker = selected(image, window, **settings)
    for number in range(5):
        image = view((120.0 + 6.0 * number, 100.0 + 3.0 * number), angle=0.1 * number)
        expected = project(image)
        if number == 0:
            (found,) = tracker.objects()
        else:
            (found,) = tracker.update(number / RATE, image)
        assert np.abs(tracker.back_projection().astype(int) - expected).max() <= 1
        if method == "camshift":
            rotated, window = cv2.CamShift(expected, window, criteria)
            corners = cv2.boxPoints(rotated) - 0.5
            assert found.outline == pytest.approx(corners, abs=0.01)
        else:
            _, window = cv2.meanShift(expected, window, criteria)
        assert found.window == window


def test_a_hidden_object_is_expected_then_lost_and_found_elsewhere():
    tracker = selected(view((60.0, 80.0)), box((60.0, 80.0)), max_prediction=0.21, smoothing=0.0)
    for number in range(1, 20):
        (seen,) = tracker.update(number / RATE, view((60.0 + 3.0 * number, 80.0)))
    for number in range(20, 32):
        (found,) = tracker.update(number / RATE, view())
        hidden = (number - 19) / RATE
        assert not found.tracked and found.confidence == 0.0 and found.id == 1
        assert found.predicted == (hidden <= 0.21)
        shift = np.subtract(found.center, seen.center)
        if found.predicted:
            assert shift == pytest.approx((90.0 * hidden, 0.0), abs=20.0 * hidden)
            assert found.velocity[0] == pytest.approx(90.0, abs=20.0)
            assert found.outline - seen.outline == pytest.approx(np.tile(shift, (4, 1)))
        else:
            assert tuple(shift) == (0.0, 0.0) and found.velocity == (0.0, 0.0)
        assert tracker.back_projection().mean() < 1.0
    (found,) = tracker.update(32 / RATE, view((250.0, 190.0), angle=1.0))
    assert found.tracked and found.velocity == (0.0, 0.0)
    assert found.center == pytest.approx((250.0, 190.0), abs=0.6)


def test_what_jumps_further_than_its_size_is_found_in_the_same_frame():
    for method in ("meanshift", "camshift"):
        tracker = selected(view((60.0, 60.0)), box((60.0, 60.0)), method=method)
        (found,) = tracker.update(1 / RATE, view((260.0, 180.0)))
        assert found.tracked and found.center == pytest.approx((260.0, 180.0), abs=0.6)


def test_never_expected_without_a_prediction():
    tracker = selected(view((60.0, 80.0)), box((60.0, 80.0)), max_prediction=0.0)
    (found,) = tracker.update(0.0, view())
    assert not found.tracked and not found.predicted


def test_the_time_goes_back_or_the_image_has_another_size():
    tracker = selected(view((60.0, 80.0)), box((60.0, 80.0)))
    (found,) = tracker.update(-5.0, view((64.0, 80.0)))
    assert found.tracked and found.velocity == (0.0, 0.0)
    (found,) = tracker.update(-4.9, view((60.0, 80.0))[:160, :200])
    assert found.tracked and found.center == pytest.approx((60.0, 80.0), abs=0.6)
    for time in (-4.8, -4.7):
        (lost,) = tracker.update(time, np.full((1, 1, 3), BLUE, np.uint8))
        assert not lost.tracked and not lost.predicted and lost.velocity == (0.0, 0.0)
        assert lost.center == found.center and np.array_equal(lost.outline, found.outline)


def test_colors_of_the_background_do_not_count():
    """Half of what is selected is the table, and another table is beside it."""
    table = np.full((*SIZE[::-1], 3), (30, 80, 200), np.uint8)
    image, where = view((160.0, 120.0), background=table), (120, 90, 80, 60)
    for subtract in (False, True):
        tracker = selected(image, where, subtract_background=subtract)
        for number in range(1, 6):
            (found,) = tracker.update(number / RATE, image)
        length = sides(found.outline)[0]
        assert (length < 64.0) == subtract, length


@pytest.mark.parametrize("cut", [0, 1, 5])  # px
def test_a_disc_on_a_gray_floor_may_stick_out_of_what_is_selected(cut):
    center, radius = (160, 120), 40
    image = np.full_like(BACKGROUND, 100)
    cv2.circle(image, center, radius, BLUE, cv2.FILLED)
    tracker = selected(image, box(center, (radius - cut, radius - cut)))
    for number in range(1, 4):
        (found,) = tracker.update(number / RATE, image)
    assert found.tracked and found.confidence > 0.7
    assert found.center == pytest.approx(center, abs=0.6)
    assert sides(found.outline)[:2] == pytest.approx((80.0, 80.0), abs=2.0)


def test_limits_of_saturation_and_value_leave_pixels_out():
    image = view((160.0, 120.0))
    image[:, :20] = (120, 100, 90)  # a pale and a dark blue
    image[:, 20:40] = (30, 12, 3)
    settings = {"subtract_background": False}
    tracker = selected(image, box((160.0, 120.0)), min_saturation=0, min_value=0, **settings)
    assert tracker.back_projection()[:, :40].min() == 255
    tracker.configure(params(min_saturation=100, min_value=0, **settings))
    tracker.update(0.1, image)
    assert not tracker.back_projection()[:, :20].any()
    assert tracker.back_projection()[:, 20:40].min() == 255
    tracker.configure(params(min_saturation=100, min_value=60, **settings))
    tracker.update(0.2, image)
    assert not tracker.back_projection()[:, :40].any()


def test_saturation_tells_colors_of_one_hue():
    image = view((160.0, 120.0))
    image[:, :40] = (200, 150, 120)  # pale
    for channels, pale in (("hue", 255), ("hue_saturation", 0)):
        tracker = selected(image, box((160.0, 120.0)), channels=channels)
        assert np.median(tracker.back_projection()[:, :40]) == pale, channels
    tracker = selected(image, box((160.0, 120.0)), channels="hue_saturation", saturation_bins=1)
    assert np.median(tracker.back_projection()[:, :40]) == 255


def test_few_bins_of_hue_take_in_other_hues():
    image = view((160.0, 120.0))
    image[:, :40] = GREEN
    for hue_bins, green in ((16, 0), (1, 255)):
        tracker = selected(image, box((160.0, 120.0)), hue_bins=hue_bins, subtract_background=False)
        assert np.median(tracker.back_projection()[:, :40]) == green, hue_bins


@pytest.mark.parametrize("setting", [{"max_iterations": 1}, {"epsilon": 50.0}])
def test_steps_end_as_they_are_told(setting):
    image, where = view((100.0, 100.0)), box((100.0, 100.0))
    moved = []
    for values in ({}, setting):
        tracker = selected(image, where, method="meanshift", **values)
        (found,) = tracker.update(0.1, view((140.0, 100.0)))
        moved.append(found.window[0] - where[0])
    assert moved[0] == pytest.approx(40, abs=2) and moved[1] < 30


def test_too_little_similarity_or_area_is_lost():
    image, where = view((100.0, 100.0)), box((100.0, 100.0))
    tracker = selected(image, where)
    (found,) = tracker.update(0.1, image)
    assert 0.6 < found.confidence < 0.9
    for lost in ({"min_similarity": 0.95}, {"min_area": 3000.0}):
        tracker.configure(params(**lost))
        assert not tracker.update(0.2, image)[0].tracked
        tracker.configure(params())
        assert tracker.update(0.3, image)[0].tracked


def test_smoothing_slows_the_velocity():
    velocities = []
    for smoothing in (0.0, 1.0):
        tracker = selected(view((60.0, 80.0)), box((60.0, 80.0)), smoothing=smoothing)
        for number in range(1, 5):
            (found,) = tracker.update(number / RATE, view((60.0 + 3.0 * number, 80.0)))
        velocities.append(found.velocity[0])
    assert velocities[0] == pytest.approx(90.0, abs=20.0) and 0.0 < velocities[1] < 25.0


def test_one_object_at_a_time():
    image = view((80.0, 80.0))
    cv2.ellipse(image, (220, 160), (30, 16), 0, 0, 360, GREEN, cv2.FILLED)
    tracker = selected(image, box((80.0, 80.0)))
    assert tracker.select(box((220.0, 160.0)), "leaf") == 2
    (found,) = tracker.update(0.1, image)
    assert (found.id, found.label) == (2, "leaf")
    assert found.center == pytest.approx((220.0, 160.0), abs=0.6)
    assert not tracker.forget(1) and tracker.forget(2) and not tracker.forget(2)
    assert tracker.update(0.2, image) == [] and tracker.back_projection() is None


@pytest.mark.parametrize(
    "where, text",
    [
        (
            (300, 100, 40, 40),
            r"region of 40x40 px at \(300, 100\) is not inside the image of 320x2",
        ),
        ((10, 10, 0, 20), r"region of 0x20 px at \(10, 10\) is not inside"),
        ((2**30, 0, 2**30, 2), "is not inside the image"),
        (
            (100, 100, 7, 7),
            r"region of 7x7 px at \(100, 100\) is too small, must have at least min",
        ),
        (
            (0, 0, 30, 30),
            r"region of 30x30 px at \(0, 0\) has no colour of its own: it is gray or d",
        ),
    ],
)
def test_bad_selections_are_refused_and_the_object_stays(where, text):
    image = view((160.0, 120.0))
    image[:60, :60] = 90  # gray
    tracker = rv.WindowTracker()
    with pytest.raises(ValueError, match="there is no image yet"):
        tracker.select(where)
    tracker.update(0.0, image)
    tracker.select(box((160.0, 120.0)))
    with pytest.raises(ValueError, match=text):
        tracker.select(where)
    assert tracker.update(0.1, image)[0].id == 1


def test_what_would_be_lost_at_once_is_not_selected():
    tracker = rv.WindowTracker(params(min_similarity=0.95))
    tracker.update(0.0, view((160.0, 120.0)))
    with pytest.raises(ValueError, match="cannot be followed: too little of it has its most"):
        tracker.select(box((160.0, 120.0)))


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("method", "boosting", "method is boosting, must be meanshift or camshift"),
        ("channels", "bgr", "channels is bgr, must be hue or hue_saturation"),
        ("hue_bins", 0, "hue_bins is 0, must be from 1 to 180"),
        ("epsilon", 0.5, "epsilon is 0.5, must be from 1 to 50"),
        ("min_similarity", np.nan, "min_similarity is nan, must be from 0 to 1"),
    ],
)
def test_parameters_out_of_range_are_refused(name, value, text):
    with pytest.raises(ValueError, match=text):
        rv.WindowTracker(params(**{name: value}))
    tracker = rv.WindowTracker()
    with pytest.raises(ValueError, match=text):
        tracker.configure(params(**{name: value}))


@pytest.mark.parametrize("shape", [(1, 1), (1, 64), (64, 1), (37, 51)])
@pytest.mark.parametrize("method", ["meanshift", "camshift"])
def test_images_of_any_size_and_one_color(shape, method):
    tracker = rv.WindowTracker(params(method=method, subtract_background=False, min_area=1.0))
    image = np.full((*shape, 3), BLUE, np.uint8)
    tracker.update(0.0, image)
    try:
        tracker.select((0, 0, shape[1], shape[0]))
    except ValueError as error:  # a line has no area
        assert min(shape) == 1 and method == "camshift" and "cannot be followed" in str(error)
        return
    for level in (image, np.zeros_like(image), np.full_like(image, 255), image):
        (found,) = tracker.update(0.1, level)
    assert found.tracked and found.confidence == pytest.approx(1.0)
    assert found.center == pytest.approx(((shape[1] - 1) / 2, (shape[0] - 1) / 2))


def test_other_encodings_and_arrays():
    image = view((160.0, 120.0))
    for pixels, encoding in (
        (image[:, :, ::-1], "rgb8"),
        (np.dstack([image, image[:, :, 0]]), "bgra8"),
        (np.dstack([image, image])[:, :, :3], "bgr8"),
    ):
        before = pixels.copy()
        tracker = rv.WindowTracker()
        tracker.update(0.0, pixels, encoding)
        tracker.select(box((160.0, 120.0)))
        (found,) = tracker.update(0.1, pixels, encoding)
        assert found.center == pytest.approx((160.0, 120.0), abs=0.6)
        assert np.array_equal(pixels, before)
    gray = (image[:, :, 0].astype(np.uint16)) << 8
    tracker.update(0.2, gray, "mono16")
    with pytest.raises(ValueError, match="has no colour of its own"):
        tracker.select((100, 100, 50, 50))
    with pytest.raises(ValueError, match="mono8"):
        tracker.update(0.3, image, "mono8")
    with pytest.raises(ValueError, match="time_s is nan, must be finite"):
        tracker.update(np.nan, image)


@pytest.mark.parametrize("method, near", [("camshift", 1.5), ("meanshift", 4.0)])
def test_the_scene_s_ball_is_followed_for_its_whole_round(method, near):
    settings = rv.SceneParams()
    settings.width, settings.height = SIZE
    scene = rv.Scene(settings)
    tracker, errors, ratios = None, [], []
    for number in range(0, 600, 4):
        image = scene.render(number)
        (outline,) = (one.outline for one in scene.truth(number).objects if one.name == "ball")
        if tracker is None:
            where = cv2.boundingRect(np.rint(outline).astype(np.int32))
            tracker = selected(image, where, method=method)
        (found,) = tracker.update(number / RATE, image)
        assert found.tracked
        errors.append(np.hypot(*np.subtract(found.center, outline.mean(axis=0))))
        ratios.append(sides(found.outline)[0] / np.ptp(outline, axis=0).max())
    assert max(errors) < near and np.median(errors) < 0.5 * near
    if method == "camshift":
        assert min(ratios) > 0.93 and max(ratios) < 1.1


def test_a_label_is_drawn_without_its_accents():
    image, drawn = view((160.0, 120.0)), []
    for label in ("Zoë", "Zoe"):
        tracker = rv.WindowTracker()
        tracker.update(0.0, image)
        tracker.select(box((160.0, 120.0)), label)
        drawn.append(image.copy())
        draw_window(drawn[-1], *tracker.objects())
    assert np.array_equal(*drawn) and not np.array_equal(drawn[0], image)
