"""Parameters: refused at start, refused live, changed live, saved."""

import os
import stat

import numpy as np
import pytest
import rospy
import support
import yaml
from sensor_msgs.msg import CameraInfo, Image
from std_srvs.srv import Empty, Trigger


@pytest.mark.parametrize(
    "node, name, value, message",
    [
        ("brightness_node", "gain", -0.1, "gain is -0.1, must be from 0 to 10"),
        ("edge_detector_node", "aperture", 9, "aperture is 9, must be 3, 5 or 7"),
    ],
)
def test_bad_value_at_start_is_fatal(start, node, name, value, message):
    support.assert_fatal_at_start(start, node, name, value, message)


@pytest.mark.parametrize(
    "node, name, value, default, message",
    [
        ("brightness_node", "gain", 10.1, 1.0, "gain is 10.1"),
        ("brightness_node", "gain", -1.0, 1.0, "gain is -1"),
        ("brightness_node", "offset", -300.0, 50.0, "offset is -300"),
        ("brightness_node", "offset", 256.0, 50.0, "offset is 256"),
        ("brightness_node", "gamma", 10.5, 1.0, "gamma is 10.5"),
        ("edge_detector_node", "blur_size", 0, 7, "blur_size is 0"),
        ("edge_detector_node", "low_threshold", -1.0, 15.0, "low_threshold is -1"),
        ("camera_node", "framerate", -1.0, 0.0, "framerate is -1"),
        ("brightness_node", "gamma", 0.0, 1.0, "gamma is 0"),
        ("brightness_node", "gamma", float("nan"), 1.0, "gamma is nan"),
        ("edge_detector_node", "blur_size", 8, 7, "blur_size is 8"),
        ("edge_detector_node", "blur_size", 99, 7, "blur_size is 99"),
        ("edge_detector_node", "low_threshold", 31.0, 15.0, "high_threshold is 30"),
        ("edge_detector_node", "high_threshold", 1e9, 30.0, "high_threshold is 1e+09"),
        ("edge_detector_node", "aperture", 4, 3, "aperture is 4"),
        ("camera_node", "framerate", 2000.0, 0.0, "framerate is 2000"),
    ],
)
def test_invalid_live_value_leaves_the_old_one(start, node, name, value, default, message):
    process = start(node, "__name:=live", "_source:=synthetic")
    assert support.reconfigured("/live", **{name: value})[name] == default
    assert rospy.get_param("/live/" + name) == default
    process.wait_for_output(message)
    assert "WARN" in process.output()
    assert process.running()


@pytest.mark.parametrize(
    "node, right, wrong, meant",
    [
        ("motion_detector.py", "_minArea:=300", "minaera", "minArea"),
        ("camera_node", "_image_width:=320", "image_widht", "image_width"),
        ("brightness_node", "_diagnostic_period:=2", "gama", "gamma"),
        ("edge_detector_node", "_always_subscribe:=false", "lowthreshold", "low_threshold"),
    ],
)
def test_a_misspelt_parameter_is_reported(start, node, right, wrong, meant):
    known = ["_source:=synthetic"] if node == "camera_node" else ["_image_transport:=raw"]
    known += ["_config_file:=/no/file.yaml", right]
    # Maps that belong to a transport, the node's topics and a node below it.
    rospy.set_param("/typing/compressed/mode", "gray")
    for topic in ("image_raw", "processed_image"):
        rospy.set_param(f"/typing/{topic}/theora/quality", 3)
    rospy.set_param("/typing/other_node/gain", 3)
    below = rospy.Publisher("/typing/other_node/output", Image, queue_size=1)
    other = "/processed_image" if node == "camera_node" else "/image_raw"
    beside = rospy.Publisher("/typing" + other, Image, queue_size=1)
    process = start(node, "__name:=typing", *known, f"_{wrong}:=300", "_xyz:=1", "_zyx/of:=2")
    process.wait_for_output("parameter /typing/zyx is not known")
    process.wait_for_output("parameter /typing/xyz is not known")
    process.wait_for_output(f"parameter /typing/{wrong} is not known, is {meant} meant?")
    support.wait_for(lambda: rospy.has_param("/typing/" + right[1:].partition(":")[0]), right)
    assert process.output().count("is not known") == 3, process.output()
    below.unregister()
    beside.unregister()


@pytest.mark.parametrize(
    "node, name, value, text",
    [
        ("edge_detector_node", "low_threshold", 12.5, "12.5"),
        ("code_reader.py", "symbologies", "qr", "'qr'"),
    ],
)
def test_leftovers_of_an_ended_launch_are_reported_and_not_saved_to(
    start, tmp_path, node, name, value, text
):
    config = tmp_path / "config" / "node.yaml"
    config.parent.mkdir()
    config.write_text("spacing: 1\n")
    (tmp_path / "package.xml").write_text("<package><name>robot_vision</name></package>")
    left = {"config_file": str(config), "image_transport": "compressed", name: value}
    rospy.set_param("/left", left)
    prompt = {"PYTHONUNBUFFERED": "1"}  # else rospy's INFO lines wait in a buffer
    process = start(node, "__name:=left", env=prompt)
    shown = f"config_file: '{config}', image_transport: 'compressed', {name}: {text}"
    process.wait_for_output("/left: set on the parameter server: " + shown)
    assert process.output().count("on the parameter server") == 1
    answer = save("/left")
    assert not answer.success and f"{config}', a file of the package" in answer.message
    assert config.read_text() == "spacing: 1\n"
    process.end()
    launched = f"__log:={tmp_path}/node.log"  # as roslaunch sets it
    process = start(node, "__name:=left", launched, env=prompt)
    process.wait_for_output("on the parameter server")
    assert save("/left").success
    assert yaml.safe_load(config.read_text())[name] == value


def test_a_node_with_defaults_reports_nothing(start):
    process = start("brightness_node", "__name:=plain")  # it leaves all its values on the server
    rospy.wait_for_service("/plain/save_parameters", support.DEADLINE)
    process.end()  # or what it still registers would take the name from the next one
    process = start("brightness_node", "__name:=plain", "_threads:=2")
    process.wait_for_output("/plain: set on the parameter server: threads: 2")
    assert "threads: 2," not in process.output(), process.output()


def test_other_parameters_of_usb_cam_are_accepted(start, diagnostics):
    """These are the parameters of its development branch."""
    left = {
        "camera_transport_suffix": "image",
        "color_format": "yuv422p",
        "full_ffmpeg_log": False,
        "hardware_decoder": {"enable": False, "name": "cuda"},
        "start_service_name": "start_capture",
        "stop_service_name": "stop_capture",
    }
    suspended = {"create_suspended": True, "always_subscribe": True, "source": "synthetic"}
    intrinsic = {"intrinsic_controls": {"gain": 3, "ignore": ["gain"]}}
    rospy.set_param("/camera", {**left, **suspended, **intrinsic})
    process = start("camera_node")
    support.wait_for(
        lambda: diagnostics.next("camera").message == "stopped: ~start_capture starts it again",
        "the camera to be there",
    )
    for name in left:
        assert process.output().count(f"/camera/{name} has no effect: ") == 1, process.output()
    assert "not known" not in process.output() and "meant?" not in process.output()
    assert diagnostics.value("camera", "frames received") == "0"
    rospy.ServiceProxy("/camera/start_capture", Empty)()
    support.Messages("/camera/image_raw", Image).wait()


def test_values_are_applied_to_every_pixel_at_start_and_live(start):
    applied = {"gain": 1.5, "offset": -20.0}
    start("brightness_node", "__name:=live", "image:=/ramp", "_gain:=1.5", "_offset:=-20")
    publisher = rospy.Publisher("/ramp", Image, queue_size=1, latch=True)
    ramp = np.arange(256, dtype=np.uint8)
    publisher.publish(Image(encoding="mono8", width=256, height=1, step=256, data=ramp.tobytes()))
    for values in ({}, {"offset": 7.0}, {"gain": 2.0, "offset": -50.0}):
        answer = support.reconfigured("/live", **values)
        assert {name: answer[name] for name in values} == values
        applied.update(values)
        result = support.Messages("/live/processed_image", Image)
        levels = np.clip(np.rint(applied["gain"] * ramp + applied["offset"]), 0, 255)
        assert np.array_equal(np.frombuffer(result.wait()[0].data, np.uint8), levels)
        result.close()
        # The next subscription gets the latched frame only after this one has ended.
        support.wait_for(
            lambda: publisher.get_num_connections() == 0, "the end of the subscription"
        )
    publisher.unregister()


def save(node):
    rospy.wait_for_service(node + "/save_parameters", support.DEADLINE)
    return rospy.ServiceProxy(node + "/save_parameters", Trigger)()


NOT_WRITTEN = (
    "config.yaml cannot be written: No such file or directory; ~config_file names the file, as "
    "config:=/absolute/path.yaml of the launch files does"
)
BEFORE = """\
# How bright it is here
gain:   5  # contrast
offset: "50" # brightness
other_key: [1, 2]
its_name: "7"  # stays a string
nested:
  gamma: 3
"""
AFTER = """\
# How bright it is here
gain: 2.0  # contrast
offset: 1.0e-05 # brightness
other_key: [1, 2]
its_name: "7"  # stays a string
nested:
  gamma: 3
threads: 1
gamma: 0.1
"""


def test_values_are_saved_where_they_were(start, tmp_path):
    config = tmp_path / "brightness.yaml"
    config.write_text(BEFORE)
    config.chmod(0o640)
    link = tmp_path / "link.yaml"
    link.symlink_to(config)
    start("brightness_node", "__name:=saving", f"_config_file:={link}", "_gain:=2.0")
    support.reconfigured("/saving", offset=1e-05, gamma=0.1)
    answer = save("/saving")
    assert answer.success and answer.message == str(link)
    assert config.read_text() == AFTER
    assert yaml.safe_load(AFTER)["offset"] == 1e-05
    assert link.is_symlink()
    assert config.stat().st_mode & 0o777 == 0o640
    assert len(list(tmp_path.glob("brightness.yaml*"))) == 1  # there is no temporary file left


@pytest.mark.parametrize(
    "content, reason",
    [
        ("gain: [", "no valid YAML"),
        ("- a list\n", "no map of parameters"),
        ("{blur_size: 3, aperture: 5}\n", 'not one "name: value" in each line'),
        ("blur_size:\n  3\n", 'not one "name: value" in each line'),
        (None, NOT_WRITTEN),
    ],
)
def test_an_invalid_file_is_not_overwritten(start, tmp_path, content, reason):
    config = tmp_path / ("config.yaml" if content else "missing_folder/config.yaml")
    if content:
        config.write_text(content)
    start("edge_detector_node", "__name:=saving", f"_config_file:={config}")
    answer = save("/saving")
    assert not answer.success
    assert str(config) in answer.message and reason in answer.message
    assert not content or config.read_text() == content


def test_a_python_node_also_reports_a_file_that_cannot_be_written(start):
    start("code_reader.py", "__name:=saving", "_config_file:=/no/folder/config.yaml")
    answer = save("/saving")
    assert not answer.success and NOT_WRITTEN in answer.message


@pytest.mark.parametrize("node", ["brightness_node", "code_reader.py"])
def test_only_files_are_replaced(start, tmp_path, node):
    """If root replaced a device by a file, the device would be lost for the whole machine."""
    name = "replacing_" + node.partition(".")[0]
    start(node, f"__name:={name}", "_config_file:=/dev/null")
    pipe, bomb, text = tmp_path / "pipe.yaml", tmp_path / "bomb.yaml", tmp_path / "text.yaml"
    os.mkfifo(str(pipe))
    bomb.write_text("[" * 100000)
    null = tmp_path / "null"
    null.symlink_to("/dev/null")
    dangling = tmp_path / "dangling.yaml"
    dangling.symlink_to("nowhere")
    loop = tmp_path / "loop.yaml"
    loop.symlink_to("loop.yaml")
    for path, reason in (
        ("/dev/null", "/dev/null cannot be read: it is no file"),
        ("/dev/zero", "/dev/zero cannot be read: it is no file"),
        (null, f"{null} cannot be read: it is no file"),
        (pipe, f"{pipe} cannot be read: it is no file"),
        (tmp_path, f"{tmp_path} cannot be read: it is no file"),
        (dangling, f"{dangling} cannot be read: No such file or directory"),
        (loop, f"{loop} cannot be read: Too many levels of symbolic links"),
        (bomb, f"{bomb}: not overwritten, for it is no valid YAML: "),
    ):
        rospy.set_param(f"/{name}/config_file", str(path))
        answer = save(f"/{name}")
        assert not answer.success and reason in answer.message and "\n" not in answer.message
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode) and pipe.is_fifo()
    text.write_bytes(b"threads: 1  # core\r\n")
    rospy.set_param(f"/{name}/config_file", str(text))
    assert save(f"/{name}").success
    lines = text.read_bytes().split(b"\r\n")
    assert lines[0] == b"threads: 1  # core" and len(lines) > 2 and b"\n" not in b"".join(lines)
    names = {"pipe.yaml", "bomb.yaml", "null", "dangling.yaml", "loop.yaml", "text.yaml"}
    assert {path.name for path in tmp_path.iterdir() if path.suffix != ".log"} == names


@pytest.mark.parametrize(
    "node, name, says",
    [
        ("camera_node", "source", "cannot be read: it is no file"),
        ("camera_node", "poster", "cannot be read: it is no file"),
        ("camera_node", "meshes", "cannot be read: it is no file"),
        ("face_detector.py", "cascade_1", "which is no file"),
    ],
)
def test_a_pipe_at_start_is_fatal(start, tmp_path, node, name, says):
    pipe = tmp_path / "pipe.png"
    os.mkfifo(str(pipe))
    sources = [] if name == "source" else ["_source:=synthetic"]
    sources += ["_scene:=tabletop"] if name == "meshes" else []
    process = start(node, "__name:=bad", f"_{name}:={pipe}", *sources)
    assert process.exit_code() == 1
    (fatal,) = [line for line in process.output().splitlines() if "FATAL" in line]
    assert str(pipe) in fatal and says in fatal


@pytest.mark.parametrize(
    "content, reason",
    [
        ("pipe", "{} cannot be read: it is no file"),
        ("folder", "{} cannot be read: it is no file"),
        ("[" * 100000, "{} is no calibration that can be read: yaml-cpp: error at line 1"),
        ("\0\1\2", "{} is no calibration that can be read"),
        ("#" * (1 << 20) + "\n", "{} cannot be read: it has 1 MB, must have at most 1"),
    ],
    ids=["pipe", "folder", "deep", "binary", "large"],
)
def test_an_unreadable_calibration_is_not_used(start, tmp_path, content, reason):
    path = tmp_path / "eye.yaml"
    if content == "pipe":
        os.mkfifo(str(path))
    elif content == "folder":
        path.mkdir()
    else:
        path.write_text(content)
    url = f"_camera_info_url:=file://{path}"
    process = start("camera_node", "__name:=eye", "_source:=synthetic", url)
    support.Messages("/eye/camera_info", CameraInfo).wait()
    process.wait_for_output("not calibrated: " + reason.format(path))


def test_the_name_in_a_calibration_cannot_control_a_terminal(start, tmp_path):
    matrices = {
        "camera_matrix": (3, 3),
        "rectification_matrix": (3, 3),
        "projection_matrix": (3, 4),
    }
    content = {name: np.eye(*shape) for name, shape in matrices.items()}
    content["distortion_coefficients"] = np.zeros((1, 5))
    values = {
        name: {"rows": len(of), "cols": len(of[0]), "data": of.ravel().tolist()}
        for name, of in content.items()
    }
    values.update(image_width=640, image_height=480, camera_name="\x1b[2J" + 500 * "x")
    path = tmp_path / "eye.yaml"
    path.write_text(yaml.safe_dump({**values, "distortion_model": "plumb_bob"}))
    url = f"_camera_info_url:=file://{path}"
    process = start("camera_node", "__name:=eye", "_source:=synthetic", url)
    support.Messages("/eye/camera_info", CameraInfo).wait()
    process.wait_for_output(r"is of a camera named \x1b[2Jxxx")
    assert "\x1b[2J" not in process.output() and 150 * "x" not in process.output()


def test_without_a_home_a_node_reports_what_it_needs(start):
    """System services and some users have no home folder."""
    homeless = ["/usr/bin/env", "-u", "ROS_HOME", "HOME=/dev/null"]
    process = start(*homeless, support.executable("brightness_node"), "__name:=homeless")
    assert process.exit_code() == 1
    (fatal,) = [line for line in process.output().splitlines() if "FATAL" in line]
    assert "/dev/null/.ros" in fatal and "ROS_HOME names a folder" in fatal


@pytest.mark.parametrize(
    "word, says",
    [
        ("_threads:=99999999999", "threads is 99999999999, must be what the parameter server"),
        ("_threads:=null", "threads is None, must be what the parameter server can hold"),
        ("_threads:=2020-01-01", "threads is datetime.date(2020, 1, 1), must be what"),
        ('_symbologies:="\\e[2J"', "symbologies is '\\x1b[2J', must be what the parameter server"),
        ("_threads:=[", "invalid command-line parameters: while parsing a flow node"),
    ],
)
def test_unknown_words_on_the_command_line_are_reported(start, word, says):
    process = start("code_reader.py", "__name:=bad", word)
    assert process.exit_code() == 1
    (line,) = process.output().splitlines()
    assert line.startswith("code_reader: " + says) and line.isprintable() and len(line) < 400


def test_saving_needs_a_file_name(start):
    start("camera_node", "__name:=saving", "_source:=synthetic")
    answer = save("/saving")
    assert not answer.success
    assert "config_file" in answer.message
