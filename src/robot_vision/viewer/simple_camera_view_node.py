"""The node simple_camera_view, which shows a camera's images and tells the colours in them."""

import os
import time
from typing import Any, Dict, Optional

import cv2
import rospy
from sensor_msgs.msg import RegionOfInterest

from .. import color_channels, range_around, to_space
from ..color.colors import as_yaml, outside, title_of
from ..common.files import add_file, reason
from ..common.plain_text import brief, printable
from ..msg import Click
from ..ros.configs import SimpleCameraViewConfig
from ..ros.live_params import LiveParams
from ..ros.messages import region_of
from ..ros.params import read_param, review_params
from ..ros.startup import run_node
from ..ros.transport import Frame, ImageSubscriber
from .channel_view import SHOWS, ChannelView
from .window import Window, require_display
from .window_content import Rate, placeholder, title

POLL = 10  # ms, longest time that an image waits for the window
MAX_PATH_LENGTH = 300  # characters of a path in an error
TITLE_PERIOD = 1.0  # s
QUIT_KEYS = (ord("q"), 27)  # 27: Esc
CLICKED = ("hsv", "hls", "lab", "ycrcb")  # the spaces of a click, besides BGR


class CameraView:
    """Shows the images of the topic `image` in a window.

    A left click prints and publishes the pixel (~clicked, robot_vision/Click) and prints the range
    around its colour for hsv_tracker, in ~space. A rectangle drawn with the left button is
    published (~selected, sensor_msgs/RegionOfInterest), for object_tracker to follow. The key c
    shows the channels of one space after the other, as ~show does; s saves the image as PNG; q
    and Esc end the node.

    Parameters:
        ~autosize (bool): Whether the window takes the image's size; if not, it can be resized.
        ~save_folder (str): The folder in which s saves. A relative path starts at the folder that
            the node runs in, which for roslaunch is $ROS_HOME, ~/.ros by default. A leading ~ is
            the user's home.

    Raises:
        ValueError: A parameter cannot be used, or there is no display.
    """

    _set_show = ""  # the parameter ~show

    def __init__(self) -> None:
        require_display()
        autosize = read_param("autosize", True)
        self._params = LiveParams(SimpleCameraViewConfig, self._configure)
        self._topic = rospy.resolve_name("image")
        self._rate = Rate()
        self._newest: Optional[Frame] = None  # set by the thread of the images
        self._shown: Optional[Frame] = None
        self._shown_as = ""  # one of SHOWS
        self._clicked = rospy.Publisher("~clicked", Click, queue_size=10)
        self._selected = rospy.Publisher("~selected", RegionOfInterest, queue_size=10)
        self._subscriber = ImageSubscriber("image", self._on_frame, encoding="bgr8")
        self._window = Window(self._topic, autosize, self._on_click, self._on_drag)
        self._window.show(placeholder(self._topic))
        review_params()

    def spin(self) -> None:
        """Works until the node is shut down, or the user closes the window or quits."""
        title_due = time.monotonic()
        while not rospy.is_shutdown():
            self._show_newest()
            if time.monotonic() >= title_due:
                title_due += TITLE_PERIOD
                self._update_title()
            key = self._window.poll(POLL)
            if key in QUIT_KEYS or not self._window.is_open():
                return
            if key == ord("s"):
                self._save()
            elif key == ord("c"):
                self._show_next_space()

    def _configure(self, config: Dict[str, Any]) -> None:
        space, show = config["space"], config["show"]
        color_channels(space)  # raises ValueError unless it is a space
        if show not in SHOWS:
            raise ValueError(f"show is {brief(show)}, must be one of {', '.join(SHOWS)}")
        folder = config["save_folder"]
        if "\0" in folder:  # No path can have this character; all others are allowed.
            raise ValueError(f"save_folder is {brief(folder)}, must be a path")
        self._folder = os.path.abspath(os.path.expanduser(folder))
        self._space = space
        if show != self._set_show:  # What the key has chosen stays until this is set.
            self._show = self._set_show = show

    def _on_frame(self, frame: Frame) -> None:
        self._rate.add(time.monotonic())
        self._newest = frame

    def _show_newest(self) -> None:
        frame, show = self._newest, self._show
        if frame is not None and (frame is not self._shown or show != self._shown_as):
            view = ChannelView(show, frame.image.shape[1::-1])
            self._window.show(view.of(frame.image))
            self._shown, self._shown_as, self._view = frame, show, view

    def _update_title(self) -> None:
        size = self._shown and self._shown.image.shape[1::-1]
        self._window.set_title(title(self._topic, self._rate.hz(time.monotonic()), size))

    def _show_next_space(self) -> None:
        # The parameter stays as it is: to set it, the window would wait for the master.
        self._show = SHOWS[(SHOWS.index(self._show) + 1) % len(SHOWS)]

    def _on_click(self, x: int, y: int) -> None:
        frame = self._shown
        if frame is None:
            return
        x, y = self._view.pixel(x, y)
        if not (0 <= x < frame.image.shape[1] and 0 <= y < frame.image.shape[0]):
            return
        bgr = tuple(frame.image[y, x].tolist())
        colors = {space: to_space(bgr, space) for space in CLICKED}
        told = ", ".join(f"{title_of(space)} {color}" for space, color in colors.items())
        print(f"x {x}, y {y}: BGR {bgr}, {told}; for the colors of hsv_tracker:")
        picked = to_space(bgr, self._space)
        color = range_around(picked, self._space)
        print(f"  name: {as_yaml(color)}", flush=True)
        if outside(picked, color):
            print(outside(picked, color), flush=True)
        self._clicked.publish(Click(header=frame.header, x=x, y=y, bgr=bgr, **colors))

    def _on_drag(self, x: int, y: int, width: int, height: int) -> None:
        if self._shown is None:
            return
        x, y, width, height = self._view.region(x, y, width, height)
        print(f"x {x}, y {y}: selected {width}x{height} px", flush=True)
        self._selected.publish(region_of((x, y, width, height)))

    def _save(self) -> None:
        frame = self._shown
        if frame is None:
            rospy.logwarn("there is no image to save yet")
            return
        stamp = frame.header.stamp
        png = cv2.imencode(".png", frame.image)[1].tobytes()
        try:
            path = add_file(self._folder, f"{stamp.secs}.{stamp.nsecs:09d}", ".png", png)
            print("saved", path, flush=True)
        except OSError as error:
            folder = printable(self._folder, MAX_PATH_LENGTH)
            rospy.logerr("no image saved in %s: %s", folder, reason(error))


def main() -> None:
    run_node("simple_camera_view", CameraView, CameraView.spin)
