"""The closed loop: camera, mask, line, controller and robot on a track, at 30 Hz simulated time."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest
from simulation import LINE_WIDTH, DifferentialDrive, TrackWorld
from track import Segment, Track, course_track

import robot_vision as rv
from robot_vision.line.line_control import LineController, LineControlParams, must_stop

PERIOD = 1.0 / 30.0  # s
COURSE = LineControlParams()
PID = LineControlParams(mode="pid")
STANDING = (0.0, 0.0)


def line_mask(image):
    """The pixels of the line's colour: (height, width) uint8, 255 or 0."""
    return rv.hsv_mask(image, rv.HsvRange((0, 35, 0), (57, 255, 255)))


class Follower:
    """A robot at the start of a track, with its camera and its controller."""

    def __init__(self, track, params=COURSE, **world):
        self.track = track
        self.world = TrackWorld(track, **world)
        self.robot = DifferentialDrive(track.starts[0])
        self.controller = LineController(params)
        self.line = rv.Line()
        self.frames_come = True
        self.enabled = True
        self.steps = 0
        self.commands = []
        self.poses = []
        self._last_frame = None
        self._wanted = STANDING

    def drive(self, seconds):
        for _ in range(round(seconds / PERIOD)):
            self.step()

    def step(self):
        now = self.steps * PERIOD
        if self.frames_come:
            self._look(now)
        stop = must_stop(now, self._last_frame, self.enabled)
        self.commands.append(STANDING if stop else self._wanted)
        self.poses.append(self.robot.drive(*self.commands[-1], PERIOD))
        self.steps += 1

    def _look(self, now):
        top = self.world.camera.height * 3 // 4
        image = self.world.render(self.robot.pose, self.steps, top)
        self.line = rv.find_line(line_mask(image), previous=self.line)
        self._wanted = self.controller.update(now, self.line)
        self._last_frame = now

    def located(self):
        """Lateral error and progress, m, after each step."""
        places = np.array([(pose.x, pose.y) for pose in self.poses])
        return self.track.locate(places[:, 0], places[:, 1])

    def laps(self):
        turns = np.unwrap(self.located()[1] / self.track.length * 2.0 * math.pi)
        return turns[-1] / (2.0 * math.pi)


@pytest.mark.parametrize("params", [COURSE, PID], ids=["course", "pid"])
@pytest.mark.parametrize("way", ["anti-clockwise", "clockwise"])
def test_three_laps_on_the_line(params, way):
    track = course_track() if way == "anti-clockwise" else course_track().reversed()
    follower = Follower(track, params)
    # At full speed three laps take less; pid is slower in curves.
    follower.drive(3.0 * track.length / params.linear_speed * 1.2)
    lateral, _ = follower.located()
    rms, largest = math.sqrt(np.mean(lateral**2)), np.abs(lateral).max()
    print(f"{params.mode}, {way}: {1e3 * rms:.1f} mm RMS, {1e3 * largest:.1f} mm at most")
    assert 3.0 <= follower.laps() < 4.0
    assert largest < LINE_WIDTH / 2.0, "the middle between the wheels has left the line"
    assert all(abs(angular) <= 0.3 for _, angular in follower.commands)
    slowest = min(linear for linear, _ in follower.commands)
    assert slowest == 0.2 if params is COURSE else 0.05 < slowest < 0.19


@pytest.mark.parametrize("params", [COURSE, PID], ids=["course", "pid"])
def test_mirrored_track_is_driven_with_mirrored_commands(params):
    here = Follower(course_track(), params, noise=0.0)
    there = Follower(course_track().mirrored(), params, noise=0.0)
    for follower in (here, there):
        follower.drive(60.0)
    commands, mirrored = np.array(here.commands), np.array(there.commands)
    # Up to quantization: the texel of the floor on the middle line belongs to one side of it.
    assert np.allclose(mirrored, commands * [1.0, -1.0], atol=5e-3)
    assert commands[:, 1].max() > 0.1 and commands[:, 1].min() < -0.1


@pytest.mark.parametrize("params", [COURSE, PID], ids=["course", "pid"])
def test_follows_with_a_noisy_camera(params):
    follower = Follower(course_track(), params, noise=6.0)
    follower.drive(30.0)
    mask = line_mask(follower.world.render(follower.robot.pose, 0, 180))
    assert cv2.connectedComponents(mask)[0] > 50, "there are no speckles to disturb"
    assert np.abs(follower.located()[0]).max() < LINE_WIDTH / 2.0


def test_integral_brings_the_line_to_the_middle_of_the_image():
    radius = 1.0
    circle = Track([Segment(2.0 * math.pi * radius, 2.0 * math.pi)])
    proportional, integral = (Follower(circle, replace(PID, ki=ki)) for ki in (0.0, 0.5))
    for follower in (proportional, integral):
        follower.drive(30.0)
    assert proportional.line.error < -0.1
    assert abs(integral.line.error) < 0.01
    # The camera keeps a point ahead of the wheels on the circle, so that the wheels run inside it.
    strip = integral.world.camera.floor_points()[0][180:]
    sagitta = radius - math.sqrt(radius**2 - float(strip.mean()) ** 2)
    assert integral.located()[0][-1] == pytest.approx(sagitta, abs=0.004)


def test_stops_where_the_line_ends():
    track = Track([Segment(0.8), Segment(0.9, math.pi / 4)])
    follower = Follower(track)
    follower.drive(20.0)
    assert not follower.line.found
    assert follower.commands[-1] == STANDING
    # It stands as soon as the end of the line leaves the image at the bottom.
    nearest = float(follower.world.camera.floor_points()[0].min())
    assert follower.located()[1][-1] == pytest.approx(track.length - nearest, abs=0.01)


def test_search_takes_a_corner_that_stops_the_course():
    corner = Track([Segment(0.8), Segment(0.05, -math.pi / 2), Segment(0.8)])
    stopping = Follower(corner)
    searching = Follower(corner, replace(COURSE, search=True, search_timeout=10.0))
    for follower in (stopping, searching):
        follower.drive(40.0)
    assert stopping.commands[-1] == STANDING
    assert stopping.located()[1][-1] < 0.85
    assert (0.0, -0.3) in searching.commands, "it has not searched"
    assert searching.located()[1][-1] > 1.3


def test_stops_when_frames_stop():
    follower = Follower(course_track())
    follower.drive(3.0)
    assert follower.commands[-1] != STANDING
    follower.frames_come = False
    follower.drive(0.45)
    assert follower.commands[-1] != STANDING
    follower.drive(0.1)
    assert follower.commands[-1] == STANDING
    stood = follower.robot.pose
    follower.drive(2.0)
    assert follower.robot.pose == stood
    follower.frames_come = True
    follower.step()
    assert follower.commands[-1] != STANDING


def test_stands_while_paused():
    follower = Follower(course_track())
    follower.drive(3.0)
    follower.enabled = False
    follower.step()
    assert follower.commands[-1] == STANDING
    stood = follower.robot.pose
    follower.drive(2.0)
    assert follower.robot.pose == stood
    follower.enabled = True
    follower.drive(22.0)  # into the first curve
    lateral, progress = follower.located()
    assert np.abs(lateral).max() < LINE_WIDTH / 2.0
    assert progress[-1] == pytest.approx(0.2 * 25.0, abs=0.1)
