"""What the guest's scenarios share: nodes under test, vivid's devices, clocks, the trace."""

import contextlib
import fcntl
import os
import pathlib
import re
import struct
import subprocess
import time
import timeit
from typing import Any, Callable, Dict, Iterator, List

import rospy
import support
from sensor_msgs.msg import CameraInfo, Image

TIMEOUT = 240.0  # s, for what takes a moment on a machine that is not emulated, and not busy
DRIVER = pathlib.Path("/sys/bus/platform/drivers/vivid")
TRACING = pathlib.Path("/sys/kernel/tracing")
FRAMES = 50  # that the figures of a stream are taken from
WORK = "sum(range(300000))"  # tells how much slower than the host the guest is
# linux/videodev2.h: VIDIOC_S_FMT, the size of its struct v4l2_format, and where sizeimage is in it.
SET_FORMAT = 0xC0D05605
FORMAT_BYTES, SIZE_AT = 208, 28
CAPTURE = 1  # V4L2_BUF_TYPE_VIDEO_CAPTURE


class Camera(support.Process):
    """A camera_node under test."""

    def __init__(self, out: pathlib.Path, name: str, device: str, *arguments: str):
        command = [support.executable("camera_node"), "__name:=" + name]
        command += ["_video_device:=" + device, *arguments]
        super().__init__(command, out / (name + ".log"))
        self.name = name
        self.device = device

    def holds_device(self) -> bool:
        """Whether the process has its device open; one that was unplugged under it counts, too."""
        for link in pathlib.Path(f"/proc/{self.pid}/fd").iterdir():
            try:
                target = os.readlink(str(link))
            except FileNotFoundError:
                continue
            if target.split(" ")[0] == self.device:
                return True
        return False


class Arrivals:
    """When the messages of a topic came, with their headers, and the last of them."""

    def __init__(self, topic: str, kind: Any):
        self.headers: List[Dict[str, Any]] = []
        self.last: Any = None
        self._topic = topic
        self._subscriber = rospy.Subscriber(topic, kind, self._on_message, buff_size=2**24)

    def _on_message(self, message: Any) -> None:
        header = message.header
        self.headers.append(
            {
                "received_ns": time.time_ns(),
                "stamp_ns": header.stamp.to_nsec(),
                "frame_id": header.frame_id,
            }
        )
        self.last = message

    def wait_for_more(self, count: int) -> float:
        """Waits until `count` messages have come since now; the seconds that it took."""
        wanted = len(self.headers) + count
        return wait_for(lambda: len(self.headers) >= wanted, f"{count} more on {self._topic}")

    def close(self) -> None:
        self._subscriber.unregister()


@contextlib.contextmanager
def streaming(count: int = 1) -> Iterator[Arrivals]:
    """The camera's camera_info from when `count` have come, while somebody subscribes to it."""
    with contextlib.closing(Arrivals("/camera/camera_info", CameraInfo)) as info:
        info.wait_for_more(count)
        yield info


class Trace:
    """The time stamps that the kernel gave with the frames, as its own trace shows them.

    The event is on from the first trace to the guest's end.
    """

    def __init__(self) -> None:
        (TRACING / "trace").write_text("")
        (TRACING / "events/v4l2/v4l2_dqbuf/enable").write_text("1")

    def stamps(self) -> List[Dict[str, int]]:
        found = re.findall(
            r"v4l2_dqbuf:.*timestamp = (\d+).*sequence = (\d+)", (TRACING / "trace").read_text()
        )
        return [{"monotonic_ns": int(stamp), "sequence": int(number)} for stamp, number in found]


def wait_for(condition: Callable[[], Any], what: str) -> float:
    """Waits until `condition` is true; the seconds that it took."""
    begin = time.monotonic()
    support.wait_for(condition, what, TIMEOUT)
    return time.monotonic() - begin


def v4l2(device: str, *arguments: str) -> str:
    """Runs v4l2-ctl on a device; its output."""
    return run(["v4l2-ctl", "-d", device, *arguments], check=True)["output"]


def run(command: List[str], check: bool = False) -> Dict[str, Any]:
    """Runs a program to its end."""
    done = subprocess.run(
        command,
        check=check,
        timeout=TIMEOUT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    return {"output": done.stdout, "exit_code": done.returncode}


def unplug() -> None:
    (DRIVER / "unbind").write_text("vivid.0")


def plug_in() -> None:
    """Gives the devices back, showing an image that stands still.

    Frames are stamped when they begin; by default vivid gives the time of their end, still to come.
    """
    (DRIVER / "bind").write_text("vivid.0")
    for device in ("/dev/video0", "/dev/video1"):
        wait_for(lambda path=device: os.path.exists(path), device)
        image = "osd_text_mode=2,test_pattern=4,show_border=1,show_square=1"
        v4l2(device, "-c", image + ",timestamp_source=1")


def wall_minus_monotonic() -> int:
    """The distance of the two clocks in ns: the quickest of some tries to read both at once."""
    tries = []
    for _ in range(50):
        before, wall, after = time.monotonic_ns(), time.time_ns(), time.monotonic_ns()
        tries.append((after - before, wall - (before + after) // 2))
    return min(tries)[1]


def read_directly(device: str, fourcc: str, path: pathlib.Path) -> None:
    """Reads a frame of the standing image by read(2); fails while somebody else streams.

    By system calls, as a program takes long to start here.
    """
    wanted = struct.pack("=I4x2I4s", CAPTURE, 640, 480, fourcc.encode())
    given = bytearray(wanted.ljust(FORMAT_BYTES, b"\0"))
    file = os.open(device, os.O_RDWR)
    try:
        fcntl.ioctl(file, SET_FORMAT, given)
        assert given.startswith(wanted), f"{device} has no {fourcc} of 640x480"
        (size,) = struct.unpack_from("=I", given, SIZE_AT)
        image = os.read(file, size)
    finally:
        os.close(file)
    assert len(image) == size, f"{len(image)} of {size} bytes of {fourcc}"
    path.write_bytes(image)


def save_image(message: Image, path: pathlib.Path) -> Dict[str, Any]:
    path.write_bytes(message.data)
    fields = ("width", "height", "step", "encoding", "is_bigendian")
    return {field: getattr(message, field) for field in fields}


def emulated_work() -> float:
    """Seconds that a piece of work takes here."""
    return min(timeit.repeat(WORK, number=1, repeat=5))
