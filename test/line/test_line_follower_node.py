"""The line follower drives a simulated robot around a closed track, and stops when it must."""

import time

import cv2
import frames
import numpy as np
import pytest
import rospy
import support
from geometry_msgs.msg import Twist
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image
from simulation import LINE_COLOUR, DifferentialDrive, TrackWorld
from std_srvs.srv import SetBool
from track import Pose, course_track

from robot_vision import draw_text
from robot_vision.msg import Line

PERIOD = 1.0 / 30.0  # s, of the simulated camera


class Robot:
    """A simulated robot on a track, with its camera and its clock, that the node drives."""

    def __init__(self, track):
        self.world = TrackWorld(track)
        self.drive = DifferentialDrive(track.starts[0])
        self.frame = 0
        self.errors = []  # m left of the line, each frame
        self.driven = 0.0  # m along the track
        self._clock = rospy.Publisher("/clock", Clock, queue_size=10)
        self._images = rospy.Publisher("/robot/image_raw", Image, queue_size=1)
        self.commands = support.Messages("/robot/cmd_vel", Twist)
        self.lines = support.Messages("/follower/line", Line)

    def tick(self):
        """Advances the simulated time by a frame."""
        self.frame += 1
        self.time = rospy.Time.from_sec(10.0 + self.frame * PERIOD)
        self.now = self.time  # stamp of the image
        self._clock.publish(self.time)

    def publish_frame(self):
        image = frames.message(self.world.render(self.drive.pose, self.frame), "bgr8")
        image.header.stamp = self.now
        self._images.publish(image)

    def drive_on(self):
        """Sends frames until the robot drives on them; a stop may arrive before that."""
        support.wait_for(
            lambda: self.step() or self.commands.received[-1].linear.x == 0.2, "driving"
        )
        self.newest_line()  # no frame is on its way

    def jump(self, seconds):
        """Advances the time at once, and waits until the follower has got it and drives by it.

        `seconds` has to be more than the follower's timeout. It would drive on frames of a nearer
        future before it has got the time.
        """
        self.newest_line()  # no frame is on its way
        enable = rospy.ServiceProxy("/follower/enable", SetBool)
        enable(False)
        support.wait_for(lambda: self.commands.received[-1] == Twist(), "the stop")
        before = len(self.commands.received)  # no command to drive is on its way
        self.frame += round(seconds / PERIOD)
        self.tick()
        enable(True)

        def driven():
            self._clock.publish(self.time)  # again, because subscribers may connect late
            self.now += rospy.Duration(0.001)  # the robot does not drive on the same stamp again
            self.publish_frame()
            return any(c.linear.x == 0.2 for c in self.commands.received[before:])

        support.wait_for(driven, "driving after a jump of the time")

    def wait_until_driven(self):
        """Sends frames until the follower drives on them, while the robot stands.

        It may see frames before it hears of the time, by which they are of the future.
        """

        def driven():
            self.tick()
            self.publish_frame()
            return self.lines.received and any(c.linear.x > 0 for c in self.commands.received)

        support.wait_for(driven, "the first line and a command to drive")

    def look(self, floor, *parts, size=(240, 320), color=LINE_COLOUR):
        """The line that is found on a floor of this color with these columns and rows as lines."""
        image = np.full((*size, 3), floor, np.uint8)
        for columns, rows in parts:
            image[rows, columns] = color
        self.world.render = lambda pose, frame: image
        self.step()
        return self.newest_line()

    def newest_line(self):
        """The line of the newest frame, whose command may arrive before the line does."""
        support.wait_for(
            lambda: self.lines.received[-1].header.stamp == self.now, "the newest frame's line"
        )
        return self.lines.received[-1]

    def step(self):
        """Sends a frame, waits for its command, and moves the robot by it."""
        self.tick()
        before = len(self.commands.received)
        self.publish_frame()
        deadline = time.monotonic() + support.DEADLINE
        while len(self.commands.received) == before:  # wait_for() is too slow for 5000 frames
            assert time.monotonic() < deadline, "no command"
            time.sleep(0.0005)
        command = self.commands.received[-1]
        where = self.world.track.progress(self.drive.pose.x, self.drive.pose.y)
        pose = self.drive.drive(command.linear.x, command.angular.z, PERIOD)
        length = self.world.track.length
        way = self.world.track.progress(pose.x, pose.y) - where
        self.driven += (way + length / 2.0) % length - length / 2.0
        self.errors.append(self.world.track.lateral_error(pose.x, pose.y))


@pytest.fixture
def follower(start):
    """Starts the line follower on a simulated robot's camera and time."""

    def start_follower(*parameters):
        rospy.set_param("/use_sim_time", True)
        remapped = ["image:=/robot/image_raw", "cmd_vel:=/robot/cmd_vel"]
        # Longer than the machine may stall, so that commands come from frames, not the watchdog.
        patient = "_timeout:=10.0"
        return start("line_follower.py", "__name:=follower", *remapped, patient, *parameters)

    return start_follower


@pytest.fixture
def driven(follower):
    """driven("parameter", ...) starts the line follower, and gives the robot that it drives."""

    def start_both(*parameters, pose=None):
        robot = Robot(course_track())
        robot.drive.pose = pose or robot.drive.pose
        robot.process = follower(*parameters)
        robot.wait_until_driven()
        return robot

    return start_both


@pytest.mark.parametrize("direction", ["left", "right"])
def test_a_lap(follower, direction, record_property):
    track = course_track()
    robot = Robot(track if direction == "left" else track.reversed())
    follower()
    robot.wait_until_driven()
    while robot.driven < track.length:
        robot.step()
        assert abs(robot.errors[-1]) < 0.1, f"off the line after {robot.driven:.2f} m"
    rms, largest = np.sqrt(np.mean(np.square(robot.errors))), np.max(np.abs(robot.errors))
    report = f"lateral error in a lap: RMS {1e3 * rms:.1f} mm, at most {1e3 * largest:.1f} mm"
    print(report)
    record_property("lateral_error", report)
    assert rms < 0.05


def stands(robot, meanwhile=lambda: None):
    """Waits until the robot is told to stand five times; returns whether that goes on then.

    Behind the first a command of the last frame may still come, which was late.
    """
    commands = robot.commands.received

    def stopped():
        meanwhile()
        return len(commands) >= 5 and all(command == Twist() for command in commands[-5:])

    support.wait_for(stopped, "the stop")
    del commands[:]
    support.wait_for(lambda: meanwhile() or len(commands) >= 5, "commands")
    return all(command == Twist() for command in commands)


def test_robot_stops_when_the_camera_dies(driven):
    robot = driven("_timeout:=0.5")
    robot.drive_on()
    assert stands(robot)
    robot.drive_on()  # the camera is back


def test_robot_does_not_drive_on_a_repeated_frame(driven):
    robot = driven("_timeout:=0.5")
    robot.drive_on()
    # The camera hangs: it sends the same image with the same stamp again and again.
    assert stands(robot, robot.publish_frame)


def test_robot_does_not_drive_on_old_frames(driven):
    robot = driven("_timeout:=0.5")
    robot.jump(9.0)
    robot.now = robot.time - rospy.Duration(1.0)

    def lag():
        """Sends new images that are already a second old, as a slow network does."""
        robot.now += rospy.Duration(0, 1000)
        robot.publish_frame()

    assert stands(robot, lag)
    # The warning comes at once: the last one, if there was any, is more than 5 s ago.
    text = "frames are 1.00 s old: they are not driven on"
    support.wait_for(lambda: lag() or text in robot.process.output(), "the warning")
    diagnostics = support.Diagnostics()

    def counted():
        """As refused, though all but the command is published of them."""
        lag()
        return int(diagnostics.value("follower", "frames refused")) > 0

    support.wait_for(counted, "the frames that are refused")
    assert diagnostics.value("follower", "last error").endswith(text)
    assert robot.newest_line().header.stamp == robot.now


def test_integral_does_not_grow_during_a_pause(driven):
    beside = Pose(y=0.03)
    robot = driven("_mode:=pid", "_kp:=0.1", "_ki:=0.2", "_kd:=0.0", pose=beside)
    enable = rospy.ServiceProxy("/follower/enable", SetBool)
    enable(False)
    for _ in range(60):  # 2 s that the integral would sum up
        robot.step()
    enable(True)
    support.wait_for(lambda: robot.step() or robot.commands.received[-1].linear.x > 0, "driving")
    error = robot.newest_line().offset
    assert abs(error) > 0.05
    assert robot.commands.received[-1].angular.z == pytest.approx(-0.1 * error, rel=0.5)


def test_robot_stops_while_it_is_disabled(driven):
    robot = driven()
    enable = rospy.ServiceProxy("/follower/enable", SetBool)
    assert enable(False).message == "stopped"
    assert rospy.get_param("/follower/enabled") is False
    support.wait_for(lambda: robot.commands.received[-1] == Twist(), "the stop")
    del robot.commands.received[:]
    for _ in range(20):
        robot.step()
    assert all(c == Twist() for c in robot.commands.received)
    assert enable(True).message == "driving"
    robot.drive_on()


def test_robot_stops_without_a_line(driven):
    robot = driven()
    robot.step()
    robot.drive.pose = robot.drive.pose.along_arc(20.0, 0.0)  # carried away
    for _ in range(5):
        robot.step()
    assert robot.commands.received[-1] == Twist()
    last = robot.newest_line()
    assert (last.found, last.offset, last.confidence) == (False, 0.0, 0.0)


def test_robot_stands_if_everything_is_line(driven):
    robot = driven()
    robot.drive_on()
    said = np.full((240, 320, 3), LINE_COLOUR, np.uint8)
    said[:, [0, -1]] = 0  # as at the sides of a rectified image
    robot.world.render = lambda *_: said
    overlays = support.Messages("/follower/processed_image", Image)
    support.wait_for(overlays.connected, "the overlay")
    for _ in range(3):
        robot.step()
    assert robot.commands.received[-1] == Twist()
    assert not robot.newest_line().found
    overlay = overlays.of(robot.now)
    said = said.copy()
    draw_text(said, "no line", (10, 20))
    assert np.array_equal(np.frombuffer(overlay.data, np.uint8).reshape(said.shape), said)


def test_the_region_of_interest_and_the_threshold_image_are_published(driven):
    """Pixel by pixel, with the header of their frame; another strip is another part of it."""
    robot = driven()
    topics = [support.subscribed(f"/follower/{name}", Image) for name in ("roi", "mask")]
    for strip, rows in ((0.25, 60), (0.5, 120)):
        support.reconfigured("/follower", strip=strip)
        robot.drive.pose = Pose()
        robot.step()
        roi, mask = (topic.of(robot.now) for topic in topics)
        image = robot.world.render(Pose(), robot.frame)[-rows:]
        expected = cv2.inRange(cv2.cvtColor(image, cv2.COLOR_BGR2HSV), (0, 35, 0), (57, 255, 255))
        assert 0 < np.count_nonzero(expected) < expected.size
        assert (roi.encoding, mask.encoding) == ("bgr8", "mono8")
        assert (roi.width, roi.height) == (mask.width, mask.height) == (320, rows)
        assert np.array_equal(np.frombuffer(roi.data, np.uint8).reshape(image.shape), image)
        assert np.array_equal(np.frombuffer(mask.data, np.uint8).reshape(expected.shape), expected)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_robot_searches_where_it_last_saw_the_line(driven, side):
    # The robot is put beside the line, which it then sees on the other side.
    search = "_search:=true", "_search_angular:=0.25", "_search_timeout:=2.0"
    robot = driven(*search, pose=Pose(y=side * 0.05))
    robot.step()
    robot.drive.pose = Pose(y=20.0)
    for _ in range(10):
        robot.step()
    assert robot.commands.received[-1].angular.z == -side * 0.25
    for _ in range(60):  # two seconds of simulated time
        robot.step()
    assert robot.commands.received[-1] == Twist()


def test_a_search_ends_although_the_time_of_ros_stands_still(follower):
    """As with /use_sim_time of an old simulation, where frames have no stamps either."""
    robot = Robot(course_track())
    robot.now = rospy.Time()
    robot.drive.pose = Pose(y=0.05)
    follower("_search:=true", "_search_timeout:=0.3")

    def comes(is_meant, what):
        support.wait_for(
            lambda: robot.publish_frame() or is_meant([*robot.commands.received, None][-2:][0]),
            what,
        )

    comes(lambda last: last and last.linear.x > 0.0, "driving")
    robot.drive.pose = Pose(y=20.0)
    comes(lambda last: last.angular.z and not last.linear.x, "the search")
    comes(lambda last: last == Twist(), "its end")


def test_a_mask_that_fills_the_image_is_no_line(driven):
    robot = driven("_min_confidence:=0.0")
    robot.world.render = lambda pose, frame: np.full((240, 320, 3), LINE_COLOUR, np.uint8)
    for _ in range(5):
        robot.step()
    assert robot.commands.received[-1] == Twist() and not robot.newest_line().found


LONG = slice(60, 240)  # rows
NARROW, WIDE = (slice(24, 36), LONG), (slice(270, 290), LONG)
SPECK = NARROW[0], slice(200, 214)


def test_a_line_of_long_ago_does_not_decide_which_one_is_followed(driven):
    robot = driven("_timeout:=0.3")
    floor = robot.world.render(robot.drive.pose, 0)[0, 0]
    assert robot.look(floor, NARROW).center.x < 40
    begin = time.monotonic()
    while time.monotonic() - begin < 0.4:  # s, longer than the timeout
        robot.look(floor)
    assert robot.look(floor, SPECK, WIDE).center.x > 260


def test_a_line_in_images_of_another_size_does_not_decide_which_one_is_followed(driven):
    robot = driven()
    floor = robot.world.render(robot.drive.pose, 0)[0, 0]
    for parts in ([NARROW], [NARROW, WIDE]):
        line = robot.look(floor, *parts)
        assert line.found and line.center.x < 40
    assert robot.look(floor, NARROW, WIDE, size=(240, 400)).center.x > 260


def test_the_line_of_another_color_does_not_decide_which_one_is_followed(driven):
    """Nor does the robot search where that was."""
    red = (0, 0, 200)
    robot = driven("_search:=true")
    floor = robot.world.render(robot.drive.pose, 0)[0, 0]
    blob = slice(45, 57), slice(205, 227)
    assert robot.look(floor, NARROW).center.x < 40
    assert robot.look(floor).found is False
    support.wait_for(lambda: robot.commands.received[-1].angular.z > 0.0, "a turn to the left")
    assert robot.look(floor, NARROW).center.x < 40
    support.reconfigured("/follower", h_low=175, h_high=5)
    assert robot.look(floor, NARROW).found is False
    support.wait_for(lambda: robot.commands.received[-1] == Twist(), "the stop")
    support.reconfigured("/follower", h_low=0, h_high=57)
    assert robot.look(floor, NARROW).center.x < 40
    support.reconfigured("/follower", h_low=175, h_high=5)
    assert robot.look(floor, blob, WIDE, color=red).center.x > 260


def test_robot_is_told_to_stop_when_the_node_ends(driven):
    robot = driven("_timeout:=10.0")  # so long that the watchdog does not stop the robot
    robot.drive_on()
    robot.process.interrupt()
    assert robot.process.exit_code() == 0, robot.process.output()
    support.wait_for(lambda: robot.commands.received[-1] == Twist(), "the stop")


def test_line_is_where_the_track_is(driven):
    robot = driven()
    line = robot.lines.received[-1]
    assert line.found and line.header.stamp <= robot.now
    assert abs(line.offset) < 0.02 and abs(line.angle) < 0.05 and line.confidence > 0.1
    assert abs(line.center.x - 159.5) < 3.0 and 180 <= line.center.y < 240
