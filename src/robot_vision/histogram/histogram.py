"""The node histogram, which counts and plots the values of pixels."""

import math
import threading
from typing import Any, Dict, List, Optional

import numpy as np
import rospy
from std_msgs.msg import Float64

from .. import (
    ChannelHistogram,
    HistogramParams,
    HistogramPlotParams,
    HueSaturationParams,
    back_project,
    compare_histograms,
    compute_histogram,
    draw_hue_saturation,
    draw_outline,
    hue_saturation_histogram,
    part_of,
    plot_histogram,
    to_bgr,
    validate,
)
from ..msg import Histogram as HistogramMessage
from ..ros.configs import HistogramConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import Box, corners, region_of
from ..ros.selections import Selection, Selections
from ..ros.startup import run_node
from ..ros.transport import Frame, FrameError

WHOLE = (0, 0, 0, 0)  # the region that is the whole image
WHITE = (255, 255, 255)


class Histogram:
    """Publishes ~histogram, ~histogram_2d, ~back_projection, ~similarity and ~processed_image.

    ~histogram (robot_vision/Histogram) has the counts of each channel, ~processed_image (bgr8) the
    image with their curves, ~histogram_2d (bgr8) those of hue and saturation together. A selection
    is remembered: ~back_projection (mono8) shows where its colours are, and ~similarity
    (std_msgs/Float64) says how alike the colours of the image are.

    Subscribes to image, and to ~select (sensor_msgs/RegionOfInterest): the region to count in; an
    empty one means the whole image.
    """

    def __init__(self) -> None:
        self._region: Box = WHOLE
        self._configured: Box = WHOLE
        self._selection: Optional[np.ndarray] = None  # BGR pixels, as they were selected
        self._lock = threading.Lock()  # guards the selections that wait
        self._node = ImageNode(self._process, encoding="")
        self._selections = Selections(self._node, self._lock)
        self._params = LiveParams(HistogramConfig, self._configure)
        self._histogram = self._node.publisher("~histogram", HistogramMessage)
        self._similarity = self._node.publisher("~similarity", Float64)
        self._histogram_2d = self._node.image_publisher("~histogram_2d")
        self._projection = self._node.image_publisher("~back_projection")
        self._processed = self._node.image_publisher("~processed_image")
        self._selections.subscribe()
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        used = [
            filled(params, config)
            for params in (HistogramParams(), HueSaturationParams(), HistogramPlotParams())
        ]
        for params in used:
            validate(params)
        self._used = used  # replaced in one step: another thread may process a frame
        region = (config["x"], config["y"], config["width"], config["height"])
        if region != self._configured:
            self._configured = region
            with self._lock:
                self._selections.add(Selection(region, timeout=math.inf))

    def _process(self, frame: Frame) -> None:
        try:
            bgr = to_bgr(frame.image, frame.encoding)
            region = self._region_in(bgr)
        except (TypeError, ValueError) as error:
            raise FrameError(error) from None
        params, hue_saturation, plot = self._used
        if self._histogram.get_num_connections() or self._processed.get_num_connections():
            # Gray has more than 8 bits in the image as it came.
            is_gray = params.space == "gray"
            image, encoding = (frame.image, frame.encoding) if is_gray else (bgr, "bgr8")
            counted = compute_histogram(image, encoding, params, region)
            self._histogram.publish(message(frame, region, params, counted))
            if self._processed.get_num_connections():
                self._publish_plot(frame, bgr, region, counted, plot)
        if self._histogram_2d.get_num_connections():
            counts = hue_saturation_histogram(bgr, "bgr8", hue_saturation, region)
            self._histogram_2d.publish(draw_hue_saturation(counts, plot), "bgr8", frame.header)
        if self._projection.get_num_connections() or self._similarity.get_num_connections():
            self._compare(frame, bgr, hue_saturation)

    def _region_in(self, bgr: np.ndarray) -> Box:
        """Returns the part of a frame to count in, after a new region was looked at."""
        size = bgr.shape[1::-1]
        with self._lock:
            for wanted in self._selections.take():
                try:
                    x, y, width, height = part_of(size, wanted.box)
                except ValueError as error:
                    self._selections.refuse(wanted, error)
                    continue
                self._region = wanted.box
                pixels = bgr[y : y + height, x : x + width].copy()
                self._selection = None if wanted.box == WHOLE else pixels
            self._selections.keep_working()
        return part_of(size, self._region)

    def _compare(self, frame: Frame, bgr: np.ndarray, params: HueSaturationParams) -> None:
        if self._selection is None:
            rospy.logwarn_throttle(
                10.0, "no ~back_projection and no ~similarity: no region of the image is selected"
            )
            return
        model = hue_saturation_histogram(self._selection, "bgr8", params)
        if not model.any():
            rospy.logwarn_throttle(
                10.0,
                "no ~back_projection and no ~similarity: no pixel of the selection has "
                f"min_saturation, {params.min_saturation}, and min_value, {params.min_value}",
            )
            return
        if self._projection.get_num_connections():
            projection = back_project(bgr, model, "bgr8", params)
            self._projection.publish(projection, "mono8", frame.header)
        if self._similarity.get_num_connections():
            counts = hue_saturation_histogram(bgr, "bgr8", params)
            self._similarity.publish(compare_histograms(model, counts, params.comparison))

    def _publish_plot(
        self,
        frame: Frame,
        bgr: np.ndarray,
        region: Box,
        counted: List[ChannelHistogram],
        plot: HistogramPlotParams,
    ) -> None:
        overlay = plot_histogram(bgr, counted, plot)
        if self._selection is not None:
            draw_outline(overlay, corners(region), "selected", WHITE)
        self._processed.publish(overlay, "bgr8", frame.header)


def message(
    frame: Frame, region: Box, params: HistogramParams, counted: List[ChannelHistogram]
) -> HistogramMessage:
    """Returns the histogram of a region of a frame as a message."""
    return HistogramMessage(
        header=frame.header,
        region=region_of(region),
        space=params.space,
        channels=[channel.name for channel in counted],
        bins=params.bins,
        low=[channel.low for channel in counted],
        high=[channel.high for channel in counted],
        counts=np.concatenate([channel.counts for channel in counted]).tolist(),
    )


def main() -> None:
    run_node("histogram", Histogram)
