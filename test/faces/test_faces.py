"""Faces in photographs, against OpenCV's own search of every frame."""

import math
import pathlib

import cv2
import numpy as np
import pytest
import skimage.data
from faces import BACKGROUND, KINDS, PORTRAIT, RATE, frame, iou, is_at
from people import looks

import robot_vision as rv

CASCADES = "/usr/share/opencv4/haarcascades/"
FRONTAL = cv2.CascadeClassifier(CASCADES + "haarcascade_frontalface_default.xml")
PROFILE = cv2.CascadeClassifier(CASCADES + "haarcascade_profileface.xml")
PROFILE_PORTRAIT = cv2.cvtColor(skimage.data.camera(), cv2.COLOR_GRAY2BGR)


def params(**values):
    """Every search in the caller's thread: the same frames give the same faces."""
    made = rv.FaceParams()
    made.background = False
    for name, value in values.items():
        setattr(made, name, value)
    return made


def searched(cascade, gray, mirrored=False):
    """detectMultiScale with the parameters' defaults."""
    pixels = cv2.flip(gray, 1) if mirrored else gray
    found = cascade.detectMultiScale(pixels, 1.2, 2, 0, (40, 40))
    width = gray.shape[1]
    return {(width - x - w if mirrored else x, y, w, h) for x, y, w, h in map(tuple, found)}


def reference(image):
    """What the course's node finds, with profiles of both sides."""
    gray = cv2.equalizeHist(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))
    return searched(FRONTAL, gray) or searched(PROFILE, gray) | searched(PROFILE, gray, True)


def boxes(faces):
    return {face.box for face in faces}


PEOPLE = (looks() * 255).astype(np.uint8)


def crowd(places):
    """An image with a face, 100 px, at each place, (x, y)."""
    image = np.full((480, 640), 120, np.uint8)
    for (x, y), face in zip(places, PEOPLE):
        large = cv2.resize(face, (100, 100), interpolation=cv2.INTER_CUBIC)
        faded = cv2.copyMakeBorder(large, *(30, 30, 30, 30), cv2.BORDER_REPLICATE)
        image[y : y + 160, x : x + 160] = faded
    return image


@pytest.mark.parametrize("kind", KINDS)
def test_no_face_is_lost_that_a_search_of_every_frame_finds(kind):
    detector = rv.FaceDetector(params())
    ids, found, wrong = set(), 0, {}
    for number in range(0, 132, 4):  # the whole period
        image, truth = frame(number, kind)
        faces = detector.update(number / RATE, image)
        right = [face for face in faces if is_at(face, truth)]
        assert len(right) <= 1
        assert right or not any(iou(box, truth) >= 0.5 for box in reference(image)), number
        ids.update(face.id for face in right)
        found += len(right)
        wrong[number] = len(faces) - len(right)
    assert found >= 30 and len(ids) == 1
    too_many = sum(wrong.values())  # more than the reference finds in the frames looked at so far
    for number in sorted(wrong, key=wrong.get, reverse=True):
        if too_many > 0:
            image, truth = frame(number, kind)
            too_many -= sum(iou(box, truth) < 0.5 for box in reference(image))
    assert too_many <= 0


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    "original, is_there",
    [
        (PORTRAIT, True),
        (cv2.resize(PORTRAIT, None, fx=1.5, fy=1.5), True),
        (BACKGROUND, False),
        (PROFILE_PORTRAIT, True),  # of which only the mirrored image shows the side that is known
        (cv2.resize(PROFILE_PORTRAIT, None, fx=1.2, fy=1.2), True),
    ],
)
def test_a_search_finds_what_opencv_finds(original, is_there, mirrored):
    image = np.ascontiguousarray(original[:, ::-1]) if mirrored else original
    found = rv.FaceDetector(params()).detect(image)
    assert boxes(found) == reference(image) and (found or not is_there)
    assert [face.id for face in found] == [-1] * len(found)
    # The search for new faces goes from size to size, so that it can be ended.
    assert boxes(rv.FaceDetector(params()).update(0.0, image)) == boxes(found)


def places(size, number, random):
    """Faces of all sizes in an image, also cut off at its border."""
    width, height = size
    image = np.full((height, width), 120, np.uint8)
    image += random.integers(0, 20, image.shape, np.uint8)
    for i in range(number):
        side = min(int(random.choice([45, 70, 110, 180, 300])), height)
        face = cv2.resize(PEOPLE[i], (side, side), interpolation=cv2.INTER_CUBIC)
        x, y = (
            random.integers(-side // 4, width - side // 2),
            random.integers(-side // 4, height - side // 2),
        )
        left, top = max(-x, 0), max(-y, 0)
        face = face[top : height - y, left : width - x]
        image[y + top : y + top + face.shape[0], x + left : x + left + face.shape[1]] = face
    return image


@pytest.mark.parametrize(
    "size, number",
    [
        ((317, 211), 12),
        ((640, 480), 0),
        ((640, 480), 1),
        ((640, 480), 12),
        ((1280, 720), 12),
        ((1920, 1080), 12),
    ],
)
def test_every_box_is_opencvs(size, number):
    image = places(size, number, np.random.default_rng(size[0] + number))
    views = [image]
    if size[0] <= 640:
        views += [np.ascontiguousarray(np.rot90(image)), cv2.flip(image, 1)]
    found = 0
    for kind, cascade in (("frontalface_default", FRONTAL), ("profileface", PROFILE)):
        detector = rv.FaceDetector(params(cascade_1=f"haarcascade_{kind}.xml", cascade_2=""))
        for turned in views:
            expected = searched(cascade, cv2.equalizeHist(turned))
            assert boxes(detector.detect(turned, "mono8")) == expected
            # Of two that overlap one is followed.
            assert boxes(detector.update(0.0, turned, "mono8")) <= expected
            found += len(expected)
    assert found or not number


@pytest.mark.parametrize("size", [(1280, 720), (1920, 1080)])
def test_faces_in_large_images_are_followed_to_the_border(size):
    detector = rv.FaceDetector(params(cascade_2=""))
    width, height = size
    side, large = 60, 400
    small_face, large_face = (cv2.resize(PEOPLE[i], 2 * (n,)) for i, n in ((0, side), (3, large)))
    ids = set()
    for number in range(30):
        image = np.full((height, width), 120, np.uint8)
        x, y = width - side - 4 * (29 - number), 29 - number
        image[y : y + side, x : x + side] = small_face
        image[height - large :, 3 * number : 3 * number + large] = large_face
        faces = detector.update(number / RATE, image, "mono8")
        at = [(x, y, side, side), (3 * number, height - large, large, large)]
        found = [[face for face in faces if iou(face.box, truth) > 0.4] for truth in at]
        assert [len(some) for some in found] == [1, 1] and len(faces) == 2, number
        ids.update(face.id for (face,) in found)
    assert len(ids) == 2


@pytest.mark.parametrize("size", [(640, 480), (1920, 1080)])
@pytest.mark.parametrize("kind", ["flat", "noise", "clouds"])
def test_nothing_is_found_where_there_is_no_face(size, kind):
    random = np.random.default_rng(7)
    width, height = size
    image = np.full((height, width), 90, np.uint8)
    if kind != "flat":
        image = random.integers(0, 256, image.shape, np.uint8)
    if kind == "clouds":
        image = cv2.GaussianBlur(image, (0, 0), 20)
    detector = rv.FaceDetector(params(cascade_2="", equalize=kind != "flat"))
    for number in range(3):
        assert detector.update(number / RATE, image, "mono8") == []


@pytest.mark.parametrize(
    "smallest, largest, is_any_found",
    [
        (40, 60, True),
        (60, 100, True),
        (100, 125, True),
        (120, 0, True),
        (120, 135, True),
        (130, 0, False),  # the face is smaller
        (130, 135, False),
        (105, 120, False),  # between two sizes that are searched
    ],
)
def test_sizes_are_kept(smallest, largest, is_any_found):
    detector = rv.FaceDetector(params(min_size=smallest, max_size=largest))
    found = 0
    for number in range(8):
        image, _ = frame(number)
        for face in (*detector.update(number / RATE, image), *detector.detect(image)):
            assert smallest <= face.box[2] <= (largest or 480)
            found += 1
    assert (found > 0) == is_any_found


def test_boxes_are_inside_of_the_image():
    random = np.random.default_rng(3)
    detector = rv.FaceDetector(params(min_size=24, min_neighbors=1, scale_factor=1.05))
    found = 0
    for image in PEOPLE:
        left, top, right, bottom = random.integers(0, 8, 4)
        tight = cv2.copyMakeBorder(
            cv2.resize(image, tuple(random.integers(28, 48, 2).tolist())),
            *(top, bottom, left, right),
            cv2.BORDER_REPLICATE,
        )
        for face in detector.detect(tight, "mono8"):
            x, y, width, height = face.box
            assert x >= 0 and y >= 0 and width > 0 and height > 0
            assert x + width <= tight.shape[1] and y + height <= tight.shape[0]
            found += 1
    assert found > 50


def test_lbp_cascades_find_faces_as_well():
    lbp = params(cascade_1="lbpcascade_frontalface_improved.xml", cascade_2="")
    image, truth = frame(0)
    (face,) = rv.FaceDetector(lbp).detect(image)
    assert iou(face.box, truth) > 0.4  # its window is tighter


def test_windows_need_not_be_square():
    tall = {"cascade_1": "lbpcascade_profileface.xml", "cascade_2": "", "min_neighbors": 0}
    for image in (PORTRAIT, BACKGROUND):
        found = boxes(rv.FaceDetector(params(**tall)).detect(image))
        assert found and all(height > width >= 40 for _, _, width, height in found)
        # update() goes from size to size, and groups alike what it finds.
        assert boxes(rv.FaceDetector(params(**tall)).update(0.0, image)) == found


def test_eyes_are_in_the_face():
    detector = rv.FaceDetector(params())
    for scale in (0.6, 1.0, 2.0):
        (face, *_) = (
            face
            for face in detector.detect(cv2.resize(PORTRAIT, None, fx=scale, fy=scale))
            if is_at(face, tuple(scale * v for v in (170, 60, 108, 108)))
        )
        left, right = detector.find_eyes(face)
        for (x, y, width, height), truth in ((left, (202, 102)), (right, (247, 103))):
            middle = np.array([x + width / 2, y + height / 2]) / scale
            assert np.abs(middle - truth).max() < 8
    without = rv.FaceDetector(params(eye_cascade=""))
    assert without.find_eyes(without.detect(PORTRAIT)[0]) == []


def test_several_faces_keep_their_ids():
    detector = rv.FaceDetector(params(cascade_2=""))
    first = {}
    for number in range(45):
        shift = round(60 * math.sin(0.1 * number))
        places = [(20, 160 + shift), (240, 160 - shift), (460, 160 + shift)]
        faces = detector.update(number / RATE, crowd(places), "mono8")
        for face in faces:
            (nearest,) = (
                i for i, (x, y) in enumerate(places) if is_at(face, (x + 30, y + 30, 100, 100))
            )
            assert first.setdefault(nearest, face.id) == face.id
        assert len(faces) == 3, number
    assert len(set(first.values())) == 3


def test_a_new_face_is_found_within_the_period_and_one_that_goes_is_gone():
    detector = rv.FaceDetector(params(cascade_2="", max_search_period=0.5, hold=0.3))
    old = (40, 100)
    for number in range(20):
        assert not detector.update(number / RATE, crowd([]), "mono8")
    times = []
    for number in range(20, 60):
        faces = detector.update(number / RATE, crowd([old]), "mono8")
        times += [number] if faces else []
    assert times[0] <= 20 + 0.5 * RATE and len(times) == 60 - times[0]
    gone = [bool(detector.update(n / RATE, crowd([]), "mono8")) for n in range(60, 100)]
    assert not any(gone[1:])
    # It is remembered for a while.
    (face,) = detector.update(101 / RATE, crowd([old]), "mono8") or detector.update(
        117 / RATE, crowd([old]), "mono8"
    )
    assert face.id == 0


def test_a_face_that_no_cascade_sees_is_predicted_by_its_looks():
    detector = rv.FaceDetector(params(cascade_2="", hold=0.3))
    image = crowd([(240, 160)])
    for number in range(20):
        (face,) = detector.update(number / RATE, image, "mono8")
        assert not face.predicted
    image[214:238, 270:370] = 60  # a bar over the eyes
    assert not rv.FaceDetector(params(cascade_2="")).detect(image, "mono8")
    states = [detector.update((20 + n) / RATE, image, "mono8") for n in range(15)]
    held = round(0.3 * RATE)
    assert all(states[: held - 1]) and not any(states[held:])
    for (face,) in states[: held - 1]:
        assert face.predicted and face.id == 0 and 0.7 <= face.score <= 1.0
        assert iou(face.box, (270, 190, 100, 100)) > 0.5


@pytest.mark.parametrize("rate", [10, 60])  # Hz
@pytest.mark.parametrize("seen, part", [(12, 1.0), (5, 0.5)])  # frames, and the part of `hold`
def test_hold_is_as_long_at_any_rate(rate, seen, part):
    detector = rv.FaceDetector(params(cascade_2="", hold=1.0, max_search_period=2.0))
    image = crowd([(240, 160)])
    for number in range(seen):
        (face,) = detector.update(number / rate, image, "mono8")
        assert not face.predicted
    image[214:238, 270:370] = 60  # a bar over the eyes
    held = round(part * rate)  # frames
    frames = range(seen, seen + held + 5)
    states = [detector.update(number / rate, image, "mono8") for number in frames]
    assert all(states[: held - 1]) and not any(states[held:])
    assert all(face.predicted for (face,) in states[: held - 1])


def test_velocity_is_that_of_the_face():
    detector = rv.FaceDetector(params(cascade_2=""))
    for number in range(30):
        faces = detector.update(number / RATE, crowd([(20 + 8 * number, 160)]), "mono8")
    assert faces[0].velocity == pytest.approx((8 * RATE, 0.0), abs=0.25 * 8 * RATE)


def test_a_moving_face_is_found_before_the_next_search_of_everything():
    detector = rv.FaceDetector(params(cascade_2="", max_search_period=10.0))
    detector.update(0.0, crowd([]), "mono8")
    for number in range(1, 6):
        faces = detector.update(number / RATE, crowd([(240, 160)]), "mono8")
    assert [is_at(face, (270, 190, 100, 100)) for face in faces] == [True]


def test_searches_in_the_background_find_the_same():
    image, truth = frame(0)
    foreground, background = rv.FaceDetector(params()), rv.FaceDetector(params(background=True))
    expected = foreground.update(0.0, image)
    faces = []
    for number in range(100):  # what moves is searched before the whole image
        faces = background.update(number / RATE, image)
        if len(faces) == len(expected):
            break
        background.wait_for_search()
    assert len(faces) == len(expected) and any(is_at(face, truth) for face in faces)
    for face in expected:
        assert any(is_at(other, face.box) for other in faces)
    assert background.search_time > 0.0


def test_a_pause_of_the_stream_is_no_long_search():
    detector = rv.FaceDetector(params(background=True, cascade_2=""))
    image = crowd([(240, 160)])
    detector.update(100.0, image, "mono8")
    detector.wait_for_search()
    detector.update(160.0, image, "mono8")
    assert 0.0 < detector.search_time < 10.0


def test_time_of_a_search_is_that_of_a_slow_stream_too():
    detector = rv.FaceDetector(params(background=True, cascade_2="", max_search_period=0.1))
    for time_s in (100.0, 100.5, 101.0):
        detector.update(time_s, crowd([]), "mono8")
        detector.wait_for_search()
    assert detector.search_time == 0.5
    detector.update(161.0, crowd([]), "mono8")
    assert detector.search_time == 1.0


def test_frames_at_almost_the_same_time():
    detector = rv.FaceDetector(params(cascade_2=""))
    for number in range(20):
        image = crowd([(240 + number % 2, 160)])
        (face,) = detector.update(1.0 + 1e-6 * number, image, "mono8")
        assert np.hypot(*face.velocity) < 1e4
    (face,) = detector.update(2.0, image, "mono8")
    assert is_at(face, (270, 190, 100, 100))


def test_a_face_of_a_size_that_is_no_longer_wanted_is_forgotten():
    detector = rv.FaceDetector(params(cascade_2=""))
    image = crowd([(240, 160)])
    assert detector.update(0.0, image, "mono8")
    detector.configure(params(cascade_2="", min_size=200))
    assert not detector.update(1 / RATE, image, "mono8")


def test_other_parameters_keep_the_faces():
    detector = rv.FaceDetector(params())
    image, truth = frame(0)
    (before,) = (face for face in detector.update(0.0, image) if is_at(face, truth))
    detector.configure(params(min_neighbors=3))
    (after,) = (face for face in detector.update(1 / RATE, image) if is_at(face, truth))
    assert after.id == before.id
    with pytest.raises(ValueError, match="min_neighbors"):
        detector.configure(params(min_neighbors=-1))
    with pytest.raises(ValueError, match="cascade_1"):
        detector.configure(params(cascade_1="none.xml"))
    (after,) = (face for face in detector.update(2 / RATE, image) if is_at(face, truth))
    assert after.id == before.id


def test_another_size_and_an_earlier_time_begin_anew():
    detector = rv.FaceDetector(params(cascade_2=""))
    image = crowd([(240, 160)])
    (face,) = detector.update(5.0, image, "mono8")
    assert face.id == 0
    (face,) = detector.update(1.0, image, "mono8")
    assert face.id == 1
    detector.detect(PORTRAIT)  # has nothing to do with it
    (face,) = detector.update(1.1, image, "mono8")
    assert face.id == 1
    (face,) = detector.update(1.2, np.ascontiguousarray(image[:, 100:]), "mono8")
    assert face.id == 2 and is_at(face, (170, 190, 100, 100))


@pytest.mark.parametrize("shape", [(1, 1), (10, 300), (300, 10), (24, 24)])
def test_images_smaller_than_a_face(shape):
    detector = rv.FaceDetector(params(min_size=1))
    image = np.random.default_rng(1).integers(0, 256, shape, np.uint8)
    before = image.copy()
    for number in range(5):
        detector.update(number / RATE, image, "mono8")
    detector.detect(image, "mono8")
    assert (image == before).all()


def test_bad_images_are_refused():
    detector = rv.FaceDetector(params())
    with pytest.raises(ValueError, match="bgr8"):
        detector.update(0.0, np.zeros((4, 4), np.uint8))
    with pytest.raises(ValueError):
        detector.detect(np.zeros((0, 4), np.uint8), "mono8")
    for time_s in (math.nan, math.inf):
        with pytest.raises(ValueError, match=r"time_s is .*, must be finite"):
            detector.update(time_s, PORTRAIT)


def test_a_long_pause_does_not_move_a_face():
    detector = rv.FaceDetector(params(cascade_2=""))
    for number in range(10):
        detector.update(number / RATE, crowd([(20 + 8 * number, 160)]), "mono8")
    (face,) = detector.update(1e9, crowd([(240, 160)]), "mono8")
    assert is_at(face, (270, 190, 100, 100))


def test_after_a_pause_a_face_is_another_one():
    detector = rv.FaceDetector(params(cascade_2=""))
    image = crowd([(240, 160)])
    ids = []
    for time_s in (0.0, 0.1, 1.9, 4.0, 4.1, 600.0, 600.1):
        (face,) = detector.update(time_s, image, "mono8")
        ids.append(face.id)
    assert ids == [0, 0, 0, 1, 1, 2, 2]


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("scale_factor", math.nan, "scale_factor is nan"),
        ("max_size", 39, r"max_size is 39, must be 0 \(any\) or from min_size \(40\) to 8192"),
        ("cascade_1", "", "cascade_1 is '', must be the name of a file"),
    ],
)
def test_parameters_out_of_range(name, value, text):
    with pytest.raises(ValueError, match=text):
        rv.FaceDetector(params(**{name: value}))
    with pytest.raises(ValueError, match=text):
        rv.validate(params(**{name: value}))


@pytest.mark.parametrize("parameter", ["cascade_1", "cascade_2", "eye_cascade"])
@pytest.mark.parametrize(
    "name, content, text",
    [
        ("there_is_none.xml", None, "which is in none of .*/haarcascades/.*opencv-data"),
        ("./there_is_none.xml", None, "there is no such file"),
        ("./" + 300 * "n", None, "which cannot be looked at: File name too long"),
        ("folder", "folder", "which is no file"),
        ("empty.xml", "", "which is empty"),
        ("text.xml", "I am no cascade", "which is no cascade of OpenCV's"),
        ("other.xml", "<opencv_storage><a>1</a></opencv_storage>", "which is no cascade"),
        ("cut.xml", "cut", "which is no cascade"),
    ],
)
def test_cascades_that_are_none(tmp_path, parameter, name, content, text):
    path = tmp_path / name
    if content == "folder":
        path.mkdir()
    elif content == "cut":
        whole = pathlib.Path(CASCADES, "haarcascade_frontalface_default.xml").read_text()
        path.write_text(whole[: len(whole) // 2])
    elif content is not None:
        path.write_text(content)
    given = name if content is None else str(path)
    with pytest.raises(ValueError, match=f"^{parameter} is '{given}', {text}"):
        rv.FaceDetector(params(**{parameter: given}))
