"""Which frame a call gets that waits for the next one."""

import concurrent.futures
import threading
import time

import pytest
from still_clock import StillClock

from robot_vision.ros import frame_calls
from robot_vision.ros.frame_calls import FrameCalls

TIMEOUT = 30.0  # s, for what another thread does at once


class Node:
    """Takes the place of an ImageNode."""

    def keep_working(self, _wanted):
        pass

    def no_frame(self, seconds):
        return f"no frame within {seconds:g} s"


@pytest.fixture
def calls():
    return FrameCalls(Node())


@pytest.fixture
def begin(calls):
    """Begins a call, and returns its future when it waits."""
    with concurrent.futures.ThreadPoolExecutor() as pool:

        def begin():
            waits = threading.Event()  # set by what is asked now and then whether to wait no longer
            call = pool.submit(calls.wait, TIMEOUT, waits.set)
            assert waits.wait(TIMEOUT) and calls.waiting
            return call

        yield begin


def test_a_call_does_not_get_a_frame_from_before_it(calls, begin):
    before = time.monotonic()
    call = begin()
    calls.offer(lambda: "old", before)
    assert calls.waiting
    calls.offer(lambda: "new", time.monotonic())
    assert call.result(TIMEOUT) == "new"
    assert not calls.waiting


def test_a_call_does_not_get_a_frame_that_may_have_been_on_its_way(calls, begin, monkeypatch):
    monkeypatch.setattr(frame_calls, "FRAME_PERIOD", TIMEOUT)
    before = time.monotonic()
    calls.offer(lambda: "nobody's", before)
    call = begin()
    for result in ("old", "on its way", "new"):
        taken = before if result == "old" else time.monotonic()
        calls.offer(lambda result=result: result, taken)
    assert call.result(TIMEOUT) == "new"


def test_a_call_is_late_by_the_time_in_which_no_frame_is_processed(monkeypatch):
    clock = StillClock()
    monkeypatch.setattr(frame_calls, "time", clock)
    calls = FrameCalls(Node())
    with calls.processing():  # of a frame from before the call
        clock.now += 2.0
        call = frame_calls._Call(clock.now, calls._busy_until_now(), None)
        clock.now += 100.0
        assert calls._waited(call) == 0.0
    clock.now += 3.0
    assert calls._waited(call) == pytest.approx(3.0)
    with calls.processing():
        clock.now += 100.0
        assert calls._waited(call) == pytest.approx(3.0)
    with pytest.raises(RuntimeError), calls.processing():
        raise RuntimeError("a frame of no use")
    clock.now += 4.0
    assert calls._waited(call) == pytest.approx(7.0)


def test_frames_that_are_processed_at_a_time_count_from_the_first_to_the_last(monkeypatch):
    clock = StillClock()
    monkeypatch.setattr(frame_calls, "time", clock)
    calls = FrameCalls(Node())
    call = frame_calls._Call(clock.now, calls._busy_until_now(), None)
    first, second = calls.processing(), calls.processing()
    first.__enter__()
    clock.now += 4.0
    second.__enter__()
    clock.now += 2.0
    first.__exit__(None, None, None)
    clock.now += 6.0
    assert calls._waited(call) == 0.0
    second.__exit__(None, None, None)
    clock.now += 3.0
    assert calls._waited(call) == pytest.approx(3.0)


def test_a_frame_that_takes_longer_than_a_call_waits_is_answered(calls):
    waits = threading.Event()
    with concurrent.futures.ThreadPoolExecutor() as pool, calls.processing():
        call = pool.submit(calls.wait, 0.0, waits.set)
        # Asked twice: the first question may have come before the time was looked at.
        for _ in range(2):
            waits.clear()
            assert waits.wait(TIMEOUT)
        calls.offer(lambda: "new")
        assert call.result(TIMEOUT) == "new"
    with pytest.raises(RuntimeError, match="no frame within 0 s"):
        calls.wait(0.0)


def test_what_cannot_be_made_is_raised_where_it_is_waited_for(calls, begin):
    call = begin()
    calls.offer(lambda: 1 // 0)
    with pytest.raises(ZeroDivisionError):
        call.result(TIMEOUT)


def test_a_frame_that_is_of_no_use_is_told(calls, begin):
    call = begin()
    calls.refuse("too dark")
    with pytest.raises(RuntimeError, match="too dark"):
        call.result(TIMEOUT)
