"""What the dashboard can do: each feature is an object with operations."""

import logging
from typing import Any, Iterable, List

from .bag_feature import BagFeature
from .calibration_feature import CalibrationFeature
from .capture_feature import CaptureFeature
from .color_feature import ColorFeature
from .face_feature import FaceFeature
from .foxglove import FoxgloveFeature
from .frame_feature import FrameFeature
from .graph_feature import GraphFeature
from .image_feature import ImageFeature
from .image_hub import ImageHub
from .log_feature import LogFeature
from .message_feature import MessageFeature
from .operations import Operation
from .parameter_feature import ParameterFeature
from .point_feature import PointFeature
from .select_feature import SelectFeature
from .settings import Settings

LOG = logging.getLogger("dashboard")
# A feature has operations: List[Operation], close(), and maybe routes: a list of routes of tornado,
# (pattern, a subclass of handlers.GuardedHandler or GuardedSocket[, arguments of initialize()]).
FEATURES = (
    GraphFeature,
    MessageFeature,
    ParameterFeature,
    SelectFeature,
    FaceFeature,
    CaptureFeature,
    LogFeature,
    FrameFeature,
    BagFeature,
    PointFeature,
    FoxgloveFeature,
)
# These get an ImageHub, too, which ends with the first of them.
IMAGE_FEATURES = (ImageFeature, ColorFeature, CalibrationFeature)


def make_features(settings: Settings) -> List[Any]:
    """Returns the objects of all features."""
    image_hub = ImageHub()
    return [
        *(kind(settings) for kind in FEATURES),
        *(kind(settings, image_hub) for kind in IMAGE_FEATURES),
    ]


def operations_of(features: Iterable[Any]) -> List[Operation]:
    return [operation for feature in features for operation in feature.operations]


def routes_of(features: Iterable[Any]) -> List[Any]:
    return [route for feature in features for route in getattr(feature, "routes", [])]


def close_all(features: Iterable[Any]) -> None:
    """Closes features, each whatever the others do."""
    for feature in features:
        try:
            feature.close()
        except Exception:
            LOG.exception("%s did not end well", type(feature).__name__)
