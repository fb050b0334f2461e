"""Which frames a network looks at, and what is told of each frame meanwhile."""

import queue
import time
from types import SimpleNamespace

import numpy as np
import pytest
import rospy
from std_msgs.msg import Header

import robot_vision as rv
from robot_vision.dnn.frame_follower import FrameFollower, Pace
from robot_vision.ros.transport import Frame

RATE = 30.0  # Hz
SPEED = 60.0  # px/s, to the right
TIMEOUT = 30.0  # s, for what another thread does at once
NOISE = np.random.default_rng(5).integers(0, 256, (120, 160, 3)).astype(np.uint8)


@pytest.mark.parametrize("rate", [30.0, 20.0, 15.0, 10.0, 0.7])
def test_as_many_frames_are_looked_at_as_the_rate_allows(rate):
    """Also of a camera whose frames do not come at equal times."""
    random, pace = np.random.default_rng(3), Pace()
    pace.period = 1.0 / rate
    times = 1e9 + np.arange(1800) / RATE + random.normal(0.0, 0.001, 1800)
    seen = np.array([time for time in times if pace.is_due(time)])
    assert len(seen) == pytest.approx(rate * 60.0, abs=2)
    for count in (2, 10):  # in no time more than one too many
        assert (
            len(seen) <= count
            or (seen[count:] - seen[:-count] > (count - 1) * pace.period - 1e-6).all()
        )


def test_what_is_wanted_or_of_an_earlier_time_is_looked_at():
    pace = Pace()
    pace.period = 1.0
    times = (10.0, False), (10.4, True), (10.5, False), (11.5, False), (2.0, False), (2.5, False)
    assert [pace.is_due(*one) for one in times] == [True, True, False, True, True, False]


def frame_of(number):
    """A frame of a camera that does not move, which is known by its stamp."""
    return Frame(NOISE, "bgr8", Header(stamp=rospy.Time.from_sec(100.0 + number / RATE)))


def number_of(frame):
    return round((frame.time - 100.0) * RATE)


def truth(number):
    """The box of the only thing in a frame."""
    left = 20.0 + SPEED * number / RATE
    return left, 30.0, left + 40.0, 70.0


def found_in(number):
    return [SimpleNamespace(class_id=3, score=0.9, box=truth(number))]


class Network:
    """Looks at a frame when the test lets it, and says what the test says."""

    def __init__(self):
        self.asked, self.answers = queue.Queue(), queue.Queue()

    def look(self, frame):
        self.asked.put(number_of(frame))
        answer = self.answers.get(timeout=TIMEOUT)
        if isinstance(answer, Exception):
            raise answer
        return answer


class Rig:
    def __init__(self, **params):
        self.network = Network()
        self.told, self.failures = queue.Queue(), queue.Queue()
        self.follower = FrameFollower(self.network.look, self._tell, self.failures.put)
        made = rv.BoxTrackerParams()
        made.min_hits = 1
        self.follower.configure(made, params.get("period", 0.0), lambda found: found.score)

    def _tell(self, frame, tracks, found):
        self.told.put((number_of(frame), tracks, found))

    def offer(self, number):
        self.follower.offer(frame_of(number))

    def asked(self):
        return self.network.asked.get(timeout=TIMEOUT)

    def next(self):
        return self.told.get(timeout=TIMEOUT)

    def answer(self, value):
        self.network.answers.put(value)

    def wait_for_end(self):
        """Waits until its thread has taken the answer."""
        deadline = time.monotonic() + TIMEOUT
        while self.follower._job is not None:
            assert time.monotonic() < deadline
            time.sleep(0.001)


@pytest.fixture
def rig():
    made = []

    def make(**params):
        made.append(Rig(**params))
        return made[-1]

    yield make
    for one in made:
        one.answer([])  # lets its thread wait for work that does not come


def test_a_fast_network_is_heard_before_its_frame_is_told_of(rig):
    rig = rig()
    for number in range(6):
        rig.offer(number)
        assert rig.asked() == number
        assert rig.told.empty()
        found = found_in(number)
        rig.answer(found)
        told, tracks, in_time = rig.next()
        assert told == number and in_time is found
        (track,) = tracks
        assert (track.id, track.class_id, track.detection) == (1, 3, 0)
        assert not track.predicted
        assert np.allclose(track.box, truth(number), atol=2.0)


def test_a_slow_network_holds_up_no_frame_and_things_move_on_meanwhile(rig):
    rig = rig()
    latency = 4  # frames
    job = 0
    numbers = []
    for number in range(60):
        rig.offer(number)
        if number == job:
            assert rig.asked() == job
        elif number == job + latency - 1:
            rig.answer(found_in(job))
            job += latency
            rig.wait_for_end()
        while not rig.told.empty():
            told, tracks, found = rig.next()
            numbers.append(told)
            assert not len(found)  # all of it comes too late for its frame
            if told >= 24:
                (track,) = tracks
                assert track.predicted and track.id == 1
                assert np.allclose(track.box, truth(told), atol=1.5)
    assert numbers == list(range(len(numbers)))
    assert len(numbers) >= 59


def test_the_network_looks_at_the_newest_frame(rig):
    rig = rig()
    rig.offer(0)
    assert rig.asked() == 0
    for number in range(1, 5):
        rig.offer(number)
    rig.answer([])
    rig.wait_for_end()
    rig.offer(5)
    assert rig.asked() == 5


def test_it_looks_no_more_often_than_it_shall(rig):
    rig = rig(period=0.2 - 1e-6)
    asked = []
    for number in range(31):
        rig.offer(number)
        if number % 6 == 0:  # 0.2 s later
            asked.append(rig.asked())
            rig.answer([])
            assert rig.next()[0] == number
        else:
            assert rig.next()[0] == number
            assert rig.network.asked.empty()
    assert asked == [0, 6, 12, 18, 24, 30]


def test_it_looks_at_once_at_a_frame_that_is_wanted(rig):
    rig = rig(period=10.0)
    for number, wanted in ((0, False), (1, True), (2, True)):
        rig.follower.offer(frame_of(number), wanted)
        assert rig.asked() == number
        rig.answer([])
        assert rig.next()[0] == number
    rig.offer(3)
    assert rig.next()[0] == 3
    assert rig.network.asked.empty()


def test_when_time_goes_back_it_looks_at_once(rig):
    rig = rig(period=10.0)
    for number in (300, 0):
        rig.offer(number)
        assert rig.asked() == number
        rig.answer([])
        assert rig.next()[0] == number


def test_a_network_that_fails_is_told_and_asked_again(rig):
    rig = rig()
    for number in range(3):
        rig.offer(number)
        rig.asked()
        rig.answer(RuntimeError(f"no memory {number}"))
        assert str(rig.failures.get(timeout=TIMEOUT)) == f"no memory {number}"
        assert rig.next() == (number, [], [])
    rig.offer(3)
    assert rig.asked() == 3
    rig.answer(found_in(3))
    assert len(rig.next()[1]) == 1


@pytest.mark.parametrize(
    "damage", [{"score": 7.0}, {"score": float("nan")}, {"box": (0.0, 0.0, 1e7, 1.0)}, {"box": ()}]
)
def test_what_the_tracker_cannot_take_is_told_and_the_network_is_asked_again(rig, damage):
    rig = rig()
    (thing,) = found_in(0)
    rig.offer(0)
    rig.asked()
    rig.answer([SimpleNamespace(**{**vars(thing), **damage})])
    assert isinstance(rig.failures.get(timeout=TIMEOUT), (TypeError, ValueError))
    assert rig.next() == (0, [], [])
    rig.offer(1)
    assert rig.asked() == 1
    rig.answer(found_in(1))
    assert len(rig.next()[1]) == 1


def test_what_cannot_be_told_does_not_end_the_work(rig):
    rig = rig()
    refused = [1, 2]

    def tell(frame, tracks, found):
        if number_of(frame) in refused:
            raise ValueError("no message can hold it")
        rig.told.put((number_of(frame), tracks, found))

    rig.follower._tell = tell
    rig.offer(1)  # is told of in the network's thread
    rig.asked()
    rig.answer(found_in(1))
    assert str(rig.failures.get(timeout=TIMEOUT)) == "no message can hold it"
    rig.wait_for_end()
    rig.offer(2)
    rig.asked()
    with pytest.raises(ValueError):
        rig.offer(3)  # frame 2 is told of first
    rig.offer(4)
    assert rig.next()[0] == 4
    rig.answer([])
    rig.wait_for_end()
    rig.offer(5)
    assert rig.asked() == 5


class Unstamped(Frame):
    """A frame whose time is that of the question, as of one without a stamp."""

    now = 100.0  # s

    @property
    def time(self):
        Unstamped.now += 1.0 / RATE
        return Unstamped.now


def test_a_frame_without_a_stamp_has_one_time(rig):
    rig = rig()
    frame = Unstamped(NOISE, "bgr8", Header())
    rig.network.look = lambda frame: found_in(0)
    rig.follower._look = rig.network.look
    rig.follower._tell = lambda frame, tracks, found: rig.told.put((tracks, found))
    before = Unstamped.now
    rig.follower.offer(frame)
    tracks, _ = rig.told.get(timeout=TIMEOUT)
    assert [one.age for one in tracks] == [0.0]
    assert Unstamped.now == before + 1.0 / RATE


def test_what_is_found_after_all_is_forgotten_does_not_count(rig):
    rig = rig()
    rig.offer(0)
    rig.asked()
    rig.follower.clear()
    rig.answer(found_in(0))
    rig.offer(1)
    assert rig.asked() == 1
    rig.answer([])
    assert rig.next() == (1, [], [])
    assert rig.told.empty()


def test_frames_of_another_size_begin_anew(rig):
    rig = rig()
    for number in (0, 1):
        rig.offer(number)
        assert rig.asked() == number
        if number == 0:
            rig.answer(found_in(number))
            assert len(rig.next()[1]) == 1
    small = frame_of(2)
    rig.follower.offer(Frame(NOISE[:60, :80], small.encoding, small.header))
    told, tracks, _ = rig.next()
    assert told == 1 and len(tracks) == 1  # of the old size, and so are the tracks
    rig.answer(found_in(1))
    assert rig.asked() == 2
    rig.answer([])
    assert rig.next() == (2, [], [])
    assert rig.told.empty()


def test_parameters_that_cannot_be_change_nothing(rig):
    rig = rig()
    bad = rv.BoxTrackerParams()
    bad.low_score, bad.high_score = 0.9, 0.1
    with pytest.raises(ValueError, match="low_score"):
        rig.follower.configure(bad, 0.0, lambda found: found.score)
    rig.offer(0)
    rig.asked()
    rig.answer(found_in(0))
    assert len(rig.next()[1]) == 1
