"""The camera node on files and the synthetic scene: what it publishes, and when it ends."""

import contextlib
import http.server
import itertools
import os
import pathlib
import re
import subprocess
import threading
import time

import cv2
import numpy as np
import pytest
import rospy
import support
import tf2_msgs.msg
import yaml
from frames import pixels
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image
from sensor_msgs.srv import SetCameraInfo
from std_srvs.srv import Empty, Trigger

from robot_vision import Scene, SceneParams
from robot_vision.msg import GroundTruth


@pytest.fixture
def gray_video(tmp_path):
    """A video at 10 Hz whose frame i has the gray level 20 * i everywhere."""
    path = str(tmp_path / "ramp.avi")
    writer = cv2.VideoWriter(path, cv2.CAP_FFMPEG, cv2.VideoWriter_fourcc(*"MJPG"), 10, (64, 48))
    for i in range(12):
        writer.write(np.full((48, 64, 3), 20 * i, np.uint8))
    writer.release()
    return path


def test_scene_comes_with_its_ground_truth(start):
    truths = support.Messages("/camera/ground_truth", GroundTruth)
    images = support.Messages("/camera/image_raw", Image)
    infos = support.Messages("/camera/camera_info", CameraInfo)
    transforms = support.Messages("/tf", tf2_msgs.msg.TFMessage)
    start("camera_node", "_source:=synthetic", "_camera_frame_id:=eye")
    image, info, truth, tf = support.same_frame(images, infos, truths, transforms)
    scene = Scene(SceneParams())
    assert (image.encoding, image.header.frame_id) == ("bgr8", "eye")
    assert np.array_equal(pixels(image), scene.render(truth.frame))
    assert info.header.frame_id == truth.header.frame_id == "eye"
    assert np.allclose(np.reshape(info.K, (3, 3)), scene.camera.K)
    assert np.allclose(info.D, scene.camera.D) and info.distortion_model == "plumb_bob"
    objects = scene.truth(truth.frame).objects
    assert len(truth.objects) == len(tf.transforms) == len(objects) > 5
    for sent, transform, exact in zip(truth.objects, tf.transforms, objects):
        assert transform.child_frame_id == "scene/" + exact.name == "scene/" + sent.name
        position = sent.pose.position
        assert np.allclose([position.x, position.y, position.z], exact.pose[:3, 3])
        shift = transform.transform.translation
        assert np.allclose([shift.x, shift.y, shift.z], exact.pose[:3, 3])
        q = transform.transform.rotation
        x_axis = [
            1 - 2 * (q.y**2 + q.z**2),
            2 * (q.x * q.y + q.w * q.z),
            2 * (q.x * q.z - q.w * q.y),
        ]
        assert np.allclose(x_axis, exact.pose[:3, 0])
        assert np.allclose([sent.center.x, sent.center.y], exact.center)
        assert np.allclose([[p.x, p.y] for p in sent.outline], exact.outline)
        assert sent.visible == exact.visible


def test_default_frame_id_is_that_of_usb_cam(start):
    images = support.Messages("/camera/image_raw", Image)
    start("camera_node", "_source:=synthetic")
    assert images.wait()[0].header.frame_id == "head_camera"
    assert rospy.get_param("/camera/loop") is False


def test_image_mono_is_the_gray_image(start):
    raw = support.Messages("/camera/image_raw", Image)
    mono = support.Messages("/camera/image_mono", Image)
    start("camera_node", "_source:=synthetic", "_image_width:=64", "_image_height:=64")
    image, gray = support.same_frame(raw, mono)
    assert gray.encoding == "mono8"
    assert gray.header.frame_id == image.header.frame_id
    assert np.array_equal(pixels(gray), cv2.cvtColor(pixels(image), cv2.COLOR_BGR2GRAY))


@pytest.mark.parametrize(
    "wanted, published, code",
    [
        ("rgb8", "rgb8", cv2.COLOR_BGR2RGB),
        ("mono8", "mono8", cv2.COLOR_BGR2GRAY),
        ("native", "bgr8", None),
    ],
)
def test_images_have_the_output_encoding(start, wanted, published, code):
    images = support.Messages("/camera/image_raw", Image)
    truths = support.Messages("/camera/ground_truth", GroundTruth)
    start("camera_node", "_source:=synthetic", "_output_encoding:=" + wanted)
    image, truth = support.same_frame(images, truths)
    expected = Scene(SceneParams()).render(truth.frame)
    if code is not None:
        expected = cv2.cvtColor(expected, code)
    assert image.encoding == published
    assert image.step == 640 * (1 if published == "mono8" else 3)
    assert np.array_equal(np.frombuffer(image.data, np.uint8), expected.ravel())


@pytest.mark.parametrize("parameter", ["video_device", "source"])
def test_waits_for_a_camera_by_its_name(start, parameter):
    process = start("camera_node", f"_{parameter}:=No Such Camera")
    process.wait_for_output("trying again")
    assert "'No Such Camera' is no camera; there is " in process.output()
    process.interrupt()
    assert process.exit_code() == 0


def test_list_cameras_checks_its_arguments():
    def run(*arguments):
        command = [support.executable("list_cameras"), *arguments]
        done = subprocess.run(command, capture_output=True, text=True, timeout=30)
        return done.returncode, done.stdout, done.stderr

    code, out, err = run("--help")
    assert (code, err) == (0, "") and out.startswith("usage: list_cameras [NAME]")
    assert run("--all")[0] == run("a", "b")[0] == 2
    code, out, err = run("No Such Camera")
    assert (code, out) == (1, "") and err.startswith("'No Such Camera' is no camera; there is ")
    code, out, err = run("/dev/null")
    assert (code, out, err) == (1, "", "/dev/null is no camera\n")


def test_video_plays_at_its_rate_and_ends(start, gray_video):
    images = support.Messages("/camera/image_raw", Image)
    process = start("camera_node", f"_source:={gray_video}")
    assert process.exit_code() == 0, process.output()
    assert "the source has ended" in process.output()

    def to_the_end():
        """Levels and stamps of all frames, but for the first, which nobody has subscribed to.

        The node ends after the last one, which it may not have sent then.
        """
        frames = [(pixels(m).mean(), m.header.stamp.to_sec()) for m in images.received]
        return frames if frames and 197 <= frames[-1][0] < 224 else None

    levels, stamps = np.transpose(support.wait_for(to_the_end, "the last frame"))
    steps = np.diff(levels) / 20
    # The newest frame is sent where two wait, on a machine that stops for so long.
    assert (np.round(steps) >= 1).all() and np.allclose(steps, np.round(steps), atol=0.2), levels
    assert np.median(steps) == pytest.approx(1.0, abs=0.2)
    assert np.median(np.diff(stamps) / np.round(steps)) == pytest.approx(0.1, abs=0.02)


def test_video_plays_at_the_rate_asked_for_and_loops(start, gray_video):
    images = support.Messages("/camera/image_raw", Image)
    start("camera_node", f"_source:={gray_video}", "_framerate:=50", "_loop:=true")
    received = images.wait(40)
    stamps = [m.header.stamp.to_sec() for m in received]
    assert np.median(np.diff(stamps)) == pytest.approx(0.02, abs=0.005)
    levels = [int(pixels(m).mean()) for m in received]
    assert sum(b < a for a, b in zip(levels, levels[1:])) >= 2  # the video began again


def test_looping_keeps_the_rate(start, tmp_path):
    for name in "ab":
        cv2.imwrite(str(tmp_path / f"{name}.png"), np.zeros((48, 64, 3), np.uint8))
    images = support.Messages("/camera/image_raw", Image)
    start("camera_node", f"_source:={tmp_path}", "_loop:=true", "_framerate:=50")
    stamps = np.array([m.header.stamp.to_sec() for m in images.wait(51)])
    # Twice the period from each image to itself; a machine that stops now and then is seen in few.
    assert np.median(stamps[2:] - stamps[:-2]) == pytest.approx(0.04, rel=0.1)


class MjpegServer(http.server.BaseHTTPRequestHandler):
    """A network camera: an endless stream of JPEGs, each of one gray level."""

    protocol_version = "HTTP/1.0"

    def do_GET(self):
        self.send_response(200)
        self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=frame")
        self.end_headers()
        with contextlib.suppress(OSError):  # the reader hangs up
            for i in itertools.count():
                jpeg = cv2.imencode(".jpg", np.full((48, 64, 3), 10 * (i % 20), np.uint8))[1]
                head = "--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n"
                self.wfile.write(head.format(len(jpeg)).encode() + jpeg.tobytes() + b"\r\n")
                time.sleep(0.01)

    def log_message(self, *_):
        pass


def test_network_stream_plays_and_is_waited_for(start):
    port = support.free_port()
    url = f"http://127.0.0.1:{port}/stream.mjpg"
    process = start("camera_node", f"_source:={url}")
    process.wait_for_output(url + ": the stream cannot be opened; trying again")
    images = support.Messages("/camera/image_raw", Image)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", port), MjpegServer)
    server.daemon_threads = True
    threading.Thread(target=server.serve_forever, daemon=True).start()
    levels = {int(round(pixels(m).mean(), -1)) for m in images.wait(30)}
    assert len(levels) > 10 and levels <= set(range(0, 200, 10))
    process.interrupt()
    assert process.exit_code() == 0, process.output()
    server.shutdown()
    server.server_close()


class FailingServer(http.server.BaseHTTPRequestHandler):
    """Has a video, of which it sends only the half to the first who asks."""

    video = b""
    asked = 0

    def do_GET(self):
        self.send_response(200)
        self.send_header("Content-Type", "video/x-msvideo")
        self.send_header("Content-Length", str(len(self.video)))
        self.end_headers()
        type(self).asked += 1
        whole = self.asked > 1
        with contextlib.suppress(OSError):
            self.wfile.write(self.video if whole else self.video[: len(self.video) // 2])

    def log_message(self, *_):
        pass


def test_video_of_a_server_that_fails_is_asked_for_again(start, tmp_path):
    """Its frames are of noise, so that FFmpeg has not read most of them when it opens the video."""
    path = str(tmp_path / "noise.avi")
    writer = cv2.VideoWriter(path, cv2.CAP_FFMPEG, cv2.VideoWriter_fourcc(*"MJPG"), 50, (320, 240))
    noise = np.random.default_rng(1).integers(0, 50, (240, 320, 3))
    for i in range(24):
        writer.write((noise + 8 * i).astype(np.uint8))
    writer.release()
    FailingServer.video = pathlib.Path(path).read_bytes()
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), FailingServer)
    server.daemon_threads = True
    threading.Thread(target=server.serve_forever, daemon=True).start()
    url = f"http://127.0.0.1:{server.server_port}/noise.avi"
    images = support.Messages("/camera/image_raw", Image)
    process = start("camera_node", f"_source:={url}")
    assert process.exit_code() == 0, process.output()
    broke = re.search(
        re.escape(url) + r": the stream broke off after (\d+) of 24 frames; trying",
        process.output(),
    )
    assert broke, process.output()
    assert 5 < int(broke[1]) < 15

    def levels():
        return [pixels(image).mean() for image in list(images.received)]

    support.wait_for(lambda: max(levels(), default=0.0) > 8 * 20, "the end of the video")
    assert any(np.diff(levels()) < 0), "it was not played from its beginning again"
    server.shutdown()
    server.server_close()


def test_deleted_video_ends_a_looping_node(start, gray_video):
    images = support.Messages("/camera/image_raw", Image)
    process = start("camera_node", f"_source:={gray_video}", "_framerate:=50", "_loop:=true")
    images.wait(20)
    os.unlink(gray_video)
    assert process.exit_code() == 1
    assert "FATAL" in process.output() and gray_video in process.output()


@pytest.fixture
def half_a_video(gray_video):
    half = pathlib.Path(gray_video).with_name("half.avi")
    whole = pathlib.Path(gray_video).read_bytes()
    half.write_bytes(whole[: len(whole) * 3 // 4])
    return half


def test_truncated_video_plays_to_its_end_and_exits_1(start, half_a_video):
    images = support.Messages("/camera/image_raw", Image)
    process = start("camera_node", f"_source:={half_a_video}")
    assert process.exit_code() == 1
    assert f"{half_a_video}: truncated or damaged, only" in process.output()
    assert "FATAL" in process.output()
    images.wait()


def test_exits_at_the_end_of_a_video_although_the_master_is_stopped(start, half_a_video):
    master = support.Master(start)
    arguments = [f"_source:={half_a_video}", "_framerate:=0.6", "_always_subscribe:=true"]
    process = start("camera_node", *arguments, env=master.env)
    with support.service_of(master.api, "/camera/save_parameters") as service:
        rospy.ServiceProxy(service, Trigger)()  # the node answers when it has started
    with support.standing_still(master.process):
        assert process.exit_code() == 1, process.output()
    assert f"{half_a_video}: truncated or damaged, only" in process.output()


@pytest.mark.parametrize(
    "name, reason",
    [("missing.mp4", "no such file or folder"), ("folder", "no images that OpenCV can read")],
)
def test_wrong_source_exits_1_naming_the_path(start, tmp_path, name, reason):
    """The gtest Sources.areNamedIfTheyAreWrong has the other kinds of wrong files."""
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "notes.txt").write_text("no image")
    path = tmp_path / name
    process = start("camera_node", f"_source:={path}")
    assert process.exit_code() == 1
    fatal = [line for line in process.output().splitlines() if "FATAL" in line]
    assert len(fatal) == 1 and str(path) in fatal[0] and reason in fatal[0], process.output()


def test_missing_device_is_retried(start, diagnostics, tmp_path):
    device = f"/dev/robot_vision_test_{os.getpid()}"
    process = start("camera_node", "__name:=retry", f"_source:={device}")
    process.wait_for_output(device + ": cannot be opened: No such file or directory")

    def in_error():
        status = diagnostics.next("retry")
        return status.level == 2 and device in status.message

    support.wait_for(in_error, "the error on /diagnostics")
    assert process.running()


def test_damaged_images_of_a_folder_are_refused_and_counted(start, diagnostics, tmp_path):
    whole = cv2.imencode(".jpg", np.full((48, 64, 3), 99, np.uint8))[1].tobytes()
    (tmp_path / "a.jpg").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "b.jpg").write_bytes(whole)
    images = support.Messages("/camera/image_raw", Image)
    process = start("camera_node", f"_source:={tmp_path}", "_loop:=true")
    received = images.wait(5)
    assert all(abs(int(pixels(m).mean()) - 99) <= 1 for m in received)
    support.wait_for(
        lambda: int(diagnostics.value("camera", "frames refused")) > 0, "the refused one"
    )
    process.wait_for_output(str(tmp_path / "a.jpg"))


def test_capture_stops_and_starts(start, diagnostics):
    start("camera_node", "_source:=synthetic")
    images = support.Messages("/camera/image_raw", Image)
    images.wait()
    rospy.wait_for_service("/camera/stop_capture", support.DEADLINE)
    rospy.ServiceProxy("/camera/stop_capture", Empty)()
    support.wait_for(
        lambda: diagnostics.next("camera").message == "stopped: ~start_capture starts it again",
        "the end of the capture",
    )
    stopped = int(diagnostics.value("camera", "frames received"))
    assert int(diagnostics.value("camera", "frames received")) == stopped
    count = len(images.received)
    rospy.ServiceProxy("/camera/start_capture", Empty)()
    images.wait(count + 1)


def test_capture_goes_on_without_subscribers_if_asked(start, diagnostics):
    start("camera_node", "_source:=synthetic", "_keep_streaming:=true")
    support.wait_for(
        lambda: int(diagnostics.value("camera", "frames received")) > 3, "frames for nobody"
    )


def test_stamps_follow_simulated_time(start):
    """They also do when the time jumps back, as it does when rosbag loops."""
    rospy.set_param("/use_sim_time", True)
    try:
        clock = rospy.Publisher("/clock", Clock, queue_size=1, latch=True)
        images = support.Messages("/camera/image_raw", Image)
        start("camera_node", "_source:=synthetic")
        for seconds in (1000, 2000, 500):
            time_of_clock = rospy.Time(seconds, 250000000)
            clock.publish(Clock(clock=time_of_clock))
            support.wait_for(
                lambda t=time_of_clock: images.received and images.received[-1].header.stamp == t,
                f"a frame at {seconds} s",
            )
        clock.unregister()
    finally:
        rospy.delete_param("/use_sim_time")


def test_calibration_is_set_saved_and_used(start, tmp_path):
    url = f"file://{tmp_path}/calibration.yaml"
    arguments = ["_source:=synthetic", "_camera_info_url:=" + url, "_camera_name:=eye"]
    start("camera_node", *arguments)
    rospy.wait_for_service("/camera/set_camera_info", support.DEADLINE)
    info = CameraInfo(**calibration_of(640, 480))
    assert rospy.ServiceProxy("/camera/set_camera_info", SetCameraInfo)(info).success
    saved = yaml.safe_load((tmp_path / "calibration.yaml").read_text())
    assert saved["camera_name"] == "eye"
    assert saved["camera_matrix"]["data"] == info.K

    start("camera_node", "__name:=next", *arguments)
    for node in ("/camera", "/next"):
        infos = support.Messages(node + "/camera_info", CameraInfo)
        assert list(infos.wait()[0].K) == info.K
        infos.close()


INVALID_CALIBRATIONS = [
    # The wrong fields of a CameraInfo, and the reason why it is refused. The gtest of the camera
    # model has more of both.
    ({"width": 0}, "width is 0, must be 640 as in the camera's images"),
    ({"height": 481}, "height is 481, must be 480 as in the camera's images"),
    ({"K": [0.0] * 9}, "K is 0 everywhere, must be that of a calibrated camera"),
    ({"K": [500, 1e300, 320, 0, 500, 240, 0, 0, 1]}, "K is 1e+300, must be from -1e+06 to 1e+06"),
    ({"K": [500, 0, 320, 0, 500, 240, 0, 0, -1]}, "the last row of K is 0, 0, -1, must be 0, 0, 1"),
    ({"R": [2.0, 0, 0, 0, 1, 0, 0, 0, 1]}, "R is no rotation, must be a rotation matrix"),
    ({"P": [float("nan")] * 12}, "P is nan, must be finite"),
    ({"D": [0.1] * 3}, "D is 3 numbers, must be 0, 4, 5 or 8 of them"),
    ({"distortion_model": "barrel"}, "distortion_model is 'barrel', must be plumb_bob, "),
]


def test_invalid_calibration_is_refused(start, tmp_path):
    """The saved calibration stays in its file and in use."""
    path = tmp_path / "calibration.yaml"
    write_calibration(path, 640, 480)
    saved = path.read_bytes()
    url = f"_camera_info_url:=file://{path}"
    process = start("camera_node", "_source:=synthetic", url)
    infos = support.Messages("/camera/camera_info", CameraInfo)
    infos.wait()
    give = rospy.ServiceProxy("/camera/set_camera_info", SetCameraInfo)
    refused = [(CameraInfo(), "width is 0")] + [
        (CameraInfo(**{**calibration_of(640, 480), **wrong}), reason)
        for wrong, reason in INVALID_CALIBRATIONS
    ]
    for info, reason in refused:
        answer = give(info)
        assert not answer.success and reason in answer.status_message, answer.status_message
        process.wait_for_output("the calibration stays as it is: " + reason)
        assert path.read_bytes() == saved
    assert list(tmp_path.glob("calibration*")) == [path]
    count = len(infos.received)
    assert infos.wait(count + 2)[-1].K[0] == 9.0


def test_calibration_of_any_size_is_taken_before_the_first_image(start, tmp_path):
    """While the camera's size is unknown, everything else is checked."""
    start(
        "camera_node",
        "_source:=/dev/robot_vision_none",
        f"_camera_info_url:=file://{tmp_path}/a.yaml",
    )
    rospy.wait_for_service("/camera/set_camera_info", support.DEADLINE)
    give = rospy.ServiceProxy("/camera/set_camera_info", SetCameraInfo)
    answer = give(CameraInfo())
    assert (answer.success, answer.status_message) == (False, "width is 0, must be at least 1")
    assert not (tmp_path / "a.yaml").exists()
    assert give(CameraInfo(**calibration_of(320, 240))).success
    assert yaml.safe_load((tmp_path / "a.yaml").read_text())["image_width"] == 320


def test_calibration_that_cannot_be_written_is_an_error(start, tmp_path):
    (tmp_path / "file").touch()
    for name, reason in (
        ("file/a.yaml", "Not a directory"),
        ("a.txt", "must end in .yaml, .yml or .ini"),
    ):
        node = f"__name:=eye_{len(name)}"
        start(
            "camera_node", node, "_source:=synthetic", f"_camera_info_url:=file://{tmp_path}/{name}"
        )
        service = f"/{node.split('=')[1]}/set_camera_info"
        rospy.wait_for_service(service, support.DEADLINE)
        answer = rospy.ServiceProxy(service, SetCameraInfo)(CameraInfo(**calibration_of(640, 480)))
        assert not answer.success and reason in answer.status_message, answer.status_message


def calibration_of(width, height):
    """The fields of a valid CameraInfo of this size."""
    return {
        "width": width,
        "height": height,
        "distortion_model": "plumb_bob",
        "D": [0.1, 0, 0, 0, 0],
        "K": [500.0, 0, 320, 0, 501, 240, 0, 0, 1],
        "R": [1.0, 0, 0, 0, 1, 0, 0, 0, 1],
        "P": [500.0, 0, 320, 0, 0, 501, 240, 0, 0, 0, 1, 0],
    }


def write_calibration(path, width, height):
    """Writes a calibration with a focal length of 9 px as camera_calibration saves it."""
    identity, nine = [1.0, 0, 0, 0, 1, 0, 0, 0, 1], [9.0, 0, 0, 0, 9, 0, 0, 0, 1]
    projection = [9.0, 0, 0, 0, 0, 9, 0, 0, 0, 0, 1, 0]
    values = {
        "image_width": width,
        "image_height": height,
        "camera_name": "head_camera",
        "camera_matrix": {"rows": 3, "cols": 3, "data": nine},
        "distortion_model": "plumb_bob",
        "distortion_coefficients": {"rows": 1, "cols": 5, "data": [0.0] * 5},
        "rectification_matrix": {"rows": 3, "cols": 3, "data": identity},
        "projection_matrix": {"rows": 3, "cols": 4, "data": projection},
    }
    path.parent.mkdir(exist_ok=True)
    path.write_text(yaml.safe_dump(values))


def test_the_scenes_own_calibration_precedes_the_users_file(start, tmp_path):
    path = tmp_path / "camera_info" / "head_camera.yaml"
    write_calibration(path, 640, 480)
    image = tmp_path / "image.png"
    cv2.imwrite(str(image), np.zeros((480, 640, 3), np.uint8))
    exact = Scene(SceneParams()).camera.K[0, 0]
    for source, argument, focal_length, said in [
        (image, "", 9.0, "camera_info/head_camera.yaml"),
        ("synthetic", "", exact, "camera_info is the scene's own, exact"),
        ("synthetic", f"file://{path}", 9.0, "camera_info is that of camera_info_url"),
    ]:
        infos = support.Messages("/camera/camera_info", CameraInfo)
        arguments = [f"_source:={source}", "_camera_info_url:=" + argument]
        process = start("camera_node", *arguments, env={"ROS_HOME": str(tmp_path)})
        info = infos.wait()[0]
        assert info.K[0] == pytest.approx(focal_length), source
        process.wait_for_output(said)
        before = path.read_bytes()
        answer = rospy.ServiceProxy("/camera/set_camera_info", SetCameraInfo)(info)
        if focal_length == exact:
            assert not answer.success and path.read_bytes() == before
            assert "exact: camera_info_url must name a file for another" in answer.status_message
        else:
            assert answer.success and answer.status_message == str(path)
        infos.close()
        process.end()


@pytest.mark.parametrize(
    "valid, wrong, reason",
    [
        ("9.0", "-9.0", "K is -9, must be above 0"),
        ("cols: 4", "cols: 3", "projection_matrix is 3x3 with 12 numbers, must be 3x4"),
    ],
)
def test_invalid_calibration_file_is_not_used(start, tmp_path, valid, wrong, reason):
    path = tmp_path / "none.yaml"
    write_calibration(path, 640, 480)
    path.write_text(path.read_text().replace(valid, wrong))
    infos = support.Messages("/camera/camera_info", CameraInfo)
    process = start("camera_node", "_source:=synthetic", f"_camera_info_url:=file://{path}")
    process.wait_for_output(f"not calibrated: {path}")
    process.wait_for_output(reason)
    assert infos.wait()[0].K[0] not in (-9.0, 9.0)
    infos.close()


def test_calibration_of_another_size_is_not_published(start, tmp_path):
    write_calibration(tmp_path / "other.yaml", 320, 240)
    image = tmp_path / "image.png"
    cv2.imwrite(str(image), np.zeros((48, 64, 3), np.uint8))
    infos = support.Messages("/camera/camera_info", CameraInfo)
    url = f"file://{tmp_path}/other.yaml"
    process = start("camera_node", f"_source:={image}", "_camera_info_url:=" + url)
    info = infos.wait()[0]
    assert (info.width, info.height, info.K[0]) == (64, 48, 0.0)
    process.wait_for_output("the calibration is for 320x240, the image has 64x48")
