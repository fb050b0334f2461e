"""The Kinect: recordings of the scene, played by fakenect in place of libfreenect."""

import os

import kinect_recording as recording
import numpy as np
import pytest
import support
from frames import pixels
from ros_programs import ROSLAUNCH
from sensor_msgs.msg import CameraInfo, Image
from tf2_msgs.msg import TFMessage

from robot_vision import Scene, SceneParams

MOMENTS = (0, 40, 90)  # frames of the scene
FRAMES = {
    "camera_rgb_frame": ("camera_link", (0, -0.045, 0), (0, 0, 0, 1)),
    "camera_depth_frame": ("camera_link", (0, -0.02, 0), (0, 0, 0, 1)),
    "camera_rgb_optical_frame": ("camera_rgb_frame", (0, 0, 0), (-0.5, 0.5, -0.5, 0.5)),
    "camera_depth_optical_frame": ("camera_depth_frame", (0, 0, 0), (-0.5, 0.5, -0.5, 0.5)),
}  # of kinect_frames.launch: parent, translation in m, rotation as quaternion

pytestmark = pytest.mark.skipif(
    not recording.available(), reason="no libfreenect-dev when this was built, or no fakenect"
)


@pytest.fixture(scope="module")
def moments():
    """Color images and depths in m of the scene."""
    scene = Scene(SceneParams())
    return [(scene.render(frame), scene.render_depth(frame)) for frame in MOMENTS]


@pytest.fixture
def recorded(moments, tmp_path):
    shown = [(bgr, recording.shifts_of(metres)) for bgr, metres in moments]
    return recording.write_recording(tmp_path / "recording", shown)


def by_stamp(messages):
    return {support.stamp_of(message): message for message in messages.received}


def transform_of(sent):
    moved, turned = sent.transform.translation, sent.transform.rotation
    return (
        sent.header.frame_id,
        (moved.x, moved.y, moved.z),
        (turned.x, turned.y, turned.z, turned.w),
    )


def same_place(sent, expected):
    (parent, moved, turned), (of, place, turn) = transform_of(sent), expected
    close = np.allclose(moved, place, atol=1e-9)
    return parent == of and close and abs(np.dot(turned, turn)) == pytest.approx(1.0)


def test_a_recording_of_the_scene_comes_as_the_topics_of_freenect_launch(start, recorded, moments):
    static = support.Messages("/tf_static", TFMessage)
    names = "rgb/image_raw", "depth/image_raw", "depth_registered/image_raw"
    images = [support.Messages(f"/camera/{name}", Image) for name in names]
    infos = [
        support.Messages(f"/camera/{view}/camera_info", CameraInfo) for view in ("rgb", "depth")
    ]
    start(ROSLAUNCH, "robot_vision", "freenect.launch", env=recording.playing(recorded))
    found = {}

    def all_found():
        parts = [by_stamp(messages) for messages in (*images, *infos)]
        for stamp in set.intersection(*map(set, parts)):
            shown = pixels(parts[0][stamp])
            for number, (bgr, _) in enumerate(moments):
                if number not in found and np.array_equal(shown, bgr):
                    found[number] = [part[stamp] for part in parts]
        return len(found) == len(moments)

    support.wait_for(all_found, "all moments of the recording")
    for number, (_, metres) in enumerate(moments):
        color, depth, registered, color_info, depth_info = found[number]
        assert (color.encoding, depth.encoding) == ("bgr8", "16UC1")
        assert color.header.frame_id == color_info.header.frame_id == "camera_rgb_optical_frame"
        assert depth.header.frame_id == depth_info.header.frame_id == "camera_depth_optical_frame"
        shifts = recording.shifts_of(metres)
        expected = np.rint(1000 * np.nan_to_num(recording.depths_of(shifts)))
        measured = pixels(depth).astype(float)
        assert np.abs(measured - expected).max() <= 1  # a half may be rounded to either side
        assert np.mean(measured != expected) < 0.01
        known = measured > 0
        assert known.mean() > 0.5
        step = 1000 * metres**2 / (8 * recording.FOCAL_LENGTH * recording.BASELINE)  # mm
        assert np.all(np.abs(measured - 1000 * metres)[known] < 0.51 * step[known] + 1)
        assert registered.header.frame_id == "camera_rgb_optical_frame"
        assert np.mean(pixels(registered) > 0) > 0.5
        assert color_info.K[0] == 525 and color_info.width == 640
        assert depth_info.K[0] == pytest.approx(recording.FOCAL_LENGTH)
        assert not any(depth_info.D)
    stamps = list(by_stamp(images[0]))
    assert stamps == sorted(stamps)
    sent = {one.child_frame_id: one for message in static.wait() for one in message.transforms}
    assert sent.keys() == FRAMES.keys()
    assert all(same_place(sent[child], expected) for child, expected in FRAMES.items())


def test_a_recording_that_has_ended_is_played_again(start, recorded):
    images = support.Messages("/camera/image_raw", Image)
    process = start("camera_node", "_source:=freenect:0", env=recording.playing(recorded))
    process.wait_for_output("640x480 color at 30 Hz from the Kinect freenect:0")
    process.wait_for_output("the Kinect is gone, or its recording has ended; trying again")
    process.wait_for_output("streaming again")
    images.wait(2 * len(MOMENTS))
    process.interrupt()
    assert process.prompt_exit_code() == 0


def test_a_kinect_that_is_not_there_is_looked_for(start, diagnostics):
    process = start("camera_node", "_source:=freenect:99")
    process.wait_for_output("freenect:99: ")
    process.wait_for_output("; trying again")
    support.wait_for(lambda: "freenect:99: " in diagnostics.next("camera").message, "the error")
    assert process.running()


def test_a_library_that_cannot_be_loaded_is_named(start, tmp_path):
    name = os.path.basename(recording.LIBRARY)
    (tmp_path / name).write_bytes(b"")
    process = start("camera_node", "_source:=freenect:0", env=recording.library_path(tmp_path))
    process.wait_for_output(f"freenect:0: libfreenect cannot be loaded: {tmp_path}/{name}")
    process.wait_for_output("install the version that robot_vision was built with; trying again")


def test_frames_of_tf_can_be_left_to_the_robot_s_description(start, recorded):
    infos = support.Messages("/camera/depth/camera_info", CameraInfo)
    words = "_views:=rgbd", "_publish_tf:=false", "_second_frame_id:=head_depth"
    start("camera_node", "_source:=freenect:0", *words, env=recording.playing(recorded))
    assert infos.wait()[0].header.frame_id == "head_depth"
    # It would have told the master of the topic before its first frame.
    assert support.publishers_of("/tf_static") == []


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("views", "stereo", "views is 'stereo', must be one or rgbd for a Kinect"),
        ("second_frame_id", "a" * 300, "must be a name of at most 255 printable letters"),
    ],
)
def test_what_no_kinect_has_is_fatal_at_start(start, name, value, text):
    views = [] if name == "views" else ["_views:=rgbd"]
    process = start("camera_node", "_source:=freenect:0", f"_{name}:={value}", *views)
    assert process.exit_code() == 1
    assert text in process.output()
