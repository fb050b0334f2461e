#!/usr/bin/env python3
"""Drives camera_node on vivid's devices, inside the VM of vivid-vm, and writes down what it sees.

    guest.py OUT

OUT/seen.json gets one entry per scenario, OUT/*.raw what v4l2-ctl read from the device,
OUT/*.image_raw and OUT/*.image_mono the pixels that camera_node published. What has to be true of
them: test/nodes/test_v4l2.py.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import time
import timeit
import traceback
from typing import Any, Callable, Dict, List, Optional

import rosgraph
import rospy
import support
from sensor_msgs.msg import CameraInfo, Image

PATIENCE = 60.0  # s, for what takes a moment on a machine that is not emulated
DRIVER = pathlib.Path("/sys/bus/platform/drivers/vivid")
TRACING = pathlib.Path("/sys/kernel/tracing")
FRAMES = 50  # that the figures of a stream are taken from
WORK = "sum(range(300000))"  # tells how much slower than the host the guest is


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

    def wait_for_more(self, count: int) -> None:
        """Waits until `count` messages have come since now."""
        wanted = len(self.headers) + count
        wait_for(lambda: len(self.headers) >= wanted, f"{count} more on {self._topic}")

    def close(self) -> None:
        self._subscriber.unregister()


class Trace:
    """The time stamps that the kernel gave with the frames, as its own trace shows them."""

    def __init__(self) -> None:
        (TRACING / "trace").write_text("")
        self._switch(True)

    def stamps(self) -> List[Dict[str, int]]:
        self._switch(False)
        found = re.findall(
            r"v4l2_dqbuf:.*timestamp = (\d+).*sequence = (\d+)", (TRACING / "trace").read_text()
        )
        return [{"monotonic_ns": int(stamp), "sequence": int(number)} for stamp, number in found]

    @staticmethod
    def _switch(on: bool) -> None:
        (TRACING / "events/v4l2/v4l2_dqbuf/enable").write_text("1" if on else "0")


def wait_for(condition: Callable[[], Any], what: str) -> float:
    """Waits until `condition` is true; the seconds that it took."""
    begin = time.monotonic()
    support.wait_for(condition, what, PATIENCE)
    return time.monotonic() - begin


def v4l2(device: str, *arguments: str) -> str:
    """Runs v4l2-ctl on a device; its output."""
    command = ["v4l2-ctl", "-d", device, *arguments]
    return subprocess.run(
        command,
        check=True,
        timeout=PATIENCE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    ).stdout


def unplug() -> None:
    (DRIVER / "unbind").write_text("vivid.0")


def plug_in() -> None:
    """Gives the devices back, showing a picture that stands still.

    Frames are stamped when they begin; by default vivid gives the time of their end, still to come.
    """
    (DRIVER / "bind").write_text("vivid.0")
    for device in ("/dev/video0", "/dev/video1"):
        wait_for(lambda path=device: os.path.exists(path), device)
        v4l2(device, "-c", "osd_text_mode=2,test_pattern=4,show_border=1,show_square=1")
        v4l2(device, "-c", "timestamp_source=1")


def wall_minus_monotonic() -> int:
    """The distance of the two clocks in ns: the quickest of some tries to read both at once."""
    tries = []
    for _ in range(50):
        before, wall, after = time.monotonic_ns(), time.time_ns(), time.monotonic_ns()
        tries.append((after - before, wall - (before + after) // 2))
    return min(tries)[1]


def read_directly(device: str, fourcc: str, path: pathlib.Path) -> None:
    """Has v4l2-ctl read a frame of the standing picture; fails while somebody else streams."""
    size = "width=640,height=480,pixelformat=" + fourcc
    v4l2(device, "--set-fmt-video=" + size)
    v4l2(device, "--stream-mmap", "--stream-count=1", f"--stream-to={path}")


def save_picture(message: Image, path: pathlib.Path) -> Dict[str, Any]:
    path.write_bytes(message.data)
    fields = ("width", "height", "step", "encoding", "is_bigendian")
    return {field: getattr(message, field) for field in fields}


def emulated_work() -> float:
    """Seconds that a piece of work takes here."""
    return min(timeit.repeat(WORK, number=1, repeat=5))


class Scenarios:
    """What is tried, in this order; each returns what it saw."""

    def __init__(self, out: pathlib.Path):
        self.out = out
        self.diagnostics = support.Diagnostics()
        self.camera: Optional[Camera] = None

    def counters(self) -> Dict[str, str]:
        status = self.diagnostics.next("camera")
        return {pair.key: pair.value for pair in status.values}

    def wait_until_idle(self) -> float:
        return wait_for(lambda: not self.camera.holds_device(), "the end of streaming")

    def missing_at_start(self) -> Dict[str, Any]:
        unplug()
        self.camera = Camera(self.out, "camera", "/dev/video0")
        self.camera.wait_for_output("trying again", PATIENCE)
        before = self.camera.output()
        plug_in()
        seconds = wait_for(lambda: "from /dev/video0" in self.camera.output(), "the device's use")
        return {"before": before, "after": self.camera.output(), "seconds": seconds}

    def idle(self) -> Dict[str, Any]:
        self.wait_until_idle()
        read_directly("/dev/video0", "YUYV", self.out / "yuyv.raw")
        return {"message": self.diagnostics.next("camera").message}

    def stream(self) -> Dict[str, Any]:
        trace = Trace()
        begin = time.monotonic()
        info = Arrivals("/camera/camera_info", CameraInfo)
        wait_for(lambda: info.headers, "the first frame")
        seconds_to_start = time.monotonic() - begin
        held = self.camera.holds_device()
        info.wait_for_more(FRAMES)  # undisturbed by the weight of the pictures
        raw = Arrivals("/camera/image_raw", Image)
        mono = Arrivals("/camera/image_mono", Image)
        raw.wait_for_more(5)
        mono.wait_for_more(5)
        pictures = {
            "image_raw": save_picture(raw.last, self.out / "yuyv.image_raw"),
            "image_mono": save_picture(mono.last, self.out / "yuyv.image_mono"),
        }
        for topic in (raw, mono, info):
            topic.close()
        seconds_to_stop = self.wait_until_idle()
        kernel, counters = trace.stamps(), self.counters()
        read_directly("/dev/video0", "YUYV", self.out / "afterwards.raw")
        return {
            "kernel": kernel,
            "counters": counters,
            "wall_minus_monotonic_ns": wall_minus_monotonic(),
            "seconds_to_start": seconds_to_start,
            "seconds_to_stop": seconds_to_stop,
            "held": held,
            "camera_info": info.headers,
            "info_size": [info.last.width, info.last.height],
            "image_raw": raw.headers,
            "image_mono": mono.headers,
            "pictures": pictures,
        }

    def stamped_ahead(self) -> Dict[str, Any]:
        v4l2("/dev/video0", "-c", "timestamp_source=0")
        info = Arrivals("/camera/camera_info", CameraInfo)
        info.wait_for_more(20)
        info.close()
        v4l2("/dev/video0", "-c", "timestamp_source=1")
        return {"camera_info": info.headers}

    def damaged_buffer(self) -> Dict[str, Any]:
        before = self.counters()
        trace = Trace()
        info = Arrivals("/camera/camera_info", CameraInfo)
        info.wait_for_more(1)
        v4l2("/dev/video0", "-c", "inject_v4l2_buf_flag_error=1")
        wait_for(lambda: "refused a frame" in self.camera.output(), "the refusal")
        info.wait_for_more(10)
        info.close()
        self.wait_until_idle()
        after = self.counters()
        log = self.camera.output()
        return {"before": before, "after": after, "kernel": trace.stamps(), "log": log}

    def lost_frames(self) -> Dict[str, Any]:
        before = self.counters()
        trace = Trace()
        info = Arrivals("/camera/camera_info", CameraInfo)
        v4l2("/dev/video0", "-c", "percentage_of_dropped_buffers=50")
        info.wait_for_more(20)
        v4l2("/dev/video0", "-c", "percentage_of_dropped_buffers=0")
        info.close()
        self.wait_until_idle()
        return {"before": before, "after": self.counters(), "kernel": trace.stamps()}

    def fatal_error(self) -> Dict[str, Any]:
        info = Arrivals("/camera/camera_info", CameraInfo)
        info.wait_for_more(1)
        logged = len(self.camera.output())
        v4l2("/dev/video0", "-c", "inject_fatal_streaming_error=1")
        wait_for(lambda: "trying again" in self.camera.output()[logged:], "the report of the error")
        reported = time.monotonic()
        count = len(info.headers)
        wait_for(lambda: len(info.headers) > count, "a frame after the error")
        seconds = time.monotonic() - reported
        info.wait_for_more(5)
        info.close()
        log = self.camera.output()[logged:]
        return {"seconds": seconds, "log": log, "camera_info": info.headers}

    def stalled(self) -> Dict[str, Any]:
        info = Arrivals("/camera/camera_info", CameraInfo)
        info.wait_for_more(1)
        logged = len(self.camera.output())
        v4l2("/dev/video0", "-c", "percentage_of_dropped_buffers=100")
        wait_for(lambda: "trying again" in self.camera.output()[logged:], "the report of the stall")
        message = self.diagnostics.next("camera").message
        v4l2("/dev/video0", "-c", "percentage_of_dropped_buffers=0")
        info.wait_for_more(5)
        info.close()
        return {"log": self.camera.output()[logged:], "message": message}

    def unplugged(self) -> Dict[str, Any]:
        info = Arrivals("/camera/camera_info", CameraInfo)
        info.wait_for_more(1)
        logged = len(self.camera.output())
        unplug()
        try:
            wait_for(lambda: "trying again" in self.camera.output()[logged:], "report of the loss")
            wait_for(lambda: not self.camera.holds_device(), "the lost device to be closed")
            wait_for(
                lambda: "cannot be opened" in self.diagnostics.next("camera").message,
                "diagnostics of the retries",
            )
            status = self.diagnostics.next("camera")
            count = len(info.headers)
        finally:
            plug_in()
        seconds = wait_for(lambda: len(info.headers) > count, "a frame of the device come back")
        info.wait_for_more(5)
        info.close()
        return {
            "seconds": seconds,
            "log": self.camera.output()[logged:],
            "level": ord(status.level) if isinstance(status.level, bytes) else status.level,
            "message": status.message,
        }

    def formats(self) -> Dict[str, Any]:
        cameras = {}
        for name in ("uyvy", "grey", "nv12", "mjpeg"):
            node = "camera_" + name
            cameras[name] = Camera(self.out, node, "/dev/video1", "_pixel_format:=" + name)
        for camera in cameras.values():
            camera.wait_for_output("from /dev/video1", PATIENCE)
        seen = {}
        for name, camera in cameras.items():
            wait_for(lambda camera=camera: not camera.holds_device(), "an idle " + camera.name)
            if name != "mjpeg":  # which vivid does not have
                read_directly("/dev/video1", name.upper(), self.out / (name + ".raw"))
            seen[name] = {"pictures": self.pictures_of(camera, name), "log": camera.output()}
        for camera in cameras.values():
            camera.interrupt()
        for name, camera in cameras.items():
            seen[name]["exit_code"] = camera.exit_code(PATIENCE)
        return seen

    def pictures_of(self, camera: Camera, name: str) -> Dict[str, Any]:
        topics = {
            topic: Arrivals(f"/{camera.name}/{topic}", Image)
            for topic in ("image_raw", "image_mono")
        }
        pictures = {}
        for topic, arrivals in topics.items():
            wait_for(lambda arrivals=arrivals: arrivals.headers, topic + " of " + camera.name)
            path = self.out / f"{name}.{topic}"
            pictures[topic] = save_picture(arrivals.last, path)
        for arrivals in topics.values():
            arrivals.close()
        wait_for(lambda: not camera.holds_device(), "the end of streaming of " + camera.name)
        return pictures

    def interrupt(self) -> Dict[str, Any]:
        raw = Arrivals("/camera/image_raw", Image)
        raw.wait_for_more(2)
        begin = time.monotonic()
        self.camera.interrupt()
        code = self.camera.exit_code(PATIENCE)
        return {"exit_code": code, "seconds": time.monotonic() - begin}


def main() -> None:
    out = pathlib.Path(sys.argv[1])
    wait_for(rosgraph.is_master_online, "the master")
    (TRACING / "trace_clock").write_text("mono")
    rospy.init_node("guest", disable_signals=True, disable_rosout=True)
    scenarios = Scenarios(out)
    seen: Dict[str, Any] = {"work": {"statement": WORK, "seconds": emulated_work()}}
    for scenario in (
        scenarios.missing_at_start,
        scenarios.idle,
        scenarios.stream,
        scenarios.stamped_ahead,
        scenarios.damaged_buffer,
        scenarios.lost_frames,
        scenarios.fatal_error,
        scenarios.stalled,
        scenarios.unplugged,
        scenarios.formats,
        scenarios.interrupt,
    ):
        name = scenario.__name__
        begin = time.monotonic()
        try:
            seen[name] = scenario()
        except Exception:
            seen[name] = {"error": traceback.format_exc()}
        print(f"{name}: {time.monotonic() - begin:.1f} s", flush=True)
        seen["work"]["seconds"] = max(seen["work"]["seconds"], emulated_work())
        (out / "seen.json").write_text(json.dumps(seen, indent=1))
    if scenarios.camera:
        scenarios.camera.end()


if __name__ == "__main__":
    main()
