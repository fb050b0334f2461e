"""The node cube_overlay: what it publishes of a board, and what it says without a calibration."""

import numpy as np
import pytest
import support
from calibrated_camera import CalibratedCamera, info_of, not_calibrated, show_until_known
from frames import pixels
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Float64
from tag_studio import angle_between, matrix_of
from tf2_msgs.msg import TFMessage

from robot_vision import CalibrationScene, SceneParams
from robot_vision.calibration import cube_drawing

SCENE = CalibrationScene(SceneParams())
TEXT = 50  # px, the height of what is written above


class Studio:
    """A calibrated camera at 10 Hz of its own time, and what the node says of its frames."""

    def __init__(self, start, *arguments, info=None):
        self.camera = CalibratedCamera(10.0, info or info_of(SCENE.camera))
        words = "__name:=cube", f"image:={self.camera.topic}", "_square:=0.05"
        self.process = start("cube_overlay.py", *words, *arguments)
        self.overlays = support.subscribed("/cube/processed_image", Image)
        self.poses = support.subscribed("/cube/pose", PoseStamped)
        self.errors = support.subscribed("/cube/reprojection_error", Float64)
        self.camera.wait_for()

    def show(self, image):
        """Shows an image; the stamp of its header, and the overlay."""
        header = self.camera.show(image)
        overlay = self.overlays.of(header.stamp)
        assert (overlay.header.frame_id, overlay.encoding) == ("eye", "bgr8")
        return header.stamp, pixels(overlay)


def test_pose_transform_error_and_cube_of_a_frame(start):
    studio = Studio(start)
    transforms = support.subscribed("/tf", TFMessage)
    image, truth = SCENE.render(3), SCENE.truth(3).objects[0].pose
    stamp, overlay = show_until_known(studio.show, image)
    found = studio.poses.of(stamp)
    assert found.header.frame_id == "eye"
    pose = matrix_of(found.pose)
    assert np.linalg.norm(pose[:3, 3] - truth[:3, 3]) < 0.001 and angle_between(pose, truth) < 0.2
    (transform,) = transforms.of(stamp).transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("eye", "board")
    assert np.allclose(matrix_of(transform.transform), pose)
    assert 0.0 < studio.errors.wait()[0].data < 0.2
    expected = image.copy()
    cube_drawing.draw_cube(expected, pose, 3 * 0.05, SCENE.camera)
    assert np.array_equal(overlay[TEXT:], expected[TEXT:])
    assert (overlay[:TEXT] != expected[:TEXT]).any()

    support.reconfigured("/cube", draw="axes", size=2.0, publish_tf=False)
    silent, overlay = studio.show(image)
    expected = image.copy()
    cube_drawing.draw_axes(expected, pose, 2 * 0.05, SCENE.camera)
    assert np.array_equal(overlay[TEXT:], expected[TEXT:])
    assert studio.poses.of(silent)
    nothing = np.full(image.shape, 90, np.uint8)
    empty, overlay = studio.show(nothing)
    assert np.array_equal(overlay, nothing)
    support.reconfigured("/cube", max_error=0.01)
    wrong, overlay = studio.show(image)
    assert np.array_equal(overlay, image)
    support.reconfigured("/cube", max_error=2.0, publish_tf=True)
    last, _ = studio.show(image)
    for topic, never in ((studio.poses, {empty, wrong}), (transforms, {silent, empty, wrong})):
        assert topic.of(last)  # so that whatever was said of the frames before is there, too
        assert not never & set(map(support.stamp_of, topic.received))

    config = support.reconfigured("/cube", board="cheese", columns=9)
    assert (config["board"], config["columns"]) == ("chessboard", 8)
    studio.process.wait_for_output("board is 'cheese', must be chessboard, circles")


def test_a_camera_that_is_not_calibrated_has_no_poses_but_one_warning(start, diagnostics):
    zeros = CameraInfo(width=640, height=480, distortion_model="plumb_bob", D=[0.0] * 5)
    studio = Studio(start, "_board_frame_id:=wall", "_diagnostic_period:=0.02", info=zeros)
    transforms = support.subscribed("/tf", TFMessage)
    image = SCENE.render(3)
    said = f"camera_info on {studio.camera.topic.replace('image', 'camera_info')}: "
    warning = f"no poses of the board: {said}the camera is not calibrated"

    def is_warned_of():  # A frame may be there before its camera_info.
        assert np.array_equal(studio.show(image)[1], not_calibrated(image))
        return warning in studio.process.output()

    support.wait_for(is_warned_of, "the warning")
    told = studio.process.output().count("no poses of the board")
    for _ in range(5):
        assert np.array_equal(studio.show(image)[1], not_calibrated(image))
    assert not studio.poses.received
    support.wait_for(
        lambda: int(diagnostics.value("cube", "frames refused")) >= 6, "six frames to be refused"
    )
    assert diagnostics.value("cube", "last error").endswith(warning)
    assert int(diagnostics.value("cube", "frames published")) == 0
    studio.camera.info = info_of(SCENE.camera)  # comes late
    stamp, _ = show_until_known(studio.show, image)
    assert studio.poses.of(stamp)
    assert transforms.of(stamp).transforms[0].child_frame_id == "wall"
    assert studio.process.output().count(warning) == 1
    assert studio.process.output().count("no poses of the board") == told


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("board", "cheese", "board is 'cheese', must be chessboard, circles, acircles or charuco"),
        ("columns", 2, "columns is 2, must be from 3 to 100"),
        ("draw", "sphere", "draw is 'sphere', must be cube or axes"),
        ("board_frame_id", "", "board_frame_id is '', must be a name"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "cube_overlay.py", name, value, text)
