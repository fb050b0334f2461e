"""Follows the poses of the tags and bundles in a layout."""

from collections import Counter
from functools import lru_cache
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from .. import (
    CameraModel,
    MeasuredCorners,
    Tag,
    TagPoseParams,
    TagPoses,
    TagPoseTracker,
    measure_corners,
    single_tag,
    tag_cells,
    tag_family,
    without_bent_edges,
)
from .tag_depth import TagDepth
from .tag_layout import TagKey, TagLayout

MAX_TRACKED = 1000  # tags whose poses are remembered

Corners = Union[MeasuredCorners, np.ndarray]  # (4, 2) px if they could not be measured


class LocatedTag(NamedTuple):
    """A tag in a frame, and its poses."""

    tag: Tag
    size: float  # m
    frame_id: str
    poses: Optional[TagPoses]  # None without a camera, or if no pose explains the corners
    unique: bool  # whether no other tag in the frame has the same family and id
    corners: Optional[Corners] = None  # that the poses were estimated from; None without a camera


class LocatedBundle(NamedTuple):
    """A bundle of which some tags are in a frame."""

    name: str
    family: str
    ids: List[int]  # of the tags in the frame
    poses: TagPoses


class TagLocator:
    """Follows the poses of all tags and bundles. It can be used by one thread at a time.

    A tag that is there more than once is not followed, and not used for a bundle, because nobody
    can tell which tag is which.
    """

    def __init__(self, layout: TagLayout, params: TagPoseParams):
        self._layout = layout
        self._params = params
        self._forget()
        self._camera: Optional[CameraModel] = None

    def locate(
        self,
        time: float,
        tags: Sequence[Tag],
        camera: Optional[CameraModel],
        gray: Optional[np.ndarray] = None,
        depth: Optional[TagDepth] = None,
    ) -> Tuple[List[LocatedTag], List[LocatedBundle]]:
        """Returns the tags in the frame of a time, and the bundles that have one of them.

        When the camera object changes, all earlier poses are forgotten.

        Args:
            time: The time of the frame in s.
            tags: The tags as the detector found them.
            camera: The camera; None if it is not known.
            gray: The gray image in which the corners are measured. With None they are used as
                they were found.
            depth: The depth image of the same time, if there is one: the poses of tags and bundles
                explain the corners, and the planes of the tags in it.
        """
        if camera is not self._camera:
            self._forget()
            self._camera = camera
        seen = Counter(key_of(tag) for tag in tags)
        located = []
        usable: Dict[TagKey, Corners] = {}  # corners for bundles
        for tag in tags:
            key = key_of(tag)
            unique = seen[key] == 1
            size, frame_id = self._layout.size(key), self._layout.frame_id(key)
            corners = poses = None
            if camera is not None:
                corners = corners_of(tag, camera, gray, depth)
                poses = self._poses_of(time, key, corners, unique, camera)
                if unique and poses is not None:
                    usable[key] = corners
            located.append(LocatedTag(tag, size, frame_id, poses, unique, corners))
        return located, [] if camera is None else self._locate_bundles(time, usable, camera)

    def locate_at_once(
        self,
        tags: Sequence[Tag],
        camera: Optional[CameraModel],
        gray: Optional[np.ndarray] = None,
        depth: Optional[TagDepth] = None,
    ) -> Tuple[List[LocatedTag], List[LocatedBundle]]:
        """Like locate(), for a single image: earlier poses are neither used nor changed."""
        return TagLocator(self._layout, self._params).locate(0.0, tags, camera, gray, depth)

    def _forget(self) -> None:
        self._tags: Dict[TagKey, TagPoseTracker] = {}
        self._bundles = [TagPoseTracker(one.bundle, self._params) for one in self._layout.bundles]

    def _poses_of(
        self, time: float, key: TagKey, corners: Corners, unique: bool, camera: CameraModel
    ) -> Optional[TagPoses]:
        seen = {key.id: corners}
        try:
            tracker = self._tracker(key) if unique else self._new_tracker(key)
            return tracker.update(time, seen, camera)
        except ValueError:  # No tag has such corners, or the camera has no rays there.
            return None

    def _tracker(self, key: TagKey) -> TagPoseTracker:
        tracker = self._tags.pop(key, None) or self._new_tracker(key)
        self._tags[key] = tracker  # moves it to the end, as the newest
        if len(self._tags) > MAX_TRACKED:
            del self._tags[next(iter(self._tags))]
        return tracker

    def _new_tracker(self, key: TagKey) -> TagPoseTracker:
        return TagPoseTracker(single_tag(key.id, self._layout.size(key)), self._params)

    def _locate_bundles(
        self, time: float, corners_of_tags: Dict[TagKey, Corners], camera: CameraModel
    ) -> List[LocatedBundle]:
        found = []
        for one, tracker in zip(self._layout.bundles, self._bundles):
            keys = [TagKey(one.family, tag.id) for tag in one.bundle.tags]
            corners = {key.id: corners_of_tags[key] for key in keys if key in corners_of_tags}
            if not corners:
                continue
            # This cannot raise, as the trackers of the single tags have accepted the corners.
            poses = tracker.update(time, corners, camera)
            if poses is not None:
                found.append(LocatedBundle(one.bundle.name, one.family, sorted(corners), poses))
        return found


def key_of(tag: Tag) -> TagKey:
    return TagKey(tag.family, tag.id)


def corners_of(
    tag: Tag,
    camera: CameraModel,
    gray: Optional[np.ndarray],
    depth: Optional[TagDepth] = None,
) -> Corners:
    """Returns the corners of a tag, measured in the image if there is one, and its plane."""
    found = without_bent_edges(tag.corners, camera)
    measured = None
    if gray is not None:
        width = tag_family(tag.family).width_at_border
        measured = measure_corners(gray, cells_of(key_of(tag)), width, found, camera)
    if depth is None:
        return measured or found
    if measured is None:
        return MeasuredCorners(found, plane=depth.plane_of(found, camera))
    plane = depth.plane_of(measured.corners, camera)
    return MeasuredCorners(measured.corners, measured.covariance, plane)


@lru_cache(MAX_TRACKED)
def cells_of(key: TagKey) -> np.ndarray:
    return tag_cells(*key)
