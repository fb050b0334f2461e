"""The camera node with two views: color and depth, and pairs of images."""

import cv2
import numpy as np
import pytest
import rosgraph
import rospy
import support
from ros_programs import ROSLAUNCH
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from tf2_msgs.msg import TFMessage

from robot_vision import CameraModel, Scene, SceneParams, TabletopScene
from robot_vision.meshes import read_mesh, sample_mesh, write_mesh
from robot_vision.msg import GroundTruth

WIDTH, HEIGHT = 320, 240
SIZE = [f"_image_width:={WIDTH}", f"_image_height:={HEIGHT}"]
TYPES = {"bgr8": (np.uint8, 3), "16UC1": (np.uint16, 1), "32FC1": (np.float32, 1)}


@pytest.fixture(scope="module")
def scene():
    params = SceneParams()
    params.width, params.height = WIDTH, HEIGHT
    return Scene(params)


def pixels(message):
    """The pixels of an Image message."""
    kind, channels = TYPES[message.encoding]
    image = np.frombuffer(message.data, kind).reshape(message.height, message.width, channels)
    return image.squeeze()


def topics(node, views):
    """The images and calibrations of both views."""
    images = [support.Messages(f"/{node}/{view}/image_raw", Image) for view in views]
    infos = [support.Messages(f"/{node}/{view}/camera_info", CameraInfo) for view in views]
    return images + infos


def shift_of(static):
    """The place of the second view in the first view's frame, and the names of both frames."""
    (sent,) = static.wait()[0].transforms
    turn, place = sent.transform.rotation, sent.transform.translation
    assert (turn.x, turn.y, turn.z, turn.w) == (0, 0, 0, 1)  # both look in the same direction
    return np.array([place.x, place.y, place.z]), sent.header.frame_id, sent.child_frame_id


def test_depth_is_how_far_the_things_of_the_truth_are(start, scene):
    static = support.Messages("/tf_static", TFMessage)
    truths = support.Messages("/camera/ground_truth", GroundTruth)
    wanted = topics("camera", ["rgb", "depth"])
    start("camera_node", "_source:=synthetic", "_views:=rgbd", "_depth_encoding:=32FC1", *SIZE)
    color, depth, _, info, truth = support.same_frame(*wanted, truths)
    shift, parent, child = shift_of(static)
    assert (color.header.frame_id, depth.header.frame_id) == (parent, child)
    assert (parent, child) == ("head_camera", "head_camera_depth_optical_frame")
    assert info.header.frame_id == child and info.P[3] == 0
    assert np.allclose(shift, scene.view_pose("depth")[:3, 3])
    assert np.array_equal(pixels(color), scene.render(truth.frame))
    z = pixels(depth)
    np.testing.assert_array_equal(z, scene.render_depth(truth.frame))

    camera = CameraModel(info.width, info.height, np.reshape(info.K, (3, 3)), list(info.D))
    close = []
    for thing in scene.truth(truth.frame).objects:
        if thing.visible and thing.name.startswith(("tag", "qr", "checker")):
            normal, middle = thing.pose[:3, 2], thing.pose[:3, 3] - shift
            u, v = np.rint(camera.project([middle])[0][0]).astype(int)
            ray = np.append(camera.rays([[float(u), float(v)]])[0], 1.0)
            error = z[v, u] - normal @ middle / (normal @ ray)  # of the plane's point in this pixel
            assert error < 1e-4, thing.name  # something else may be in between
            close.append(error > -1e-4)
    assert any(close)


def test_a_pair_of_the_scene_is_calibrated_together(start, scene):
    static = support.Messages("/tf_static", TFMessage)
    truths = support.Messages("/camera/ground_truth", GroundTruth)
    wanted = topics("camera", ["left", "right"])
    start("camera_node", "_source:=synthetic", "_views:=stereo", "_camera_name:=eyes", *SIZE)
    left, right, left_info, right_info, truth = support.same_frame(*wanted, truths)
    assert np.array_equal(pixels(left), scene.render(truth.frame))
    assert np.array_equal(pixels(right), scene.render(truth.frame, "right"))
    shift, parent, child = shift_of(static)
    assert (parent, child) == ("head_camera", "eyes_right_optical_frame")
    assert {one.header.frame_id for one in (left, right, left_info, right_info)} == {parent}
    assert right_info.P[3] == pytest.approx(-right_info.P[0] * shift[0])
    assert shift[0] > 0 and left_info.P[3] == 0
    assert right_info.P[:3] + right_info.P[4:] == left_info.P[:3] + left_info.P[4:]
    assert left_info.R == right_info.R == (1, 0, 0, 0, 1, 0, 0, 0, 1)


def test_the_launch_file_has_the_names_of_a_kinect(start):
    static = support.Messages("/tf_static", TFMessage)
    truths = support.Messages("/camera/ground_truth", GroundTruth)
    wanted = topics("camera", ["rgb", "depth"])
    size = ["image_width:=160", "image_height:=120"]
    start(ROSLAUNCH, "robot_vision", "rgbd.launch", *size)
    color, depth, _, info, truth = support.same_frame(*wanted, truths)
    assert shift_of(static)[1:] == ("camera_rgb_optical_frame", "camera_depth_optical_frame")
    assert color.header.frame_id == "camera_rgb_optical_frame"
    assert depth.header.frame_id == info.header.frame_id == "camera_depth_optical_frame"
    params = SceneParams()
    params.width, params.height = 160, 120
    metres = np.nan_to_num(Scene(params).render_depth(truth.frame))
    assert depth.encoding == "16UC1"
    assert np.abs(pixels(depth) - 1000.0 * metres).max() < 0.501


def test_the_launch_file_puts_meshes_on_a_table(start, tmp_path):
    path = tmp_path / "cup of mine.ply"
    cup = sample_mesh("mug").mesh
    write_mesh(str(path), cup)
    truths = support.Messages("/camera/ground_truth", GroundTruth)
    frames = support.Messages("/tf", TFMessage)
    wanted = topics("camera", ["rgb", "depth"])
    size = ["image_width:=160", "image_height:=120"]
    start(
        *(ROSLAUNCH, "robot_vision", "rgbd.launch", "scene:=tabletop"),
        *(f"meshes:=nut,{path}", "depth_encoding:=32FC1", *size),
    )
    color, depth, _, _, truth = support.same_frame(*wanted, truths)
    assert [one.name for one in truth.objects] == ["nut", "cup_of_mine"]
    params = SceneParams()
    params.width, params.height = 160, 120
    scene = TabletopScene(
        params, [("nut", sample_mesh("nut").mesh), ("cup", read_mesh(str(path)).mesh)]
    )
    assert np.array_equal(pixels(color), scene.render(truth.frame))
    np.testing.assert_array_equal(pixels(depth), scene.render_depth(truth.frame))
    place = truth.objects[1].pose.position
    assert np.allclose([place.x, place.y, place.z], scene.truth(truth.frame).objects[1].pose[:3, 3])

    def sent():
        return {one.child_frame_id for message in frames.received for one in message.transforms}

    support.wait_for(lambda: {"scene/nut", "scene/cup_of_mine"} <= sent(), "the meshes in tf")


def names_of(node):
    """The topics and services of a node, below its name."""
    published, _, services = rosgraph.Master("/test").getSystemState()
    names = {name for name, _ in (*published, *services) if name.startswith(f"/{node}/")}
    return {name[len(node) + 2 :] for name in names}


def test_the_color_view_can_be_where_that_of_a_camera_without_depth_is(start):
    """As demo.launch has it, so that no other node need know of the depth."""
    moved = [f"/eye/rgb/{name}:=/eye/{name}" for name in ("image_raw", "image_mono")]
    moved.append("/eye/rgb/set_camera_info:=/eye/set_camera_info")
    start("camera_node", "__name:=plain", "_source:=synthetic", *SIZE)
    start("camera_node", "__name:=eye", "_source:=synthetic", "_views:=rgbd", *SIZE, *moved)
    support.Messages("/plain/image_raw", Image).wait()
    kinds = {"image_raw": Image, "image_mono": Image, "camera_info": CameraInfo}
    kinds.update({"image_raw/compressed": CompressedImage, "depth/image_raw": Image})
    sent = support.same_frame(*(support.Messages(f"/eye/{n}", kind) for n, kind in kinds.items()))
    frames = {name: message.header.frame_id for name, message in zip(kinds, sent)}
    assert frames.pop("depth/image_raw") == "head_camera_depth_optical_frame"
    assert set(frames.values()) == {"head_camera"}
    for name in ("plain", "eye"):
        rospy.wait_for_service(f"/{name}/stop_capture", support.DEADLINE)  # its last one
    assert names_of("plain") <= names_of("eye")
    assert not [name for name in names_of("eye") if name.startswith("rgb")]


def test_one_image_is_divided_into_a_pair(start, tmp_path):
    both = np.random.default_rng(1).integers(0, 256, (48, 128, 3), np.uint8)
    cv2.imwrite(str(tmp_path / "both.png"), both)
    wanted = topics("camera", ["left", "right"])
    compressed = support.Messages("/camera/left/image_raw/compressed", CompressedImage)
    start("camera_node", f"_source:={tmp_path}/both.png", "_views:=stereo")
    left, right, info, _, jpeg = support.same_frame(*wanted, compressed)
    assert np.array_equal(pixels(left), both[:, :64])
    assert np.array_equal(pixels(right), both[:, 64:])
    assert (info.width, info.height, info.K[0]) == (64, 48, 0)
    assert cv2.imdecode(np.frombuffer(jpeg.data, np.uint8), 1).shape == (48, 64, 3)


def test_images_of_two_folders_are_color_and_depth(start, tmp_path):
    random = np.random.default_rng(1)
    written = {
        "rgb": random.integers(0, 256, (24, 32, 3), np.uint8),
        "depth": random.integers(0, 13000, (12, 16)).astype(np.uint16) * 5,
    }
    for name, image in written.items():
        (tmp_path / name).mkdir()
        cv2.imwrite(str(tmp_path / name / "1.png"), image)
    wanted = topics("camera", ["rgb", "depth"])
    words = f"_source:={tmp_path}", "_views:=rgbd", "_depth_scale:=5000", "_loop:=true"
    start("camera_node", *words)
    color, depth, _, info = support.same_frame(*wanted)
    assert np.array_equal(pixels(color), written["rgb"])
    assert depth.encoding == "16UC1"
    assert np.array_equal(pixels(depth), written["depth"] // 5)
    assert depth.header.frame_id == info.header.frame_id == "head_camera_depth_optical_frame"
    assert (info.width, info.height, info.K[0]) == (16, 12, 0)


def test_an_image_that_cannot_be_divided_is_refused(start, tmp_path):
    cv2.imwrite(str(tmp_path / "odd.png"), np.zeros((48, 127, 3), np.uint8))
    process = start("camera_node", f"_source:={tmp_path}/odd.png", "_views:=stereo")
    images = support.subscribed("/camera/left/image_raw", Image)
    process.wait_for_output("a bgr8 image of 127x48 cannot be divided into a left and a right one")
    assert not images.received


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("views", "rgbd", "views is 'rgbd', must be one or stereo, as a V4L2 camera or"),
        ("views", "both", "views is 'both', must be one, stereo or rgbd"),
        ("right_frame", "both", "right_frame is 'both', must be left or own"),
        ("depth_noise", "lots", "depth_noise is 'lots', must be none, kinect, stereo or tof"),
    ],
)
def test_wrong_views_are_fatal_at_start(start, name, value, text):
    support.assert_fatal_at_start(start, "camera_node", name, value, text)
