"""Parameters of nodelets with invalid values: one line reports each."""

import contextlib
import itertools
import pathlib
import re
import xmlrpc.client

import pytest
import rospy
import support
from hostile import DEEP, INF, NAN, is_flag, is_number
from std_srvs.srv import Trigger

import robot_vision.cfg.BrightnessConfig
import robot_vision.cfg.CameraConfig
import robot_vision.cfg.DenseFlowConfig
import robot_vision.cfg.DepthRegistrationConfig
import robot_vision.cfg.EdgeDetectorConfig
import robot_vision.cfg.FilterConfig
import robot_vision.cfg.SegmenterConfig
import robot_vision.cfg.SpectrumConfig
import robot_vision.cfg.StereoMatcherConfig
from robot_vision import operations

ROOT = pathlib.Path(__file__).resolve().parents[2]
LONG, OBEYED = "x" * 100000, "\n\x7f\x9b2J\u202e"  # characters that control a terminal
# Values that the parameter server can hold: integers of 32 bits, texts without \0 and \x1b.
HOSTILE = [
    {"a": {"b": 1}},
    {OBEYED: OBEYED},
    [1, 2],
    DEEP,
    NAN,
    INF,
    -INF,
    1e300,
    -0.5,
    2**31 - 1,
    -(2**31),
    True,
    LONG,
    OBEYED,
    "",
    xmlrpc.client.Binary(b"\x00\xff"),
]
LONGEST = 1000  # characters, of a line


def integer(low, high):
    return lambda value: type(value) is int and low <= value <= high


def text(value):
    return type(value) is str


def empty(value):
    return value == ""


def name_of_device(value):
    return text(value) and value != ""


def controls(value):
    return isinstance(value, dict) and all(map(text, value.values()))


def control(value):
    """Doubles stand for integers that the parameter server cannot hold."""
    return type(value) in (bool, int, str)


def never(_value):
    return False


ALL = {"always_subscribe": is_flag, "diagnostic_period": is_number(0.01, 3600.0)}
FILTER = {**ALL, "threads": integer(1, 64), "image_transport": never}
BRIGHTNESS = {
    **FILTER,
    "gain": is_number(0.0, 10.0),
    "offset": is_number(-255.0, 255.0),
    "gamma": is_number(0.1, 10.0),
}
EDGE_DETECTOR = {
    **FILTER,
    "blur_size": never,
    "low_threshold": never,
    "high_threshold": never,
    "aperture": never,
    "l2_gradient": is_flag,
}
# Of the parameters of operations, which are all read alike, one of each kind.
CHAIN = {
    **ALL,
    "image_transport": never,
    "chain": empty,
    "use_second": is_flag,
    "gaussian_size": never,
    "gaussian_sigma": is_number(0.0, 100.0),
    "canny_l2_gradient": is_flag,
    "kernel_rows": text,
    "resize_interpolation": never,
}
# Of those that only are fields of the core's structs, too.
DENSE_FLOW = {
    "method": never,
    "scale": is_number(0.05, 1.0),
    "levels": never,
    "gaussian_window": is_flag,
}
SPECTRUM = {
    "filter": never,
    "radius": is_number(0.001, 1.5),
    "order": never,
    "optimal_size": is_flag,
}
SEGMENTER = {
    "method": never,
    "opacity": is_number(0.0, 1.0),
    "clusters": never,
    "outlines": is_flag,
}
DEPTH_REGISTRATION = {
    "image_transport": never,
    "depth_image_transport": never,
    "slop": is_number(0.0, 10.0),
    "max_jump": is_number(0.001, 1.0),
    "color": is_flag,
}
STEREO_MATCHER = {
    "image_transport": never,
    "slop": is_number(0.0, 10.0),
    "method": never,
    "full_image": is_flag,
}
OPERATION_PARAMS = {f"{one.name}_{param.name}" for one in operations() for param in one.params}
USB_CAM_CONTROLS = (
    "brightness",
    "contrast",
    "saturation",
    "sharpness",
    "gain",
    "focus",
    "autofocus",
    "auto_focus",
    "autoexposure",
    "exposure",
    "white_balance",
    "auto_white_balance",
)
WITHOUT_EFFECT = (
    "camera_transport_suffix",
    "color_format",
    "full_ffmpeg_log",
    "hardware_decoder",
    "start_service_name",
    "stop_service_name",
)
CAMERA = {
    **ALL,
    "keep_streaming": is_flag,
    "create_suspended": is_flag,
    "loop": is_flag,
    "framerate": is_number(0.0, 1000.0),
    "timeout": is_number(0.1, 3600.0),
    "image_width": never,
    "image_height": never,
    "source": text,  # a camera of any name may still appear
    "video_device": name_of_device,
    "pixel_format": never,
    "io_method": never,
    "scene": never,
    "views": never,
    "right_frame": never,
    "depth_encoding": never,
    "depth_noise": never,
    "depth_scale": is_number(1.0, 1e6),
    "poster": empty,
    "meshes": text,  # of a scene that is not there
    "camera_frame_id": empty,
    "second_frame_id": text,  # of a second view, which is not there
    "publish_tf": is_flag,
    "camera_name": never,
    "camera_info_url": empty,
    "output_encoding": never,
    "controls": controls,
    "intrinsic_controls": controls,
    "controls/gain": control,
    "intrinsic_controls/ignore": never,
    USB_CAM_CONTROLS[0]: control,
}
KINDS = {
    "brightness": (BRIGHTNESS, robot_vision.cfg.BrightnessConfig),
    "edge_detector": (EDGE_DETECTOR, robot_vision.cfg.EdgeDetectorConfig),
    "camera": (CAMERA, robot_vision.cfg.CameraConfig),
    "filter": (CHAIN, robot_vision.cfg.FilterConfig),
    "dense_flow": (DENSE_FLOW, robot_vision.cfg.DenseFlowConfig),
    "spectrum": (SPECTRUM, robot_vision.cfg.SpectrumConfig),
    "segmenter": (SEGMENTER, robot_vision.cfg.SegmenterConfig),
    "depth_registration": (DEPTH_REGISTRATION, robot_vision.cfg.DepthRegistrationConfig),
    "stereo_matcher": (STEREO_MATCHER, robot_vision.cfg.StereoMatcherConfig),
}
READ_ALIKE = OPERATION_PARAMS | {
    of["name"]
    for kind in ("dense_flow", "spectrum", "segmenter", "depth_registration", "stereo_matcher")
    for of in KINDS[kind][1].config_description["parameters"]
}


# What the gtests of the parameters of the core do not have: nodelet, parameter, value, text of the
# FATAL line.
REFUSED = [
    ("brightness", "gamma", 0.05, "gamma is 0.05, must be from 0.1 to 10"),
    ("brightness", "gain", True, "gain is 1, must be a number"),
    ("brightness", "gain", "strong", "gain is 'strong', must be a number"),
    ("brightness", "always_subscribe", "maybe", "must be true or false"),
    (
        "brightness",
        "diagnostic_period",
        0,
        "diagnostic_period is 0, must be from 0.01 to 3600",
    ),
    ("camera", "diagnostic_period", -1, "diagnostic_period is -1, must be from 0.01 to 3600"),
    ("edge_detector", "image_transport", "pigeon", "must be one that is installed: "),
    ("edge_detector", "always_subscribe", 1.5, "must be true or false"),
    ("camera", "always_subscribe", "x", "must be true or false"),
    ("camera", "source", 7, "source is 7, must be a string"),
    ("camera", "source", {"a": 1}, "must be a string"),
    ("camera", "source", ["a"], "must be a string"),
    ("camera", "poster", "/dev/zero", "/dev/zero cannot be read: it is no file"),
    ("camera", "framerate", {"a": {"b": "x" * 10000}}, "..., must be a number"),
    ("camera", "pixel_format", "x" * 10000, "..., must be yuyv, uyvy, nv12, "),
    (
        "filter",
        "chain",
        "gray, blur",
        "'blur' is no operation, must be one of adaptive_threshold, add",
    ),
    ("filter", "chain", "gray,,canny", "must be names with one comma between two"),
    ("filter", "open_size", 4, "open_size is 4, must be odd and from 1 to 99"),
    ("dense_flow", "poly_n", 6, "poly_n is 6, must be 5 or 7"),
    ("spectrum", "radius", 0, "radius is 0, must be above 0 and at most 1.5"),
    ("segmenter", "opening", 4, "opening is 4, must be odd and from 1 to 31"),
    ("brightness", "gain", [1.0, 2.0], "must be a number"),
    ("brightness", "gain", INF, "gain is inf, must be from 0 to 10"),
    ("brightness", "gain", 1e300, "gain is 1e+300, must be from 0 to 10"),
    ("edge_detector", "aperture", 2**31 - 1, "must be 3, 5 or 7"),
    ("camera", "poster", "/no/poster.png", "/no/poster.png cannot be read: No such file"),
    ("camera", "image_width", 32, "image_width is 32, must be from 64 to 4096"),
    ("camera", "image_width", 1600, "from a third to three times image_height, 480"),
    (
        "edge_detector",
        "low_threshold",
        40,
        "high_threshold is 30, must be at least low_threshold, 40",
    ),
    ("edge_detector", "aperture", 3.5, "must be an integer"),
    ("edge_detector", "l2_gradient", "yes, please", "must be true or false"),
    ("camera", "image_width", 8193, "image_width is 8193, must be from 16 to 8192"),
    ("camera", "image_height", 0, "image_height is 0, must be from 16 to 8192"),
    ("camera", "framerate", 1001, "framerate is 1001, must be from 0 to 1000"),
    ("camera", "timeout", 0, "timeout is 0, must be from 0.1 to 3600"),
    ("camera", "keep_streaming", 2, "keep_streaming is 2, must be true or false"),
    ("camera", "controls", 5, "controls is 5, must be a map of controls' names and values"),
    ("camera", "controls/gain", 0.5, "controls/gain is 0.5, must be an integer, true, false"),
    ("camera", "intrinsic_controls", 5, "must be a map of controls' names and values"),
    (
        "camera",
        "intrinsic_controls/gain",
        0.5,
        "intrinsic_controls/gain is 0.5, must be an in",
    ),
    ("camera", "intrinsic_controls/ignore", "gain", "must be a list of controls' names"),
    ("camera", "brightness", 0.5, "brightness is 0.5, must be an integer, true, false"),
    ("camera", "loop", "often", "must be true or false"),
    ("camera", "camera_name", "no/name", "must be letters, digits and _"),
    (
        "camera",
        "camera_info_url",
        "ftp://there",
        "must be empty, file:///... or package://...",
    ),
]
REFUSED += [
    ("camera", "camera_info_url", url, "must be " + expected)
    for url, expected in (
        ("http://there/eye.yaml", "empty, file:///... or package://..."),
        ("eye.yaml", "empty, file:///... or package://..."),
        ("file://eye.yaml", "empty, file:///... or package://..."),
        ("package://no_such_package/eye.yaml", "package://, the name of a package that is there"),
        ("package://robot_vision", "package://, the name of a package that is there"),
        ({"file": 1}, "a string"),
    )
]


def test_all_parameters_are_tested():
    """The parameters are found where the sources read them, and in the .cfg files."""
    named = {USB_CAM_CONTROLS[0]}  # the sources have the others in two arrays
    for path in [*ROOT.glob("src/nodelets/*.?pp"), *ROOT.glob("src/ros/*/*.?pp")]:
        source = path.read_text()
        named |= set(re.findall(r'\b(?:readParam|readMap|getParam)\(\w+, "(\w+)"', source))
        named |= set(re.findall(r'\bgetParam\("(\w+)"', source))
        transports = re.findall(r'\breadTransport\(\w+, \w+(?:, "(\w+)")?\)', source)
        named |= {name or "image_transport" for name in transports}
    of_source = (ROOT / "include/robot_vision/camera/open_source.hpp").read_text()
    named |= set(re.findall(r'\bvisit\("(\w+)"', of_source))  # readFields() reads them
    of_controls = (ROOT / "src/ros/camera/control_params.cpp").read_text()
    array = of_controls[of_controls.index("kUsbCamControls[] =") :].partition(";")[0]
    assert set(re.findall(r'"(\w+)"', array)) == set(USB_CAM_CONTROLS)
    of_usb_cam = (ROOT / "src/ros/camera/usb_cam_params.cpp").read_text()
    assert set(re.findall(r'\{"(\w+)", "', of_usb_cam)) == set(WITHOUT_EFFECT)
    for _, config in KINDS.values():
        named |= {parameter["name"] for parameter in config.config_description["parameters"]}
    swept = {name for parameters, _ in KINDS.values() for name in parameters if "/" not in name}
    assert named == swept | {"config_file"} | READ_ALIKE


@pytest.fixture(scope="module")
def manager(start_once):
    return support.NodeletManager(start_once)


def lines_of(process, name):
    """The log lines of a nodelet, without roscpp's colors."""
    found = [line for line in process.output().split("\n") if f"{name}: " in line]
    return [re.sub("\x1b\\[[0-9;]*m", "", line) for line in found]


numbers = itertools.count()


def cases():
    for kind, (parameters, config) in KINDS.items():
        for parameter, can_be in parameters.items():
            yield pytest.param(kind, parameter, can_be, config, id=f"{kind}-{parameter}")


@pytest.mark.parametrize("kind, parameter, can_be, config", cases())
def test_a_nodelet_accepts_valid_values_and_reports_others_in_one_line(
    manager, kind, parameter, can_be, config
):
    """All are loaded into one manager, which must survive."""
    live = {of["name"] for of in config.config_description["parameters"]}
    for value in HOSTILE:
        name = f"/hostile_{next(numbers)}"
        started, kept, lines = tried(
            manager, name, kind, {**source_with(parameter), parameter: value}
        )
        assert started == can_be(value), (value, lines)
        fatal = [line for line in lines if "FATAL" in line]
        if started:
            assert not fatal and (parameter not in live or kept[parameter] == value)
        else:
            (line,) = fatal
            assert re.search(rf"{name}: {parameter}\b.*(, must be | cannot be read: )", line), line


@pytest.mark.parametrize("kind, parameter, value, message", REFUSED)
def test_an_invalid_value_is_reported_with_the_valid_ones(manager, kind, parameter, value, message):
    name = f"/refused_{next(numbers)}"
    values = {**source_with(parameter), parameter: value}
    started, _, lines = tried(manager, name, kind, values)
    (line,) = (line for line in lines if "FATAL" in line)
    assert not started and parameter in line and message in line


def source_with(parameter):
    """The parameters, besides this one, that a camera needs to start without a device."""
    return {} if parameter in ("source", "video_device") else {"source": "synthetic"}


def tried(manager, name, kind, values):
    """Whether a nodelet starts with these parameters, their values then, and its log lines."""
    for parameter, value in values.items():
        rospy.set_param(f"{name}/{parameter}", value)
    started = False
    with contextlib.suppress(rospy.ServiceException):
        started = manager.load(name, kind, {"/image": "/no/image"})
    assert manager.process.running(), (values, manager.process.output()[-1000:])
    kept = rospy.get_param(name)
    if started:
        assert manager.unload(name)
    rospy.delete_param(name)
    lines = lines_of(manager.process, name)
    assert all(line.isprintable() and len(line) <= LONGEST for line in lines), lines
    return started, kept, lines


@pytest.mark.parametrize("number", range(1, len(USB_CAM_CONTROLS) + 1))
def test_all_controls_are_read_in_the_same_way(manager, number):
    name = f"/usb_cam_{number}"
    values = dict.fromkeys(USB_CAM_CONTROLS[:number], 2**31 - 1)
    refused = [*USB_CAM_CONTROLS, "intrinsic_controls/gain"][number]
    started, _, lines = tried(manager, name, "camera", {**values, refused: INF})
    (line,) = (line for line in lines if "FATAL" in line)
    assert not started and f"{name}: {refused} is inf, must be an integer, true, false" in line


def test_unused_parameters_may_have_any_value(manager):
    """That is, usb_cam's other parameters and unknown ones."""
    odd = {f"/a {OBEYED}": OBEYED, "/" + LONG: LONG, "/x y": {OBEYED: DEEP}}
    for number, value in enumerate(({"a": [NAN]}, DEEP, OBEYED, LONG)):
        values = {"source": "synthetic", **dict.fromkeys(WITHOUT_EFFECT, value)}
        name = f"/odd_{number}"
        rospy.set_param(name, {key[1:]: of for key, of in odd.items()})
        started, _, lines = tried(manager, name, "camera", values)
        assert started, lines
        for parameter in WITHOUT_EFFECT:
            assert manager.process.output().count(f"{name}/{parameter} has no effect: ") == 1
        told = [
            line for line in manager.process.output().split("\n") if f"parameter {name}/" in line
        ]
        assert len(told) == len(odd)
        for line in (re.sub("\x1b\\[[0-9;]*m", "", line) for line in told):
            assert line.isprintable() and len(line) <= LONGEST, line


def test_an_unsuitable_file_for_saving_is_reported_in_one_line(manager):
    assert manager.load("/saver", "brightness", {"/image": "/no/image"})
    save = rospy.ServiceProxy("/saver/save_parameters", Trigger)
    for value in HOSTILE:
        rospy.set_param("/saver/config_file", value)
        answer = save()
        assert not answer.success and "config_file" in answer.message, answer
        assert answer.message.isprintable() and len(answer.message) <= LONGEST, answer
    for value in ("/" + LONG, "/" + OBEYED + "/x.yaml"):
        rospy.set_param("/saver/config_file", value)
        answer = save()
        assert not answer.success and "cannot be " in answer.message, answer
        assert answer.message.isprintable() and len(answer.message) <= LONGEST, answer
    assert manager.unload("/saver")
