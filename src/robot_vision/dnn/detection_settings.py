"""The live parameters of the node object_detector."""

from typing import Any, Dict, List, NamedTuple, Sequence

import numpy as np

from .. import BoxTrack, BoxTracker, BoxTrackerParams, FoundObject
from ..ros.live_params import filled
from .detector import DetectionSettings
from .thresholds import SURE, ClassThresholds
from .tiles import MAX_FOUND, Region

MAX_BOXES = 1000  # of the tracker
NEVER = 1.0  # a threshold that hardly any score reaches


class Settings(NamedTuple):
    """The live parameters; each change makes new ones."""

    thresholds: ClassThresholds
    detection: DetectionSettings  # with the scores below which a detection is of no use
    config: Dict[str, Any]
    tracker: BoxTrackerParams

    @property
    def track(self) -> bool:
        """Whether things are followed."""
        return self.config["track"]

    @property
    def period(self) -> float:
        """The shortest time from one frame that the network looks at to the next, in s."""
        rate = self.config["max_rate"]
        return 1.0 / rate if rate else 0.0

    def tracker_score(self, found: FoundObject) -> float:
        """Returns the score of what was found for the tracker, which has one threshold for all."""
        return self.thresholds.for_tracker(found.class_id, found.score)

    def score_of_track(self, track: BoxTrack) -> float:
        """Returns the network's score of what a track had last."""
        return self.thresholds.from_tracker(track.class_id, track.score)

    def region(self, bgr: np.ndarray) -> Region:
        """Returns the part of an image that is searched.

        Raises:
            ValueError: It is outside of the image.
        """
        height, width = bgr.shape[:2]
        x, y = self.config["region_x"], self.config["region_y"]
        if x >= width or y >= height:
            raise ValueError(
                f"region_x and region_y are {x} and {y}, outside of an image of {width}x{height} px"
            )
        right, bottom = width - x, height - y
        return (
            x,
            y,
            min(self.config["region_width"] or right, right),
            min(self.config["region_height"] or bottom, bottom),
        )

    def reported(self, tracks: Sequence[BoxTrack]) -> List[BoxTrack]:
        """Returns those that are reported of what is followed, in the order of their ids.

        What the last result did not have gives way to what it had.
        """
        best = sorted(tracks, key=lambda one: (one.lost, -self.score_of_track(one)))
        return sorted(best[: self.config["max_detections"]], key=lambda one: one.id)

    def sure(self, found: Sequence[FoundObject]) -> List[FoundObject]:
        """Returns those that are reported of what was found, the surest first."""
        sure = [one for one in found if self.thresholds.is_sure(one.class_id, one.score)]
        return sure[: self.config["max_detections"]]


def settings_of(config: Dict[str, Any], names: Sequence[str]) -> Settings:
    """Returns the settings for values by their names.

    Args:
        config: The values.
        names: The names of the network's classes.

    Raises:
        ValueError: A value cannot be.
    """
    thresholds = ClassThresholds(
        names, config["score_threshold"], config["class_scores"], config["only"]
    )
    unsure = config["unsure_score"] if config["track"] else 1.0
    detection = filled(DetectionSettings(), config)
    detection.score_threshold = min(config["score_threshold"], unsure)
    lowest: Dict[str, float] = {}  # by name, which classes may share
    for number, (name, score) in enumerate(zip(names, thresholds.scores)):
        score = min(score, unsure) if thresholds.wants(number) else NEVER
        lowest[name] = min(score, lowest.get(name, NEVER))
    detection.class_thresholds = {
        name: score for name, score in lowest.items() if score != detection.score_threshold
    }
    if config["only"].strip() or config["class_scores"].strip():
        # What is not reported may be surer than what is, and must not take its place.
        detection.max_detections = max(detection.max_detections, MAX_FOUND)
    elif config["track"]:
        # What is not among the surest in one result continues its track all the same.
        detection.max_detections = max(detection.max_detections, MAX_BOXES)
    tracker = filled(BoxTrackerParams(), config)
    tracker.low_score, tracker.high_score = 0.0, SURE  # on the scale of ClassThresholds
    tracker.max_boxes = MAX_BOXES  # as what is lost or unconfirmed must not take up the room
    BoxTracker(tracker)  # refuses them now, before some of the settings are put to use
    return Settings(thresholds, detection, config, tracker)
