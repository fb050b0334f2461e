"""The line follower's controller: tables of lines and the commands that they must give."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from robot_vision.line.line_control import LineController, LineControlParams, must_stop

COURSE = LineControlParams()
PID = LineControlParams(
    mode="pid", kp=1.0, ki=0.5, kd=0.1, linear_speed=0.4, min_speed=0.1, max_angular=2.0
)


def line(error, angle=0.0, width=320, found=True):
    """A line as find_line() describes it in an image of `width` px."""
    return SimpleNamespace(found=found, error=error, offset=error * width / 2.0, angle=angle)


def commands(params, *seen):
    """The commands of a new controller for several (time, line)."""
    controller = LineController(params)
    return [controller.update(time, line) for time, line in seen]


@pytest.mark.parametrize(
    "offset, angular",
    [
        (0.0, 0.0),
        (20.0, 0.0),
        (-20.0, 0.0),
        (20.5, -0.3),  # the line is on the right: turn right, which is negative
        (-20.5, 0.3),
        (160.0, -0.3),
        (-160.0, 0.3),
    ],
)
def test_course_turns_outside_the_dead_band(offset, angular):
    assert commands(COURSE, (0.0, line(offset / 160.0))) == [(0.2, angular)]


@pytest.mark.parametrize(
    "change, offset, command",
    [
        ({"gain": 0.004}, 50.0, (0.2, -0.2)),
        ({"gain": 0.004}, -70.0, (0.2, 0.28)),
        ({"gain": 0.004, "max_angular": 0.1}, 50.0, (0.2, -0.1)),
        ({"gain": 0.004, "dead_band": 60.0}, 50.0, (0.2, 0.0)),
        ({"gain": 0.004, "dead_band": 0.0, "linear_speed": 0.5}, 5.0, (0.5, -0.02)),
    ],
)
def test_course_parameters(change, offset, command):
    (answer,) = commands(replace(COURSE, **change), (0.0, line(offset / 160.0)))
    assert answer == pytest.approx(command)


def test_integral_before_a_gap_is_forgotten():
    controller = LineController(replace(PID, kd=0.0))
    for step in range(30):
        controller.update(step / 30.0, line(0.2))
    assert controller.update(1.0, line(0.1))[1] < -0.15  # with the integral
    assert controller.update(1.6, line(0.1))[1] == pytest.approx(-0.1)
    assert controller.update(100.0, None) == (0.0, 0.0)
    assert controller.update(50.0, line(0.1))[1] == pytest.approx(-0.1)


@pytest.mark.parametrize("params", [COURSE, PID], ids=["course", "pid"])
@pytest.mark.parametrize("nothing", [None, line(0.9, found=False)], ids=["none", "not found"])
def test_stands_without_a_line(params, nothing):
    assert commands(params, (0.0, nothing), (0.1, line(0.5)), (0.2, nothing))[::2] == [(0, 0)] * 2


@pytest.mark.parametrize(
    "seen, angular",
    [
        ([(0.0, 0.5)], -0.5),  # the first frame: proportional only
        ([(0.0, -0.5)], 0.5),
        # 1.0 * 0.6 + 0.5 * (0.6 * 0.1) + 0.1 * (0.1 / 0.1)
        ([(0.0, 0.5), (0.1, 0.6)], -0.73),
        # The same change over twice the time: the integral doubles and the derivative halves.
        ([(0.0, 0.5), (0.2, 0.6)], -0.71),
        ([(0.0, 0.5), (0.1, 0.5), (0.2, 0.5), (0.4, 0.5)], -0.6),
        # The same frame twice: no time has passed, so that nothing is integrated or differentiated.
        ([(0.0, 0.5), (0.0, 0.6)], -0.6),
        # Time runs backwards: the controller begins anew.
        ([(5.0, 0.5), (5.1, 0.9), (1.0, 0.6)], -0.6),
    ],
)
def test_pid_terms(seen, angular):
    answers = commands(PID, *[(time, line(error)) for time, error in seen])
    assert answers[-1][1] == pytest.approx(angular)


def test_pid_does_not_depend_on_the_frame_rate():
    def ramp(rate):
        frames = [(i / rate, line(0.1 + 0.2 * i / rate)) for i in range(2 * rate + 1)]
        return commands(PID, *frames)[-1][1]

    # Error 0.5, its integral 0.6 s, its change 0.2 /s.
    assert ramp(1000) == pytest.approx(-(0.5 + 0.5 * 0.6 + 0.1 * 0.2), abs=1e-3)
    assert ramp(10) == pytest.approx(ramp(1000), abs=0.02)


def test_pid_does_not_wind_up():
    controller = LineController(replace(PID, max_angular=0.6, kd=0.0))
    for i in range(1000):
        assert abs(controller.update(0.1 * i, line(0.8))[1]) == pytest.approx(0.6)
    # After 100 s at the limit the integral adds nothing: the turn is that of the error alone.
    assert controller.update(100.0, line(0.1))[1] == pytest.approx(-(0.1 + 0.5 * 0.01))
    # The integral from below the limit shrinks even at the limit, once the line changes sides.
    controller.reset()
    for i in range(11):
        controller.update(0.1 * i, line(0.3))
    assert controller.update(1.1, line(-0.9))[1] == pytest.approx(0.6)
    assert controller.update(1.2, line(0.0))[1] == pytest.approx(-0.5 * (0.3 - 0.09))


def test_pid_forgets_what_was_before_the_line_was_lost():
    frames = [(0.0, line(0.5)), (1.0, line(0.5)), (1.1, None), (1.2, line(-0.2))]
    assert commands(PID, *frames)[-1][1] == pytest.approx(0.2)


@pytest.mark.parametrize(
    "error, angle, speed",
    [
        (0.0, 0.0, 0.4),
        (0.5, 0.0, 0.25),
        (-0.5, 0.0, 0.25),
        (1.0, 0.0, 0.1),
        (0.0, math.pi / 6, 0.25),
        (0.0, -math.pi / 2, 0.1),
        (0.2, math.pi / 6, 0.25),  # the larger reduction of the two counts
    ],
)
def test_pid_slows_down_in_curves(error, angle, speed):
    assert commands(PID, (0.0, line(error, angle)))[0][0] == pytest.approx(speed)


@pytest.mark.parametrize("mode", ["course", "pid"])
@pytest.mark.parametrize("error, angular", [(0.4, -0.25), (-0.4, 0.25), (0.0, 0.0)])
def test_search_turns_to_where_the_line_was(mode, error, angular):
    params = LineControlParams(mode=mode, search=True, search_angular=0.25, search_timeout=2.0)
    controller = LineController(params)
    assert controller.update(9.0, None) == (0.0, 0.0)  # no line was seen, so there is no side
    controller.update(10.0, line(error))
    for step in range(20):
        assert controller.update(10.1 + 0.1 * step, None) == (0.0, angular)
    assert controller.update(12.2, None) == (0.0, 0.0)
    assert controller.update(60.0, None) == (0.0, 0.0)
    # The line was found and lost again: the timeout begins anew, on the other side.
    assert controller.update(61.0, line(-error))[0] > 0.0
    assert controller.update(61.1, None) == (0.0, -angular)


def test_a_search_turns_no_faster_than_all_else():
    params = LineControlParams(search=True, search_angular=0.3, max_angular=0.1)
    assert commands(params, (0.0, line(0.5)), (0.1, None))[1] == (0.0, -0.1)


@pytest.mark.parametrize("timeout", [0.5, 2.0])
def test_search_does_not_begin_after_a_pause(timeout):
    """The robot has stood since then, and may be elsewhere."""
    params = LineControlParams(search=True, timeout=timeout)
    for pause, turns in (0.9 * timeout, True), (1.1 * timeout, False), (300.0, False):
        controller = LineController(params)
        controller.update(10.0, line(0.4))
        assert (controller.update(10.0 + pause, None) != (0.0, 0.0)) is turns


def test_search_does_not_go_on_after_a_pause():
    """Until a line has been seen again."""
    for pause, turns in (0.4, True), (0.6, False), (5.9, False):
        controller = LineController(LineControlParams(search=True, search_timeout=10.0))
        controller.update(10.0, line(0.4))
        assert controller.update(10.1, None) == (0.0, -0.3)
        assert (controller.update(10.1 + pause, None) != (0.0, 0.0)) is turns
        assert (controller.update(10.2 + pause, None) != (0.0, 0.0)) is turns
        assert controller.update(10.3 + pause, line(-0.4)) == (0.2, 0.3)
        assert controller.update(10.4 + pause, None) == (0.0, 0.3)


def test_terms_of_the_error_last_until_the_timeout():
    for timeout, turn in (1.0, -0.75), (0.5, -0.5):
        params = replace(PID, ki=0.0, kd=0.5, timeout=timeout)
        _, (_, angular) = commands(params, (0.0, line(0.1)), (0.8, line(0.5)))
        assert angular == pytest.approx(turn)


def test_a_slow_robot_is_slower_than_min_speed():
    slow = replace(PID, linear_speed=0.03)
    assert commands(slow, (0.0, line(1.0)))[0][0] == pytest.approx(0.03)
    assert commands(replace(COURSE, linear_speed=0.0), (0.0, line(0.0)))[0] == (0.0, 0.0)


def test_reset_forgets_the_side():
    controller = LineController(LineControlParams(search=True))
    controller.update(0.0, line(0.4))
    controller.reset()
    assert controller.update(0.1, None) == (0.0, 0.0)


@pytest.mark.parametrize(
    "now, last_frame, enabled, stop",
    [
        (10.0, 10.0, True, False),
        (10.0, 9.6, True, False),
        (10.0, 9.5, True, False),
        (10.0, 9.4, True, True),
        (10.0, None, True, True),
        (10.0, 10.0, False, True),
        (10.0, 10.1, True, False),  # the camera's clock may be a little ahead
        (10.0, 10.6, True, True),
        (10.0, math.nan, True, True),
        (math.nan, 10.0, True, True),
    ],
)
def test_watchdog(now, last_frame, enabled, stop):
    assert must_stop(now, last_frame, enabled) is stop


def test_watchdog_timeout():
    assert must_stop(10.0, 9.6, True, timeout=0.3)
    assert not must_stop(10.0, 9.0, True, timeout=1.5)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"mode": "pdi"}, "mode is pdi, must be course or pid"),
        ({"linear_speed": -0.1}, "linear_speed is -0.1, must be from 0 to 5"),
        ({"linear_speed": math.nan}, "linear_speed is nan, must be from 0 to 5"),
        ({"max_angular": 11}, "max_angular is 11, must be from 0 to 10"),
        ({"gain": -1}, "gain is -1, must be from 0 to 10"),
        ({"dead_band": -1}, "dead_band is -1, must be from 0 to 10000"),
        ({"kp": 101}, "kp is 101, must be from 0 to 100"),
        ({"ki": -1}, "ki is -1, must be from 0 to 100"),
        ({"kd": math.inf}, "kd is inf, must be from 0 to 100"),
        ({"min_speed": -0.1}, "min_speed is -0.1, must be from 0 to 5"),
        ({"timeout": 11}, "timeout is 11, must be from 0.05 to 10"),
        ({"search_angular": 20}, "search_angular is 20, must be from 0 to 10"),
        ({"search_timeout": 61}, "search_timeout is 61, must be from 0 to 60"),
    ],
)
def test_parameters_out_of_range_are_named(change, message):
    with pytest.raises(ValueError) as error:
        LineControlParams(**change)
    assert str(error.value) == message
    with pytest.raises(ValueError):
        replace(LineControlParams(), **change)
