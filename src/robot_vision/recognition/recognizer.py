"""What recognizes objects in images: matchers that say where they may be, and what verifies it."""

from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .. import (
    CameraModel,
    DepthErrorParams,
    ObjectMatchParams,
    ObjectRecognizer,
    PointPairMatchParams,
    PoseCandidate,
    RecognitionFrame,
    RecognizerParams,
    RefinerParams,
    TextureMatchParams,
    VerifierParams,
    outline_overlaps,
)
from ..common.polygons import box_corners
from .found import Found, KnownObject, Limits, are_same
from .pair_method import PAIRS, pair_matcher
from .texture_method import TEXTURES, texture_matcher
from .view_method import VIEWS, view_matcher

NEEDS_DEPTH = "not recognized: what was learned of it needs depth"
SAME_PLACE = 0.5  # intersection over union of the boxes of two poses of one thing


class RecognitionParams(NamedTuple):
    """The parameters of all that recognizes."""

    match: ObjectMatchParams
    pairs: PointPairMatchParams
    textures: TextureMatchParams
    decision: RecognizerParams
    refiner: RefinerParams
    verifier: VerifierParams
    errors: DepthErrorParams

    @staticmethod
    def defaults() -> "RecognitionParams":
        """The defaults of all of them."""
        return RecognitionParams(*(kind() for kind in RecognitionParams.__annotations__.values()))


class Recognizer:
    """Recognizes objects in the images of cameras without distortion. For one thread at a time.

    Args:
        objects: The objects.
        params: The parameters.
        before: One that this one replaces, of which it takes the matchers that would be the same.

    Raises:
        ValueError: A parameter is out of range, or a model is damaged.
    """

    def __init__(
        self,
        objects: Sequence[KnownObject],
        params: RecognitionParams,
        before: Optional["Recognizer"] = None,
    ) -> None:
        self._span = params.match.min_distance, params.match.max_distance  # m
        self._objects = list(objects)
        self._titles = _titles(self._objects)
        self._recognizer = ObjectRecognizer(
            params.decision, params.refiner, params.verifier, params.errors
        )
        for one in self._objects:
            self._recognizer.add(one.shape)
        can_keep = before is not None and are_same(self._objects, before._objects)
        kept = before._matchers if can_keep else {}
        self._matchers: Dict[str, Tuple[Any, ...]] = {}  # of each method, with its parameters
        self._views, self._of_views = self._matcher(VIEWS.name, kept, view_matcher, params.match)
        self._pairs, self._of_pairs = self._matcher(PAIRS.name, kept, pair_matcher, params.pairs)
        self._textures, self._of_textures = self._matcher(
            TEXTURES.name, kept, texture_matcher, params.textures, params.errors
        )
        without_depth = {*self._of_views, *self._of_textures}
        self._blind = [index for index in self._of_pairs if index not in without_depth]
        self._threshold = params.decision.threshold
        self._frame: Optional[RecognitionFrame] = None
        self._camera: Optional[CameraModel] = None

    @property
    def titles(self) -> List[str]:
        """What the objects are called where it is told what became of them."""
        return self._titles

    @property
    def needs_depth(self) -> bool:
        """Whether nothing was learned by which an object is recognized without depth."""
        return not (self._of_views or self._of_textures)

    def recognize(
        self,
        bgr: np.ndarray,
        depth: Optional[np.ndarray],
        camera: CameraModel,
        mask: Optional[np.ndarray] = None,
        limits: Optional[Limits] = None,
    ) -> Tuple[List[Found], Dict[str, str]]:
        """Returns the objects in an image, and what became of each, by title.

        Args:
            bgr: (height, width, 3) uint8.
            depth: (height, width), uint16 in mm or float32 in m, of its pixels; or None.
            camera: The camera, without distortion.
            mask: (height, width) uint8, not 0 where objects may be; None: everywhere.
            limits: Where their origins may be; None: anywhere.
        """
        if camera is not self._camera:
            self._frame, self._camera = RecognitionFrame(camera), camera
        self._frame.set(bgr, depth)
        candidates = []
        if self._of_views:
            there = self._views.match(bgr, depth, camera, mask)
            candidates += _renumbered(there, self._of_views)
        if self._of_pairs and depth is not None:
            there = self._pairs.match(self._frame)
            there = _within(_renumbered(there, self._of_pairs), mask)
            candidates += [one for one in there if self._is_in_range(one.model, one.pose)]
        textured = self._textured(bgr, depth, camera, mask)
        candidates += [
            PoseCandidate(index, one.pose, one.score, one.box, 0)
            for index, one in textured
            if not self._objects[index].is_box
        ]
        made = self._recognizer.recognize(self._frame, candidates)
        found = [
            Found(self._objects[one.model], one.pose, one.covariance, one.probability)
            for one in made.objects
        ]
        told = {self._titles[one.model]: _told(one) for one in made.reports}
        if depth is None:
            told.update((self._titles[index], NEEDS_DEPTH) for index in self._blind)
        found += self._unverified(textured, told)
        return found if limits is None else self._within(limits, found, told), told

    def _within(self, limits: Limits, found: List[Found], told: Dict[str, str]) -> List[Found]:
        """Returns what is within limits, and tells of what is not."""
        within = [one for one in found if limits.holds(one.pose)]
        for title, known in zip(self._titles, self._objects):
            all_of, left = (sum(one.object is known for one in some) for some in (found, within))
            if left < all_of:
                told[title] += f", {all_of - left} outside of the crop"
        return within

    def _textured(self, *seen: Any) -> List[Tuple[int, Any]]:
        """Returns what was found by its texture, each with the index of the object."""
        if not self._of_textures:
            return []
        found = ((self._of_textures[one.model], one) for one in self._textures.match(*seen))
        return [(index, one) for index, one in found if self._is_in_range(index, one.pose)]

    def _is_in_range(self, index: int, pose: np.ndarray) -> bool:
        near, far = self._span
        return bool(near <= self._objects[index].middle_at(pose)[2] <= far)

    def _unverified(self, textured: Sequence[Tuple[int, Any]], told: Dict[str, str]) -> List[Found]:
        """Returns what has no mesh that could verify it, and tells what became of it."""
        found = []
        for index, known in enumerate(self._objects):
            if not known.is_box:
                continue
            there = _once([one for of, one in textured if of == index])
            best = max((one.probability for one in there), default=0.0)
            own = [
                Found(known, one.pose, one.covariance, one.probability)
                for one in there
                if one.probability >= self._threshold
            ]
            missed = f"not found: the best probability is {best:.2f}"
            told[self._titles[index]] = (
                f"found {len(own)}, probability {best:.2f}" if own else missed
            )
            found += own
        return found

    def _matcher(
        self, method: str, kept: Dict[str, Tuple[Any, ...]], make: Callable[..., Any], *params: Any
    ) -> Any:
        """Returns a matcher of what a method has learned, which may be one that is kept."""
        made_with, matcher = kept.get(method, (None, None))
        if made_with != params:
            matcher = make(self._models(method), *params)
        self._matchers[method] = params, matcher
        return matcher

    def _models(self, method: str) -> List[Tuple[int, bytes]]:
        return [
            (index, one.models[method])
            for index, one in enumerate(self._objects)
            if method in one.models
        ]


def _titles(objects: Sequence[KnownObject]) -> List[str]:
    """Returns the names of objects, with their ids where there are several of one name."""
    names = [one.name for one in objects]
    return [
        one.name if names.count(one.name) == 1 else f"{one.name} {one.id[:8]}" for one in objects
    ]


def _once(found: Sequence[Any]) -> List[Any]:
    """Returns what was found of an object without what is where something more probable is.

    Such are both tilts of a flat label that is seen from afar, and poses of one thing by different
    keypoints. No mesh tells which of them is right.
    """
    kept: List[Any] = []
    for one in sorted(found, key=lambda one: -one.probability):
        outline = _outline(one.box)
        shared = (outline_overlaps(outline, _outline(other.box))[0] for other in kept)
        if all(share <= SAME_PLACE for share in shared):
            kept.append(one)
    return kept


def _outline(box: Sequence[int]) -> np.ndarray:
    """Returns the corners, (4, 2), of a box in the image, as of a pixel if it is empty."""
    x, y, width, height = box
    return box_corners((x, y, max(width, 1), max(height, 1)))


def _renumbered(candidates: Sequence[Any], objects: Sequence[int]) -> List[Any]:
    """Returns candidates of a matcher's models as those of objects."""
    if objects == list(range(len(objects))):
        return list(candidates)
    return [
        PoseCandidate(objects[one.model], one.pose, one.score, one.box, one.view)
        for one in candidates
    ]


def _within(candidates: Sequence[Any], mask: Optional[np.ndarray]) -> List[Any]:
    """Returns the candidates whose boxes have something of the mask in them."""
    if mask is None:
        return list(candidates)
    kept = []
    for one in candidates:
        x, y, width, height = one.box
        part = mask[max(y, 0) : max(y + height, 0), max(x, 0) : max(x + width, 0)]
        kept += [one] if part.any() else []
    return kept


def _told(report: Any) -> str:
    """Returns what became of an object."""
    if report.found:
        return f"found {report.found}, probability {report.best_probability:.2f}"
    return f"not found: {report.reason}"
