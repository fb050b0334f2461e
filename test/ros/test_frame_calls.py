"""Which frame a call gets that waits for the next one."""

import concurrent.futures
import threading
import time

import pytest

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
