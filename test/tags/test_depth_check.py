"""The self-check of a depth camera: its scale and bias, by tags, against the truth."""

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus

import robot_vision as rv
from robot_vision.tags import depth_report
from robot_vision.tags.depth_check import MIN_PLANES, DepthCheck
from robot_vision.tags.depth_errors import DepthErrorEstimate
from robot_vision.tags.depth_report import misfit, summary, values
from robot_vision.tags.tag_depth import TagDepth
from robot_vision.tags.tag_layout import TagLayout
from robot_vision.tags.tag_poses import TagLocator

SCALE, BIAS = 1.03, 0.02  # m


def measured(rng, count, low, high, deviation, scale=SCALE, bias=BIAS):
    estimate = DepthErrorEstimate()
    for true in rng.uniform(low, high, count):
        estimate.add(true, scale * true + bias + rng.normal(0.0, deviation), deviation)
    return estimate


@pytest.mark.parametrize("count, low, high", [(5, 1.0, 3.0), (60, 0.5, 4.0), (200, 1.9, 2.1)])
def test_scale_and_bias_are_found_within_their_standard_errors(count, low, high):
    rng = np.random.default_rng(1)
    squares = []
    for _ in range(200):
        errors = measured(rng, count, low, high, 0.005).errors()
        off = np.array([errors.scale - SCALE, errors.bias - BIAS])
        squares.append(off @ np.linalg.solve(errors.covariance, off))
        assert errors.scale_error == pytest.approx(errors.covariance[0, 0] ** 0.5)
        assert low <= errors.nearest <= errors.farthest <= high
    assert 0.4 < np.mean(squares) / 2.0 < 1.6


def test_what_one_distance_does_not_tell_is_uncertain():
    """The sum of scale and bias is known there, but not which of the two it is."""
    estimate = DepthErrorEstimate()
    estimate.add(2.0, 2.1, 0.01)
    errors = estimate.errors()
    error, deviation = errors.at(2.0)
    assert error == pytest.approx(0.1, abs=1e-4) and deviation == pytest.approx(0.01, rel=0.01)
    assert errors.scale_error > 0.3 and errors.bias_error > 0.3
    assert errors.at(4.0)[1] > 0.5


def test_outliers_do_not_count():
    rng = np.random.default_rng(2)
    estimate = measured(rng, 90, 1.0, 3.0, 0.005)
    for true in rng.uniform(1.0, 3.0, 10):
        estimate.add(true, true + 1.0, 0.005)
    errors = estimate.errors()
    assert errors.scale == pytest.approx(SCALE, abs=0.01)
    assert errors.bias == pytest.approx(BIAS, abs=0.02)
    assert estimate.ratio() == pytest.approx(SCALE + BIAS / 2.0, abs=0.02)


def test_only_significant_errors_above_the_limit_are_errors():
    errors = measured(np.random.default_rng(3), 100, 1.0, 3.0, 0.005).errors()
    depth, error = errors.worst(0.03)
    assert depth == errors.farthest
    assert error == pytest.approx((SCALE - 1.0) * errors.farthest + BIAS, abs=0.005)
    assert errors.worst(0.2)[1] == 0.0
    few = measured(np.random.default_rng(3), 3, 1.0, 3.0, 0.2).errors()
    assert few.worst(0.03)[1] == 0.0


def test_the_last_measurements_count():
    estimate = DepthErrorEstimate(20)
    for scale in (1.5, SCALE):
        for true in np.linspace(1.0, 3.0, 20):
            estimate.add(true, scale * true, 0.001)
    assert len(estimate) == 20
    assert estimate.errors().scale == pytest.approx(SCALE, abs=1e-3)
    estimate.clear()
    assert len(estimate) == 0


class SceneCheck:
    """The tags of frames of the scene, located with its depth, and checked."""

    def __init__(self, change=lambda depth: depth, sensor="none"):
        params = rv.SceneParams()
        params.noise = 1.0
        scene = rv.Scene(params)
        self.check, self.camera = DepthCheck(), scene.camera
        self.params, self.errors = rv.TagPoseParams(), rv.DepthErrorParams()
        detector = rv.TagDetector()
        noise = rv.DepthNoise(sensor, scene.view_camera("depth"))
        registration = rv.DepthRegistration(
            scene.view_camera("depth"), self.camera, scene.view_pose("depth")
        )
        locator = TagLocator(TagLayout("tag36h11", 0.24), self.params)
        for number in range(0, 600, 40):
            gray = rv.to_gray(scene.render(number), "bgr8")
            depth = registration.apply(noise.apply(number, scene.render_depth(number)))
            image = change(depth).astype(np.float32)
            tags, _ = locator.locate(
                number / 30.0,
                detector.detect(gray, "mono8"),
                self.camera,
                gray,
                TagDepth(image, self.camera, self.errors),
            )
            self.add(tags)
            self.tags = tags or getattr(self, "tags", [])

    def add(self, tags):
        self.check.add(tags, self.camera, self.params, self.errors)


@pytest.fixture(scope="module")
def exact():
    return SceneCheck()


def test_a_depth_camera_that_is_off_is_told_as_such():
    found = SceneCheck(lambda depth: SCALE * depth + BIAS)
    errors = found.check.estimate.errors()
    off = np.array([errors.scale - SCALE, errors.bias - BIAS])
    assert off @ np.linalg.solve(errors.covariance, off) < 12.0  # of two: one in 400
    assert abs(off[0]) < 3.0 * errors.scale_error and abs(off[1]) < 3.0 * errors.bias_error
    level, text = summary(found.check, "/depth", 0.03)
    assert level == DiagnosticStatus.WARN
    far = errors.farthest
    assert f"it is off by +{errors.at(far)[0]:.3f} m at {far:.2f} m" in text, text
    shown = values(found.check)
    assert float(shown["scale"]) == pytest.approx(errors.scale, abs=1e-6)
    assert float(shown["bias standard error (m)"]) == pytest.approx(errors.bias_error, abs=1e-6)
    assert int(shown["tags compared"]) == len(found.check.estimate) > 10


def test_a_small_error_is_a_matter_of_the_limit():
    """Depths that poses still take."""
    found = SceneCheck(lambda depth: depth + 0.012)
    assert not found.check.rejects()
    assert summary(found.check, "/depth", 0.03)[0] == DiagnosticStatus.OK
    level, text = summary(found.check, "/depth", 0.005)
    assert level == DiagnosticStatus.WARN and text.startswith("depths are off by +0.01"), text


@pytest.mark.parametrize("sensor", ["none", "kinect"])
def test_a_depth_camera_that_is_right_is_not_warned_of(sensor, exact):
    found = exact if sensor == "none" else SceneCheck(sensor=sensor)
    errors = found.check.estimate.errors()
    for depth in (errors.nearest, errors.farthest):
        error, deviation = errors.at(depth)
        assert abs(error) < max(3.0 * deviation, 0.003)
    assert not found.check.rejects()
    level, text = summary(found.check, "/depth", 0.03)
    assert level == DiagnosticStatus.OK and text.startswith("depths fit the tags: scale 1.0"), text


def test_a_tag_at_rest_counts_once(exact):
    check, camera = DepthCheck(), exact.camera
    assert exact.tags
    for _ in range(5):
        check.add(exact.tags, camera, exact.params, exact.errors)
    assert len(check.estimate) == len(exact.tags)
    assert check.left_out() == (0, 5 * len(exact.tags))
    moved = [
        tag._replace(
            corners=rv.MeasuredCorners(
                tag.corners.corners + 4.0, tag.corners.covariance, tag.corners.plane
            )
        )
        for tag in exact.tags
    ]
    check.add(moved, camera, exact.params, exact.errors)
    assert len(check.estimate) == 2 * len(exact.tags)
    twins = [tag._replace(unique=False, corners=exact.tags[0].corners) for tag in exact.tags]
    check.add(twins, camera, exact.params, exact.errors)
    assert len(check.estimate) == 2 * len(exact.tags)
    check.clear()
    assert len(check.estimate) == 0 and check.left_out() == (0, 0)
    assert summary(check, "/depth", 0.03)[1] == "no tag was seen with depth on /depth"


def test_with_other_parameters_of_depths_all_is_compared_anew(exact):
    check, other = DepthCheck(), rv.DepthErrorParams()
    assert check.add(exact.tags, exact.camera, exact.params, exact.errors) == len(exact.tags)
    assert check.add([], exact.camera, exact.params, rv.DepthErrorParams()) == 0
    assert len(check.estimate) == len(exact.tags)
    other.depth_bias += 0.01
    assert check.add([], exact.camera, exact.params, other) == 0
    assert len(check.estimate) == 0 and check.left_out() == (0, 0)


class Node:
    """What a DepthReport uses of an ImageNode and its DepthInput."""

    topic = "/depth"
    lack = ""

    def on_idle(self, release):
        self.end_work = release

    def problem(self):
        return self.lack


class Status:
    """A StatusTopic whose status is always due."""

    def __init__(self, _):
        pass

    def publish(self, status):
        self.level, self.text, self.values = status()


def test_a_status_tells_what_is_missing_and_how_old_it_is(monkeypatch, exact):
    now = [100.0]
    monkeypatch.setattr(depth_report, "StatusTopic", Status)
    monkeypatch.setattr(depth_report.time, "monotonic", lambda: now[0])
    node = Node()
    report = depth_report.DepthReport(node, node)

    def told(seconds, lack=""):
        now[0] += seconds
        report.add([], exact.camera, exact.params, exact.errors)
        report.publish(lack)
        return report._status.level, report._status.text

    nothing = DiagnosticStatus.OK, "no tag was seen with depth on /depth"
    assert told(200.0) == nothing
    report.add(exact.tags, exact.camera, exact.params, exact.errors)
    level, text = told(4.9)
    assert level == DiagnosticStatus.OK and text.startswith("depths fit the tags: scale ")
    assert told(25.1) == (level, f"{text}; no tag was seen with depth for 30 s")
    node.lack = "no depth on /depth for 30 s"
    assert told(0.0) == (DiagnosticStatus.WARN, node.lack)
    assert report._status.values["tags compared"] == str(len(exact.tags))
    assert told(0.0, "no poses of tags") == (DiagnosticStatus.WARN, node.lack)
    node.lack = ""
    assert told(0.0, "no poses of tags") == (DiagnosticStatus.WARN, "no poses of tags")
    node.end_work()
    assert told(0.0) == nothing


@pytest.mark.parametrize(
    "factor, said",
    [
        (10.0, "it is 10 times too large"),
        (0.1, "it is 10 times too small"),
        (1.3, "it is off by +"),
    ],
)
def test_depths_in_another_unit_are_told_so(factor, said):
    found = SceneCheck(lambda depth: factor * depth)
    while found.check.left_out()[1] < MIN_PLANES:
        found.add(found.tags)
    assert found.check.rejects()
    text = misfit(found.check, "/their/depth")
    assert said in text and " in the depth on /their/depth do not fit" in text, text
    assert summary(found.check, "/their/depth", 0.03) == (DiagnosticStatus.WARN, text)


def test_of_depths_that_are_left_out_only_a_significant_error_is_told(exact):
    check = DepthCheck()
    left_out = [
        tag._replace(
            poses=rv.estimate_pose(
                rv.single_tag(tag.tag.id, tag.size), {tag.tag.id: tag.corners.corners}, exact.camera
            )
        )
        for tag in exact.tags
    ]
    while check.left_out()[1] < MIN_PLANES:
        check.add(left_out, exact.camera, exact.params, exact.errors)
    assert check.rejects() and check.estimate.errors().worst(0.0)[1] == 0.0
    text = misfit(check, "/their/depth")
    assert " in the depth on /their/depth do not fit their corners. They are left out" in text, text


def test_tags_without_planes_are_not_counted(exact):
    check = DepthCheck()
    without = [
        exact.tags[0]._replace(corners=corners)
        for corners in (None, np.zeros((4, 2)), rv.MeasuredCorners(np.zeros((4, 2))))
    ]
    check.add([*without, exact.tags[0]._replace(poses=None)], exact.camera, exact.params, None)
    assert check.left_out() == (0, 0)
