"""Properties that all bindings share."""

import inspect
import math
import re

import pytest

import robot_vision as rv

# What programs import; a new name need not be here, but none of these may vanish.
PUBLISHED = """
    BallMeasurement BallPosition BallState BallTracker BallTrackerParams
    BrightnessParams Bundle BundleTag CalibrationScene CameraModel CaptureParams
    ChannelHistogram Code CodeReader CodeReaderParams ColorMask ColorRange Contour
    ContourDefect ContourFinder ContourParams ContourResult DenseFlow
    DenseFlowParams EdgeParams Face FaceDetector FaceParams FilterChain FloorScene
    FlowDrawingParams GroundParams HistogramParams HistogramPlotParams HoughCircle
    HoughLine HoughParams HoughResult HoughTransform HsvMask HsvRange
    HueSaturationParams ImageShift KeypointMatcher KeypointMatches KeypointParams
    Keypoints Lane LaneDetector LaneLine LaneParams Line LineParams MatchParams
    MatchedFrame MeasuredCorners Motion MotionDetector MotionParams ObjectTracker
    ObjectTrackerParams Operation OperationParam PeopleDetector PeopleParams Person
    PhaseCorrelator PoseEstimate ReferencePose Region RegionFinder RegionParams
    RoadScene Scene SceneObject SceneParams SceneTruth Segment SegmentPaintParams
    SegmentSeed Segmentation Segmenter SegmenterParams SpectrumParams Tag
    TagDetector TagDetectorParams TagFamily TagPoseParams TagPoseTracker TagPoses
    TemplateMatch TemplateMatcher TemplateMatches TemplateParams TrackedObject
    TrackedWindow TurnedShape WindowTracker WindowTrackerParams adjust_brightness
    back_project ball_position choose_ball code_types color_channels color_spaces
    compare_histograms compute_histogram convert_range draw_ball draw_flow_arrows
    draw_hue_saturation draw_lane draw_outline draw_passband draw_text draw_trail
    encodings estimate_pose filter_frequencies find_edges find_keypoints find_line
    find_segments flow_to_colors frequency_mask hsv_mask hue_saturation_histogram
    image_to_space is_calibrated keeps_bytes mask_picture match_keypoints mean_flow
    measure_corners median_flow operations paint_segments part_of plot_histogram
    range_around response_image set_threads single_tag spectrum_image
    spectrum_magnitude tag_cells tag_families tag_family template_response to_bgr
    to_gray to_hsv to_space validate validate_rectification without_bent_edges
"""

PARAMS = {
    name: kind
    for name, kind in vars(rv._core).items()
    if name.endswith("Params") or name == "HsvRange"
}


def fields(kind):
    return [name for name, value in vars(kind).items() if isinstance(value, property)]


def documents():
    for name, value in vars(rv._core).items():
        yield name, value.__doc__
        if inspect.isclass(value):
            for member in vars(value).values():
                yield name, member.__doc__


def test_package_has_the_names_of_the_core():
    assert set(PUBLISHED.split()) <= set(rv.__all__)
    for name in rv.__all__:
        assert getattr(rv, name) is getattr(rv._core, name)


def test_signatures_have_python_names():
    """pybind11 writes C++ names if a type is bound after a function that uses it."""
    for name, document in documents():
        assert "::" not in (document or ""), name


def test_there_are_parameters():
    assert {"BrightnessParams", "MotionParams", "TagPoseParams"} <= set(PARAMS)


@pytest.mark.parametrize("kind", PARAMS.values(), ids=list(PARAMS))
def test_parameters_are_valid_documented_and_compared(kind):
    params = kind()
    rv.validate(params)
    assert params == kind()
    for name in fields(kind):
        assert getattr(kind, name).__doc__, name
        value = getattr(params, name)
        other = kind()
        setattr(other, name, value)
        assert other == params
        if isinstance(value, (bool, int, float)):
            setattr(other, name, not value if isinstance(value, bool) else value + 1)
            assert other != params


@pytest.mark.parametrize("kind", PARAMS.values(), ids=list(PARAMS))
def test_values_out_of_the_documented_range_are_refused(kind):
    number = r"-?[\d.]+(?:e[+-]?\d+)?"
    ranges = 0
    for name in fields(kind):
        found = re.search(
            rf"(odd and from|from|above) ({number}) (?:and at most|and up to|to) ({number})\)$",
            getattr(kind, name).__doc__,
        )
        words = re.search(r"[ (](\w+(?:, \w+)* or \w+)\)$", getattr(kind, name).__doc__)
        if words and isinstance(getattr(kind(), name), str):
            ranges += 1
            params = kind()
            setattr(params, name, "magic")
            with pytest.raises(ValueError, match=f"^{name} is .*magic.*, must be {words[1]}$"):
                rv.validate(params)
        if not found:
            continue
        ranges += 1
        of_type = type(getattr(kind(), name))
        low, high = float(found[2]), float(found[3])
        wrong = [low - 1, high + 1]
        wrong += [low] if found[1] == "above" else []
        wrong += [low + 1] if found[1] == "odd and from" else []
        wrong += [math.nan] if of_type is float else []
        for value in wrong:
            params = kind()
            setattr(params, name, of_type(value))
            with pytest.raises(ValueError, match=rf"^{name} is "):
                rv.validate(params)
    assert ranges, "no range is documented as this test reads them"
