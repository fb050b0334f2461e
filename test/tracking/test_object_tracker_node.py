"""The node object_tracker: how objects are selected, followed, lost, found and published."""

import concurrent.futures
import copy
import subprocess
import threading
import types
import weakref

import cv2
import numpy as np
import pytest
import rospy
import skimage.data
import support
from diagnostic_msgs.msg import DiagnosticStatus
from frames import Camera, Source
from geometry_msgs.msg import Point
from ros_programs import ROSLAUNCH
from sensor_msgs.msg import Image, RegionOfInterest
from std_msgs.msg import Header
from still_clock import StillClock

from robot_vision.common.polygons import box_corners
from robot_vision.msg import (
    Detection,
    DetectionArray,
    Flow,
    GroundTruth,
    TrackState,
    TrackStateArray,
)
from robot_vision.ros.image_node import INPUT_TIMEOUT
from robot_vision.srv import ForgetObject, SelectObject
from robot_vision.tracking import auto_selection
from robot_vision.tracking.auto_selection import AutoSelection
from robot_vision.tracking.selections import MAX_OBJECTS, TrackSelection, TrackSelections
from robot_vision.transport import Frame

RATE = 30.0  # Hz, by the stamps of the images
ASTRONAUT = cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2BGR)
BACKGROUND = cv2.resize(cv2.cvtColor(skimage.data.coffee(), cv2.COLOR_RGB2BGR), (320, 240))
OBJECT = cv2.resize(ASTRONAUT[20:220, 160:320], (64, 80), interpolation=cv2.INTER_AREA)
SMALL = cv2.resize(ASTRONAUT[300:460, 160:320], (48, 48), interpolation=cv2.INTER_AREA)


def region(x, y, patch=OBJECT):
    return RegionOfInterest(x_offset=x, y_offset=y, width=patch.shape[1], height=patch.shape[0])


def view(x=None, y=80, other=None):
    """The background with the object at (x, y) and another one at `other` (top left corners)."""
    image = BACKGROUND.copy()
    if x is not None:
        image[y : y + OBJECT.shape[0], x : x + OBJECT.shape[1]] = OBJECT
    if other is not None:
        left, top = other
        image[top : top + SMALL.shape[0], left : left + SMALL.shape[1]] = SMALL
    return image


class Desk:
    """A camera, the node, and the messages about each frame."""

    def __init__(self, start, *arguments, outputs=True):
        self._camera = Camera(RATE)
        self.topic = self._camera.topic
        self.process = start("object_tracker.py", "__name:=eye", f"image:={self.topic}", *arguments)
        self.objects = self.states = None
        if outputs:
            self.listen()
            self._camera.wait_for()
        rospy.wait_for_service("/eye/select_object", support.DEADLINE)
        self._select = rospy.ServiceProxy("/eye/select_object", SelectObject)
        self.forget = rospy.ServiceProxy("/eye/forget", ForgetObject)

    def listen(self):
        """Subscribes to what the node says of each frame."""
        self.objects = support.subscribed("/eye/object", DetectionArray)
        self.states = support.subscribed("/eye/state", TrackStateArray)

    def send(self, pixels):
        """Sends a frame, and returns its stamp."""
        return self._camera.show(pixels).stamp

    def show(self, pixels):
        """Sends a frame, and returns the tracked objects and all states by id."""
        stamp = self.send(pixels)
        objects, states = (topic.of(stamp) for topic in (self.objects, self.states))
        assert objects.header.frame_id == states.header.frame_id == "eye"
        assert (objects.width, objects.height) == (320, 240)
        tracked = {track.id for track in states.tracks if track.state == TrackState.TRACKED}
        assert [found.id for found in objects.detections] == sorted(tracked)
        return objects.detections, {track.id: track for track in states.tracks}

    def select(self, where, label, pixels):
        """Selects by the service while frames are sent, and returns its answer."""
        with concurrent.futures.ThreadPoolExecutor() as pool:
            answer = pool.submit(self._select, where, label)
            while not answer.done():
                self.send(pixels)
                concurrent.futures.wait([answer], 1.0 / RATE)
            return answer.result()


def test_select_by_the_service_follow_lose_and_find_again(start):
    desk = Desk(start)
    assert desk.show(view(40)) == ([], {})
    answer = desk.select(region(40, 80), "face", view(40))
    assert (answer.success, answer.message, answer.id) == (True, "", 1)
    for step in range(1, 31):
        (found,), states = desk.show(view(40 + 2 * step, 80 + step // 3))
    assert (found.label, found.id, found.predicted) == ("face", 1, False)
    assert (found.center.x, found.center.y) == pytest.approx((131.5, 129.5), abs=0.5)
    assert (found.box.x_offset, found.box.y_offset) == pytest.approx((100, 90), abs=1)
    assert (found.box.width, found.box.height) == pytest.approx((64, 80), abs=2)
    assert found.outline[2].x == pytest.approx(163.5, abs=1)
    assert found.area == pytest.approx(64 * 80, rel=0.03)
    assert found.circle_radius == pytest.approx(np.hypot(32, 40), rel=0.02)
    assert found.has_velocity and found.velocity.x == pytest.approx(60.0, abs=3.0)
    state = states[1]
    assert found.score == state.confidence > 0.6
    assert (state.scale, state.angle) == pytest.approx((1.0, 0.0), abs=0.02)
    assert len(state.points) > 15 and all(100 <= point.x <= 164 for point in state.points)
    for _ in range(5):
        found, states = desk.show(view())
        assert not found and states[1].state == TrackState.LOST
        assert states[1].label == "face" and states[1].confidence == 0 and not states[1].points
    back = (desk.show(view(200, 30))[0] for _ in range(30))  # for a second
    found = next(filter(None, back))
    assert (found[0].center.x, found[0].center.y) == pytest.approx((231.5, 69.5), abs=0.5)


def test_several_objects_and_forgetting_them(start):
    desk = Desk(start)
    pixels = view(40, other=(250, 20))
    desk.show(pixels)
    assert desk.select(region(40, 80), "face", pixels).id == 1
    assert desk.select(region(250, 20, SMALL), "suit", pixels).id == 2
    for step in range(1, 20):
        found, states = desk.show(view(40 + step, other=(250 - 2 * step, 20)))
        assert len(found) == len(states) == 2
    assert [one.center.x for one in found] == pytest.approx([90.5, 235.5], abs=0.5)
    answer = desk.forget(7)
    assert not answer.success
    assert answer.message == "id is 7, must be of an object (1, 2), or -1 for all"
    assert desk.forget(1).success
    found, states = desk.show(view(60, other=(212, 20)))
    assert [one.label for one in found] == ["suit"] and set(states) == {2}
    assert desk.forget(-1).success
    assert desk.show(view(60, other=(212, 20))) == ([], {})


def test_selection_by_topic_replaces_objects_unless_several(start):
    desk = Desk(start)
    select = Source("/eye/select", RegionOfInterest)
    select.wait_for()
    pixels = view(40, other=(250, 20))
    desk.show(pixels)

    def ids_after(where, newest):
        """All ids, after the newest object has appeared."""
        select.send(where)
        states = support.wait_for(
            lambda: [found for found in [desk.show(pixels)[1]] if newest in found], "the selection"
        )
        return set(states[0])

    assert ids_after(region(40, 80), 1) == {1}
    assert ids_after(region(250, 20, SMALL), 2) == {2}
    support.reconfigured("/eye", several=True)
    assert ids_after(region(40, 80), 3) == {2, 3}
    support.reconfigured("/eye", several=False)
    select.send(region(300, 80))  # a bad one changes nothing
    refused = "nothing selected on " + desk.topic
    support.wait_for(lambda: desk.show(pixels) and refused in desk.process.output(), refused)
    found, states = desk.show(pixels)
    assert set(states) == {2, 3} and len(found) == 2


@pytest.mark.parametrize(
    "where, text",
    [
        (region(300, 80), "region of 64x80 px at (300, 80) is not inside the image of 320x240"),
        (RegionOfInterest(), "region of 0x0 px at (0, 0) is too small, must be at least 16x16 px"),
        (region(2**32 - 1, 2**32 - 1), "is not inside the image of 320x240"),
        (region(4, 4, np.zeros((60, 60))), "region of 60x60 px at (4, 4) has 0 feature points"),
    ],
)
def test_bad_selections_are_answered_and_logged(start, where, text):
    desk = Desk(start)
    pixels = view(100)
    pixels[:70, :70] = 90  # has no features
    desk.show(pixels)
    answer = desk.select(where, "nothing", pixels)
    assert not answer.success and text in answer.message and answer.id == -1
    desk.process.wait_for_output("nothing selected on " + desk.topic)
    assert desk.show(pixels) == ([], {})
    assert desk.select(region(100, 80), "face", pixels).success


def test_a_label_that_is_too_long_is_refused_at_once(start):
    desk = Desk(start, outputs=False)
    answer = rospy.ServiceProxy("/eye/select_object", SelectObject)(region(40, 80), "x" * 256)
    assert not answer.success and answer.id == -1
    assert answer.message.startswith("label is 'xxxx")
    assert answer.message.endswith("...: 256 letters, must be at most 255")
    assert desk.select(region(40, 80), "x" * 255, view(40)).success


def test_a_selection_beyond_the_largest_number_of_objects_is_refused():
    node = types.SimpleNamespace(topic="/images", keep_working=lambda _wanted: None)
    selector = Selector()
    selections = TrackSelections(node, threading.Lock(), selector)

    def select(count, replaces):
        """What became of as many selections in a frame."""
        made = [TrackSelection((0, 0, 20, 20), replaces=replaces) for _ in range(count)]
        for one in made:
            selections.add(one)
        with selections.updating(1.0):
            pass
        return made

    *taken, last = select(MAX_OBJECTS + 1, replaces=False)
    assert [one.id for one in taken] == list(selector.boxes) == list(range(1, MAX_OBJECTS + 1))
    assert last.id == -1
    assert last.error == "there are 100 objects, which is the most: forget one before"
    (only,) = select(1, replaces=True)  # it makes room
    assert list(selector.boxes) == [only.id]


def test_selection_is_followed_while_nobody_subscribes(start, diagnostics):
    desk = Desk(start, "_diagnostic_period:=0.02", outputs=False)
    idle = "idle: nobody subscribes"
    support.wait_for(lambda: diagnostics.next("eye").message == idle, idle)
    answer = desk.select(region(40, 80), "face", view(40))
    assert (answer.success, answer.id) == (True, 1)

    def done():
        return int(diagnostics.value("eye", "frames published"))

    for step in range(1, 21):  # the object has moved far away before anybody subscribes
        before = done()
        desk.send(view(40 + 5 * step))
        support.wait_for(lambda old=before: done() > old, "the frame to be done with")
    desk.listen()
    (found,), _ = desk.show(view(145))
    assert found.center.x == pytest.approx(176.5, abs=0.5)
    desk.objects.close()
    desk.states.close()
    topics = "/eye/object", "/eye/state"
    support.wait_for(lambda: not any(support.sends("/eye", one) for one in topics), "no subscriber")
    diagnostics.next("eye")  # that of a period which had begun before
    assert diagnostics.next("eye").message != idle
    assert desk.forget(1).success
    support.wait_for(lambda: diagnostics.next("eye").message == idle, idle)


def test_service_call_without_frames_is_answered(start):
    desk = Desk(start, outputs=False)
    answer = rospy.ServiceProxy("/eye/select_object", SelectObject)(region(40, 80), "face")
    assert not answer.success
    assert answer.message == f"no frame on {desk.topic} within 10 s"
    assert desk.process.running()


def test_selection_after_a_pause_is_made_in_a_new_frame(start, diagnostics):
    desk = Desk(start, "_diagnostic_period:=0.1", outputs=False)
    assert desk.select(region(40, 80), "face", view(40)).success
    assert desk.forget(1).success
    idle = "idle: nobody subscribes"
    support.wait_for(lambda: diagnostics.next("eye").message == idle, idle)
    assert desk.select(region(150, 80), "face", view(150)).id == 2
    desk.states = support.subscribed("/eye/state", TrackStateArray)
    states = desk.states.of(desk.send(view(154)))
    assert [(track.id, track.state) for track in states.tracks] == [(2, TrackState.TRACKED)]


def test_last_of_several_selections_without_a_frame_counts(start):
    desk = Desk(start)
    selector = Source("/eye/select", RegionOfInterest)
    selector.wait_for()
    for x in (200, 120, 40):
        selector.send(region(x, 80))

    def arrived():
        _, _, (_, of, _) = support.node_api("/eye").getBusStats(rospy.get_name())
        return [one[2] for one in dict(of).get("/eye/select", [])] == [3]

    support.wait_for(arrived, "all selections")
    states = support.wait_for(lambda: desk.show(view(40))[1], "the object")
    assert set(states) == {1}
    (found,), _ = desk.show(view(44))
    assert found.center.x == pytest.approx(75.5, abs=0.5)


def test_flow_is_that_of_the_whole_image(start):
    desk = Desk(start)
    flows = support.subscribed("/eye/flow", Flow)
    large = cv2.resize(ASTRONAUT, (400, 400))
    for step in range(4):
        stamp = desk.send(large[20 + step : 260 + step, 40 - 2 * step : 360 - 2 * step])
        flow = flows.of(stamp)
        assert len(flow.points) == len(flow.velocities)
        assert flow.header.frame_id == "eye"
    velocities = np.array([(v.x, v.y) for v in flow.velocities])
    assert 50 < len(velocities) <= 200
    assert np.median(velocities, axis=0) == pytest.approx((60.0, -30.0), abs=1.0)


def test_overlay_shows_tracked_objects_and_names_lost_ones(start):
    desk = Desk(start)
    overlays = support.subscribed("/eye/processed_image", Image)

    def overlay(pixels):
        sent = overlays.of(desk.send(pixels))
        return np.frombuffer(sent.data, np.uint8).reshape(240, 320, 3)

    desk.show(view(100))
    desk.select(region(100, 80), "face", view(100))
    drawn = overlay(view(100))
    for x, y in [(100, 120), (163, 120), (130, 80), (130, 159)]:
        around = drawn[y - 2 : y + 3, x - 2 : x + 3].reshape(-1, 3)
        assert (around == (0, 255, 0)).all(axis=1).any(), (x, y)
    inside = (drawn[80:160, 100:164] == (0, 255, 255)).all(axis=2)
    assert np.count_nonzero(inside) > 50  # points
    assert np.array_equal(drawn[200:], view(100)[200:])
    lost = overlay(view())
    changed = (lost != view()).any(axis=2)
    assert changed[:30, :120].any() and not changed[30:].any()
    blue, green, red = np.moveaxis(lost[:30].astype(int), 2, 0)
    assert np.count_nonzero((red > 150) & (blue < 60) & (green < 60)) > 20


class Finder:
    """Another node, which publishes detections."""

    def __init__(self):
        self._source = Source("/finder/found", DetectionArray)
        self._source.wait_for()
        self._sent = 0

    def found_at(self, stamp, *things):
        """Publishes (label, box) or (label, box, id) as found in the frame with this stamp.

        Waits until the node has received them, so that the next frame may select them.
        """
        array = DetectionArray(width=320, height=240)
        array.header.stamp = stamp
        for label, box, *number in things:
            center = Point(box.x_offset + box.width / 2, box.y_offset + box.height / 2, 0)
            found = Detection(label=label, box=box, center=center, id=number[0] if number else -1)
            array.detections.append(found)
        self._source.send(array)
        self._sent += 1
        support.wait_for(lambda: self._received() == self._sent, "the detections")

    def _received(self):
        """The number of messages that the node has received."""
        _, _, (_, subscribed, _) = support.node_api("/eye").getBusStats("/test")
        ((_, _, count, *_),) = dict(subscribed)[self._source.topic]  # one connection: number, bytes
        return count


def test_detections_of_another_node_are_selected(start):
    desk = Desk(
        start,
        "_auto_select:=true",
        "_auto_label:=face",
        "_auto_after:=0",
        "_max_objects:=1",
        "detections:=/finder/found",
    )
    finder = Finder()

    stamp = desk.send(view(40, other=(250, 20)))
    desk.states.of(stamp)
    desk.show(view(44, other=(250, 20)))
    # The message is two frames late, begins with another label, and has one object too many.
    suit = region(250, 20, SMALL)
    finder.found_at(stamp, ("suit", suit), ("face", region(40, 80)), ("face", suit))

    def tracked():
        return desk.show(view(46, other=(250, 20)))[0]

    (found,) = support.wait_for(tracked, "the detection to be followed")
    assert (found.label, found.id) == ("face", 1)
    assert found.center.x == pytest.approx(77.5, abs=0.5)
    for step in range(10):  # detected again it stays the same object; there is no room for another
        x = 46 + 2 * step
        stamp = desk.send(view(x, other=(250, 20)))
        finder.found_at(stamp, ("face", region(x, 80)), ("face", region(250, 20, SMALL)))
        found, states = desk.show(view(x, other=(250, 20)))
        assert set(states) == {1} and found


def test_detections_that_cannot_be_selected_are_told(start, diagnostics):
    desk = Desk(start, "_auto_select:=true", "detections:=/finder/found", "_diagnostic_period:=0.2")

    def told(text):
        desk.show(view(40))
        status = diagnostics.next("eye")
        return status.level == DiagnosticStatus.WARN and text in status.message

    nobody = "nobody publishes detections on /finder/found"
    support.wait_for(lambda: told(nobody), nobody)
    assert f"nothing is selected automatically: {nobody}" in desk.process.output()
    finder = Finder()
    apart = f"the stamps on /finder/found and {desk.topic} do not meet: the last is of none of the"

    def told_of_stamps():
        finder.found_at(
            desk.send(view(40)) + rospy.Duration.from_sec(0.001), ("face", region(40, 80))
        )
        return told(apart)

    support.wait_for(told_of_stamps, apart)

    def is_well():
        """Whether a status is well behind detections in a frame that the node has processed."""
        stamp = desk.send(view(40))
        desk.states.of(stamp)
        finder.found_at(stamp)
        return not told("")

    support.wait_for(is_well, "the end of the warning")


class Selector:
    """An ObjectTracker that only records the selections."""

    def __init__(self):
        self.selected = []
        self.labels = []
        self.images = []  # in which they were selected
        self.boxes = {}  # by the ids of those that were not forgotten

    def select_in(self, image, box, label):
        self.images.append(image)
        return self.select(box, label)

    def select(self, box, label):
        self.selected.append(box)
        self.labels.append(label)
        number = len(self.selected)
        self.boxes[number] = box
        return number

    def objects(self):
        return [
            types.SimpleNamespace(id=number, tracked=True, outline=box_corners(box))
            for number, box in self.boxes.items()
        ]

    def forget(self, number):
        del self.boxes[number]


def selecting(after, most=1, predicted=False):
    """A Selector, and an AutoSelection that selects there what was found for so long (s)."""
    selector = Selector()
    selection = AutoSelection(selector)
    selection.configure("", most, after, predicted)
    return selector, selection


def test_only_the_best_of_thousands_of_detections_are_used(log):
    boxes = [region(x, y, SMALL) for y in range(0, 5000, 100) for x in range(0, 6000, 100)]
    array = DetectionArray(detections=[Detection(box=box, id=-1) for box in boxes])
    order = np.random.default_rng(1).permutation(len(boxes))
    for detection, rank in zip(array.detections, order):
        detection.score = 1.0 - rank / len(boxes)
    selector, selection = selecting(0.1, most=3000)
    for second in (1, 2, 3):
        array.header.stamp = rospy.Time(second)
        found = copy.deepcopy(array)
        selection.add(found)
        selection.select(Frame(BACKGROUND, "bgr8", found.header), selector.objects())
    best = {(box.x_offset, box.y_offset) for box, rank in zip(boxes, order) if rank < 100}
    assert {box[:2] for box in selector.selected} == best
    assert len(selector.selected) == len(best)
    assert "3000 detections in a message: only the 100 of the highest score" in log()


def test_detections_of_images_without_stamps_are_those_of_the_newest_frame():
    selector, found = Selector(), Detection(box=region(40, 80), id=-1)
    selection = AutoSelection(selector)
    selection.configure("", 1, 0.0)
    frames = [Frame(view(x), "bgr8", Header()) for x in (0, 20, 40)]
    for frame in frames[:2]:
        selection.select(frame, [])
    selection.add(DetectionArray(detections=[found]))
    selection.select(frames[2], [])
    (used,) = selector.images
    assert used is frames[2].image


def test_a_long_label_is_cut():
    selector, selection = selecting(0.0)
    header = Header(stamp=rospy.Time(1))
    found = Detection(box=region(40, 80), id=-1, label="ä" * 100_000)
    selection.add(DetectionArray(header=header, detections=[found]))
    selection.select(Frame(BACKGROUND, "bgr8", header), selector.objects())
    assert selector.labels == ["ä" * 255]


def found_at(selection, selector, seconds, *boxes, image=BACKGROUND, predicted=False):
    """Has detections in a frame of this time, and the frame itself, come to an AutoSelection."""
    header = Header(stamp=rospy.Time.from_sec(seconds))
    found = [Detection(box=box, id=-1, predicted=predicted) for box in boxes]
    selection.add(DetectionArray(header=header, detections=found))
    selection.select(Frame(image, "bgr8", header), selector.objects())


def shown(selection, selector, late, frames, off=0.0):
    """Shows frames at 30 Hz; the detections of each come so many frames late, stamped `off` (s)."""
    for number in range(frames):
        if number >= late:
            of = Header(stamp=rospy.Time.from_sec(1000.0 + (number - late) / RATE + off))
            found = Detection(box=region(40, 80), id=-1)
            selection.add(DetectionArray(header=of, detections=[found]))
        header = Header(stamp=rospy.Time.from_sec(1000.0 + number / RATE))
        selection.select(Frame(BACKGROUND, "bgr8", header), selector.objects())


@pytest.mark.parametrize("late", [0, 15, 55])
def test_what_a_slow_detector_finds_is_selected(late):
    selector, selection = selecting(0.2)
    shown(selection, selector, late, late + 7)
    assert len(selector.selected) == 1 and not selection.misfit


def test_what_is_found_after_its_frame_was_dropped_is_told():
    selector, selection = selecting(0.2)
    shown(selection, selector, 75, 60 + 75)
    kept = "2.5 s older than the newest image, and only the images of 2 s are kept"
    assert selection.misfit == f"the last is {kept}"
    shown(selection, selector, 0, 10)  # as after the end of a recording
    assert len(selector.selected) == 1 and not selection.misfit


@pytest.mark.parametrize(
    "off, apart",
    [(0.01, "0.01"), (3.0, "2.7"), (-500.0, "499")],
    ids=["between", "ahead", "behind"],
)
def test_detections_that_are_of_no_frame_are_told(off, apart):
    selector, selection = selecting(0.0)
    shown(selection, selector, 0, 40, off)
    assert not selector.selected
    assert selection.misfit.startswith(f"the last is of none of the images, the nearest {apart}")
    assert selection.misfit.endswith(" s off")


def test_what_is_lost_when_a_short_recording_begins_anew_is_selected_again():
    selector, selection = selecting(0.2)
    for times in (1, 2, 3):
        shown(selection, selector, 5, 45)  # of 1.5 s, the same stamps each time
        assert len(selector.selected) == times and not selection.misfit
        selector.forget(times)


def test_what_still_comes_of_the_end_of_a_recording_is_no_misfit():
    selector, selection = selecting(0.2)
    for number in range(4 * 300):
        of, now = (
            Header(stamp=rospy.Time.from_sec(1000.0 + one % 300 / RATE))
            for one in (number - 45, number)
        )
        selection.add(DetectionArray(header=of, detections=[Detection(box=region(40, 80), id=-1)]))
        selection.select(Frame(BACKGROUND, "bgr8", now), selector.objects())
        assert number < 300 or not selection.misfit


def test_where_there_are_no_images_detections_are_not_missing(monkeypatch):
    clock = StillClock()
    monkeypatch.setattr(auto_selection, "time", clock)
    _, selection = selecting(0.2)
    for pause in (INPUT_TIMEOUT, 1.0, 60.0):
        clock.now += pause
        selection.select(Frame(BACKGROUND, "bgr8", Header()), [])
        assert selection.silence() == (1.0 if pause == 1.0 else 0.0)


def test_of_a_detector_in_time_few_frames_are_kept():
    """More than eight would have to be copied out of shared memory."""
    selector, selection = selecting(0.2)
    shown(selection, selector, 2, 60)
    assert len(selection._frames) == 8


def test_messages_that_come_at_a_time_are_each_of_their_frame():
    selector, selection = selecting(0.5)
    shown(selection, selector, 100, 31)  # without any detections
    for number in (0, 10, 29, 15):
        of = Header(stamp=rospy.Time.from_sec(1000.0 + number / RATE))
        selection.add(DetectionArray(header=of, detections=[Detection(box=region(40, 80), id=-1)]))
    frame = Frame(BACKGROUND.copy(), "bgr8", Header(stamp=rospy.Time.from_sec(1000.0 + 31 / RATE)))
    selection.select(frame, [])
    assert len(selector.selected) == 1 and not selection.misfit


def test_what_was_found_before_the_first_frame_is_no_misfit():
    selector, selection = selecting(0.0)
    shown(selection, selector, 0, 40, -1.5)
    assert not selector.selected and not selection.misfit


def test_what_was_found_before_a_gap_is_found_anew():
    selector, selection = selecting(50.0)
    place = region(40, 80)
    for seconds in (1.0, 101.0, 60.0, 101.0):  # the clock of a recording may go back, too
        found_at(selection, selector, seconds, place)
    for seconds in np.arange(104.0, 151.0, 3.0):  # of a slow detector
        found_at(selection, selector, seconds, place)
    assert not selector.selected
    found_at(selection, selector, 151.0, place)
    assert len(selector.selected) == 1


def test_what_is_predicted_is_no_gap_but_not_selected():
    selector, selection = selecting(0.5)
    place = region(40, 80)
    found_at(selection, selector, 1.0, place)
    for seconds in (1.2, 1.5, 1.8):
        found_at(selection, selector, seconds, place, predicted=True)
    assert not selector.selected
    seen = BACKGROUND.copy()
    found_at(selection, selector, 1.9, place, image=seen)
    (image,) = selector.images
    assert image is seen


def test_what_is_seen_only_afterwards_has_not_been_found_for_long():
    selector, selection = selecting(0.5)
    place = region(40, 80)
    found_at(selection, selector, 1.0, place, predicted=True)
    for seconds in (1.4, 1.8):
        found_at(selection, selector, seconds, place)
    assert not selector.selected
    found_at(selection, selector, 1.9, place)
    assert len(selector.selected) == 1


def test_what_is_predicted_is_selected_if_that_is_wanted():
    selector, selection = selecting(0.5, predicted=True)
    for seconds in (1.0, 1.4):
        found_at(selection, selector, seconds, region(40, 80), predicted=True)
    assert not selector.selected
    found_at(selection, selector, 1.5, region(40, 80), predicted=True)
    assert len(selector.selected) == 1


def test_what_was_found_before_automatic_selection_ended_is_found_anew():
    selector, selection = selecting(0.5)
    place = region(40, 80)
    image = BACKGROUND.copy()
    found_at(selection, selector, 1.0, place, image=image)
    held = weakref.ref(image)
    del image
    assert held() is not None
    selection.clear()
    assert held() is None
    for seconds in (2.0, 2.4):
        found_at(selection, selector, seconds, place)
    assert not selector.selected
    found_at(selection, selector, 2.5, place)
    assert len(selector.selected) == 1


def test_automatic_selection_ends_at_the_largest_number_of_objects():
    selector = Selector()
    for _ in range(MAX_OBJECTS - 1):
        selector.select((0, 0, 20, 20), "")
    selection = AutoSelection(selector)
    selection.configure("", 100, 0.0)
    found_at(selection, selector, 1.0, region(40, 80), region(140, 80))
    assert len(selector.boxes) == MAX_OBJECTS and (40, 80, 64, 80) in selector.boxes.values()
    selector.forget(1)
    found_at(selection, selector, 2.0, region(40, 80), region(140, 80))
    assert len(selector.boxes) == MAX_OBJECTS and (140, 80, 64, 80) in selector.boxes.values()


@pytest.mark.parametrize("ids", [(), (7,)], ids=["followed by place", "followed by id"])
def test_only_objects_detected_for_long_enough_are_selected(start, ids):
    """The suit is not detected in three frames, the face in all."""
    desk = Desk(start, "_auto_select:=true", "_auto_after:=0.19", "detections:=/finder/found")
    finder = Finder()
    for step in range(7):  # in the seventh frame the face has been detected for 0.2 s
        pixels = view(40 + 2 * step, other=(250, 20))
        stamp = desk.send(pixels)
        things = [("face", region(40 + 2 * step, 80), *ids)]
        if step not in (2, 3, 4):
            things.insert(0, ("face", region(250, 20, SMALL), *(number + 1 for number in ids)))
        assert not desk.states.of(stamp).tracks
        finder.found_at(stamp, *things)

    def tracked():
        return desk.show(pixels)[0]

    (found,) = support.wait_for(tracked, "the detection to be followed")
    assert found.center.x == pytest.approx(40 + 2 * step + 31.5, abs=0.5)


def test_objects_lost_for_long_are_forgotten(start):
    desk = Desk(start, "_forget_after:=0.49")
    desk.show(view(40))
    desk.select(region(40, 80), "face", view(40))
    desk.show(view(40))
    kept = [bool(desk.show(view())[1]) for _ in range(20)]
    assert kept == [True] * 15 + [False] * 5


def test_rectangle_dragged_in_the_launch_files_window_is_followed(start, display):
    """The scene's poster, from the image on the screen to the messages."""
    start("camera_node", "__name:=usb_cam", "_source:=synthetic")
    start(ROSLAUNCH, "robot_vision", "object_tracker.launch", "view:=true")
    objects = support.Messages("/object_tracker/object", DetectionArray)
    truths = support.Messages("/usb_cam/ground_truth", GroundTruth)

    def poster(truth):
        return next(thing for thing in truth.objects if thing.name == "poster")

    def corners(thing):
        outline = np.array([(corner.x, corner.y) for corner in thing.outline])
        return outline.min(axis=0), outline.max(axis=0)

    def window():
        title = "/object_tracker/processed_image  "
        shown = [number for name, number in support.windows().items() if name.startswith(title)]
        return shown if any("640x480" in name for name in support.windows()) else []

    number = support.wait_for(window, "the window with images")[0]

    def drag():
        """Drags the poster's place of the newest frame, from which it moves on meanwhile."""
        seen = support.wait_for(
            lambda: [t for t in truths.received[-1:] if poster(t).visible], "the poster"
        )
        begin, end = (corner.astype(int).tolist() for corner in corners(poster(seen[0])))
        command = ["mousemove", "--window", number, *begin, "mousedown", 1]
        for place in ([sum(pair) // 2 for pair in zip(begin, end)], end):
            command += ["mousemove", "--window", number, *place]
        subprocess.run(["xdotool", *map(str, command), "mouseup", "1"], check=True)
        del objects.received[:]

    def followed():
        """What is followed first in a frame whose truth has come: either may miss some."""
        known = {truth.header.stamp: truth for truth in list(truths.received)}
        with_one = (one for one in list(objects.received) if one.detections)
        stamps = ((one, known.get(one.header.stamp)) for one in with_one)
        return next(((one, truth) for one, truth in stamps if truth), None)

    def follows_the_poster():
        drag()
        try:
            found, truth = support.wait_for(followed, "the poster to be followed", 10.0)
        except AssertionError:  # What was dragged has not come, or could not be selected.
            return False
        low, high = corners(poster(truth))
        box = found.detections[0].box
        end = box.x_offset + box.width, box.y_offset + box.height
        return np.abs(np.subtract((box.x_offset, box.y_offset, *end), (*low, *high))).max() <= 12

    support.wait_for(follows_the_poster, "the place that was dragged")


def test_bad_value_at_start_is_fatal(start):
    text = "window is 8, must be odd and from 5 to 51"
    support.assert_fatal_at_start(start, "object_tracker.py", "window", 8, text)
