"""Finds objects in images by a network: from image to found objects."""

import dataclasses
import difflib
from typing import Any, Dict, List, Optional, Tuple

import numpy as np

from .. import FoundObject, HeadDecoder, HeadParams, InputParams, fill_input
from ..common.errors import about
from ..common.plain_text import brief
from ..common.ranges import require_range
from .network import Network, NetworkSettings, open_network
from .runtimes import NetworkError
from .tiles import MAX_OVERLAP, MAX_TILES, Region, merged, tiles_of


@dataclasses.dataclass
class DetectionSettings:
    """What can be changed while the network runs. The ranges are those of HeadParams."""

    score_threshold: float = 0.25
    class_thresholds: Dict[str, float] = dataclasses.field(default_factory=dict)  # by name
    iou_threshold: float = 0.45
    class_agnostic: bool = False
    max_detections: int = 300
    tile_rows: int = 1  # 1 to MAX_TILES
    tile_columns: int = 1  # the same; of both together there are at most MAX_TILES
    tile_overlap: float = 0.2  # share of a tile, 0 to MAX_OVERLAP


class NetworkDetector:
    """A network, and how its outputs become objects.

    detect() belongs to one thread; configure() may be called by another meanwhile.

    Args:
        settings: Which network, and how it is run.
        live: What configure() can change.

    Raises:
        OSError: A file cannot be read.
        ValueError: The model cannot be used, or a setting is out of range.
    """

    def __init__(self, settings: NetworkSettings, live: Optional[DetectionSettings] = None):
        self.network: Network = open_network(settings)
        self._background = settings.background
        self._input_params = self._input_params_of()
        self._input = np.zeros(self.network.input.shape, np.float32)
        self.configure(live or DetectionSettings())
        with about(self.network.model.path):
            self._try_decoder()

    @property
    def names(self) -> Tuple[str, ...]:
        """The names of the classes."""
        return self.network.names

    def name_of(self, found: FoundObject) -> str:
        """Returns the name of an object's class, also of one that the model did not announce."""
        if found.class_id < len(self.names):
            return self.names[found.class_id]
        return f"class {found.class_id}"

    def configure(self, live: DetectionSettings) -> None:
        """Puts other settings to use; those that are refused change nothing.

        Raises:
            ValueError: One is out of range, or names a class that the network does not have.
        """
        for name, high in (("tile_rows", MAX_TILES), ("tile_columns", MAX_TILES)):
            require_range(name, getattr(live, name), 1, high)
        require_range("tile_overlap", live.tile_overlap, 0.0, MAX_OVERLAP)
        if live.tile_rows * live.tile_columns > MAX_TILES:
            raise ValueError(
                f"tile_rows x tile_columns is {live.tile_rows * live.tile_columns}, must be at "
                f"most {MAX_TILES}"
            )
        # Replaced in one step: another thread may be at work on an image.
        self._tools = HeadDecoder(self._head_params(live)), dataclasses.replace(live)

    def detect(self, image: np.ndarray, roi: Optional[Region] = None) -> List[FoundObject]:
        """Returns the objects in an image, or in a part of it, the surest first.

        Args:
            image: (height, width, 3) uint8, BGR.
            roi: x, y, width and height of the part, px.

        Raises:
            ValueError: The image or the part cannot be used.
            NetworkError: The runtime threw, or gave something else than at start.
        """
        decoder, live = self._tools
        region = roi or (0, 0, image.shape[1], image.shape[0])
        parts = tiles_of(region, live.tile_rows, live.tile_columns, live.tile_overlap)
        if len(parts) == 1:
            return self._detect_in(image, region, decoder)
        found = [(one, part) for part in parts for one in self._detect_in(image, part, decoder)]
        limits = live.iou_threshold, live.class_agnostic, live.max_detections
        return merged(found, region, *limits)

    def _detect_in(self, image: np.ndarray, part: Region, decoder: Any) -> List[FoundObject]:
        placement = fill_input(image, part, self._input_params, self._input)
        outputs = self._ordered(self.network.runtime.run(self._input))
        try:
            return decoder.decode(outputs, placement, (image.shape[1], image.shape[0]))
        except ValueError as error:
            raise NetworkError(f"the network gave something else than at start: {error}") from error

    def _ordered(self, outputs: List[np.ndarray]) -> List[np.ndarray]:
        order = self.network.head.order
        if not order:
            return outputs
        if len(outputs) != len(order):
            raise NetworkError(f"the network gave {len(outputs)} outputs, must give {len(order)}")
        return [outputs[number] for number in order]

    def _try_decoder(self) -> None:
        """Raises ValueError if the decoder does not take what the network gives."""
        image = np.zeros((self.network.input.height, self.network.input.width, 3), np.uint8)
        placement = fill_input(image, None, self._input_params, self._input)
        outputs = self._ordered(list(self.network.outputs))
        self._tools[0].decode(outputs, placement, (image.shape[1], image.shape[0]))

    def _input_params_of(self) -> InputParams:
        params, network = InputParams(), self.network
        params.width, params.height = network.input.width, network.input.height
        params.layout = network.input.layout
        params.fit, params.pad, params.order = (
            network.image.fit,
            network.image.pad,
            network.image.order,
        )
        params.mean, params.std = list(network.image.mean), list(network.image.std)
        return params

    def _head_params(self, live: DetectionSettings) -> HeadParams:
        params, head = HeadParams(), self.network.head
        params.head, params.task, params.classes = head.head, head.task, head.classes
        params.strides = list(head.strides)
        params.background = self._background
        if head.keypoints:
            params.keypoints, params.keypoint_values = head.keypoints, head.keypoint_values
        params.input_width = self.network.input.width
        params.input_height = self.network.input.height
        for name in ("score_threshold", "iou_threshold", "class_agnostic", "max_detections"):
            setattr(params, name, getattr(live, name))
        params.class_thresholds = self._thresholds(live)
        return params

    def _thresholds(self, live: DetectionSettings) -> List[float]:
        """Returns the threshold of each class, or nothing if all have the same."""
        if not live.class_thresholds:
            return []
        for name in live.class_thresholds:
            if name not in self.names:
                near = difflib.get_close_matches(name, self.names, 1)
                hint = f", is {near[0]} meant?" if near else ""
                raise ValueError(f"class_thresholds has {brief(name)}, which is no class{hint}")
        return [live.class_thresholds.get(name, live.score_threshold) for name in self.names]
