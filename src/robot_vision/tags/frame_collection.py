"""A collection of frames that show tags together, from which their layout is learned."""

from collections import Counter
from typing import Dict, Iterable, List, Set, Tuple

import numpy as np

from .. import CameraModel, without_bent_edges

MIN_MOTION = 1.0 / 64.0  # of the image's width, of a corner between different frames
MAX_COORDINATE = 4.0  # of the image's width, largest coordinate of a corner
MIN_TURN = 1.0  # px^2, what the cross product of two edges in a row must exceed


class FrameCollection:
    """Keeps frames with at least two of the tags that differ from all frames kept before.

    Args:
        tags: The ids of the tags on the rigid body.
        master: The tag that all others have to be linked with.
        most: The largest number of frames that are kept.
    """

    def __init__(self, tags: Iterable[int], master: int, most: int):
        self._tags = sorted(tags)
        self._master = master
        self._corners = np.full((most, len(self._tags), 4, 2), np.inf)  # infinite if not seen
        self._kept = 0
        self._alone: Dict[int, np.ndarray] = {}  # corners of tags that were seen alone
        self._refused = 0  # number of tags with impossible corners
        self._skipped = 0  # number of frames that could not be used
        self.problem = ""  # of the last of these frames
        self.offered = 0  # number of frames, with or without tags

    @property
    def full(self) -> bool:
        """Whether no more frames are kept."""
        return self._kept == len(self._corners)

    def add(self, camera: CameraModel, tags: Iterable[Tuple[int, np.ndarray]]) -> None:
        """Offers a frame of a camera: the ids and the corners, (4, 2) px, of its tags.

        An id that is there twice is ignored, because nobody can tell which tag is which. Corners
        that the camera cannot see are ignored too: with them the computation might never end, or
        refuse all frames.
        """
        self.offered += 1
        tags = list(tags)
        times = Counter(tag for tag, _ in tags)
        once = {tag: corners for tag, corners in tags if times[tag] == 1 and tag in self._tags}
        found = {tag: corners for tag, corners in once.items() if _is_plausible(corners, camera)}
        self._refused += len(once) - len(found)
        if len(found) == 1:
            self._alone.update(found)
        if len(found) < 2 or self.full:
            return
        seen = [self._tags.index(tag) for tag in found]
        corners = np.array(list(found.values()), float)
        moved = np.abs(self._corners[: self._kept, seen] - corners).max(axis=(1, 2, 3))
        if not (moved < MIN_MOTION * camera.width).any():
            self._corners[self._kept, seen] = corners
            self._kept += 1

    def skip(self, problem: str) -> None:
        """Counts a frame that cannot be used, and remembers the problem."""
        self._skipped += 1
        self.problem = problem

    def frames(self) -> List[Dict[int, np.ndarray]]:
        """Returns corners by tag of the frames kept, and of tags that were only seen alone."""
        frames = [
            {tag: corners for tag, corners in zip(self._tags, frame) if np.isfinite(corners).all()}
            for frame in self._corners[: self._kept]
        ]
        together = {tag for frame in frames for tag in frame}
        return frames + [
            {tag: corners} for tag, corners in self._alone.items() if tag not in together
        ]

    def summary(self) -> str:
        """Returns what was collected and what is missing, as a line of text."""
        shown = np.isfinite(self._corners[: self._kept, :, 0, 0]).astype(int)
        together = shown.T @ shown
        tags = [f"{tag} ({together[i, i]})" for i, tag in enumerate(self._tags) if together[i, i]]
        pairs = [
            f"{one}+{other} ({together[i, j]})"
            for i, one in enumerate(self._tags)
            for j, other in enumerate(self._tags)
            if i < j and together[i, j]
        ]
        parts = [f"{self._kept} of {len(self._corners)} frames"]
        if tags:
            parts += ["tags: " + ", ".join(tags), "together: " + ", ".join(pairs)]
        seen = {tag for tag, count in zip(self._tags, np.diag(together)) if count}.union(
            self._alone
        )
        unseen = [str(tag) for tag in self._tags if tag not in seen]
        loose = [str(tag) for tag in sorted(seen - self._linked(together) - {self._master})]
        if unseen:
            parts.append("not seen: " + ", ".join(unseen))
        if loose:
            parts.append(f"not linked with {self._master}: " + ", ".join(loose))
        if self._refused:
            parts.append(f"{self._refused} sightings left out, whose corners no camera sees")
        if self._skipped:
            parts.append(f"{self._skipped} frames left out: {self.problem}")
        return "; ".join(parts)

    def _linked(self, together: np.ndarray) -> Set[int]:
        """Returns the tags that are linked with the master over pairs seen together."""
        reached = [self._tags.index(self._master)]
        for index in reached:
            reached += [i for i in np.flatnonzero(together[index]) if i not in reached]
        return {self._tags[i] for i in reached}


def _is_plausible(corners: np.ndarray, camera: CameraModel) -> bool:
    """Returns whether corners may be a tag's: near the image, convex, and in a tag's order.

    They must be so for estimate_pose(), too: without the bend of their edges, and as rays.
    """
    # The comparison is also false if a corner is NaN.
    if not (np.abs(corners) <= MAX_COORDINATE * camera.width).all():
        return False
    if not _is_convex(corners, MIN_TURN):
        return False
    straight = without_bent_edges(corners, camera)
    return _is_convex(straight, MIN_TURN) and _is_convex(camera.rays(straight), 0.0)


def _is_convex(corners: np.ndarray, min_turn: float) -> bool:
    """Returns whether all cross products of two edges in a row exceed `min_turn`."""
    edges = np.roll(corners, -1, axis=0) - corners
    after = np.roll(edges, -1, axis=0)
    turns = edges[:, 1] * after[:, 0] - edges[:, 0] * after[:, 1]
    return bool((turns > min_turn).all())  # This is also false if a corner has no ray.
