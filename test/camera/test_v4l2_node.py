"""camera_node on a real V4L2 device: the kernel's driver vivid in a VM that is booted once."""

import ast
import json
import pathlib
import re
import timeit
from typing import Any, Dict, List, NamedTuple, Optional

import cv2
import host
import numpy as np
import pytest
import yaml

VIVID = pathlib.Path(__file__).resolve().parent.parent / "vivid"
SIZE = (480, 640)  # rows, columns
FRAMERATE = 30.0  # Hz, for which camera_node asks by default
COUNTS = "frames published", "frames refused", "frames dropped"
# VIDIOC_QBUF or VIDIOC_DQBUF fails, whichever comes first after the fault.
QUEUE_FAILED = r"\[ERROR\] /camera: /dev/video0: VIDIOC_D?QBUF failed: {}; trying again"


class Layout(NamedTuple):
    """The layout of a format in memory, and OpenCV's codes to convert it."""

    native: str  # its encoding with output_encoding native
    channels: int
    to_bgr: Optional[int]  # cv2.COLOR_..., None if there is nothing to convert
    to_gray: Optional[int]
    dtype: Any = np.uint8
    white: int = 0  # the largest value of a 16-bit format


PLANAR = (cv2.COLOR_YUV2BGR_NV12, cv2.COLOR_YUV2BGR_NV21, cv2.COLOR_YUV2BGR_I420)
BAYER = {
    "rggb": (cv2.COLOR_BayerBG2BGR, cv2.COLOR_BayerBG2GRAY),
    "bggr": (cv2.COLOR_BayerRG2BGR, cv2.COLOR_BayerRG2GRAY),
    "gbrg": (cv2.COLOR_BayerGR2BGR, cv2.COLOR_BayerGR2GRAY),
    "grbg": (cv2.COLOR_BayerGB2BGR, cv2.COLOR_BayerGB2GRAY),
}
LAYOUTS = {
    "yuyv": Layout("yuv422_yuy2", 2, cv2.COLOR_YUV2BGR_YUY2, cv2.COLOR_YUV2GRAY_YUY2),
    "uyvy": Layout("yuv422", 2, cv2.COLOR_YUV2BGR_UYVY, cv2.COLOR_YUV2GRAY_UYVY),
    "nv12": Layout("bgr8", 1, cv2.COLOR_YUV2BGR_NV12, None),
    "nv21": Layout("bgr8", 1, cv2.COLOR_YUV2BGR_NV21, None),
    "yu12": Layout("bgr8", 1, cv2.COLOR_YUV2BGR_I420, None),
    "bgr24": Layout("bgr8", 3, None, cv2.COLOR_BGR2GRAY),
    "rgb24": Layout("rgb8", 3, cv2.COLOR_RGB2BGR, cv2.COLOR_RGB2GRAY),
    "grey": Layout("mono8", 1, cv2.COLOR_GRAY2BGR, None),
    "y16": Layout("mono16", 1, cv2.COLOR_GRAY2BGR, None, np.uint16, 65535),
    "y10": Layout("mono16", 1, cv2.COLOR_GRAY2BGR, None, np.uint16, 1023),
    **{f"bayer_{p}8": Layout(f"bayer_{p}8", 1, *codes) for p, codes in BAYER.items()},
}


@pytest.fixture(scope="module")
def vm(tmp_path_factory):
    """The folder in which the guest has left its results."""
    out = tmp_path_factory.mktemp("vivid")
    two_webcams = "n_devs=2 node_types=0x1,0x1 num_inputs=1,1 input_types=0,0"
    done = host.run_guest(VIVID / "guest.py", out, two_webcams, 840.0)
    if done.returncode == host.UNAVAILABLE:
        pytest.skip(done.stdout.strip())
    log = out / "log"
    said = done.stdout + (log.read_text(errors="replace") if log.exists() else "")
    assert done.returncode == 0, f"exit code {done.returncode}:\n{said}"
    return out


@pytest.fixture(scope="module")
def seen(vm):
    """seen(scenario) gives the guest's results of a scenario; it fails if the scenario did."""
    scenarios = json.loads((vm / "seen.json").read_text())

    def get(scenario: str) -> Dict[str, Any]:
        assert "error" not in scenarios[scenario], scenarios[scenario]["error"]
        return scenarios[scenario]

    return get


@pytest.fixture(scope="module")
def rate(seen):
    """rate(asked) gives the nearest rate that this kernel's vivid has at this size."""
    listed = seen("cameras")["listed"]["one"]["output"]
    offered = re.search(r"      640x480: (.*) Hz\n", listed).group(1)
    rates = [float(word) for word in offered.split(", ")]
    return lambda asked: min(rates, key=lambda offer: abs(offer - asked))


@pytest.fixture(scope="module")
def period_ns(rate):
    return 1e9 / rate(FRAMERATE)


@pytest.fixture(scope="module")
def slowness(seen):
    """How many times slower the guest is at its worst than this machine at its best."""
    work = seen("work")
    here = min(timeit.repeat(work["statement"], number=1, repeat=10))
    return max(1.0, work["seconds"] / here)


def stamps(headers: List[Dict[str, Any]]) -> np.ndarray:
    return np.array([header["stamp_ns"] for header in headers])


def ages(headers: List[Dict[str, Any]]) -> np.ndarray:
    """The time from stamp to arrival in ns, both on the ROS clock."""
    return np.array([header["received_ns"] for header in headers]) - stamps(headers)


def require_each_counted(kernel: List[Dict[str, int]], counts: Dict[str, int]) -> None:
    """Each number of the driver's counts once: as published, refused, or dropped by driver or node.

    On a busy machine the node leaves frames out, and vivid uses a number twice.
    """
    numbers = [frame["sequence"] for frame in kernel]
    repeated = len(numbers) - len(set(numbers))
    assert 0 <= sum(counts.values()) - (max(numbers) - min(numbers) + 1) <= repeated
    assert counts["frames published"] + counts["frames refused"] <= len(numbers)


def increase(scenario: Dict[str, Any], key: str) -> int:
    return int(scenario["after"][key]) - int(scenario["before"][key])


def published(vm: pathlib.Path, name: str, topic: str, message: Dict[str, Any]) -> np.ndarray:
    """The pixels of a message, after a check of its size."""
    channels = (3,) if message["encoding"] == "bgr8" else ()
    assert (message["height"], message["width"]) == SIZE
    assert message["step"] == SIZE[1] * (channels[0] if channels else 1)
    return np.fromfile(str(vm / f"{name}.{topic}"), np.uint8).reshape(SIZE + channels)


def pixels(path: pathlib.Path, layout: Layout) -> np.ndarray:
    """The pixels in a file, in the shape that cv2.cvtColor takes."""
    rows, columns = SIZE
    if layout.to_bgr in PLANAR:
        rows = rows * 3 // 2
    shape = (rows, columns, layout.channels) if layout.channels > 1 else (rows, columns)
    return np.fromfile(str(path), layout.dtype).reshape(shape)


def to_8_bits(image: np.ndarray, white: int) -> np.ndarray:
    return np.rint(image * (255.0 / white)).astype(np.uint8)


def as_bgr(image: np.ndarray, layout: Layout) -> np.ndarray:
    if layout.white:
        image = to_8_bits(image, layout.white)
    return image if layout.to_bgr is None else cv2.cvtColor(image, layout.to_bgr)


def as_gray(image: np.ndarray, layout: Layout) -> np.ndarray:
    if layout.white:
        return to_8_bits(image, layout.white)
    if layout.to_bgr in PLANAR:
        return image[: SIZE[0]]
    return image if layout.to_gray is None else cv2.cvtColor(image, layout.to_gray)


def test_missing_device_is_named_and_retried(seen, slowness):
    start = seen("missing_at_start")
    assert "/dev/video0: cannot be opened: No such file or directory" in start["before"]
    assert "trying again" in start["before"]
    assert "from /dev/video0" not in start["before"]
    assert start["seconds"] <= 2.0 * slowness


def test_rate_is_that_of_the_driver(seen, rate, period_ns):
    said = f"YUYV 640x480 at {rate(FRAMERATE):g} Hz from /dev/video0"
    assert said in seen("missing_at_start")["after"]
    frames = seen("stream")["kernel"]
    times = stamps(seen("stream")["camera_info"])
    periods = np.round((times[-1] - times[0]) / period_ns)
    assert (times[-1] - times[0]) / periods == pytest.approx(period_ns, rel=0.02)
    assert len(times) <= len(frames)


def test_stamps_are_those_of_the_driver(seen, period_ns):
    """Each stamp is the kernel's time of a frame; they are in order and each comes once."""
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
        assert nearest.max() < period_ns / 2


def test_stamps_are_within_a_frame_of_the_ros_clock(seen, slowness, period_ns):
    age = ages(seen("stream")["camera_info"])
    assert np.all(age > 0)
    # Without emulation, the fastest message takes less than 2 ms on its way.
    assert age.min() < period_ns + 2e6 * slowness


def test_no_stamp_is_in_the_future(seen):
    """In this scenario the driver delivers each frame before the time in its stamp."""
    headers = seen("stamped_ahead")["camera_info"]
    assert np.all(ages(headers) > 0)
    assert np.all(np.diff(stamps(headers)) > 0)


def test_camera_info_comes_with_every_image(seen):
    stream = seen("stream")
    assert stream["info_size"] == [640, 480]
    info = stamps(stream["camera_info"])
    for topic in ("image_raw", "image_mono"):
        # The subscribers were not shut down at the same time.
        times = stamps(stream[topic])
        times = times[(times >= info[0]) & (times <= info[-1])]
        assert len(times) >= 5
        assert len(np.intersect1d(times, info)) >= len(times) - 1, topic
    assert {h["frame_id"] for h in stream["image_raw"] + stream["camera_info"]} == {"head_camera"}


def test_frames_are_counted(seen):
    stream = seen("stream")
    counts = {name: int(stream["counters"][name]) for name in COUNTS}
    require_each_counted(stream["kernel"], counts)
    assert counts["frames refused"] == 0
    assert int(stream["counters"]["frames received"]) == counts["frames published"]


def test_yuyv_images(vm, seen):
    images = seen("stream")["images"]
    direct = pixels(vm / "yuyv.raw", LAYOUTS["yuyv"])
    assert images["image_raw"]["encoding"] == "bgr8"
    assert images["image_mono"]["encoding"] == "mono8"
    for topic, expected in (("image_raw", as_bgr), ("image_mono", as_gray)):
        np.testing.assert_array_equal(
            published(vm, "yuyv", topic, images[topic]), expected(direct, LAYOUTS["yuyv"])
        )
    assert (vm / "afterwards.raw").read_bytes() == (vm / "yuyv.raw").read_bytes()


def test_every_format_is_supported(seen):
    formats = seen("formats")
    assert formats["exit_code"] == 0, formats["output"]
    found = dict(line.split(", ")[:2] for line in formats["output"].splitlines())
    assert found == {name: layout.native for name, layout in LAYOUTS.items()}


@pytest.mark.parametrize("name", LAYOUTS)
def test_images_are_exactly_those_of_the_device(vm, seen, name):
    """They are bit-exactly those that read(2) gives and OpenCV converts."""
    seen("formats")
    layout = LAYOUTS[name]
    direct = pixels(vm / (name + ".raw"), layout)
    assert direct.min() < direct.max()  # an image, and not a uniform colour
    bgr = as_bgr(direct, layout)
    natives = {"bgr8": bgr, "mono16": np.rint(direct * (65535.0 / (layout.white or 1)))}
    expected = {
        "bgr8": bgr,
        "rgb8": bgr[:, :, ::-1],
        "mono8": as_gray(direct, layout),
        "native": natives.get(layout.native, direct),
    }
    for suffix, image in expected.items():
        kind = layout.dtype if suffix == "native" else np.uint8
        ours = np.fromfile(str(vm / f"{name}.{suffix}"), kind).reshape(image.shape)
        np.testing.assert_array_equal(ours, image, suffix)


def test_all_formats_show_the_same_image(vm, seen):
    """The scene is the same in all formats: colours may differ along edges only."""
    seen("formats")
    reference = pixels(vm / "bgr24.raw", LAYOUTS["bgr24"]).astype(int)
    for name, layout in LAYOUTS.items():
        bgr = np.fromfile(str(vm / (name + ".bgr8")), np.uint8).reshape((*SIZE, 3)).astype(int)
        gray = layout.native.startswith("mono")
        wanted = cv2.cvtColor(reference.astype(np.uint8), cv2.COLOR_BGR2GRAY).astype(int)
        error = np.abs(bgr[:, :, 1] - wanted) if gray else np.abs(bgr - reference).max(axis=2)
        assert np.median(error) <= (25 if gray else 6), name


def test_native_images_are_published_unchanged(vm, seen, rate):
    found = seen("cameras")["native"]
    assert f"GBRG 640x480 at {rate(FRAMERATE):g} Hz from /dev/video1" in found["log"]
    assert found["images"]["image_raw"]["encoding"] == "bayer_gbrg8"
    mosaic = published(vm, "native", "image_raw", found["images"]["image_raw"])
    np.testing.assert_array_equal(mosaic, pixels(vm / "bayer_gbrg8.raw", LAYOUTS["bayer_gbrg8"]))
    assert found["exit_code"] == 0


def test_unsupported_modes_are_replaced_with_a_warning(vm, seen, rate):
    """vivid has no MJPEG and silently gives another format when asked for it."""
    found = seen("cameras")["mjpeg"]
    warning = re.search(r"\[ WARN\] /camera_mjpeg: (.*)", found["log"]).group(1)
    begin = "/dev/video1: asked for MJPG 700x480, gives YUYV 640x480; it offers YUYV, "
    assert warning.startswith(begin)
    assert re.search(r"NV12.*: 320x180, 640x360, 640x480, ", warning)
    highest = f"{rate(1000.0):g}"
    refused = f"; asked for 1000 Hz, gives {highest}; YUYV 640x480 has "
    assert re.search(re.escape(refused) + rf".*\b{highest}\b.* Hz", warning)
    assert f"YUYV 640x480 at {highest} Hz from /dev/video1" in found["log"]
    assert found["images"]["image_raw"]["encoding"] == "bgr8"
    bgr = published(vm, "mjpeg", "image_raw", found["images"]["image_raw"])
    direct = pixels(vm / "yuyv.raw", LAYOUTS["yuyv"])
    np.testing.assert_array_equal(bgr, as_bgr(direct, LAYOUTS["yuyv"]))


def test_cameras_are_listed(seen):
    listed = seen("cameras")["listed"]
    assert {name: one["exit_code"] for name, one in listed.items()} == dict.fromkeys(listed, 0)
    both, one = listed["all"]["output"], listed["one"]["output"]
    names = [
        f"/dev/video{i}: vivid\n  driver: vivid\n  bus: platform:vivid-00{i}\n" for i in (0, 1)
    ]
    assert both.startswith(names[0]) and names[1] in both
    for text in (one, listed["link"]["output"]):
        assert text.startswith(names[1] + "  /dev/front_camera\n")
    assert "    nv12 (NV12, Y/UV 4:2:0)\n      320x180: " in one
    assert "    not taken by camera_node (" in one
    assert re.search(r"      640x480: .*\b25\b.* Hz\n", one)
    assert re.search(r"    brightness: 0 to 255, default 128, is \d+\n", one)
    assert re.search(r"    test_pattern: one of those below, default 0, is 4\n      0: ", one)


def test_device_is_free_without_subscribers(vm, seen):
    """The device could be read from before and after the node streamed."""
    assert seen("idle")["message"] == "idle: nobody subscribes"
    assert (vm / "yuyv.raw").stat().st_size == (vm / "afterwards.raw").stat().st_size > 0


def test_streams_only_while_subscribed(seen, slowness):
    stream = seen("stream")
    assert stream["held"]
    assert stream["seconds_to_start"] <= 1.0 * slowness
    assert stream["seconds_to_stop"] <= 1.0 * slowness


def test_a_damaged_buffer_is_refused(seen):
    damaged = seen("damaged_buffer")
    assert "is marked as damaged by the driver" in damaged["log"]
    assert "is marked as damaged by the driver" in damaged["after"]["last error"]
    assert increase(damaged, "frames refused") == 1
    # It does not count as lost as well, and the stream has gone on.
    require_each_counted(damaged["kernel"], {name: increase(damaged, name) for name in COUNTS})
    assert increase(damaged, "frames published") >= 10


def test_lost_frames_are_counted(seen):
    lost = seen("lost_frames")
    require_each_counted(lost["kernel"], {name: increase(lost, name) for name in COUNTS})
    numbers = {frame["sequence"] for frame in lost["kernel"]}
    assert increase(lost, "frames dropped") >= max(numbers) - min(numbers) + 1 - len(numbers) > 0


def test_streams_again_after_a_fatal_error(seen, slowness):
    fatal = seen("fatal_error")
    assert re.search(QUEUE_FAILED.format("Input/output error"), fatal["log"])
    assert fatal["seconds"] <= 2.0 * slowness
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


def test_controls_are_set_at_start_and_wrong_ones_reported(seen):
    """gain depends on gain_automatic but comes before it in the map; v4l2-ctl reads the values."""
    controls = seen("controls")
    at_start = controls["at_start"]
    assert (at_start["integer_32_bits"], at_start["gain"], at_start["gain_automatic"]) == (
        "99",
        "50",
        "0",
    )
    assert at_start["contrast"] == "128"
    warning = "[ WARN] /camera: /dev/video0: "
    out_of_range = warning + "control contrast is 999, must be an integer from 0 to 255"
    assert controls["log"].count(out_of_range) == 1
    missing = warning + "there is no control no_such_control, the camera has brightness, contrast,"
    assert controls["log"].count(missing) == 1


def test_controls_are_described_to_dynamic_reconfigure(seen):
    described = seen("controls")["described"]
    hue = described["hue"]
    assert (hue["type"], hue["min"], hue["max"], hue["default"]) == ("int", -128, 128, 0)
    assert described["horizontal_flip"]["type"] == "bool"
    assert described["integer_64_bits"]["type"] == "double"
    assert described["string"]["type"] == "str"
    items = ast.literal_eval(described["menu"]["edit_method"])["enum"]
    assert {item["value"]: item["name"] for item in items} == {
        1: "Menu Item 1",
        3: "Menu Item 3",
        4: "Menu Item 4",
    }


LIVE = {
    "saturation": "33",
    "horizontal_flip": "1",
    "integer_64_bits": "17179869184",
    "bitmask": "16",
    "string": "'abcd'",
    "menu": "4 (Menu Item 4)",
}


def test_controls_change_live(seen):
    controls = seen("controls")
    assert {name: controls["live"][name] for name in LIVE} == LIVE
    assert controls["answer"]["saturation"] == 33 and controls["answer"]["menu"] == 4
    refusal = "refused: /dev/video0: control hue is 1000, must be an integer from -128 to 128"
    assert refusal in controls["live_log"]
    assert controls["live"]["hue"] == "0" and controls["answer"]["hue"] == 0


def test_controls_are_saved(vm, seen):
    assert seen("controls")["saved"] == "/out/camera.yaml"
    saved = yaml.safe_load((vm / "camera.yaml").read_text())["controls"]
    assert saved["gain_auto"] is False and saved["horizontal_flip"] is True
    assert "gain_automatic" not in saved  # the driver's name of what the file has already
    assert (saved["gain"], saved["saturation"], saved["menu"]) == (50, 33, 4)
    assert (saved["integer_64_bits"], saved["string"]) == (2.0**34, "abcd")
    assert "hue" not in saved and "mute" not in saved


def test_an_unplugging_is_reported_while_nobody_subscribes(seen):
    message = seen("unplugged_while_idle")["message"]
    assert message == "/dev/video0: cannot be opened: No such file or directory"


@pytest.mark.parametrize(
    "scenario", ["controls_after_unplugging", "unplugged_while_idle", "stopped"]
)
def test_controls_are_restored_with_the_device(seen, scenario):
    assert seen(scenario)["values"] == seen("controls")["live"]


@pytest.mark.parametrize("name", ["streamon", "reqbufs", "qbuf"])
def test_streams_again_after_a_call_that_failed(seen, name):
    log = seen("failing_calls")[name]
    failure = f"VIDIOC_{name.upper()} failed: Invalid argument; trying again"
    assert log.count("trying again") == 1 and failure in log
    assert "streaming again" in log


def test_streams_again_after_a_disconnection(seen):
    disconnected = seen("disconnected")
    assert re.search(QUEUE_FAILED.format("No such device"), disconnected["log"])
    assert "streaming again" in disconnected["log"]
    assert np.all(np.diff(stamps(disconnected["camera_info"])) > 0)


def test_a_busy_device_is_retried_and_its_holder_named(seen):
    busy = seen("busy")
    holder = "it is open in v4l2-ctl (process {})".format(busy["holder"])
    assert busy["message"].endswith("failed: Device or resource busy; " + holder)
    assert holder + "; trying again" in busy["log"] and "streaming again" in busy["log"]
    assert busy["arrived"] == 0


def test_stopped_capture_stays_stopped(seen):
    """It also does when the device is unplugged and plugged in again."""
    stopped = seen("stopped")
    assert stopped["message"] == "stopped: ~start_capture starts it again"
    assert not stopped["held"] and stopped["arrived"] == 0


def test_stamps_do_not_go_back_with_the_clock(seen, slowness):
    step = seen("clock_set_back")
    times = stamps(step["camera_info"])
    assert np.all(np.diff(times) > 0)
    age = ages(step["camera_info"])
    assert age.min() < 0 < age[-1]  # the clock was set back, and has caught up with the stamps
    assert re.search(r"the clock was set back: stamps are [\d.]+ s ahead", step["log"])


def test_a_hundred_unpluggings(seen, slowness):
    cycles = seen("cycles")
    descriptors, threads, memory = np.array(cycles["uses"]).T
    assert len(descriptors) == 100
    assert np.all(descriptors == descriptors[0]) and np.all(threads == threads[0])
    # A leak would grow in each cycle, by 2400 kB if it were one cycle's buffers. On a busy machine,
    # waiting frames make the heap larger once or twice.
    assert np.median(memory[19:] - memory[9:-10]) < 260
    assert max(cycles["seconds"]) <= 2.0 * slowness
    assert np.all(np.diff(stamps(cycles["camera_info"])) > 0)


def test_interrupt_while_streaming(seen, slowness):
    interrupt = seen("interrupt")
    assert interrupt["exit_code"] == 0
    assert interrupt["seconds"] <= 1.0 * slowness
