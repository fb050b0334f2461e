#!/usr/bin/env python3
"""Drives camera_node on vivid's devices, inside the VM of vivid-vm, and writes down what it sees.

    guest.py OUT

OUT/seen.json gets one entry per scenario, OUT/*.raw what read(2) gives of the device, and
OUT/*.image_raw and OUT/*.image_mono the pixels that camera_node published. What has to be true of
them: test/camera/test_v4l2_node.py.
"""

import contextlib
import json
import os
import pathlib
import sys
import time
import traceback
from typing import Any, Dict, Optional

import rosgraph
import rospy
import support
from rig import (
    FRAMES,
    TIMEOUT,
    TRACING,
    WORK,
    Arrivals,
    Camera,
    Trace,
    emulated_work,
    plug_in,
    read_directly,
    run,
    save_image,
    streaming,
    unplug,
    v4l2,
    wait_for,
    wall_minus_monotonic,
)
from sensor_msgs.msg import CameraInfo, Image
from survival import CONTROLS, Survival


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
        rospy.set_param("/camera/controls", CONTROLS)
        rospy.set_param("/camera/config_file", str(self.out / "camera.yaml"))
        unplug()
        self.camera = Camera(self.out, "camera", "/dev/video0")
        self.camera.wait_for_output("trying again", TIMEOUT)
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
        info.wait_for_more(FRAMES)  # undisturbed by the weight of the images
        raw = Arrivals("/camera/image_raw", Image)
        mono = Arrivals("/camera/image_mono", Image)
        raw.wait_for_more(5)
        mono.wait_for_more(5)
        info.wait_for_more(2)  # so that those of the images have come, too
        images = {
            "image_raw": save_image(raw.last, self.out / "yuyv.image_raw"),
            "image_mono": save_image(mono.last, self.out / "yuyv.image_mono"),
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
            "images": images,
        }

    def stamped_ahead(self) -> Dict[str, Any]:
        v4l2("/dev/video0", "-c", "timestamp_source=0")
        with streaming(20) as info:
            pass
        v4l2("/dev/video0", "-c", "timestamp_source=1")
        return {"camera_info": info.headers}

    def damaged_buffer(self) -> Dict[str, Any]:
        before = self.counters()
        trace = Trace()
        with streaming() as info:
            v4l2("/dev/video0", "-c", "inject_v4l2_buf_flag_error=1")
            wait_for(lambda: "refused a frame" in self.camera.output(), "the refusal")
            info.wait_for_more(10)
        self.wait_until_idle()
        after = self.counters()
        log = self.camera.output()
        return {"before": before, "after": after, "kernel": trace.stamps(), "log": log}

    def lost_frames(self) -> Dict[str, Any]:
        before = self.counters()
        trace = Trace()
        with streaming(0) as info:
            v4l2("/dev/video0", "-c", "percentage_of_dropped_buffers=50")
            info.wait_for_more(20)
            v4l2("/dev/video0", "-c", "percentage_of_dropped_buffers=0")
        self.wait_until_idle()
        return {"before": before, "after": self.counters(), "kernel": trace.stamps()}

    def fatal_error(self) -> Dict[str, Any]:
        with streaming() as info:
            logged = len(self.camera.output())
            v4l2("/dev/video0", "-c", "inject_fatal_streaming_error=1")
            wait_for(lambda: "trying again" in self.camera.output()[logged:], "report of the error")
            reported = time.monotonic()
            info.wait_for_more(1)
            seconds = time.monotonic() - reported
            info.wait_for_more(5)
        log = self.camera.output()[logged:]
        return {"seconds": seconds, "log": log, "camera_info": info.headers}

    def stalled(self) -> Dict[str, Any]:
        with streaming() as info:
            logged = len(self.camera.output())
            v4l2("/dev/video0", "-c", "percentage_of_dropped_buffers=100")
            wait_for(lambda: "trying again" in self.camera.output()[logged:], "report of the stall")
            message = self.diagnostics.next("camera").message
            v4l2("/dev/video0", "-c", "percentage_of_dropped_buffers=0")
            info.wait_for_more(5)
        return {"log": self.camera.output()[logged:], "message": message}

    def unplugged(self) -> Dict[str, Any]:
        with streaming() as info:
            logged = len(self.camera.output())
            unplug()
            try:
                wait_for(lambda: "trying again" in self.camera.output()[logged:], "the loss")
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
        return {
            "seconds": seconds,
            "log": self.camera.output()[logged:],
            "level": ord(status.level) if isinstance(status.level, bytes) else status.level,
            "message": status.message,
        }

    def formats(self) -> Dict[str, Any]:
        """Each format that vivid and we have, in one process: nodes take long to start here."""
        grabbed = run([support.executable("test_grab_formats"), "/dev/video1", str(self.out)])
        for line in grabbed["output"].splitlines():
            name, _, source = line.split(", ")
            read_directly("/dev/video1", f"{source.split()[0]:4}", self.out / (name + ".raw"))
        return grabbed

    def cameras(self) -> Dict[str, Any]:
        """What list_cameras says, and nodes that are told names of the second camera."""
        os.symlink("video1", "/dev/front_camera")  # as a rule of udev would
        listed = {
            "all": run([support.executable("list_cameras")]),
            "one": run([support.executable("list_cameras"), "platform:vivid-001"]),
            "link": run([support.executable("list_cameras"), "front_camera"]),
        }
        arguments = {
            "native": ("_pixel_format:=bayer_gbrg8", "_output_encoding:=native"),
            "mjpeg": ("_pixel_format:=mjpeg", "_image_width:=700", "_framerate:=1000"),
        }
        cameras = {
            name: Camera(
                self.out, "camera_" + name, "/dev/video1", "_source:=platform:vivid-001", *args
            )
            for name, args in arguments.items()
        }
        for camera in cameras.values():
            camera.wait_for_output("from /dev/video1", TIMEOUT)
        seen: Dict[str, Any] = {"listed": listed}
        for name, camera in cameras.items():
            wait_for(lambda camera=camera: not camera.holds_device(), "an idle " + camera.name)
            seen[name] = {"images": self.images_of(camera, name), "log": camera.output()}
        for camera in cameras.values():
            camera.interrupt()
        for name, camera in cameras.items():
            seen[name]["exit_code"] = camera.exit_code(TIMEOUT)
        return seen

    def images_of(self, camera: Camera, name: str) -> Dict[str, Any]:
        topics = {
            topic: Arrivals(f"/{camera.name}/{topic}", Image)
            for topic in ("image_raw", "image_mono")
        }
        images = {}
        for topic, arrivals in topics.items():
            wait_for(lambda arrivals=arrivals: arrivals.headers, topic + " of " + camera.name)
            path = self.out / f"{name}.{topic}"
            images[topic] = save_image(arrivals.last, path)
        for arrivals in topics.values():
            arrivals.close()
        wait_for(lambda: not camera.holds_device(), "the end of streaming of " + camera.name)
        return images

    def interrupt(self) -> Dict[str, Any]:
        raw = Arrivals("/camera/image_raw", Image)
        raw.wait_for_more(2)
        begin = time.monotonic()
        self.camera.interrupt()
        code = self.camera.exit_code(TIMEOUT)
        return {"exit_code": code, "seconds": time.monotonic() - begin}


def waiting_threads() -> str:
    """What the threads of the nodes under test wait for in the kernel, a line for each."""
    lines = []
    for task in sorted(pathlib.Path("/proc").glob("[0-9]*/task/[0-9]*")):
        with contextlib.suppress(OSError):  # Threads end.
            if b"camera_node" in (task / "cmdline").read_bytes():
                files = ("comm", "wchan", "syscall", "stack")
                lines.append(" | ".join((task / file).read_text().strip() for file in files))
    return "\n".join(lines)


def main() -> None:
    out = pathlib.Path(sys.argv[1])
    wait_for(rosgraph.is_master_online, "the master")
    (TRACING / "trace_clock").write_text("mono")
    rospy.init_node("guest", disable_signals=True, disable_rosout=True)
    scenarios = Scenarios(out)
    survival = Survival(scenarios)
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
        survival.controls,
        scenarios.unplugged,
        survival.controls_after_unplugging,
        survival.unplugged_while_idle,
        survival.failing_calls,
        survival.disconnected,
        survival.busy,
        survival.stopped,
        survival.clock_set_back,
        survival.cycles,
        scenarios.formats,
        scenarios.cameras,
        scenarios.interrupt,
    ):
        name = scenario.__name__
        begin = time.monotonic()
        try:
            seen[name] = scenario()
        except Exception:
            seen[name] = {"error": traceback.format_exc()}
            print(seen[name]["error"])  # for who gives the guest up before its end
            print(waiting_threads(), flush=True)
        print(f"{name}: {time.monotonic() - begin:.1f} s", flush=True)
        seen["work"]["seconds"] = max(seen["work"]["seconds"], emulated_work())
        (out / "seen.json").write_text(json.dumps(seen, indent=1))
    if scenarios.camera:
        scenarios.camera.end()


if __name__ == "__main__":
    main()
