"""Where the tags and bundles of a layout are, from frame to frame."""

from collections import Counter
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from . import (
    Bundle,
    CameraModel,
    Tag,
    TagPoseParams,
    TagPoses,
    TagPoseTracker,
    estimate_pose,
    single_tag,
    without_bent_edges,
)
from .tag_layout import TagKey, TagLayout

MOST_TRACKED = 1000  # tags whose poses are remembered


class LocatedTag(NamedTuple):
    """A tag of a frame, and where it is."""

    tag: Tag
    size: float  # m
    frame_id: str
    poses: Optional[TagPoses]  # None without a camera, and where corners are like no pose
    unique: bool  # no other tag of this frame has its family and id


class LocatedBundle(NamedTuple):
    """A bundle of which tags are in a frame."""

    name: str
    family: str
    ids: List[int]  # of the tags seen
    poses: TagPoses


class TagLocator:
    """Follows the poses of all tags and bundles. Belongs to one thread at a time.

    A tag that is there twice has poses of this frame alone, and none in a bundle: nobody can say
    which one is which.
    """

    def __init__(self, layout: TagLayout, params: TagPoseParams):
        self._layout = layout
        self._params = params
        self._forget()
        self._camera: Optional[CameraModel] = None

    def locate(
        self, time: float, tags: Sequence[Tag], camera: Optional[CameraModel]
    ) -> Tuple[List[LocatedTag], List[LocatedBundle]]:
        """The tags in the frame of a time, s, and the bundles that have one of them.

        Another camera, which is another object, makes it forget what it knows.
        """
        if camera is not self._camera:
            self._forget()
            self._camera = camera
        seen = Counter(key_of(tag) for tag in tags)
        located = []
        usable: Dict[TagKey, np.ndarray] = {}  # corners for bundles
        for tag in tags:
            key = key_of(tag)
            unique = seen[key] == 1
            size, frame_id = self._layout.size(key), self._layout.frame_id(key)
            poses = None
            if camera is not None:
                corners = without_bent_edges(tag.corners, camera)
                poses = self._poses_of(time, key, corners, unique, camera)
                if unique and poses is not None:
                    usable[key] = corners
            located.append(LocatedTag(tag, size, frame_id, poses, unique))
        return located, [] if camera is None else self._locate_bundles(time, usable, camera)

    def locate_at_once(
        self, tags: Sequence[Tag], camera: Optional[CameraModel]
    ) -> Tuple[List[LocatedTag], List[LocatedBundle]]:
        """The same of a picture by itself: nothing of earlier ones is used, or changed."""
        return TagLocator(self._layout, self._params).locate(0.0, tags, camera)

    def _forget(self) -> None:
        self._tags: Dict[TagKey, TagPoseTracker] = {}
        self._bundles = [TagPoseTracker(one.bundle, self._params) for one in self._layout.bundles]

    def _poses_of(
        self, time: float, key: TagKey, corners: np.ndarray, unique: bool, camera: CameraModel
    ) -> Optional[TagPoses]:
        seen = {key.id: corners}
        try:
            if not unique:
                return estimate_pose(self._single(key), seen, camera, self._params.corner_noise)
            return self._tracker(key).update(time, seen, camera)
        except ValueError:  # the tag is where this camera has no rays
            return None

    def _tracker(self, key: TagKey) -> TagPoseTracker:
        tracker = self._tags.pop(key, None) or TagPoseTracker(self._single(key), self._params)
        self._tags[key] = tracker  # as the newest
        if len(self._tags) > MOST_TRACKED:
            del self._tags[next(iter(self._tags))]
        return tracker

    def _single(self, key: TagKey) -> Bundle:
        return single_tag(key.id, self._layout.size(key))

    def _locate_bundles(
        self, time: float, corners_of: Dict[TagKey, np.ndarray], camera: CameraModel
    ) -> List[LocatedBundle]:
        found = []
        for one, tracker in zip(self._layout.bundles, self._bundles):
            keys = [TagKey(one.family, tag.id) for tag in one.bundle.tags]
            corners = {key.id: corners_of[key] for key in keys if key in corners_of}
            if not corners:
                continue
            try:
                poses = tracker.update(time, corners, camera)
            except ValueError:
                continue
            if poses is not None:
                found.append(LocatedBundle(one.bundle.name, one.family, sorted(corners), poses))
        return found


def key_of(tag: Tag) -> TagKey:
    return TagKey(tag.family, tag.id)
