"""Motion in a photograph through which a box wanders, against the truth."""

from functools import lru_cache

import cv2
import numpy as np
import pytest
import skimage.data
from faces import iou

import robot_vision as rv

PHOTOGRAPH = cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2BGR)[:384]
BOX = np.random.default_rng(2).integers(0, 256, (70, 90, 3), np.uint8)
RATE = 30.0  # Hz


def place(frame):
    """Top left corner of the box: it comes in, rests, and goes on out of the image."""
    step = min(frame, 60) + max(frame - 120, 0) - 30
    return 8 * step, 100 + step


@lru_cache(maxsize=None)  # drawing the noise takes longer than finding what moves
def frame_of(frame, box=True, seed=0):
    """A frame with the camera's noise, and the box's part of it as (x, y, width, height)."""
    image = PHOTOGRAPH.copy()
    width = image.shape[1]
    x, y = place(frame)
    left, right = max(x, 0), min(x + BOX.shape[1], width)
    shown = box and right > left
    if shown:
        image[y : y + BOX.shape[0], left:right] = BOX[:, left - x : right - x]
    noise = np.random.default_rng(seed + frame).normal(0.0, 2.0, image.shape)
    image = np.clip(image + noise, 0, 255).astype(np.uint8)
    return image, (left, y, right - left, BOX.shape[0]) if shown else None


def params(**values):
    made = rv.MotionParams()
    for name, value in values.items():
        setattr(made, name, value)
    return made


@pytest.mark.parametrize("method", ["first_frame", "running_average", "mog2"])
def test_box_is_found_when_and_where_it_is(method):
    detector = rv.MotionDetector(params(method=method, learning_rate=0.002))
    for frame in range(30):  # mog2 learns what is there
        detector.update(frame / RATE, frame_of(0, box=False, seed=1000 + frame)[0])
    right = wrong = missed = 0
    for frame in range(220):
        image, truth = frame_of(frame)
        regions = detector.update(1.0 + frame / RATE, image).regions
        if truth is not None and truth[2] < 30:
            continue  # a strip at the border, smaller than the least area
        hits = sum(truth is not None and iou(region.box, truth) >= 0.5 for region in regions)
        right += hits > 0
        wrong += len(regions) - hits
        missed += truth is not None and not hits
    assert right > 80
    assert right / (right + wrong) >= 0.95 and right / (right + missed) >= 0.95


def walker(x):
    """A room with somebody who is 80 px wide and looks the same all over, at x."""
    image = np.full((240, 320, 3), 90, np.uint8)
    image[80:200, max(x, 0) : max(x + 80, 0)] = 200
    noise = np.random.default_rng(x + 1000).normal(0.0, 2.0, image.shape)
    return np.clip(image + noise, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("speed", [2, 6])  # px per frame
def test_a_walker_is_whole_for_mog2_by_default(speed):
    detector = rv.MotionDetector(params(method="mog2"))
    for frame in range(10):
        detector.update(frame / RATE, walker(-100 - frame))
    for frame, x in enumerate(range(0, 130, speed), 10):
        (region,) = detector.update(frame / RATE, walker(x)).regions
        assert iou(region.box, (x, 80, 80, 120)) > 0.85, x


def test_previous_frame_sees_what_moves_now():
    detector = rv.MotionDetector(params(method="previous_frame"))
    moving, resting = [], []
    for frame in range(120):
        image, truth = frame_of(frame)
        regions = detector.update(frame / RATE, image).regions
        if truth is not None and truth[2] == BOX.shape[1]:
            (moving if frame <= 60 else resting).append(len(regions) > 0)
    assert np.mean(moving) >= 0.95 and np.mean(resting) <= 0.05


@pytest.mark.parametrize("method", ["first_frame", "previous_frame", "running_average", "mog2"])
def test_only_the_first_frame_stays_the_background_when_time_goes_back(method):
    detector = rv.MotionDetector(params(method=method))
    detector.update(10.0, frame_of(0, box=False)[0])
    image, truth = frame_of(60)
    for second, kept in ((10.1, True), (9.0, method == "first_frame")):
        regions = detector.update(second, image).regions
        assert len(regions) == kept, second
        assert not kept or iou(regions[0].box, truth) > 0.5
    empty = detector.update(9.1, frame_of(0, box=False, seed=1)[0])
    assert len(empty.regions) == (method != "first_frame")


def test_a_change_of_the_whole_image_settles_anew_when_time_goes_back():
    detector = rv.MotionDetector(params(settle=1.0))
    dark = frame_of(0, box=False)[0] // 3
    lit = frame_of(0, box=False)[0] // 2 + 100
    detector.update(10.0, dark)
    for second, is_change in ((10.5, True), (5.0, True), (5.9, True), (6.0, True), (6.1, False)):
        assert detector.update(second, lit).everywhere == is_change, second


def test_a_shaken_camera_is_not_one_huge_box():
    detector = rv.MotionDetector(params(threshold=10.0, max_changed=0.3))
    still = frame_of(0, box=False)[0]
    detector.update(0.0, still)
    for number, (dx, dy) in enumerate([(30, 10), (-25, 20), (40, -30)], 1):
        motion = detector.update(0.1 * number, np.roll(still, (dy, dx), (0, 1)))
        assert motion.everywhere and not motion.regions
    motion = detector.update(0.5, still)
    assert not motion.everywhere and not motion.regions


def test_lights_go_on_and_a_box_is_left():
    """Afterwards the lit room is the background, and with a running average the box as well."""
    detector = rv.MotionDetector(params(method="running_average", learning_rate=0.1))
    dark = frame_of(0, box=False)[0] // 3
    for frame in range(30):
        assert not detector.update(frame / RATE, dark).regions
    lit = frame_of(0, box=False)[0] // 2 + 100
    changes = [detector.update(1.0 + frame / RATE, lit) for frame in range(60)]
    assert changes[0].everywhere
    assert not any(change.regions for change in changes[:1] + changes[45:])
    left = lit.copy()
    left[100:170, 200:290] = BOX
    after = [detector.update(3.0 + frame / RATE, left) for frame in range(120)]
    assert iou(after[0].regions[0].box, (200, 100, 90, 70)) > 0.5
    assert not after[-1].regions


class Room:
    """The synthetic scene before a still camera: a ball bounces, a box moves now and then."""

    def __init__(self):
        params = rv.SceneParams()
        params.still = True
        self._scene = rv.Scene(params)
        params.noise = 0.0
        self._clean = rv.Scene(params)
        self._first = self.gray(0)

    def gray(self, frame):
        return cv2.cvtColor(self._clean.render(frame), cv2.COLOR_BGR2GRAY)

    def image(self, frame):
        return self._scene.render(frame)

    def changed(self, frame):
        """Where the image is another one than at first, by more than 25 gray levels."""
        return cv2.absdiff(self.gray(frame), self._first) > 25

    def silhouette(self, frame, name):
        """Where an object is, and its outline's points."""
        outline = next(o.outline for o in self._scene.truth(frame).objects if o.name == name)
        mask = np.zeros(self._first.shape, np.uint8)
        cv2.fillPoly(mask, [np.rint(outline).astype(np.int32)], 255)
        return mask > 0, outline


def test_of_many_regions_the_largest_are_told():
    params = rv.MotionParams()
    params.method, params.blur_size, params.threshold, params.dilate = "previous_frame", 1, 0.0, 0
    params.min_area, params.max_changed = 0.0, 1.0
    detector = rv.MotionDetector(params)
    image = np.zeros((240, 320), np.uint8)
    detector.update(0.0, image, "mono8")
    image = image.copy()
    image[::4, ::4] = 255  # 4800 of 1 px
    image[100:110, 100:120] = 255
    motion = detector.update(0.1, image, "mono8")
    areas = [region.area for region in motion.regions]
    assert len(areas) == 1000 and areas[0] > 150 and areas == sorted(areas, reverse=True)


def test_the_scene_s_box_and_ball_are_found_while_they_are_elsewhere():
    room = Room()
    detector = rv.MotionDetector(params())
    detector.update(0.0, room.image(0))
    rest = {name: room.silhouette(0, name)[0] for name in ("box", "ball")}
    found = missed = right = wrong = moved_box = 0
    for frame in range(5, 600, 5):
        motion = detector.update(frame / RATE, room.image(frame))
        changed = room.changed(frame)
        for name in rest:
            now = room.silhouette(frame, name)[0]
            fresh = now & ~rest["box"] & ~rest["ball"] & changed
            if fresh.sum() < 1000:  # too much of it is where something was at first
                continue
            moved_box += name == "box"
            seen = (motion.mask[fresh] > 0).mean() >= 0.9
            inside = any(covers(region.box, fresh) for region in motion.regions)
            found += seen and inside
            missed += not (seen and inside)
        for region in motion.regions:
            x, y, width, height = region.box
            true = changed[y : y + height, x : x + width].sum() >= 0.3 * region.area
            right += true
            wrong += not true
    assert moved_box > 30 and found + missed > 100
    assert found / (found + missed) >= 0.95 and right / (right + wrong) >= 0.95
    # Whenever the box is where it was, nothing is said to have moved there.
    quiet = detector.update(21.0, room.image(1)).mask[rest["box"] & ~rest["ball"]]
    assert not quiet.any()


def covers(box, mask):
    """Whether a box holds nine tenths of a mask's pixels."""
    x, y, width, height = box
    return mask[y : y + height, x : x + width].sum() >= 0.9 * mask.sum()
