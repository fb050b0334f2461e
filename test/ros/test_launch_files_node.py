"""The launch files: their arguments, the parameters that they set, hosts and displays."""

import contextlib
import io
import pathlib
import re
import shlex
import subprocess
import sys
from xml.etree import ElementTree

import pytest
import rosgraph
import roslaunch
import roslaunch.config
import roslaunch.xmlloader
import rospy
import support
import yaml
from fake_params import use_params
from ros_programs import ROSLAUNCH
from sensor_msgs.msg import CameraInfo, Image

from robot_vision.color.named_colors import NamedColors
from robot_vision.demo import demo_status

LAUNCH = pathlib.Path(__file__).resolve().parents[2] / "launch"
CHAIN = f"""
<launch>
  <include file="{LAUNCH}/camera.launch"><arg name="source" value="synthetic"/></include>
  <include file="{LAUNCH}/brightness.launch"/>
  <include file="{LAUNCH}/edge_detector.launch">
    <arg name="image" value="/brightness/processed_image"/>
  </include>
</launch>
"""
CHAINED = {"usb_cam": "camera", "brightness": "brightness", "edge_detector": "edge_detector"}
ENCODINGS = {
    "/usb_cam/image_raw": "bgr8",
    "/usb_cam/image_mono": "mono8",
    "/brightness/processed_image": "bgr8",
    "/edge_detector/processed_image": "mono8",
}
NO_TEXTS = {
    *("tag_size", "ball_diameter", "image_width", "image_height", "framerate", "loop", "view"),
    *("basics", "camera_height", "columns", "invert", "lane_width", "max_features", "pitch"),
    *("color", "depth", "disparities", "max_distance", "publish_tf", "radius", "rows", "slop"),
    *("recognition", "score_threshold", "square", "threads", "track"),
    *("foxglove", "open_browser", "open_streams", "port"),
}


def texts():
    """The parameters that are set to the text of an argument: file, parameter, argument."""
    for path in sorted(LAUNCH.glob("*.launch")):
        for param in ElementTree.parse(path).iter("param"):
            argument = re.fullmatch(r"\$\(arg (\w+)\)", param.get("value", ""))
            if argument and param.get("name") not in NO_TEXTS:
                yield path.name, param.get("name"), argument.group(1)


def output_of(*arguments):
    """The output of roslaunch, run in this process, because its import takes a second."""
    printed, words = io.StringIO(), list(sys.argv)
    sys.argv[:] = ["roslaunch", *map(str, arguments)]  # in place, as roslaunch refers to it
    try:
        with contextlib.redirect_stdout(printed), contextlib.suppress(SystemExit):
            roslaunch.main()
    finally:
        sys.argv[:] = words
    return printed.getvalue()


def loaded(name, *arguments):
    """The configuration that roslaunch loads from one of our launch files."""
    config = roslaunch.config.ROSLaunchConfig()
    loader = roslaunch.xmlloader.XmlLoader()
    loader.ignore_unset_args = False  # so that one that is required is an error
    loader.load(str(LAUNCH / name), config, argv=["roslaunch", *arguments], verbose=False)
    return config


def parameters_of(name, *arguments):
    return {name: param.value for name, param in loaded(name, *arguments).params.items()}


def test_frames_go_through_a_chain_of_launch_files_with_the_values_of_config(start, tmp_path):
    """The launch files as people use them, one on top of the other."""
    images = [support.Messages(topic, Image) for topic in ENCODINGS]
    infos = support.Messages("/usb_cam/camera_info", CameraInfo)
    (tmp_path / "chain.launch").write_text(CHAIN)
    start(ROSLAUNCH, tmp_path / "chain.launch")
    *frames, info = support.same_frame(*images, infos)
    for image, encoding in zip(frames, ENCODINGS.values()):
        assert image.header.frame_id == "head_camera"
        assert (image.encoding, image.width, image.height) == (encoding, 640, 480)
        assert len(image.data) == image.step * image.height
    assert (info.width, info.height) == (640, 480)
    for node, name in CHAINED.items():
        config = LAUNCH.parent / "config" / f"{name}.yaml"
        for key, value in yaml.safe_load(config.read_text()).items():
            assert rospy.get_param(f"/{node}/{key}") == value, key
        assert rospy.get_param(f"/{node}/config_file").endswith(config.name)


@pytest.mark.parametrize("path", sorted(LAUNCH.glob("*.launch")), ids=lambda path: path.name)
def test_only_the_part_of_two_hosts_is_a_required_argument(path):
    listed = output_of("--ros-args", path)
    assert "Optional Arguments:" in listed
    required = listed.partition("Required Arguments:\n")[2].partition("Optional")[0].split()
    assert required[:1] == (["part:"] if path.name == "remote.launch" else []), listed


@pytest.mark.parametrize(
    "display, arguments, windows",
    [(":7", (), 1), ("", (), 0), (":7", ("view:=false",), 0), ("", ("view:=true",), 1)],
)
def test_usb_cam_test_opens_a_window_where_there_is_a_display(
    monkeypatch, display, arguments, windows
):
    monkeypatch.setenv("DISPLAY", display)
    nodes = output_of("--nodes", LAUNCH / "usb_cam-test.launch", *arguments).split()
    assert nodes.count("/usb_cam") == 1
    assert nodes.count("/image_view") == windows


@pytest.mark.parametrize("arguments, loop", [((), False), (("loop:=true",), True)])
def test_a_folder_is_repeated_if_loop_is_set(arguments, loop):
    parameters = yaml.safe_load(output_of("--dump-params", LAUNCH / "camera.launch", *arguments))
    assert parameters["/usb_cam/loop"] is loop


def test_descriptive_default_arguments_mean_no_value(start, tmp_path):
    home = {"ROS_HOME": str(tmp_path)}
    images = support.Messages("/usb_cam/image_raw", Image)
    start(ROSLAUNCH, "robot_vision", "camera.launch", "source:=synthetic", env=home)
    images.wait()
    start(ROSLAUNCH, "robot_vision", "apriltag.launch", env=home)
    parameter = "/apriltag_detector/tag_size"
    assert support.wait_for(lambda: rospy.get_param(parameter, None), parameter) == 0.1
    home["PYTHONUNBUFFERED"] = "1"
    recognizer = start(ROSLAUNCH, "robot_vision", "face_recognizer.launch", env=home)
    recognizer.wait_for_output(f"0 people by 0 images in {tmp_path}/robot_vision/faces")


@pytest.mark.parametrize("path", sorted(LAUNCH.glob("*.launch")), ids=lambda path: path.name)
def test_every_launch_file_checks_for_unknown_arguments(monkeypatch, path):
    commands = []

    def value(_loader, _verbose, _name, _type, value, _text, _binary, command):
        if command:
            commands.append(command.split())
        return value or ""

    monkeypatch.setattr(roslaunch.xmlloader.XmlLoader, "param_value", value)
    arguments = ["part:=capture"] if path.name == "remote.launch" else []
    loaded(path.name, *arguments)
    assert not commands
    # One hides a function, and one is only passed on by the file.
    inner = {"demo.launch": "cmd_vel", "remote.launch": "image"}.get(path.name, "vieww")
    for name in (inner, "map", "open"):
        loaded(path.name, *arguments, f"{name}:=true")
        ((program, file),) = commands
        assert program.endswith("/check_arguments.py")
        assert pathlib.Path(file.strip("'")).samefile(path)
        commands.clear()


def test_an_unknown_argument_is_an_error_before_anything_starts(start):
    words = ROSLAUNCH, "robot_vision", "camera.launch", "image_widht:=320"
    launch = start(*words, fork=False)  # roslaunch reads the command line of its process
    assert launch.exit_code() == 1
    assert "camera.launch has no argument image_widht, is image_width meant?" in launch.output()
    assert "\n  image_height: px; config: as in the YAML file" in launch.output()
    with pytest.raises(rosgraph.MasterError):
        rosgraph.Master("/test").lookupNode("/usb_cam")
    assert not rospy.has_param("/usb_cam")


def test_another_launch_file_may_pass_on_its_own_arguments(start, tmp_path):
    theirs = tmp_path / "camera.launch"
    theirs.write_text(
        f"""<launch><arg name="robot"/><arg name="map" default="/map.yaml"/>
        <include file="{LAUNCH}/camera.launch" pass_all_args="true"/></launch>"""
    )
    # It runs in its own process, because it reads the process's command line.
    command = ["roslaunch", "--dump-params", theirs, "robot:=a", "source:=synthetic"]
    result = subprocess.run(command, stdout=subprocess.PIPE, text=True, timeout=60, check=True)
    parameters = yaml.safe_load(result.stdout)
    assert parameters["/usb_cam/source"] == "synthetic"


def test_the_camera_s_parameters_are_arguments():
    before = parameters_of("camera.launch")
    given = {"image_width": 320, "image_height": 240, "framerate": 5, "camera_name": "7"}
    given.update(pixel_format="mjpeg", source="/a.mp4", scene="calibration", poster="auto")
    given.update(views="stereo", depth_noise="tof", meshes="mug,/home/me/a.stl")
    after = parameters_of("camera.launch", *(f"{name}:={value}" for name, value in given.items()))
    assert after == {**before, **{"/usb_cam/" + name: value for name, value in given.items()}}


@pytest.mark.parametrize("name, parameter, argument", texts())
def test_a_text_of_digits_stays_a_text(monkeypatch, tmp_path, name, parameter, argument):
    """Serial numbers of cameras are such texts; XML-RPC could not even send them as numbers."""
    digits = "200901010001"
    (tmp_path / digits).write_text("{}")  # it may be the name of a file
    monkeypatch.chdir(tmp_path)
    parameters = parameters_of(name, f"{argument}:={digits}")
    # A second node of the file may have this parameter, too.
    assert digits in [value for key, value in parameters.items() if key.endswith("/" + parameter)]


@pytest.mark.parametrize("name", [name for name, _, argument in texts() if argument == "config"])
def test_values_of_a_users_file_are_kept(tmp_path, name):
    """A user's file takes the place of ours, and default arguments do not override it."""
    nodes = ElementTree.parse(LAUNCH / name).iter("node")
    (node,) = (node for node in nodes if node.find("rosparam[@file='$(arg config)']") is not None)
    names = {param.get("name") for param in node.iter("param")} - {"config_file"}
    values = {key: f"their {key}" for key in names | {"video_device"}}
    theirs = tmp_path / "theirs.yaml"
    theirs.write_text(yaml.safe_dump(values))
    name_of_node = node.get("name").replace("$(arg camera)", "camera")
    given = {f"/{name_of_node}/{key}": value for key, value in values.items()}
    assert given.items() <= parameters_of(name, f"config:={theirs}").items()


def test_the_host_with_the_camera_passes_the_source_on_unchanged():
    parameters = parameters_of("remote.launch", "part:=capture", "source:=0042")
    assert parameters["/usb_cam/source"] == "0042"


@pytest.mark.parametrize(
    "name, arguments, changed",
    [
        ("camera", ["synthetic:=true"], {"source": "synthetic"}),
        ("rgbd", ["depth_noise:=kinect"], {"depth_noise": "kinect"}),
        ("freenect", ["device_id:=#2"], {"source": "freenect:#2"}),
        ("freenect", ["device_id:=0000000000000000"], {"source": "freenect:0000000000000000"}),
        ("freenect", ["rgb_frame_id:=eye", "publish_tf:=false"], {"publish_tf": False}),
        ("apriltag", ["synthetic:=true"], {"tag_size": 0.24}),
        ("apriltag", ["synthetic:=true", "tag_size:=0.3"], {"tag_size": 0.3}),
        (
            "apriltag",
            ["depth_transport:=compressedDepth"],
            {"depth_image_transport": "compressedDepth"},
        ),
        ("ball_tracker", ["synthetic:=true"], {"ball_diameter": 0.2}),
        ("ball_tracker", ["ball_diameter:=0.1"], {"ball_diameter": 0.1}),
        ("ball_tracker", ["color:=green"], {"h_low": 36, "h_high": 85, "v_low": 40}),
        ("line_follower", ["synthetic:=true"], {"h_high": 180, "s_low": 0, "v_high": 60}),
        ("line_follower", ["synthetic:=true", "color:=blue"], {"h_low": 90, "h_high": 120}),
        ("motion_detector", ["synthetic:=true"], {"method": "previous_frame"}),
        ("motion_detector", ["synthetic:=true", "method:=mog2"], {"method": "mog2"}),
        ("lane_detector", ["synthetic:=true"], {}),
        (
            "lane_detector",
            ["ground:=points", "lane_width:=3.5"],
            {"ground": "points", "lane_width": 3.5},
        ),
        ("cube_overlay", ["synthetic:=true"], {"square": 0.05}),
        ("cube_overlay", ["board:=acircles", "columns:=4"], {"board": "acircles", "columns": 4}),
        ("code_reader", ["synthetic:=true"], {}),
        ("hough", ["method:=circles", "circle_method:=gradient_alt"], {"method": "circles"}),
        ("contours", ["invert:=true", "draw:=hull"], {"invert": True, "draw": "hull"}),
        ("contours", ["template_file:=/a.png"], {"template_file": "/a.png"}),
        ("dense_flow", ["method:=farneback"], {"method": "farneback"}),
        ("dense_flow", ["draw:=arrows"], {"draw": "arrows"}),
        ("spectrum", ["filter:=low_pass", "radius:=0.2"], {"filter": "low_pass", "radius": 0.2}),
        ("stereo", ["method:=bm", "disparities:=96"], {"method": "bm", "disparities": 96}),
        ("stereo", ["epipolar:=fundamental", "slop:=0.02"], {"slop": 0.02}),
        ("depth_registration", ["color:=false", "threads:=2"], {"color": False, "threads": 2}),
        (
            "depth_registration",
            ["depth_transport:=compressedDepth", "color_transport:=compressed"],
            {"depth_image_transport": "compressedDepth", "image_transport": "compressed"},
        ),
        (
            "detections_3d",
            ["shape:=sphere", "frame_prefix:=a_"],
            {"shape": "sphere", "frame_prefix": "a_"},
        ),
        ("tabletop", ["synthetic:=true"], {"vertical_frame": "scene/line"}),
        (
            "tabletop",
            ["vertical_frame:=base_link", "max_distance:=2.0"],
            {"vertical_frame": "base_link", "max_distance": 2.0},
        ),
        ("features", ["synthetic:=true"], {}),
        ("features", ["detector:=akaze", "max_features:=9"], {"max_features": 9}),
        ("features", ["match:=last_frame", "reference:=/a.png"], {"match": "last_frame"}),
        ("features", ["match:=last_frame", "matcher:=flow"], {"matcher": "flow"}),
        ("template_matcher", ["synthetic:=true"], {}),
        ("template_matcher", ["templates:=/a", "results:=multiple"], {"templates": "/a"}),
        ("template_matcher", ["method:=ccorr"], {"method": "ccorr"}),
        (
            "dashboard",
            ["address:=0.0.0.0", "port:=0", "browser:=true"],
            {"address": "0.0.0.0", "port": 0, "open_browser": True},
        ),
        (
            "dashboard",
            ["open_streams:=true", "foxglove:=true", "bag_folder:=/b", "view_token:=12345678"],
            {"open_streams": True, "foxglove": True, "bag_folder": "/b", "view_token": "12345678"},
        ),
    ],
)
def test_arguments_set_parameters(name, arguments, changed):
    before, after = (parameters_of(name + ".launch", *given) for given in ([], arguments))
    differ = {key: value for key, value in after.items() if before.get(key) != value}
    others = {
        "apriltag": "apriltag_detector",
        "camera": "usb_cam",
        "freenect": "camera",
        "rgbd": "camera",
        "stereo": "stereo_matcher",
    }
    node = others.get(name, name)
    assert (
        changed.items() <= {key.rpartition("/")[2]: value for key, value in differ.items()}.items()
    )
    assert all(key.startswith(f"/{node}/") for key in differ)
    assert bool(changed) == bool(differ) and after.keys() >= before.keys()


def test_the_other_image_of_a_chain_is_that_of_a_topic_that_is_given():
    (node,) = loaded("filter.launch", "second:=/other/image_raw").nodes
    assert dict(node.remap_args)["second"] == "/other/image_raw"
    before, after = (
        parameters_of("filter.launch", *words) for words in ([], ["second:=/other/image_raw"])
    )
    assert after == {**before, "/filter/use_second": True}
    (node,) = loaded("filter.launch").nodes
    assert "second" not in dict(node.remap_args) and not before["/filter/use_second"]


@pytest.mark.parametrize(
    "name", ["histogram", "object_tracker", "segmenter", "template_matcher", "window_tracker"]
)
def test_what_is_dragged_in_a_node_s_window_goes_to_the_node(name):
    nodes = {node.name: node for node in loaded(f"{name}.launch", "view:=true").nodes}
    window = nodes[f"{name}_view"]
    assert window.type == "simple_camera_view_node.py"
    topics = {"image": f"{name}/processed_image", "~selected": f"{name}/select"}
    if name == "segmenter":
        topics["~clicked"] = "segmenter/click"
    assert dict(window.remap_args) == topics


def test_tags_have_a_depth_image_where_one_is_given():
    (node,) = loaded("apriltag.launch").nodes
    assert "depth" not in dict(node.remap_args)
    topic = "/camera/depth_registered/image_raw"
    (node,) = loaded("apriltag.launch", f"depth:={topic}").nodes
    assert dict(node.remap_args)["depth"] == topic
    assert parameters_of("apriltag.launch", f"depth:={topic}") == parameters_of("apriltag.launch")


def test_a_pair_of_cameras_is_started_where_it_is_asked_for():
    nodes = {node.name for node in loaded("stereo.launch").nodes}
    assert nodes == {"stereo_matcher"}
    words = "camera:=true", "source:=/a.mp4"
    (matcher,) = (node for node in loaded("stereo.launch", *words).nodes if node.name != "usb_cam")
    names = ("left/image_raw", "left/camera_info", "right/image_raw", "right/camera_info")
    assert dict(matcher.remap_args) == {name: "usb_cam/" + name for name in names}
    parameters = parameters_of("stereo.launch", *words)
    assert (parameters["/usb_cam/source"], parameters["/usb_cam/views"]) == ("/a.mp4", "stereo")
    assert "/usb_cam/source" not in parameters_of("stereo.launch")
    (matcher,) = loaded("stereo.launch", "stereo:=/eyes").nodes
    assert dict(matcher.remap_args)["left/image_raw"] == "/eyes/left/image_raw"
    (matcher,) = loaded("stereo.launch").nodes
    assert dict(matcher.remap_args)["left/image_raw"] == "/usb_cam/left/image_raw"
    for name in ("/robot/usb_cam", "usb_cam/"):  # as included in a namespace
        assert len(loaded("stereo.launch", f"stereo:={name}", *words).nodes) == 2
    with pytest.raises(roslaunch.RLException, match="whose pair is usb_cam and not /eyes,"):
        loaded("stereo.launch", "stereo:=/eyes", *words)


def test_a_camera_info_beside_the_depth_is_not_remapped():
    words = "detections:=/tracker/objects", "depth:=/depth/image"
    (node,) = loaded("detections_3d.launch", *words).nodes
    assert dict(node.remap_args) == {"detections": "/tracker/objects", "depth": "/depth/image"}
    (node,) = loaded("detections_3d.launch", "camera_info:=/color/camera_info").nodes
    assert dict(node.remap_args)["camera_info"] == "/color/camera_info"


def test_a_kinect_s_names_begin_with_that_of_its_camera():
    nodes = {node.namespace + node.name: node for node in loaded("freenect.launch").nodes}
    assert nodes.keys() == {
        "/camera",
        "/camera/camera_nodelet_manager",
        "/camera/depth_registration",
    }
    head = loaded("freenect.launch", "camera:=head").nodes
    names = {node.namespace + node.name: node.args for node in head}
    assert names["/head"] == "load robot_vision/camera head/head_nodelet_manager"
    registration = names["/head/depth_registration"]
    assert registration == "load robot_vision/depth_registration head_nodelet_manager"
    parameters = parameters_of("freenect.launch", "camera:=head")
    assert parameters["/head/camera_name"] == "head"
    assert parameters["/head/camera_frame_id"] == "head_rgb_optical_frame"
    before = parameters_of("freenect.launch")
    assert before["/camera/camera_name"] == "camera"
    assert before["/camera/camera_frame_id"] == "camera_rgb_optical_frame"
    words = "load_driver:=false", "depth_registration:=false"
    (manager,) = loaded("freenect.launch", *words).nodes
    assert manager.args == "manager"


OF_OTHERS = {  # nodes of other packages, viewers, and what has a manager already
    *("calibrate", "calibrate_stereo", "cameracheck", "rectify", "simple_camera_view"),
    *("usb_cam-test", "demo", "remote", "cameras", "freenect", "rgbd"),
    *("light", "dashboard"),
}
NODES = sorted(path.stem for path in LAUNCH.glob("*.launch") if path.stem not in OF_OTHERS)


@pytest.mark.parametrize("name", NODES)
def test_a_node_is_a_process_or_loaded_into_a_manager(name):
    """With the same name, parameters and remappings."""
    alone, in_manager = (loaded(f"{name}.launch", *words) for words in ([], ["manager:=eyes"]))
    (process,), (loader,) = alone.nodes, in_manager.nodes
    kind = re.sub(r"(_node|\.py)$", "", process.type)
    assert (process.package, process.args) == ("robot_vision", "")
    assert (loader.package, loader.type) == ("nodelet", "nodelet")
    assert loader.args == f"load robot_vision/{'camera' if kind == 'usb_cam' else kind} eyes"
    assert loader.name == process.name and loader.remap_args == process.remap_args
    values = [
        {key: param.value for key, param in one.params.items()} for one in (alone, in_manager)
    ]
    assert values[0] == values[1]


@pytest.mark.parametrize(
    "name, words, loaders",
    [
        ("rgbd", [], {"camera", "depth_registration"}),
        ("freenect", ["camera:=head"], {"head", "depth_registration"}),
        ("stereo", ["camera:=true"], {"usb_cam", "stereo_matcher"}),
        ("object_detector", ["depth:=/depth"], {"object_detector", "detections_3d"}),
        ("remote", ["part:=capture"], {"usb_cam"}),
        ("remote", ["part:=processing"], {"edge_detector"}),
    ],
)
def test_what_a_launch_file_starts_besides_goes_into_the_same_manager(name, words, loaders):
    nodes = loaded(f"{name}.launch", *words, "manager:=/eyes").nodes
    args = {node.name: node.args for node in nodes if node.package == "nodelet"}
    assert args.keys() == loaders
    assert all(re.fullmatch(r"load robot_vision/\w+ /eyes", each) for each in args.values())


def test_a_small_computer_runs_the_nodes_that_are_named():
    words = "source:=synthetic", "image_width:=160"
    config = loaded("light.launch", "nodes:=hsv_tracker,apriltag", *words)
    nodes = {node.name: node for node in config.nodes}
    assert nodes.keys() == {"vision", "usb_cam", "hsv_tracker", "apriltag_detector"}
    assert nodes.pop("vision").type == "python_manager.py"
    assert all(node.args.endswith(" vision") for node in nodes.values())
    values = {name: param.value for name, param in config.params.items()}
    sizes = [values[f"/usb_cam/{name}"] for name in ("image_width", "image_height", "framerate")]
    assert sizes == [160, 240, 15]
    assert values["/apriltag_detector/tag_size"] == 0.24
    assert {node.name for node in loaded("light.launch", "dashboard:=true").nodes} == {
        *("vision", "usb_cam", "line_follower", "dashboard")
    }


@pytest.mark.parametrize(
    "name, words, topic",
    [
        ("line_follower", [], "cmd_vel"),
        ("line_follower", ["synthetic:=true"], "line_follower/cmd_vel"),
        ("line_follower", ["synthetic:=true", "cmd_vel:=wheels"], "wheels"),
        ("light", [], "line_follower/cmd_vel"),
        ("light", ["source:=synthetic"], "line_follower/cmd_vel"),
        ("light", ["cmd_vel:=cmd_vel"], "cmd_vel"),
    ],
)
def test_a_robot_drives_only_when_it_is_asked_to(name, words, topic):
    (follower,) = (
        node for node in loaded(f"{name}.launch", *words).nodes if node.name == "line_follower"
    )
    assert dict(follower.remap_args)["cmd_vel"] == topic


@pytest.mark.parametrize(
    "name, words, topics",
    [
        (
            "light",
            {"nodes": "line_follower,ball_tracker,apriltag", "cmd_vel": "cmd_vel"},
            {
                "line_follower": {"image": "/b/usb_cam/image_raw", "cmd_vel": "/b/cmd_vel"},
                "ball_tracker": {"image": "/b/usb_cam/image_raw"},
                "apriltag_detector": {"image": "/b/usb_cam/image_raw"},
            },
        ),
        (
            "remote",
            {"part": "processing"},
            {
                "remote_camera": {"out": "/b/remote_camera/image_raw"},
                "edge_detector": {"image": "/b/remote_camera/image_raw"},
            },
        ),
    ],
)
def test_a_robot_s_nodes_have_the_images_of_its_own_camera(tmp_path, name, words, topics):
    """Where several robots share a master, each has a namespace."""
    arguments = "".join(f'<arg name="{word}" value="{value}"/>' for word, value in words.items())
    path = tmp_path / "robot.launch"
    path.write_text(
        f'<launch><group ns="b"><include file="{LAUNCH}/{name}.launch">{arguments}</include>'
        "</group></launch>"
    )
    nodes = {node.name: node for node in loaded(path).nodes}
    for node, expected in topics.items():
        names = resolved(nodes[node])
        assert {of: names[of] for of in expected} == expected
    assert all(node.namespace == "/b/" for node in nodes.values())


@pytest.mark.parametrize("name", ["rectify", "calibrate", "cameracheck"])
def test_an_image_in_no_namespace_that_can_be_told_is_refused(name):
    with pytest.raises(roslaunch.RLException, match="image with its namespace, as /image_raw or"):
        loaded(f"{name}.launch", "image:=image_raw")


@pytest.mark.parametrize("name", ["rgbd", "freenect", "demo", "depth_registration"])
def test_parameters_of_depth_registration_can_be_saved(name):
    words = {"demo": ["depth:=true"]}.get(name, [])
    params = loaded(f"{name}.launch", *words).params
    (key,) = (one for one in params if one.endswith("/depth_registration/config_file"))
    assert params[key].value == str(LAUNCH.parent / "config" / "depth_registration.yaml")
    assert key.replace("config_file", "max_jump") in params


def test_a_node_that_light_launch_has_not_is_an_error():
    # It runs in its own process, because it reads the process's command line.
    command = ["roslaunch", "--nodes", LAUNCH / "light.launch", "nodes:=hsv_tracker,huogh"]
    result = subprocess.run(command, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
    assert result.returncode != 0
    assert "nodes without huogh, which light.launch does not have" in result.stderr


def test_cameras_are_loaded_into_a_manager_that_is_there():
    assert parameters_of("cameras.launch")["/camera_loader/manager"] == "camera_manager"
    config = loaded("cameras.launch", "manager:=eyes")
    assert {node.name for node in config.nodes} == {"camera_loader"}
    assert config.params["/camera_loader/manager"].value == "eyes"


@pytest.mark.parametrize("more", [[], ["basics:=true", "depth:=true", "recognition:=true"]])
def test_the_demo_s_nodes_are_in_one_process_or_in_several(more):
    one, several = (
        {node.namespace + node.name: node for node in loaded("demo.launch", *more, word).nodes}
        for word in ("one_process:=true", "one_process:=false")
    )
    managers = {"/vision"}
    assert several.keys() - one.keys() == ({"/table/camera_nodelet_manager"} if more else set())
    assert one.keys() <= several.keys()
    # One ends when it has done its work, the other subscribes to topics of any type as bytes.
    commands = {"/learn_samples", "/dashboard"}
    assert {name for name, node in one.items() if node.package == "robot_vision"} - commands == (
        managers
    )
    assert (one["/vision"].type, several["/vision"].type) == ("python_manager.py", "nodelet")
    for name in one.keys() - managers - commands:
        assert re.fullmatch(r"load robot_vision/\w+ /?vision", one[name].args), name
        assert one[name].required == several[name].required
    python = {name for name, node in several.items() if node.type.endswith(".py")}
    assert {"/hsv_tracker", "/dashboard", "/demo_status"} <= python


def test_every_color_is_a_range():
    files = sorted((LAUNCH.parent / "config" / "colors").glob("*.yaml"))
    assert {"blue", "red", "black"} <= {file.stem for file in files}
    for file in files:
        values = yaml.safe_load(file.read_text())
        assert list(values) == ["h_low", "s_low", "v_low", "h_high", "s_high", "v_high"], file
        assert all(0 <= values[name] <= (180 if name[0] == "h" else 255) for name in values)


def test_a_color_of_the_launch_file_is_that_of_its_file(monkeypatch):
    """Also blue, of which config/hsv_tracker.yaml has limits in lists."""
    for file in (LAUNCH.parent / "config" / "colors").glob("*.yaml"):
        there = {}
        for path, param in parameters_of("hsv_tracker.launch", f"color:={file.stem}").items():
            *spaces, name = path.replace("/hsv_tracker/", "~").split("/")
            place = there
            for space in spaces:
                place = place.setdefault(space, {})
            place[name] = param
        use_params(monkeypatch, there)
        found = NamedColors().ranges[file.stem]
        values = yaml.safe_load(file.read_text())
        assert [*found.low, *found.high] == list(values.values())


def test_demo_sets_the_parameters_of_its_launch_files():
    demo = parameters_of("demo.launch")
    for name in ("line_follower", "motion_detector", "ball_tracker", "apriltag"):
        alone = parameters_of(name + ".launch", "synthetic:=true")
        assert alone.items() <= demo.items(), name
    device = parameters_of("demo.launch", "source:=/dev/video0")
    assert device["/apriltag_detector/tag_size"] == 0.1
    assert device["/motion_detector/method"] == "first_frame"
    assert device["/ball_tracker/ball_diameter"] == 0.0


def test_the_scene_s_things_are_detected_in_the_scene_alone():
    synthetic, device = (
        {node.name for node in loaded("demo.launch", *words).nodes}
        for words in ([], ["source:=/dev/video0"])
    )
    assert synthetic - device == set(demo_status.SYNTHETIC) and device < synthetic
    parameters = parameters_of("demo.launch")
    assert parameters["/demo_status/synthetic"]
    assert parameters["/object_detector/always_subscribe"]
    assert not parameters_of("demo.launch", "source:=/dev/video0")["/demo_status/synthetic"]


def test_what_the_network_finds_is_located_where_there_is_depth():
    assert {node.name for node in loaded("object_detector.launch").nodes} == {"object_detector"}
    nodes = {
        node.name: node
        for node in loaded(
            "object_detector.launch", "depth:=/eye/depth", "camera_info:=/eye/info"
        ).nodes
    }
    assert remapped(nodes["detections_3d"]) == {
        "/detections": "/object_detector/objects",
        "/depth": "/eye/depth",
        "/camera_info": "/eye/info",
    }


def test_basics_are_an_optional_part_of_the_demo():
    nodes, more = (
        {node.name for node in loaded("demo.launch", *words).nodes}
        for words in ([], ["basics:=true"])
    )
    assert more - nodes == set(demo_status.BASICS) and nodes < more
    parameters = parameters_of("demo.launch", "basics:=true")
    assert all(parameters[f"/{name}/always_subscribe"] for name in demo_status.BASICS)
    assert parameters["/demo_status/basics"]
    with_windows = loaded("demo.launch", "basics:=true", "view:=true").nodes
    windows = {node.name for node in with_windows if "view" in node.type}
    assert windows >= {f"{name}_view" for name in demo_status.BASICS}


def remapped(node):
    """What a node's remappings make of the names in them, which are global."""
    return {f"/{name.lstrip('/')}": f"/{to.lstrip('/')}" for name, to in node.remap_args}


@pytest.mark.parametrize("word, windows", [("false", 0), ("true", 1), ("windows", 1)])
def test_the_demo_has_windows_only_where_they_are_asked_for(word, windows):
    nodes = {node.name for node in loaded("demo.launch", f"view:={word}").nodes}
    assert "dashboard" in nodes
    assert ("camera_view" in nodes) == ("hsv_tracker_view" in nodes) == bool(windows)
    parameters = parameters_of("demo.launch", f"view:={word}")
    assert parameters["/demo_status/view"] == parameters["/demo_status/dashboard"] ^ (not windows)
    assert parameters["/hsv_tracker/always_subscribe"] is not bool(windows)


def test_the_demo_takes_no_other_word_for_its_windows():
    with pytest.raises(roslaunch.RLException):
        loaded("demo.launch", "view:=widnows")


def test_the_demo_opens_a_browser_where_it_is_asked_for():
    assert not parameters_of("demo.launch")["/dashboard/open_browser"]
    parameters = parameters_of("demo.launch", "browser:=true", "port:=8090")
    assert parameters["/dashboard/open_browser"]
    assert parameters["/dashboard/port"] == 8090


def test_depth_is_an_optional_part_of_the_demo():
    nodes, more = (
        {node.name: node for node in loaded("demo.launch", *words).nodes}
        for words in ([], ["depth:=true", "rviz:=true"])
    )
    assert more.keys() - nodes.keys() == {*demo_status.DEPTH, "rviz"} and nodes.keys() < more.keys()
    parameters = parameters_of("demo.launch", "depth:=true")
    assert (parameters["/usb_cam/views"], parameters["/demo_status/depth"]) == ("rgbd", True)
    assert parameters_of("demo.launch")["/usb_cam/views"] == "one"
    topic = demo_status.DEPTH["depth_registration"]
    assert remapped(more["depth_registration"])["/depth_registered/image_raw"] == topic
    with_windows = loaded("demo.launch", "depth:=true", "view:=true").nodes
    (window,) = (node for node in with_windows if node.name == "depth_registration_view")
    assert remapped(window)["/image"] == topic


@pytest.mark.parametrize("one_process", [False, True])
def test_recognition_is_an_optional_part_of_the_demo(monkeypatch, one_process):
    monkeypatch.setenv("ROS_HOME", "/home/a robot/.ros")
    way = f"one_process:={one_process}"
    nodes, more = (
        {node.name for node in loaded("demo.launch", way, *words).nodes}
        for words in ([], ["recognition:=true"])
    )
    table = {"camera_nodelet_manager", "camera", "depth_registration", "learn_samples"}
    if one_process:
        table.remove("camera_nodelet_manager")
    assert more - nodes == {*demo_status.RECOGNITION, *table} and nodes < more
    parameters = parameters_of("demo.launch", "recognition:=true")
    assert parameters["/table/camera/scene"] == "tabletop"
    assert parameters["/demo_status/recognition"]
    assert "box" not in parameters["/table/camera/meshes"].split(",")
    (learning,) = (
        node
        for node in loaded("demo.launch", "recognition:=true").nodes
        if node.name == "learn_samples"
    )
    database = parameters["/object_recognizer/database"]
    things = parameters["/table/camera/meshes"].split(",")
    assert shlex.split(learning.args) == ["--database", database, *things]


@pytest.mark.parametrize("name", ["demo", "rgbd"])
def test_rviz_shows_topics_that_are_there(name):
    """Of its own configuration, as the launch file remaps them."""
    nodes = loaded(f"{name}.launch", "rviz:=true", *["depth:=true"][: name == "demo"]).nodes
    (rviz,) = (node for node in nodes if node.name == "rviz")
    assert (rviz.package, rviz.type) == ("rviz", "rviz")
    words = rviz.args.split()
    assert words[0] == "-d"
    shown = yaml.safe_load(pathlib.Path(words[1]).read_text())["Visualization Manager"]
    frame = words[3] if words[2:3] == ["-f"] else shown["Global Options"]["Fixed Frame"]
    camera = next(key for key in parameters_of(f"{name}.launch") if key.endswith("camera_frame_id"))
    assert frame == parameters_of(f"{name}.launch")[camera]
    topics = {
        remapped(rviz).get(display[key], display[key])
        for display in shown["Displays"]
        for key in ("Topic", "Image Topic", "Marker Topic")
        if key in display
    }
    space = camera.rpartition("/")[0]
    registered = {f"{space}/depth_registered/{one}" for one in ("image_raw", "points")}
    color = "/usb_cam/image_raw" if name == "demo" else "/camera/rgb/image_raw"
    assert topics >= registered | {color}
    if name == "demo":
        finders = {"apriltag_detector", "tabletop", "detections_3d"}
        assert finders <= {node.name for node in nodes}
        assert topics >= {f"/{finder}/markers" for finder in finders}


def test_a_camera_in_the_root_namespace_is_rectified(start):
    topics = [f"~{name}:=/{name}" for name in ("image_raw", "camera_info")]
    start("camera_node", "__name:=eye", "_source:=synthetic", *topics)
    rectified = support.Messages("/image_rect_color", Image)
    start(ROSLAUNCH, "robot_vision", "rectify.launch", "image:=/image_raw")
    assert rectified.wait()[0].encoding == "bgr8"


def resolved(node):
    """What a node's names are remapped to, as it resolves that in its namespace."""
    name = node.namespace + node.name
    return {of: rosgraph.names.resolve_name(to, name) for of, to in node.remap_args}


@pytest.mark.parametrize(
    "image, namespace",
    [
        ("eyes/image_color", "/robot/eyes"),
        ("/eyes/image_color", "/eyes"),
        ("/image_color", ""),
    ],
)
def test_a_camera_is_rectified_where_it_is(tmp_path, image, namespace):
    """Also one that is named as other launch files take it, in a group of its robot."""
    path = tmp_path / "robot.launch"
    path.write_text(
        f'<launch><group ns="robot"><include file="{LAUNCH}/cameracheck.launch">'
        f'<arg name="image" value="{image}"/></include></group></launch>'
    )
    nodes = {node.name: node for node in loaded(path).nodes}
    assert nodes["rectify"].namespace.rstrip("/") == namespace
    names = resolved(nodes["rectify"])
    assert names["image_raw"] == f"{namespace}/image_color"
    assert names["camera_info"] == f"{namespace}/camera_info"
    assert resolved(nodes["cameracheck"])["monocular"] == (namespace or "/")


def test_a_remote_detector_has_its_camera_s_calibration():
    """As docs/several_machines.md starts it, by the names that a launch file remaps."""
    page = (LAUNCH.parent / "docs" / "several_machines.md").read_text()
    (line,) = re.findall(r"roslaunch robot_vision (.* camera_info:=/usb_cam/camera_info)\n", page)
    name, *arguments = line.split()
    for launch_file in (name, "ball_tracker.launch", "rectify.launch"):
        (node,) = loaded(launch_file, *arguments).nodes
        names = resolved(node)
        assert names["camera_info"] == "/usb_cam/camera_info"
        assert "/remote_camera/image_raw" in names.values()
    (node,) = loaded(name, "image:=/front/image_raw").nodes
    assert "camera_info" not in dict(node.remap_args)  # the node finds camera_info beside the image
