"""What a camera has to live through, and its controls: scenarios for guest.py."""

import pathlib
import subprocess
import time
from typing import Any, Dict, List

import dynamic_reconfigure.client
import rospy
from rig import DRIVER, TIMEOUT, Arrivals, plug_in, streaming, unplug, v4l2, wait_for
from sensor_msgs.msg import CameraInfo
from std_srvs.srv import Empty, Trigger

CONTROLS = {
    "integer_32_bits": 99,  # those of the image stay as they are: it is compared
    "gain": 50,  # which vivid refuses while gain_automatic is on
    "gain_auto": False,  # its name under other kernels
    "contrast": 999,
    "no_such_control": 1,
}
LIVE = {
    "saturation": 33,
    "horizontal_flip": True,
    "integer_64_bits": 4.0 * 2**32,
    "bitmask": 16.0,
    "string": "abcd",
    "menu": 4,
    "hue": 1000,
}
# What CONTROLS and LIVE set, and a few that they do not.
WATCHED = (
    "integer_32_bits,contrast,gain,gain_automatic,saturation,horizontal_flip,hue,"
    "integer_64_bits,bitmask,string,menu"
)
FAILING = ("streamon", "reqbufs", "qbuf")
CYCLES = 100
STEP = 1.0  # s, by which the clock is set back


def watched() -> Dict[str, str]:
    """The values of controls, by name, as v4l2-ctl prints them."""
    lines = v4l2("/dev/video0", "-C", WATCHED).splitlines()
    return dict(line.split(": ", 1) for line in lines)


class Survival:
    """Runs after Scenarios.missing_at_start, on its camera."""

    def __init__(self, scenarios: Any):
        self._scenarios = scenarios

    @property
    def camera(self) -> Any:
        return self._scenarios.camera

    def controls(self) -> Dict[str, Any]:
        at_start = watched()
        client = dynamic_reconfigure.client.Client("/camera/controls", timeout=TIMEOUT)
        described = {p["name"]: p for p in client.get_parameter_descriptions(timeout=TIMEOUT)}
        logged = len(self.camera.output())
        answer = client.update_configuration(LIVE)
        rospy.wait_for_service("/camera/save_parameters", TIMEOUT)
        saved = rospy.ServiceProxy("/camera/save_parameters", Trigger)()
        client.close()
        return {
            "log": self.camera.output(),
            "live_log": self.camera.output()[logged:],
            "at_start": at_start,
            "live": watched(),
            "described": {name: described[name] for name in WATCHED.split(",")},
            "answer": {name: answer[name] for name in WATCHED.split(",")},
            "saved": saved.message,
        }

    def controls_after_unplugging(self) -> Dict[str, Any]:
        return {"values": watched()}

    def unplugged_while_idle(self) -> Dict[str, Any]:
        """Nobody subscribes all the time; the controls are set again, too."""
        self._scenarios.wait_until_idle()
        unplug()
        try:
            message = self._wait_for_message("cannot be opened")
        finally:
            plug_in()
        self._wait_for_message("idle")
        return {"message": message, "values": watched()}

    def _wait_for_message(self, part: str) -> str:
        """The first of the camera's diagnostics that has this in it."""
        messages = [""]

        def has_come() -> bool:
            messages.append(self._scenarios.diagnostics.next("camera").message)
            return part in messages[-1]

        wait_for(has_come, f"diagnostics with '{part}'")
        return messages[-1]

    def failing_calls(self) -> Dict[str, Any]:
        """Each fails once, and only when it is called the next time."""
        logs = {}
        for name in FAILING:
            self._scenarios.wait_until_idle()
            logged = len(self.camera.output())
            v4l2("/dev/video0", "-c", f"inject_vidioc_{name}_error=1")
            with streaming(2):
                pass
            logs[name] = self.camera.output()[logged:]
        return logs

    def disconnected(self) -> Dict[str, Any]:
        """The device works again once nobody holds it any more."""
        logged = len(self.camera.output())
        with streaming() as info:
            v4l2("/dev/video0", "-c", "disconnect=1")
            wait_for(lambda: "trying again" in self.camera.output()[logged:], "report of the loss")
            info.wait_for_more(2)
        return {"log": self.camera.output()[logged:], "camera_info": info.headers}

    def busy(self) -> Dict[str, Any]:
        """v4l2-ctl streams, and then the node wants to."""
        self._scenarios.wait_until_idle()
        logged = len(self.camera.output())
        size = "width=320,height=180"
        holder = subprocess.Popen(
            ["v4l2-ctl", "-d", "/dev/video0", "-v", size, "--stream-mmap", "--stream-to=/dev/null"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
        )
        try:
            holder.stderr.read(1)  # it tells of its first frame
            info = Arrivals("/camera/camera_info", CameraInfo)
            wait_for(lambda: "busy" in self.camera.output()[logged:], "the report of the holder")
            status = self._scenarios.diagnostics.next("camera")
            arrived = len(info.headers)
        finally:
            holder.kill()
            holder.wait()
        info.wait_for_more(2)
        info.close()
        return {
            "log": self.camera.output()[logged:],
            "message": status.message,
            "arrived": arrived,
            "holder": holder.pid,
        }

    def stopped(self) -> Dict[str, Any]:
        """~stop_capture holds, though somebody subscribes and the device comes anew."""
        with streaming() as info:
            rospy.ServiceProxy("/camera/stop_capture", Empty)()
            self._scenarios.wait_until_idle()
            stopped_ns = time.time_ns()
            unplug()
            plug_in()
            message = self._scenarios.diagnostics.next("camera").message
            held = self.camera.holds_device()
            arrived = sum(h["stamp_ns"] > stopped_ns for h in info.headers)  # not under way before
            rospy.ServiceProxy("/camera/start_capture", Empty)()
            info.wait_for_more(1)
        values = watched()
        return {"message": message, "held": held, "arrived": arrived, "values": values}

    def clock_set_back(self) -> Dict[str, Any]:
        logged = len(self.camera.output())
        with streaming(5) as info:
            time.clock_settime(time.CLOCK_REALTIME, time.time() - STEP)
            before = len(info.headers)

            def has_caught_up() -> bool:
                ages = [h["received_ns"] - h["stamp_ns"] for h in info.headers[before + 2 :]]
                return len(ages) > 0 and ages[-1] > 0

            seconds = wait_for(has_caught_up, "stamps behind the clock")
            info.wait_for_more(5)
        log = self.camera.output()[logged:]
        return {"camera_info": info.headers, "seconds": seconds, "log": log}

    def cycles(self) -> Dict[str, Any]:
        """Unplugs and plugs in again and again, with a frame each time."""
        uses, seconds = [], []
        with streaming() as info:
            for _ in range(CYCLES):
                unplug()
                wait_for(lambda: not self.camera.holds_device(), "the lost device to be closed")
                uses.append(self._use())
                (DRIVER / "bind").write_text("vivid.0")
                seconds.append(info.wait_for_more(1))
        plug_in_again()
        return {"uses": uses, "seconds": seconds, "camera_info": info.headers}

    def _use(self) -> List[int]:
        """Open descriptors, threads and resident memory (kB) of the node."""
        process = pathlib.Path(f"/proc/{self.camera.pid}")
        status = dict(line.split(":", 1) for line in (process / "status").read_text().splitlines())
        return [
            len(list((process / "fd").iterdir())),
            int(status["Threads"]),
            int(status["VmRSS"].split()[0]),
        ]


def plug_in_again() -> None:
    """With the settings that the other scenarios rely on."""
    unplug()
    plug_in()
