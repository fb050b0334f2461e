"""How right depth is, against the truth of what was drawn and of a real pair, and how fast."""

import functools
import pathlib
import statistics
import time
from typing import Any, Callable, Dict, Iterator, List, Sequence, Tuple

import cv2
import numpy as np
import skimage.data
from measuring import say
from results import Accuracy
from seen_depths import scene_of, seen_by_both
from table_world import MIDDLE, NOISE, UP, camera_of, render_depth
from tag_depths import is_the_wrong_one, narrow_camera, shots, tilt_of
from tags import squared_error

import robot_vision as rv

SENSORS = ("kinect", "stereo", "tof")
REGISTRATION_MS = {(640, 480): 3.0, (1920, 1080): 12.0}  # at most
FRAMES = (30, 240, 500)
TILTS = (0, 5, 10, 25, 40, 55)  # degrees
CORNER_NOISES = (0.3, 0.03)  # px: as libapriltag finds corners, and as they are measured
FACING = 10  # degrees, up to which a tag faces the camera
FREEDOM = 6  # of a pose
SMALL_TAG = 0.02, 1.05  # m, its size and its distance: 10 px
SMALL_TILTS = (25, 35, 45, 55)
PAIR = [f"motorcycle_{name}" for name in ("left.png", "right.png", "disp.npz")]


def timed(work: Callable[[], Any], repeats: int) -> Tuple[Any, float]:
    """The last result, and the median of the CPU ms that it takes."""
    times = []
    for _ in range(repeats):
        begin = time.thread_time()
        result = work()
        times.append((time.thread_time() - begin) * 1e3)
    return result, statistics.median(times)


def registrations(repeats: int) -> Iterator[Accuracy]:
    """The scene's exact depth for color cameras of two sizes."""
    for size, limit in REGISTRATION_MS.items():
        scene = scene_of(size)
        of = "{}x{}".format(*size)
        cameras = scene.view_camera("depth"), scene.view_camera("color")
        registration = rv.DepthRegistration(*cameras, scene.view_pose("depth"))
        filled, right, times = [], [], []
        for frame in FRAMES:
            exact = scene.render_depth(frame)
            found, ms = timed(functools.partial(registration.apply, exact), repeats)
            truth, visible = seen_by_both(scene, frame)
            filled.append((~np.isnan(found))[visible].mean())
            right.append((np.abs(found - truth) < 0.01 * truth)[visible].mean())
            times.append(ms)
        work = "depth of 640x480 in the place of a color camera"
        yield Accuracy(work, of, "CPU ms/frame", statistics.median(times), most=limit)
        yield Accuracy(work, of, "% filled of what both see", 100 * min(filled), least=99.0)
        yield Accuracy(work, of, "% of that right within 1 %", 100 * min(right), least=99.0)


def tables(repeats: int) -> Iterator[Accuracy]:
    """The plane of a table of 1 m x 0.6 m with boxes on it, 1.1 m away, at 640x480."""
    camera = camera_of(640)
    exact = render_depth(camera)
    for sensor in SENSORS:
        planes = rv.PlaneParams()
        planes.noise = NOISE[sensor]
        finder = rv.TabletopFinder(camera, planes, rv.TabletopParams())
        noise, distances, angles, times = rv.DepthNoise(sensor, camera), [], [], []
        for frame in range(max(repeats, 3)):
            find = functools.partial(finder.find, noise.apply(frame, exact), UP)
            (found, _), ms = timed(find, 3)
            plane = found[0].plane
            distances.append(abs(MIDDLE @ plane.normal + plane.distance) * 1e3)
            cosine = np.clip(plane.normal @ UP, -1.0, 1.0)
            angles.append(np.degrees(np.arccos(cosine)))
            times.append(ms)
        work = "a table and what stands on it, 640x480"
        yield Accuracy(work, sensor, "CPU ms/frame", statistics.median(times), most=10.0)
        yield Accuracy(work, sensor, "mm, its plane at worst", max(distances), most=2.0)
        yield Accuracy(work, sensor, "degrees, at worst", max(angles), most=0.2)


def tags(count: int) -> Iterator[Accuracy]:
    """Poses of single images of a tag of 0.12 m, 1 m away, by corners and depth."""
    for sensor in SENSORS:
        for noise in CORNER_NOISES:
            ratios, nees = tag_errors(sensor, noise, count)
            of = f"{sensor}, corners {noise} px"
            facing = max(ratio for tilt, ratio in ratios.items() if tilt <= FACING)
            figure = "tilt error to that by corners alone, "
            yield Accuracy("tags with depth", of, f"{figure}up to {FACING}°", facing, most=0.5)
            worst = max(ratios.values())
            yield Accuracy("tags with depth", of, figure + "at the worst tilt", worst, most=1.0)
            figure = "squared error to covariance (NEES), of each of 6"
            yield Accuracy("tags with depth", of, figure, nees, least=0.8, most=1.2)


def tag_errors(sensor: str, noise: float, count: int) -> Tuple[Dict[int, float], float]:
    """By the tilt, the error of the tilt as a share of that by corners alone; and the NEES."""
    camera, ratios, squares = narrow_camera(160, 120), {}, []
    for tilt in TILTS:
        angles = []
        for truth, *both in shots(sensor, camera, 0.12, 1.0, [tilt], count, noise):
            angles.append([tilt_of(poses.best.pose, truth) for poses in both])
            if tilt >= FACING:  # from the front there are two poses that are nearly the same
                squares.append(squared_error(both[1].best, truth) / FREEDOM)
        alone, fused = np.sqrt(np.mean(np.square(angles), axis=0))
        ratios[tilt] = fused / alone
    return ratios, float(np.mean(squares))


def small_tags(count: int) -> Iterator[Accuracy]:
    """Which of the two poses of a tag of 10 px is taken."""
    camera = narrow_camera(48, 48)
    for sensor in SENSORS:
        taken = [
            [is_the_wrong_one(poses, truth) for poses in both]
            for truth, *both in shots(sensor, camera, *SMALL_TAG, SMALL_TILTS, count)
        ]
        alone, fused = 100.0 * np.mean(taken, axis=0)
        of = f"{sensor}; by corners alone {alone:.2g} %"
        yield Accuracy("tags of 10 px with depth", of, "% of the other pose", fused, most=0.1)


def motorcycle(repeats: int) -> Iterator[Accuracy]:
    """The Middlebury pair Motorcycle, 741x500, which python3-skimage has."""
    paths = [pathlib.Path(skimage.data.__file__).parent / name for name in PAIR]
    if not all(path.exists() for path in paths):
        say("this python3-skimage has no pair Motorcycle")
        return
    left, right = (cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in paths[:2])
    (truth,) = np.load(str(paths[2])).values()
    known = np.isfinite(truth)
    for method in ("bm", "sgbm_3way"):
        shares, times = [], []
        for full in (False, True):  # False: what OpenCV finds
            params = rv.StereoParams()
            params.method, params.disparities, params.full_image = method, 80, full
            match = functools.partial(rv.StereoMatcher(params).match, left, right, "mono8")
            found, ms = timed(match, repeats)
            shares.append(100.0 * (np.abs(found - truth)[known] <= 1.0).mean())
            times.append(ms)
        work, of = "the pair Motorcycle, 741x500", f"{method}; OpenCV alone {{:.1f}}"
        figure = "% of disparities right within 1 px"
        yield Accuracy(work, of.format(shares[0]), figure, shares[1], least=shares[0])
        yield Accuracy(work, of.format(times[0]), "CPU ms/pair", times[1])


def all_accuracies(scale: float) -> List[Accuracy]:
    """`scale`: how much is measured; 1 takes half a minute."""

    def of(count: int) -> int:
        return max(round(count * scale), 2)

    parts: Sequence[Tuple[Callable[[int], Iterator[Accuracy]], int]] = (
        (registrations, of(40)),
        (tables, of(20)),
        (tags, of(150)),
        (small_tags, of(10000)),
        (motorcycle, of(6)),
    )
    found: List[Accuracy] = []
    for part, count in parts:
        say(f"depth against the truth: {part.__name__.replace('_', ' ')}")
        found += part(count)
    return found
