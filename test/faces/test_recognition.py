"""Faces in photographs: found, made alike, told apart and named by votes."""

import concurrent.futures
import math
import threading
import tracemalloc

import cv2
import numpy as np
import pytest
import skimage.data
from people import ANNA, BERT, CARLA, KNOWN, STRANGERS, looks, photograph

from robot_vision.faces.enrollment import PERIOD, Enrollment, OfferedFace
from robot_vision.faces.face_images import (
    MARGIN,
    PORTRAIT_SIDE,
    SIDE,
    cut_out,
    face_of,
    find_face,
    normalized,
    portrait,
)
from robot_vision.faces.identities import MEMORY, UNKNOWN, Identities, VoteParams
from robot_vision.faces.recognition import NOBODY, LbphRecognizer

ASTRONAUT = cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2BGR)
FACE = 224, 116  # px: the astronaut's nose


def is_around(box, point, size):
    """Whether a box has its middle near a point, and is about as wide as `size`."""
    x, y, width, height = box
    far = math.hypot(x + width / 2 - point[0], y + height / 2 - point[1])
    return far < 0.25 * size and 0.6 * size < width < 1.4 * size


@pytest.mark.parametrize("scale", [0.6, 1.0, 4.0])
def test_face_is_found_in_a_photograph_of_any_size(scale):
    image = cv2.resize(ASTRONAUT, None, fx=scale, fy=scale, interpolation=cv2.INTER_LINEAR)
    before = image.copy()
    box = find_face(image)
    assert is_around(box, [scale * value for value in FACE], scale * 100), box
    assert find_face(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)) == box
    assert np.array_equal(image, before)


def test_faces_are_found_by_several_threads_at_once():
    images = [photograph(ANNA, number)[0] for number in range(40)]
    with concurrent.futures.ThreadPoolExecutor(4) as threads:
        assert list(threads.map(find_face, images)) == [find_face(one) for one in images]


def test_largest_face_is_the_one():
    images = [photograph(ANNA, 0), photograph(BERT, 1)]
    (small, _), (large, (x, y, side, _)) = sorted(images, key=lambda one: one[1][2])
    small = cv2.copyMakeBorder(small[::2, ::2], 60, 60, 0, 0, cv2.BORDER_REPLICATE)
    both = np.hstack([small, large])
    assert is_around(find_face(both), (160 + x + side / 2, y + side / 2), side)


def test_faces_that_fill_their_image_are_found():
    found = 0
    for look in looks():
        tight = cv2.resize((255 * look).astype(np.uint8), (150, 150))
        box = find_face(tight)
        found += box is not None and is_around(box, (75, 75), 140)
    assert found >= 90


@pytest.mark.parametrize("shape", [(1, 1), (3, 200, 3), (240, 320, 3)])
def test_no_face_is_found_where_there_is_none(shape):
    blank = np.full(shape, 90, np.uint8)
    assert find_face(blank) is None
    for use in (face_of, portrait):
        with pytest.raises(ValueError, match="no face is found in it"):
            use(blank)


@pytest.mark.parametrize("margin", [0.0, 0.3])
@pytest.mark.parametrize(
    "box", [(0, 0, 20, 10), (-3, -2, 8, 9), (35, 25, 20, 20), (-9, -9, 70, 60)]
)
def test_cut_out_continues_the_border(box, margin):
    image = np.random.default_rng(1).integers(0, 256, (30, 40, 3), np.uint8)
    x, y, width, height = box
    across, down = round(margin * width), round(margin * height)
    columns = np.clip(np.arange(x - across, x + width + across), 0, 39)
    rows = np.clip(np.arange(y - down, y + height + down), 0, 29)
    assert np.array_equal(cut_out(image, box, margin), image[np.ix_(rows, columns)])


@pytest.mark.parametrize("box", [(0, 0, 0, 10), (0, 0, 10, -1), (40, 0, 5, 5), (0, -9, 5, 9)])
def test_box_that_is_not_in_the_image_is_refused(box):
    with pytest.raises(ValueError, match=r"the box .* is not in the image of 40x30"):
        normalized(np.zeros((30, 40), np.uint8), box)


@pytest.mark.parametrize("box", [(0, 0, 81, 10), (0, 0, 10, 81), (0, 0, 2**32 - 1, 2**32 - 1)])
def test_box_far_larger_than_the_image_is_refused(box):
    image = np.zeros((30, 40), np.uint8)
    for use in (normalized, portrait):
        with pytest.raises(ValueError, match=r"the box .* must have sides of at most 80 px"):
            use(image, box)
    assert normalized(image, (0, 0, 80, 80)).shape == (SIDE, SIDE)


@pytest.mark.parametrize("use, side", [(normalized, SIDE), (portrait, PORTRAIT_SIDE)])
def test_box_larger_than_a_large_image_takes_little_memory(use, side):
    image = np.zeros((2160, 3840, 3), np.uint8)
    image[:, 2000:] = 255
    for box in ((0, 0, 7680, 7680), (3839, 2159, 7680, 7680), (-7679, -7679, 7680, 7680)):
        tracemalloc.start()
        face = use(image, box)
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert face.shape[:2] == (side, side) and most < image.nbytes, box
    wide = portrait(image, (0, 0, 7680, 7680))  # from -3840 to 11520: white from 5840 on
    edge = round(PORTRAIT_SIDE * 5840 / 15360)
    assert not wide[:, : edge - 3].any() and (wide[:, edge + 3 :] == 255).all()


def test_normalized_faces_are_alike_in_any_size_and_light():
    box = 180, 70, 90, 90
    face = normalized(ASTRONAUT, box)
    assert face.shape == (SIDE, SIDE) and face.dtype == np.uint8
    assert face.min() == 0 and face.max() == 255
    large = cv2.resize(ASTRONAUT, None, fx=3, fy=3)
    dark = (40 + 0.4 * ASTRONAUT).astype(np.uint8)
    for other in (normalized(large, (540, 210, 270, 270)), normalized(dark, box)):
        assert np.mean(cv2.absdiff(face, other)) < 6.0


def test_portrait_has_the_face_in_its_middle_and_is_bounded():
    _, _, width, height = find_face(ASTRONAUT)
    image = portrait(ASTRONAUT)
    assert image.shape == (
        height + 2 * round(MARGIN * height),
        width + 2 * round(MARGIN * width),
        3,
    )
    assert is_around(find_face(image), (image.shape[1] / 2, image.shape[0] / 2), width)
    large = portrait(cv2.resize(ASTRONAUT, None, fx=5, fy=5))
    assert max(large.shape) == PORTRAIT_SIDE


def test_ten_people_are_told_apart_and_ten_are_strangers():
    faces = [(person, face_of(photograph(person, n)[0])) for person in KNOWN for n in range(5)]
    recognizer = LbphRecognizer()
    recognizer.train([face for _, face in faces], [person for person, _ in faces])
    limit = VoteParams().max_distance
    right = named = 0
    for person in KNOWN + STRANGERS:
        for number in range(10, 16):
            label, distance = recognizer.predict(face_of(photograph(person, number)[0]))
            right += person in KNOWN and label == person and distance <= limit
            named += person in STRANGERS and distance <= limit
    assert right >= 0.97 * 60 and named == 0


def test_recognizer_forgets_when_it_is_trained_anew():
    anna, bert = (face_of(photograph(person, 0)[0]) for person in (ANNA, BERT))
    recognizer = LbphRecognizer()
    assert recognizer.predict(anna) == (NOBODY, math.inf)
    recognizer.train([anna, bert], [4, 7])
    assert recognizer.predict(anna) == (4, 0.0) and recognizer.predict(bert) == (7, 0.0)
    recognizer.train([bert], [0])
    assert recognizer.predict(bert) == (0, 0.0)
    assert recognizer.predict(anna)[1] > VoteParams().max_distance
    recognizer.train([], [])
    assert recognizer.predict(anna) == (NOBODY, math.inf)


def test_opencv_without_the_recogniser_is_told(monkeypatch):
    monkeypatch.delattr(cv2, "face")
    with pytest.raises(ValueError, match=r"the OpenCV in .* has no module face"):
        LbphRecognizer()


def voted(identities, *names, distance=50.0, number=1, start=0.0):
    """The names that a face has after each of these votes."""
    shown = []
    for index, name in enumerate(names):
        identities.vote(number, name, distance, start + index)
        shown.append(identities.of(number).name)
    return shown


def test_name_comes_with_the_majority_and_does_not_flicker():
    identities = Identities()
    assert identities.of(1).name == UNKNOWN
    assert voted(identities, *"AAAAA") == [UNKNOWN] * 2 + ["A"] * 3
    assert identities.of(1).score == 1.0 and identities.of(1).known
    assert set(voted(identities, *"BABABABABAB")) == {"A"}
    assert identities.of(1).score == 0.4
    assert voted(identities, *"BBB") == ["A", "B", "B"]
    assert set(voted(identities, *"ABABABABABA")) == {"B"}
    assert identities.of(2).name == UNKNOWN


def test_unknown_wins_and_loses_like_a_name():
    identities = Identities()
    voted(identities, *"AAA", distance=50.0)
    assert voted(identities, *"AAA", distance=90.0) == ["A", "A", "A"]
    assert voted(identities, *"A", distance=90.0) == [UNKNOWN]
    identity = identities.of(1)
    assert (identity.known, identity.distance, identity.score) == (False, 90.0, 0.8)
    assert voted(identities, *"AAA", distance=50.0) == [UNKNOWN, UNKNOWN, "A"]


def test_parameters_count_from_the_next_look():
    identities = Identities()
    voted(identities, *"AAAAA", distance=50.0)
    identities.params = VoteParams(max_distance=40.0)
    assert identities.of(1).name == UNKNOWN
    identities.params = VoteParams(max_distance=60.0, votes=3)
    assert identities.of(1).name == "A"
    assert voted(identities, *"BBB") == ["A", "A", "B"]
    assert identities.at_once("A", 60.0).name == "A" and identities.at_once("A", 60.1).score == 1.0
    assert not identities.at_once("A", 60.1).known


def test_looks_are_limited_and_faces_forgotten():
    identities = Identities()
    identities.params = VoteParams(rate=4.0)
    looks = 0
    for frame in range(300):
        now = frame / 30.0
        if identities.due(1, now):
            looks += 1
            identities.vote(1, "A", 10.0, now)
        identities.see([1], now)
    assert 30 <= looks <= 40
    identities.see([2], 10.0 + MEMORY - 0.1)
    assert identities.of(1).name == "A"
    identities.see([2], 10.0 + MEMORY + 0.1)
    assert identities.of(1).name == UNKNOWN
    identities.vote(1, "A", 10.0, 10.0 + MEMORY + 0.2)
    assert identities.of(1).name == UNKNOWN  # its votes are forgotten, too
    voted(identities, *"AAA", start=100.0)
    identities.see([1], 102.0 + MEMORY + 0.1)  # another person's, perhaps
    assert identities.of(1).name == UNKNOWN and identities.due(1, 102.0 + MEMORY + 0.1)
    voted(identities, *"AAA", start=200.0)
    identities.clear()
    assert identities.of(1).name == UNKNOWN and identities.due(1, 0.0)


def test_enrollment_takes_images_of_one_clear_face():
    image, head = photograph(CARLA, 0)
    blank = np.zeros_like(image)
    face, other = OfferedFace(head), OfferedFace(head, predicted=True)
    enrollment = Enrollment(2)
    for now, (offered, faces) in enumerate(
        [
            (image, []),
            (image, [face, face]),
            (image, [face, other]),
            (image, [other]),
            (blank, [face]),
            (image, [OfferedFace((900, 0, 9, 9))]),
        ]
    ):
        enrollment.offer(offered, faces, float(now))
    assert not enrollment.wait(0.0, lambda: False)
    assert enrollment.outcome() == (
        "took 0 of 2 images; 3 showed no clear face; 1 showed no face; 2 showed several faces"
    )
    for now, taken in [(10.0, 1), (10.0 + PERIOD / 2, 1), (10.0 + 1.5 * PERIOD, 2), (20.0, 2)]:
        enrollment.offer(image, [face], now)
        assert len(enrollment.portraits) == taken
    assert enrollment.wait(0.0, lambda: False)
    assert list(enrollment.portraits) == ["image 1", "image 2"]
    for taken in enrollment.portraits.values():
        assert np.array_equal(taken, portrait(image, head))


def test_enrollment_begins_anew_when_ids_do():
    image, head = photograph(ANNA, 0)
    enrollment = Enrollment(2)
    enrollment.begin_anew()
    assert enrollment.outcome() == "took 0 of 2 images; saw no others"
    enrollment.offer(image, [OfferedFace(head, id=1)], 0.0)
    enrollment.begin_anew()
    for now in (1.0, 2.0):
        assert not enrollment.wait(0.0, lambda: False)
        enrollment.offer(image, [OfferedFace(head, id=1)], now)
    enrollment.begin_anew()  # All are there.
    assert enrollment.wait(0.0, lambda: False) and len(enrollment.portraits) == 2
    assert enrollment.outcome() == "took 2 of 2 images; 1 showed another face"


def test_enrollment_begins_anew_when_another_face_comes():
    enrollment = Enrollment(3)
    portraits = []
    for now, (person, number) in enumerate([(ANNA, 0), (ANNA, 1), (BERT, 0), (BERT, 1), (BERT, 2)]):
        image, head = photograph(person, number)
        enrollment.offer(image, [OfferedFace(head, id=person)], float(now))
        portraits.append(portrait(image, head))
    assert enrollment.wait(0.0, lambda: False)
    assert enrollment.outcome() == "took 3 of 3 images; 2 showed another face"
    for taken, expected in zip(enrollment.portraits.values(), portraits[2:]):
        assert np.array_equal(taken, expected)


def test_enrollment_begins_anew_when_the_face_was_gone():
    """Who comes to a place that is free gets the id of who was there last."""
    enrollment = Enrollment(3)
    begin, detector_misses_it, is_gone = 0.0, 1.4, 2.0
    for number, now in enumerate((begin, 1.0)):
        image, head = photograph(ANNA, number)
        enrollment.offer(image, [OfferedFace(head, id=1)], now)
    enrollment.offer(image, [], detector_misses_it)
    assert len(enrollment.portraits) == 2
    enrollment.offer(image, [OfferedFace(head, id=1, predicted=True)], 1.6)
    enrollment.offer(image, [], is_gone)
    assert enrollment.portraits == {}
    expected = []
    for number in range(3):
        image, head = photograph(BERT, number)
        enrollment.offer(image, [OfferedFace(head, id=1)], 3.0 + number)
        expected.append(portrait(image, head))
    assert enrollment.wait(0.0, lambda: False)
    assert "2 were taken before the face was gone" in enrollment.outcome()
    assert all(map(np.array_equal, enrollment.portraits.values(), expected))


def test_enrollment_ends_when_it_is_given_up():
    given_up = threading.Event()
    waiting = threading.Thread(target=Enrollment(1).wait, args=(600.0, given_up.is_set))
    waiting.start()
    given_up.set()
    waiting.join(60.0)
    assert not waiting.is_alive()
    assert Enrollment(1).outcome() == "took 0 of 1 images; saw no others"
