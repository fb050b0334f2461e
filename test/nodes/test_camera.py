"""The camera node on files and the synthetic scene: what it publishes, and when it ends."""

import contextlib
import http.server
import itertools
import os
import pathlib
import threading
import time

import cv2
import numpy as np
import pytest
import rospy
import support
import tf2_msgs.msg
import yaml
from sensor_msgs.msg import CameraInfo, Image
from sensor_msgs.srv import SetCameraInfo

from robot_vision import Scene, SceneParams
from robot_vision.msg import GroundTruth


def pixels(message):
    """The picture in an Image message."""
    shape = (message.height, message.step)
    rows = np.frombuffer(message.data, np.uint8).reshape(shape)
    channels = 3 if message.encoding == "bgr8" else 1
    return rows.reshape(message.height, message.width, channels).squeeze()


@pytest.fixture
def gray_video(tmp_path):
    """A video whose frame i is all of grey level 20 * i, at 10 Hz."""
    path = str(tmp_path / "ramp.avi")
    writer = cv2.VideoWriter(path, cv2.CAP_FFMPEG, cv2.VideoWriter_fourcc(*"MJPG"), 10, (64, 48))
    for i in range(12):
        writer.write(np.full((48, 64, 3), 20 * i, np.uint8))
    writer.release()
    return path


def test_scene_comes_with_its_truth(start):
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
    for sent, transform, exact in zip(
        truth.objects, tf.transforms, scene.truth(truth.frame).objects
    ):
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


def test_frame_id_is_usb_cam_s_by_default(start):
    images = support.Messages("/camera/image_raw", Image)
    process = start("camera_node", "_source:=synthetic")
    assert images.wait()[0].header.frame_id == "head_camera"
    assert rospy.get_param("/camera/loop") is False
    assert "camera_info/head_camera.yaml" in process.output()


def test_mono_is_the_grey_picture(start):
    raw = support.Messages("/camera/image_raw", Image)
    mono = support.Messages("/camera/image_mono", Image)
    start("camera_node", "_source:=synthetic", "_image_width:=64", "_image_height:=64")
    image, gray = support.same_frame(raw, mono)
    assert gray.encoding == "mono8"
    assert gray.header.frame_id == image.header.frame_id
    assert np.array_equal(pixels(gray), cv2.cvtColor(pixels(image), cv2.COLOR_BGR2GRAY))


def test_video_plays_at_its_rate_and_ends(start, gray_video):
    images = support.Messages("/camera/image_raw", Image)
    process = start("camera_node", f"_source:={gray_video}")
    assert process.exit_code() == 0, process.output()
    assert "the source has ended" in process.output()
    # All but the first few, which pass before the subscription has been made.
    levels = [int(pixels(m).mean()) for m in images.received]
    assert levels[-1] in range(217, 224)
    assert np.allclose(np.diff(levels), 20, atol=4)
    stamps = [m.header.stamp.to_sec() for m in images.received]
    assert np.median(np.diff(stamps)) == pytest.approx(0.1, abs=0.02)


def test_video_plays_at_the_rate_asked_for_and_loops(start, gray_video):
    images = support.Messages("/camera/image_raw", Image)
    start("camera_node", f"_source:={gray_video}", "_framerate:=50", "_loop:=true")
    received = images.wait(40)
    stamps = [m.header.stamp.to_sec() for m in received]
    assert np.median(np.diff(stamps)) == pytest.approx(0.02, abs=0.005)
    levels = [int(pixels(m).mean()) for m in received]
    assert sum(b < a for a, b in zip(levels, levels[1:])) >= 2  # began again


def test_looping_keeps_the_rate(start, tmp_path):
    for name in "ab":
        cv2.imwrite(str(tmp_path / f"{name}.png"), np.zeros((48, 64, 3), np.uint8))
    images = support.Messages("/camera/image_raw", Image)
    start("camera_node", f"_source:={tmp_path}", "_loop:=true", "_framerate:=50")
    stamps = [m.header.stamp.to_sec() for m in images.wait(51)]
    assert (stamps[-1] - stamps[0]) / 50 == pytest.approx(0.02, rel=0.1)


class MjpegServer(http.server.BaseHTTPRequestHandler):
    """A network camera: an endless stream of JPEGs, each of one grey level."""

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
    process.wait_for_output(url + ": the stream cannot be opened; trying again every second")
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


def test_video_that_is_gone_when_it_begins_again(start, gray_video):
    images = support.Messages("/camera/image_raw", Image)
    process = start("camera_node", f"_source:={gray_video}", "_framerate:=50", "_loop:=true")
    images.wait(20)
    os.unlink(gray_video)
    assert process.exit_code() == 1
    assert "FATAL" in process.output() and gray_video in process.output()


def test_truncated_video_plays_what_there_is_and_exits_1(start, gray_video):
    half = pathlib.Path(gray_video).with_name("half.avi")
    whole = pathlib.Path(gray_video).read_bytes()
    half.write_bytes(whole[: len(whole) * 3 // 4])
    images = support.Messages("/camera/image_raw", Image)
    process = start("camera_node", f"_source:={half}")
    assert process.exit_code() == 1
    assert f"{half}: truncated or damaged, only" in process.output()
    assert "FATAL" in process.output()
    assert images.received


@pytest.mark.parametrize(
    "name, content, why",
    [
        ("missing.mp4", None, "no such file or folder"),
        ("empty.mp4", b"", "the file is empty"),
        ("half.mp4", "half a video", "not a picture or video that FFmpeg can read, or truncated"),
        ("text.mp4", b"This is a text.\n" * 100, "not a picture or video"),
        ("text.png", b"hello", "not a picture or video"),
        ("folder", "folder", "no pictures that OpenCV can read"),
        ("*.png", None, "no pictures that OpenCV can read"),
        ("half.jpg", "half a jpeg", "damaged or truncated"),
    ],
)
def test_wrong_source_exits_1_naming_the_path(start, tmp_path, name, content, why):
    path = tmp_path / name
    if content == "folder":
        path.mkdir()
        (path / "notes.txt").write_text("no picture")
    elif content == "half a video":
        fourcc = cv2.VideoWriter_fourcc(*"mp4v")
        writer = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, fourcc, 30, (64, 48))
        for _ in range(20):
            writer.write(np.zeros((48, 64, 3), np.uint8))
        writer.release()
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    elif content == "half a jpeg":
        jpeg = cv2.imencode(".jpg", np.random.RandomState(1).randint(0, 256, (48, 64, 3)))[1]
        path.write_bytes(jpeg.tobytes()[: len(jpeg) // 2])
    elif content is not None:
        path.write_bytes(content)
    process = start("camera_node", f"_source:={path}")
    assert process.exit_code() == 1
    fatal = [line for line in process.output().splitlines() if "FATAL" in line]
    assert len(fatal) == 1 and str(path) in fatal[0] and why in fatal[0], process.output()


def test_missing_device_is_retried_until_it_is_there(start, diagnostics, tmp_path):
    device = f"/dev/robot_vision_test_{os.getpid()}"
    process = start("camera_node", "__name:=retry", f"_source:={device}")
    process.wait_for_output(device + ": cannot be opened: No such file or directory")
    status = diagnostics.next("retry")
    assert status.level == 2 and device in status.message
    assert process.running()


def test_damaged_pictures_of_a_folder_are_refused_and_counted(start, diagnostics, tmp_path):
    whole = cv2.imencode(".jpg", np.full((48, 64, 3), 99, np.uint8))[1].tobytes()
    (tmp_path / "a.jpg").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "b.jpg").write_bytes(whole)
    images = support.Messages("/camera/image_raw", Image)
    process = start("camera_node", f"_source:={tmp_path}", "_loop:=true")
    received = images.wait(5)
    assert all(abs(int(pixels(m).mean()) - 99) <= 1 for m in received)
    assert int(diagnostics.value("camera", "frames refused")) > 0
    assert str(tmp_path / "a.jpg") in process.output()


def test_calibration_is_set_saved_and_used(start, tmp_path):
    url = f"file://{tmp_path}/calibration.yaml"
    arguments = ["_source:=synthetic", "_camera_info_url:=" + url, "_camera_name:=eye"]
    start("camera_node", *arguments)
    rospy.wait_for_service("/camera/set_camera_info", support.DEADLINE)
    info = CameraInfo(width=640, height=480, distortion_model="plumb_bob", D=[0.1, 0, 0, 0, 0])
    info.K = [500.0, 0, 320, 0, 501.0, 240, 0, 0, 1]
    info.R = [1.0, 0, 0, 0, 1, 0, 0, 0, 1]
    info.P = [500.0, 0, 320, 0, 0, 501.0, 240, 0, 0, 0, 1, 0]
    assert rospy.ServiceProxy("/camera/set_camera_info", SetCameraInfo)(info).success
    saved = yaml.safe_load((tmp_path / "calibration.yaml").read_text())
    assert saved["camera_name"] == "eye"
    assert saved["camera_matrix"]["data"] == info.K

    start("camera_node", "__name:=next", *arguments)
    for node in ("/camera", "/next"):
        infos = support.Messages(node + "/camera_info", CameraInfo)
        assert list(infos.wait()[0].K) == info.K
        infos.close()


def test_calibration_of_another_size_is_not_published(start, tmp_path):
    (tmp_path / "other.yaml").write_text(
        yaml.safe_dump(
            {
                "image_width": 320,
                "image_height": 240,
                "camera_name": "head_camera",
                "camera_matrix": {"rows": 3, "cols": 3, "data": [9.0, 0, 0, 0, 9, 0, 0, 0, 1]},
                "distortion_model": "plumb_bob",
                "distortion_coefficients": {"rows": 1, "cols": 5, "data": [0.0] * 5},
                "rectification_matrix": {
                    "rows": 3,
                    "cols": 3,
                    "data": [1.0, 0, 0, 0, 1, 0, 0, 0, 1],
                },
                "projection_matrix": {"rows": 3, "cols": 4, "data": [9.0] + [0.0] * 11},
            }
        )
    )
    picture = tmp_path / "picture.png"
    cv2.imwrite(str(picture), np.zeros((48, 64, 3), np.uint8))
    infos = support.Messages("/camera/camera_info", CameraInfo)
    url = f"file://{tmp_path}/other.yaml"
    process = start("camera_node", f"_source:={picture}", "_camera_info_url:=" + url)
    info = infos.wait()[0]
    assert (info.width, info.height, info.K[0]) == (64, 48, 0.0)
    process.wait_for_output("the calibration is for 320x240, the picture has 64x48")
