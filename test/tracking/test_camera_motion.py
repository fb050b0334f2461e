"""The camera's motion between photographs that are moved by known similarities."""

import cv2
import numpy as np
import pytest
import skimage.data
from hostile import INF, NAN

import robot_vision as rv

SIZE = (640, 480)
IDENTITY = np.eye(2, 3)


def photograph(name="coffee", size=SIZE):
    """A photograph with room around it, so that one can look to all sides."""
    image = cv2.cvtColor(getattr(skimage.data, name)(), cv2.COLOR_RGB2BGR)
    return cv2.resize(image, (size[0] + 200, size[1] + 200), interpolation=cv2.INTER_AREA)


COFFEE = photograph()
GRAIN = np.random.default_rng(4)
GRAIN_STATE = GRAIN.bit_generator.state


@pytest.fixture(autouse=True)
def each_test_has_the_same_grain():
    GRAIN.bit_generator.state = GRAIN_STATE


def similarity(angle=0.0, scale=1.0, shift=(0.0, 0.0), size=SIZE):
    """2x3, about the middle of the image; px from its top left corner."""
    cos, sin = scale * np.cos(angle), scale * np.sin(angle)
    turn, middle = np.array([[cos, -sin], [sin, cos]]), np.array(size) / 2.0
    return np.column_stack([turn, middle - turn @ middle + shift])


def full(warp):
    return np.vstack([warp, [0.0, 0.0, 1.0]])


def view(warp, image=COFFEE, size=SIZE, noise=1.0):
    """What is seen of a photograph when a warp has moved what was in the middle of it at first."""
    to_pixels = np.array([[1.0, 0.0, -0.5], [0.0, 1.0, -0.5], [0.0, 0.0, 1.0]])  # centres are whole
    from_photograph = np.array([[1.0, 0.0, -100.0], [0.0, 1.0, -100.0], [0.0, 0.0, 1.0]])
    whole = to_pixels @ full(warp) @ from_photograph @ np.linalg.inv(to_pixels)
    seen = cv2.warpAffine(image, whole[:2], size, flags=cv2.INTER_CUBIC)
    grain = GRAIN.normal(0.0, noise, seen.shape)
    return np.clip(seen + grain, 0, 255).astype(np.uint8)


def error(warp, expected, size=SIZE):
    """The largest distance between where both have a corner of the image, px."""
    corners = np.array([[x, y, 1.0] for x in (0, size[0]) for y in (0, size[1])])
    return np.linalg.norm(corners @ (warp - expected).T, axis=1).max()


MOTIONS = {
    "rest": similarity(),
    "a shift by less than a pixel": similarity(shift=(0.4, -0.3)),
    "a shift": similarity(shift=(9.3, -6.2)),
    "a fast shift": similarity(shift=(-38.0, 21.0)),
    "a turn": similarity(angle=0.04),
    "nearer": similarity(scale=1.03),
    "all": similarity(-0.03, 0.98, (-12.0, 7.5)),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_the_motion_of_the_image_is_found(name):
    motion = rv.CameraMotion()
    assert (motion.update(view(IDENTITY)) == IDENTITY).all() and not motion.known
    warp = motion.update(view(MOTIONS[name]))
    assert motion.known and motion.points >= 30
    assert warp.shape == (2, 3) and warp.dtype == np.float64
    assert error(warp, MOTIONS[name]) < 0.4


@pytest.mark.parametrize("size", [(160, 120), (322, 241), (643, 479), (1280, 720), (1920, 1080)])
def test_images_of_all_sizes_are_measured_in_their_own_pixels(size):
    image, moved = photograph(size=size), similarity(0.01, 1.01, (3.0, -2.0), size)
    motion = rv.CameraMotion()
    motion.update(view(IDENTITY, image, size))
    assert error(motion.update(view(moved, image, size)), moved, size) < 0.4 * max(size[0] / 640, 1)
    assert motion.known


def test_each_frame_is_compared_with_the_one_before():
    motion, last = rv.CameraMotion(), IDENTITY
    for number in range(12):
        pose = similarity(0.01 * number, 1.0 + 0.003 * number, (2.0 * number, -3.0 * number))
        warp = motion.update(view(pose))
        assert error(warp, (full(pose) @ np.linalg.inv(full(last)))[:2]) < 0.4 or number == 0
        last = pose


def with_poster(image, box):
    """The image with another one in a box (x0, y0, x1, y1)."""
    x0, y0, x1, y1 = box
    seen = image.copy()
    other = cv2.resize(photograph("astronaut"), (x1 - x0, y1 - y0), interpolation=cv2.INTER_AREA)
    seen[y0:y1, x0:x1] = other
    return seen


def test_what_moves_by_itself_has_no_say():
    moved = similarity(0.01, 1.0, (4.0, 3.0))
    motion = rv.CameraMotion()
    motion.update(with_poster(view(IDENTITY), (100, 100, 400, 380)))
    warp = motion.update(with_poster(view(moved), (115, 90, 415, 370)))
    assert motion.known and error(warp, moved) < 0.6


def test_most_of_the_image_may_move_if_it_is_left_out():
    moved, large = similarity(shift=(4.0, 3.0)), (90, 70, 570, 420)
    before, after = with_poster(view(IDENTITY), large), with_poster(view(moved), (80, 70, 560, 420))
    motion = rv.CameraMotion()
    motion.update(before)
    assert error(motion.update(after), moved) > 5.0 or not motion.known  # it takes part
    motion.reset()
    motion.update(before)
    warp = motion.update(after, leave_out=[large])
    assert motion.known and error(warp, moved) < 0.6


@pytest.mark.parametrize(
    "other",
    [
        view(IDENTITY, photograph("astronaut")),
        np.zeros((480, 640, 3), np.uint8),
        np.full((480, 640, 3), 200, np.uint8),
        GRAIN.integers(0, 256, (480, 640, 3)).astype(np.uint8),
    ],
    ids=["a cut", "darkness", "a wall", "noise"],
)
def test_what_has_nothing_to_do_with_the_last_frame_is_not_known(other):
    motion = rv.CameraMotion()
    motion.update(view(IDENTITY))
    for image in (other, view(IDENTITY)):
        assert (motion.update(image) == IDENTITY).all()
        assert not motion.known and motion.points == 0
    motion.update(view(IDENTITY))
    assert motion.known


def test_a_small_part_that_stays_in_a_cut_is_not_the_camera_s_motion():
    kept = slice(100, 380), slice(150, 470)
    before, after = view(IDENTITY), view(IDENTITY, photograph("astronaut"))
    after[kept] = before[kept]
    motion = rv.CameraMotion()
    motion.update(before)
    assert (motion.update(after) == IDENTITY).all() and not motion.known


def test_plain_walls_have_no_say():
    motion, moved, noise = rv.CameraMotion(), similarity(0.01, 1.0, (4.0, 3.0)), GRAIN
    shown = slice(120, 380), slice(180, 460)
    for warp in (IDENTITY, moved):
        image = np.clip(noise.normal(150.0, 3.0, (480, 640, 3)), 0, 255).astype(np.uint8)
        image[shown] = view(warp)[shown]
        found = motion.update(image)
    assert (
        motion.known and error(found, moved) < 3.0
    )  # px in the corners, from a part in the middle


def test_blur_is_not_known():
    motion = rv.CameraMotion()
    for shift in (0.0, 5.0):
        blurred = cv2.GaussianBlur(view(similarity(shift=(shift, 0.0))), (0, 0), 25.0)
        assert (motion.update(blurred) == IDENTITY).all() and not motion.known


def test_another_size_and_a_reset_begin_anew():
    motion = rv.CameraMotion()
    motion.update(view(IDENTITY))
    motion.update(view(IDENTITY)[:, :600])
    assert not motion.known
    motion.update(view(IDENTITY)[:, :600])
    assert motion.known
    motion.reset()
    assert not motion.known
    motion.update(view(IDENTITY)[:, :600])
    assert not motion.known


def test_the_same_frames_give_the_same_bits():
    images = [view(similarity(0.01 * i, 1.0, (3.0 * i, i))) for i in range(6)]
    runs = []
    for _ in range(2):
        motion = rv.CameraMotion()
        cv2.setRNGSeed(len(runs))
        runs.append([motion.update(image).tobytes() for image in images])
    assert runs[0] == runs[1]


def test_encodings_and_padded_rows_give_the_same_and_nothing_is_written():
    images = [view(MOTIONS["rest"]), view(MOTIONS["a shift"])]
    wide = [np.zeros((480, 700, 3), np.uint8) for _ in images]
    for image, padded in zip(images, wide):
        padded[:, 30:670] = image
    grays = [cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in images]
    kinds = {
        "bgr8": images,
        "rgb8": [np.ascontiguousarray(image[..., ::-1]) for image in images],
        "mono8": grays,
    }
    found = []
    for encoding, both in [*kinds.items(), ("bgr8", [padded[:, 30:670] for padded in wide])]:
        copies, motion = [image.copy() for image in both], rv.CameraMotion()
        found.append([motion.update(image, encoding) for image in both][1])
        assert all((image == copy).all() for image, copy in zip(both, copies))
    assert all((warp == found[0]).all() for warp in found)


@pytest.mark.parametrize("shape", [(1, 1), (1, 900), (900, 1), (5, 7), (31, 31), (40, 2000)])
def test_small_images_are_not_known(shape):
    motion, image = rv.CameraMotion(), GRAIN.integers(0, 256, (*shape, 3)).astype(np.uint8)
    for _ in range(3):
        assert (motion.update(image) == IDENTITY).all()


def test_what_is_no_image_or_box_is_refused_and_the_last_frame_kept():
    motion = rv.CameraMotion()
    motion.update(view(IDENTITY))
    with pytest.raises(ValueError, match="bgr8"):
        motion.update(np.zeros((4, 4), np.uint8))
    with pytest.raises(ValueError, match="encoding"):
        motion.update(view(IDENTITY), "bgr9")
    for box in ((NAN, 0.0, 5.0, 5.0), (0.0, 0.0, INF, 5.0)):
        with pytest.raises(ValueError, match=r"leave_out\[1\] is .*, must be finite"):
            motion.update(view(IDENTITY), leave_out=[(0.0, 0.0, 5.0, 5.0), box])
    boxes = [(9.0, 9.0, 5.0, 5.0), (-1e9, -1e9, 1e9, -5.0), (700.0, 500.0, 1e300, 1e300)]
    assert error(motion.update(view(MOTIONS["a shift"]), leave_out=boxes), MOTIONS["a shift"]) < 0.4


def test_parameters_out_of_range_are_refused():
    params = rv.CameraMotionParams()
    params.window = 10
    with pytest.raises(ValueError, match="window is 10, must be odd and from 5 to 51"):
        rv.CameraMotion(params)
