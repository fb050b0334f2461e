"""camera_node on a real V4L2 device: the kernel's driver vivid in a VM, booted once for all."""

import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import timeit
from typing import Any, Dict, List

import cv2
import numpy as np
import pytest

VIVID = pathlib.Path(__file__).resolve().parent.parent / "vivid"
UNAVAILABLE = 77  # exit code of vivid-vm when there can be no VM here
SIZE = (480, 640)  # rows, columns
PERIOD_NS = 40000000  # of vivid's highest rate at this size, 25 Hz
# Whichever of the two calls comes first after the fault.
QUEUE_FAILED = (
    r"\[ERROR\] /camera: /dev/video0: VIDIOC_D?QBUF failed: {}; trying again every second"
)
TO_BGR = {
    "yuyv": cv2.COLOR_YUV2BGR_YUY2,
    "uyvy": cv2.COLOR_YUV2BGR_UYVY,
    "nv12": cv2.COLOR_YUV2BGR_NV12,
}


@pytest.fixture(scope="module")
def vm(tmp_path_factory):
    """The folder in which the guest has left what it saw."""
    out = tmp_path_factory.mktemp("vivid")
    kept = ("PATH", "PYTHONPATH", "LD_LIBRARY_PATH", "CMAKE_PREFIX_PATH")
    guest_env = {k: v for k, v in os.environ.items() if k in kept or k.startswith("ROS")}
    guest_env.update(
        ROS_MASTER_URI="http://127.0.0.1:11311",  # the guest has a network of its own
        ROS_HOSTNAME="127.0.0.1",
        ROS_HOME="/tmp/ros",
        ROSCONSOLE_FORMAT="[${severity}] ${message}",
        PYTHONPATH="{}:{}".format(pathlib.Path(__file__).parent, os.environ.get("PYTHONPATH", "")),
    )
    command = "export {}\nrosmaster --core >master.log 2>&1 &\n{} {} /out".format(
        " ".join(f"{k}={shlex.quote(v)}" for k, v in guest_env.items()),
        shlex.quote(sys.executable),
        shlex.quote(str(VIVID / "guest.py")),
    )
    done = subprocess.run(
        [str(VIVID / "vivid-vm"), "run", str(out), command],
        env=dict(
            os.environ,
            VM_TIMEOUT="600",
            VIVID="n_devs=2 node_types=0x1,0x1 num_inputs=1,1 input_types=0,0",
        ),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if done.returncode == UNAVAILABLE:
        pytest.skip(done.stdout.strip())
    log = out / "log"
    said = done.stdout + (log.read_text(errors="replace") if log.exists() else "")
    assert done.returncode == 0, f"exit code {done.returncode}:\n{said}"
    return out


@pytest.fixture(scope="module")
def seen(vm):
    """seen(scenario): what the guest saw in it; fails if it did not get through."""
    scenarios = json.loads((vm / "seen.json").read_text())

    def get(scenario: str) -> Dict[str, Any]:
        assert "error" not in scenarios[scenario], scenarios[scenario]["error"]
        return scenarios[scenario]

    return get


@pytest.fixture(scope="module")
def slowness(seen):
    """How many times longer than this machine, at its best, the guest, at its worst, works."""
    work = seen("work")
    here = min(timeit.repeat(work["statement"], number=1, repeat=10))
    return max(1.0, work["seconds"] / here)


def stamps(headers: List[Dict[str, Any]]) -> np.ndarray:
    return np.array([header["stamp_ns"] for header in headers])


def ages(headers: List[Dict[str, Any]]) -> np.ndarray:
    """ns from stamp to arrival, both by the ROS clock."""
    return np.array([header["received_ns"] for header in headers]) - stamps(headers)


def numbers_missing(kernel: List[Dict[str, int]]) -> int:
    """Frames that the driver numbered, but did not give."""
    return kernel[-1]["sequence"] - kernel[0]["sequence"] + 1 - len(kernel)


def increase(scenario: Dict[str, Any], key: str) -> int:
    return int(scenario["after"][key]) - int(scenario["before"][key])


def published(vm: pathlib.Path, name: str, topic: str, message: Dict[str, Any]) -> np.ndarray:
    """The picture of a message, of which the size is checked."""
    channels = {"bgr8": (3,), "mono8": ()}[message["encoding"]]
    assert (message["height"], message["width"]) == SIZE
    assert message["step"] == SIZE[1] * (channels[0] if channels else 1)
    return np.fromfile(str(vm / f"{name}.{topic}"), np.uint8).reshape(SIZE + channels)


def device_picture(vm: pathlib.Path, name: str) -> np.ndarray:
    """The picture as v4l2-ctl read it, in the shape that cv2.cvtColor wants."""
    rows, columns = SIZE
    shape = {"grey": SIZE, "nv12": (rows * 3 // 2, columns)}.get(name, (rows, columns, 2))
    return np.fromfile(str(vm / (name + ".raw")), np.uint8).reshape(shape)


def luma(picture: np.ndarray, name: str) -> np.ndarray:
    if name in ("grey", "nv12"):
        return picture[: SIZE[0]]
    return picture[:, :, 0 if name == "yuyv" else 1]


def assert_pictures_equal(
    vm: pathlib.Path, name: str, pictures: Dict[str, Any], given: str
) -> None:
    """What was published under `name` is the device's picture in the format `given`, to the bit."""
    direct = device_picture(vm, given)
    y = luma(direct, given)
    assert len(np.unique(y)) > 5  # a picture, and not a plain colour
    assert pictures["image_mono"]["encoding"] == "mono8"
    np.testing.assert_array_equal(
        published(vm, name, "image_mono", pictures["image_mono"]), y, given
    )
    expected = y if given == "grey" else cv2.cvtColor(direct, TO_BGR[given])
    assert pictures["image_raw"]["encoding"] == ("mono8" if given == "grey" else "bgr8")
    np.testing.assert_array_equal(
        published(vm, name, "image_raw", pictures["image_raw"]), expected, given
    )


def test_missing_device_is_named_and_retried(seen, slowness):
    start = seen("missing_at_start")
    assert "/dev/video0: cannot be opened: No such file or directory" in start["before"]
    assert "trying again every second" in start["before"]
    assert "from /dev/video0" not in start["before"]
    assert start["seconds"] <= 2.0 * slowness


def test_the_rate_is_the_drivers(seen):
    assert "YUYV 640x480 at 25 Hz from /dev/video0" in seen("missing_at_start")["after"]
    frames = seen("stream")["kernel"]
    times = stamps(seen("stream")["camera_info"])
    periods = np.round((times[-1] - times[0]) / PERIOD_NS)
    rate = periods / (times[-1] - times[0]) * 1e9
    assert rate == pytest.approx(25.0, rel=0.02)
    assert len(times) <= len(frames)


def test_stamps_are_the_drivers(seen):
    """Each stamp is the kernel's own time of a frame, in order, each once."""
    stream = seen("stream")
    kernel = np.array([frame["monotonic_ns"] for frame in stream["kernel"]])
    kernel += stream["wall_minus_monotonic_ns"]
    for topic in ("camera_info", "image_raw", "image_mono"):
        ours = stamps(stream[topic])
        assert np.all(np.diff(ours) > 0)
        distances = np.abs(ours[:, None] - kernel)
        assert np.all(np.diff(distances.argmin(axis=1)) > 0)
        nearest = distances.min(axis=1)
        assert np.median(nearest) < 1e6
        # The node may be interrupted between reading the two clocks.
        assert nearest.max() < PERIOD_NS / 2


def test_stamps_are_within_a_frame_of_the_ros_clock(seen, slowness):
    age = ages(seen("stream")["camera_info"])
    assert np.all(age > 0)
    # The quickest arrival: a message takes less than 2 ms on its way when nothing is emulated.
    assert age.min() < PERIOD_NS + 2e6 * slowness


def test_no_stamp_is_in_the_future(seen):
    """The driver gives each frame before the time with which it stamps it."""
    headers = seen("stamped_ahead")["camera_info"]
    assert np.all(ages(headers) > 0)
    assert np.all(np.diff(stamps(headers)) > 0)


def test_camera_info_comes_with_every_picture(seen):
    stream = seen("stream")
    assert stream["info_size"] == [640, 480]
    info = stamps(stream["camera_info"])
    for topic in ("image_raw", "image_mono"):
        # The subscribers of the last messages went one after the other.
        times = stamps(stream[topic])
        times = times[(times >= info[0]) & (times <= info[-1])]
        assert len(times) >= 5
        assert len(np.intersect1d(times, info)) >= len(times) - 1, topic
    assert {h["frame_id"] for h in stream["image_raw"] + stream["camera_info"]} == {"head_camera"}


def test_frames_are_counted(seen):
    stream = seen("stream")
    assert int(stream["counters"]["frames received"]) == len(stream["kernel"])
    assert int(stream["counters"]["frames published"]) == len(stream["kernel"])
    assert int(stream["counters"]["frames dropped"]) == numbers_missing(stream["kernel"])


def test_yuyv_pictures(vm, seen):
    assert_pictures_equal(vm, "yuyv", seen("stream")["pictures"], "yuyv")
    assert (vm / "afterwards.raw").read_bytes() == (vm / "yuyv.raw").read_bytes()


@pytest.mark.parametrize("name", ["uyvy", "grey", "nv12"])
def test_other_formats(vm, seen, name):
    found = seen("formats")[name]
    assert f"{name.upper()} 640x480 at 25 Hz from /dev/video1" in found["log"]
    assert "the driver gives" not in found["log"]
    assert found["exit_code"] == 0
    assert_pictures_equal(vm, name, found["pictures"], name)


def test_a_format_that_the_driver_replaces(vm, seen):
    """vivid has no MJPEG and says nothing when asked for it."""
    found = seen("formats")["mjpeg"]
    warning = "/dev/video1: asked for MJPG 640x480, the driver gives YUYV 640x480"
    assert "[ WARN] /camera_mjpeg: " + warning in found["log"]
    assert "YUYV 640x480 at 25 Hz from /dev/video1" in found["log"]
    assert_pictures_equal(vm, "mjpeg", found["pictures"], "yuyv")


def test_device_is_free_without_subscribers(vm, seen):
    """v4l2-ctl could stream from the device before and after the node did."""
    assert seen("idle")["message"] == "idle: nobody subscribes"
    assert (vm / "yuyv.raw").stat().st_size == (vm / "afterwards.raw").stat().st_size > 0


def test_streams_while_subscribed(seen, slowness):
    stream = seen("stream")
    assert stream["held"]
    assert stream["seconds_to_start"] <= 1.0 * slowness
    assert stream["seconds_to_stop"] <= 1.0 * slowness


def test_a_damaged_buffer_is_refused(seen):
    damaged = seen("damaged_buffer")
    assert "is marked as damaged by the driver" in damaged["log"]
    assert "is marked as damaged by the driver" in damaged["after"]["last error"]
    assert increase(damaged, "frames refused") == 1
    # It is not counted as lost, too; and the stream has gone on.
    assert increase(damaged, "frames dropped") == numbers_missing(damaged["kernel"])
    assert increase(damaged, "frames published") == len(damaged["kernel"]) - 1 >= 10


def test_lost_frames_are_counted(seen):
    lost = seen("lost_frames")
    assert increase(lost, "frames dropped") == numbers_missing(lost["kernel"]) > 0
    assert increase(lost, "frames published") == len(lost["kernel"])


def test_streams_again_after_a_fatal_error(seen, slowness):
    fatal = seen("fatal_error")
    assert re.search(QUEUE_FAILED.format("Input/output error"), fatal["log"])
    assert 0.9 <= fatal["seconds"] <= 2.0 * slowness
    assert np.all(np.diff(stamps(fatal["camera_info"])) > 0)


def test_streams_again_after_a_stall(seen):
    stalled = seen("stalled")
    assert "from /dev/video0: no frame for 3 s" in stalled["log"]
    assert "streaming again" in stalled["log"]


def test_streams_again_after_unplugging(seen, slowness):
    unplugged = seen("unplugged")
    assert re.search(QUEUE_FAILED.format("No such device"), unplugged["log"])
    assert unplugged["level"] == 2  # ERROR
    assert unplugged["message"] == "/dev/video0: cannot be opened: No such file or directory"
    assert unplugged["seconds"] <= 2.0 * slowness


def test_interrupt_while_streaming(seen, slowness):
    interrupt = seen("interrupt")
    assert interrupt["exit_code"] == 0
    assert interrupt["seconds"] <= 1.0 * slowness
