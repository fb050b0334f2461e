"""Learns the layout of tags on a rigid body from frames that show several of them at once."""

import math
from dataclasses import dataclass
from itertools import combinations
from typing import Dict, List, Mapping, NamedTuple, Sequence, Tuple

import numpy as np

from .._core import Bundle, BundleTag, CameraModel, estimate_pose, single_tag
from ..common.errors import about
from .bundle_adjustment import Observations, adjust, layout_covariance
from .layout_noise import noises_of

MAX_COMPARED_FRAMES = 30  # frames that are compared for the first guess of the relation of two tags
ANGLE_DEVIATION = np.radians(5.0)  # standard deviation of angles between guesses that agree
SHIFT_DEVIATION = 0.3  # standard deviation of shifts between them, in sizes of the larger tag
OUTLIER_RATIO = 5.0  # residual above which a tag is rejected, as a multiple of the median
MIN_OUTLIER = 0.5  # px, residual up to which a tag is never rejected
# Corners of a tag with sides of length 1 in its frame.
UNIT_SQUARE = np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]])

Frame = Mapping[int, np.ndarray]  # corners (4, 2) px by tag, as estimate_pose() takes them


@dataclass(frozen=True)
class BundleCalibration:
    """A bundle that was learned, and how well it explains the observations."""

    bundle: Bundle  # with the accuracy of its layout
    frames: int  # number of frames that showed at least two of its tags
    observations: Dict[int, int]  # observations by tag in these frames, without rejected ones
    rejected: int  # number of observations that were far from where the layout has the tag
    residuals: Dict[int, float]  # px by tag, root mean square distance of its corners


def calibrate(
    name: str,
    frames: Sequence[Frame],
    sizes: Mapping[int, float],
    camera: CameraModel,
    master: int,
) -> BundleCalibration:
    """Learns a bundle whose frame is that of its master tag.

    Args:
        name: The name of the bundle.
        frames: Frames from many sides. Tags without a size are ignored.
        sizes: The sizes of the tags in m.
        camera: The camera of the frames.
        master: The master tag.

    Raises:
        ValueError: The master has no size, a tag cannot be linked with the master by tags that
            were seen together, a tag is loose, or a corner or a size is not valid.
    """
    if master not in sizes:
        raise ValueError(f"the master tag {master} has no size: there are {sorted(sizes)}")
    if len(sizes) < 2:
        raise ValueError(f"a bundle of tag {master} alone has nothing to learn, must have 2 tags")
    singles = {tag: single_tag(tag, size) for tag, size in sizes.items()}
    seen = [{tag: frame[tag] for tag in sizes if tag in frame} for frame in frames]
    for tag in (master, *sizes):
        if not any(tag in frame for frame in seen):
            word = "master tag" if tag == master else "tag"
            raise ValueError(f"the {word} {tag} was not seen in any of {len(frames)} frames")
    poses = [
        _poses_of(index, frame, singles, camera) if len(frame) > 1 else {}
        for index, frame in enumerate(seen)
    ]
    layout = _guess_layout(poses, sizes, master)
    return _refine(name, [frame for frame in seen if len(frame) > 1], layout, sizes, camera)


class _Guess(NamedTuple):
    """A pose, (4, 4), that a tag may have, and its probability or support."""

    pose: np.ndarray
    weight: float


def _poses_of(
    index: int, frame: Frame, singles: Mapping[int, Bundle], camera: CameraModel
) -> Dict[int, List[_Guess]]:
    """Returns the one or two possible poses of each tag in a frame."""
    guesses = {}
    for tag, corners in frame.items():
        with about(f"frame {index}"):
            found = estimate_pose(singles[tag], {tag: corners}, camera)
        guesses[tag] = []
        if found is not None:
            guesses[tag].append(_Guess(found.best.pose, found.probability))
            if found.other is not None:
                guesses[tag].append(_Guess(found.other.pose, 1.0 - found.probability))
    return guesses


def _guess_layout(
    poses: Sequence[Mapping[int, List[_Guess]]], sizes: Mapping[int, float], master: int
) -> Dict[int, np.ndarray]:
    """Guesses the tags' poses in the master's frame, master first, along the best links."""
    links: Dict[Tuple[int, int], _Guess] = {}
    for one, other in combinations(sizes, 2):
        both = [frame for frame in poses if one in frame and other in frame]
        step = max(1, math.ceil(len(both) / MAX_COMPARED_FRAMES))
        relations = [
            [
                _Guess(np.linalg.inv(a.pose) @ b.pose, a.weight * b.weight)
                for a in frame[one]
                for b in frame[other]
            ]
            for frame in both[::step]
        ]
        if any(relations):
            best = _most_supported(relations, max(sizes[one], sizes[other]))
            links[one, other] = best
            links[other, one] = _Guess(np.linalg.inv(best.pose), best.weight)
    layout = {master: np.eye(4)}
    while len(layout) < len(sizes):
        ways = {
            ends: link
            for ends, link in links.items()
            if ends[0] in layout and ends[1] not in layout
        }
        if not ways:
            lost = sorted(set(sizes) - set(layout))
            raise ValueError(
                f"tags {lost} were never seen together with the master tag {master}, nor with tags "
                "that were"
            )
        (known, new), link = max(ways.items(), key=lambda way: way[1].weight)
        layout[new] = layout[known] @ link.pose
    return layout


def _most_supported(relations: Sequence[Sequence[_Guess]], size: float) -> _Guess:
    """Returns the guess that most frames agree with, as wrong guesses differ between frames."""
    guesses = [guess for frame in relations for guess in frame]
    owners = np.array([index for index, frame in enumerate(relations) for _ in frame])
    shifts = np.array([guess.pose[:3, 3] for guess in guesses]) / (SHIFT_DEVIATION * size)
    turns = np.array([guess.pose[:3, :3] for guess in guesses])
    weights = np.array([guess.weight for guess in guesses])
    support = np.zeros(len(guesses))
    for index in range(len(guesses)):
        cosines = (np.sum(turns * turns[index], axis=(1, 2)) - 1.0) / 2.0
        angles = np.arccos(np.clip(cosines, -1.0, 1.0)) / ANGLE_DEVIATION
        squares = angles**2 + np.sum((shifts - shifts[index]) ** 2, axis=1)
        alike = weights * np.exp(-squares / 2.0)
        best_of_frame = np.zeros(len(relations))
        np.maximum.at(best_of_frame, owners, alike)
        support[index] = best_of_frame.sum()
    best = int(np.argmax(support))
    return _Guess(guesses[best].pose, float(support[best]))


def _refine(
    name: str,
    frames: Sequence[Frame],
    layout: Mapping[int, np.ndarray],
    sizes: Mapping[int, float],
    camera: CameraModel,
) -> BundleCalibration:
    """Refines the first guess of a layout, whose first tag is the master."""
    tags = list(layout)
    guess = Bundle(name, [BundleTag(tag, sizes[tag], layout[tag]) for tag in tags])
    found = [(frame, estimate_pose(guess, frame, camera)) for frame in frames]
    found = [(frame, poses) for frame, poses in found if poses is not None]
    observations = _observations_of([frame for frame, _ in found], tags, sizes)
    poses = np.array([poses.best.pose for _, poses in found])
    # Outliers still have some weight in the robust adjustment. They are left out of a second one.
    matrices, poses, residuals = adjust(
        observations, camera, np.array(list(layout.values())), poses
    )
    distances = _distances(residuals)
    kept = observations.where(distances <= max(OUTLIER_RATIO * np.median(distances), MIN_OUTLIER))
    of_tag = {tag: kept.tags == index for index, tag in enumerate(tags)}
    loose = sorted(tag for tag, chosen in of_tag.items() if not chosen.any())
    if loose:
        raise ValueError(f"tags {loose} are not on one rigid body with the others")
    matrices, poses, residuals = adjust(kept, camera, matrices, poses)
    squares = _distances(residuals) ** 2
    covariance = layout_covariance(kept, camera, matrices, poses, residuals)
    variances = np.diag(covariance).reshape(-1, 6).sum(axis=1)
    loose = sorted(tag for tag, value in zip(tags, variances) if not np.isfinite(value))
    if loose:
        raise ValueError(f"tags {loose} were seen too little with others to tell where they are")
    noises = noises_of(covariance, matrices, [sizes[tag] for tag in tags])
    return BundleCalibration(
        Bundle(
            name,
            [
                BundleTag(tag, sizes[tag], pose, shift, turn)
                for tag, pose, shift, turn in zip(tags, matrices, *noises)
            ],
        ),
        len(found),
        {tag: int(chosen.sum()) for tag, chosen in of_tag.items()},
        len(distances) - len(squares),
        {tag: float(np.sqrt(squares[chosen].mean())) for tag, chosen in of_tag.items()},
    )


def _observations_of(
    frames: Sequence[Frame], tags: Sequence[int], sizes: Mapping[int, float]
) -> Observations:
    entries = [
        (index, tags.index(tag), sizes[tag] * UNIT_SQUARE, corners)
        for index, frame in enumerate(frames)
        for tag, corners in frame.items()
    ]
    return Observations(*(np.array(column) for column in zip(*entries)))


def _distances(residuals: np.ndarray) -> np.ndarray:
    """Returns the root mean square distance of each tag's corners in px, (m,)."""
    return np.sqrt(np.mean(np.sum(residuals**2, axis=-1), axis=-1))
