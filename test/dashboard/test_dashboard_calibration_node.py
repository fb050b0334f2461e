"""A calibration by a page: from the synthetic camera's first board to its set_camera_info."""

import numpy as np
import pytest
import rospy
import support
import yaml
from sensor_msgs.msg import CameraInfo
from sensor_msgs.srv import SetCameraInfo, SetCameraInfoResponse
from std_msgs.msg import String
from tool_pages import VIEW_TOKEN, ToolServer

from robot_vision import CalibrationScene
from robot_vision.dashboard.calibration_feature import CalibrationFeature
from robot_vision.dashboard.image_hub import ImageHub
from robot_vision.dashboard.settings import Settings

IMAGE = "/eye/image_raw"
BOARD = {"topic": IMAGE, "kind": "chessboard", "columns": 8, "rows": 6, "square": 0.05}


class Hub:
    """The ImageHub, and how many watch by it."""

    def __init__(self):
        self.watching = 0
        self._hub = ImageHub()

    def watch(self, topic, callback):
        handle = self._hub.watch(topic, callback)
        self.watching += 1
        return Watch(self, handle)

    def close(self):
        self._hub.close()


class Watch:
    def __init__(self, hub, handle):
        self._hub, self._handle = hub, handle

    def close(self):
        self._hub.watching -= 1
        self._handle.close()


@pytest.fixture
def hub():
    made = Hub()
    yield made
    made.close()


@pytest.fixture
def server(hub):
    made = ToolServer(CalibrationFeature(Settings(), hub))
    yield made
    made.close()


@pytest.fixture
def camera(start, tmp_path):
    url = f"_camera_info_url:=file://{tmp_path}/kept.yaml"
    start("camera_node", "__name:=eye", "_source:=synthetic", "_scene:=calibration", url)
    return tmp_path / "kept.yaml"


class Service:
    """A camera that takes a calibration, or not."""

    def __init__(self, name, success=True, reason=""):
        self.infos = []
        self._answer = SetCameraInfoResponse(success, reason)
        self._service = rospy.Service(name + "/set_camera_info", SetCameraInfo, self._take)

    def _take(self, request):
        self.infos.append(request.camera_info)
        return self._answer

    def close(self):
        self._service.shutdown()


def views(page, count):
    """The state when so many views are kept."""
    return page.wait("calibration", lambda state: state["views"] >= count, f"{count} views")


def solve(page, count=8):
    views(page, count)
    page.request("calibration_solve")
    return page.wait("calibration", lambda state: state["result"], "a result")["result"]


def test_from_the_first_board_to_the_camera(server, camera, hub):
    page = server.page()
    assert page.request("calibration")["topic"] == ""
    state = page.request("calibration_start", **BOARD)
    assert (state["topic"], state["views"], state["result"]) == (IMAGE, 0, None)
    state = page.wait("calibration", lambda state: state["corners"], "a board")
    assert len(state["corners"]) == 48 and state["size"] == [640, 480]
    state = views(page, 8)
    assert np.array(state["coverage"]).shape == (8, 10) and np.any(state["coverage"])
    assert set(state["progress"]) == {"x", "y", "size", "skew"}
    assert all(0.0 <= share <= 1.0 for share in state["progress"].values())
    result = solve(page)
    truth = CalibrationScene().camera
    assert 0.0 < result["error"] < 0.5 and any("fx" in line for line in result["lines"])
    assert page.request("calibration_commit") == {"message": "/eye has the calibration now"}
    kept = yaml.safe_load(camera.read_text())
    assert np.allclose(kept["camera_matrix"]["data"], truth.K.ravel(), rtol=0.01)
    assert (kept["image_width"], kept["image_height"]) == (640, 480)
    assert yaml.safe_load(result["yaml"])["camera_matrix"]["data"] == pytest.approx(
        kept["camera_matrix"]["data"], rel=1e-6
    )
    support.wait_for(lambda: hub.watching == 0, "the end of the subscription")
    page.request("calibration_stop")
    assert page.request("calibration")["topic"] == ""


def test_a_page_that_comes_back_sees_the_run_and_another_is_told_who_calibrates(
    server, camera, hub
):
    page = server.page()
    page.request("calibration_start", **BOARD)
    kept = views(page, 2)["views"]
    page.close()
    support.wait_for(lambda: hub.watching == 0, "nobody looks")
    back = server.page()
    state = back.request("calibration")
    assert state["topic"] == IMAGE and state["views"] >= kept
    assert state["settings"]["columns"] == 8 and state["settings"]["square"] == 0.05
    views(back, state["views"] + 1)
    other = server.page()
    with pytest.raises(ValueError, match=f"{IMAGE} is being calibrated by page .*: one at a time"):
        other.request("calibration_start", **BOARD)
    viewer = server.page(VIEW_TOKEN)
    assert viewer.request("calibration")["topic"] == IMAGE
    viewer.wait("calibration", lambda state: state["views"] > 2, "it is shown to all")
    back.request("calibration_stop")
    other.request("calibration")
    assert other.request("calibration_start", **BOARD)["views"] == 0


def test_nobody_who_looks_is_no_subscription_and_loses_nothing(server, camera, hub):
    page = server.page()
    page.request("calibration_start", **BOARD)
    count = views(page, 2)["views"]
    page.request("close_calibration")
    assert hub.watching == 0
    state = page.request("calibration")
    assert state["views"] >= count and hub.watching == 1
    views(page, state["views"] + 1)
    page.request("calibration_stop")
    assert hub.watching == 0


def test_who_only_looks_neither_goes_on_with_a_calibration_nor_keeps_others_from_it(server, hub):
    page = server.page()
    page.request("calibration_start", **BOARD)
    viewer = server.page(VIEW_TOKEN)
    assert viewer.request("calibration")["topic"] == IMAGE
    page.request("close_calibration")
    assert hub.watching == 0
    assert viewer.request("calibration")["topic"] == IMAGE and hub.watching == 0
    state = server.page().request("calibration_start", **{**BOARD, "topic": "/other/image_raw"})
    assert state["topic"] == "/other/image_raw" and hub.watching == 1


def test_who_only_looks_is_told_that_a_calibration_waits(server, camera, hub):
    page, viewer = server.page(), server.page(VIEW_TOKEN)
    page.request("calibration_start", **BOARD)
    viewer.request("calibration")
    viewer.wait("calibration", lambda state: state["corners"], "a board")
    page.request("close_calibration")
    waits = "it goes on when somebody looks who may control"
    state = viewer.wait("calibration", lambda state: state["state"] == waits, waits)
    assert (state["topic"], state["corners"], hub.watching) == (IMAGE, [], 0)
    assert viewer.request("calibration")["state"] == waits
    assert page.request("calibration")["state"] != waits
    viewer.wait("calibration", lambda state: state["corners"], "a board again")
    page.request("calibration_stop")


def test_an_abandoned_calibration_gives_way(server, hub):
    page = server.page()
    page.request("calibration_start", **BOARD)
    page.request("close_calibration")
    other = server.page()
    state = other.request("calibration_start", **{**BOARD, "topic": "/other/image_raw"})
    assert state["topic"] == "/other/image_raw" and hub.watching == 1
    assert state["state"] == "waiting for images of /other/image_raw"


def test_a_topic_without_images_is_refused(server, hub):
    publisher = rospy.Publisher("/texts", String, queue_size=1)
    page = server.page()
    with pytest.raises(ValueError, match="the topic is of std_msgs/String, must be of sensor_msgs"):
        page.request("calibration_start", **{**BOARD, "topic": "/texts"})
    assert page.request("calibration")["topic"] == "" and hub.watching == 0
    publisher.unregister()


def test_what_the_camera_says_against_it_is_told(server, camera):
    page = server.page()
    page.request("calibration_start", **BOARD)
    with pytest.raises(ValueError, match="there is no result yet: solve first"):
        page.request("calibration_commit")
    solve(page)
    refusing = Service("/refusing", False, "of another size\x1b")
    taking = Service("/taking")
    with pytest.raises(ValueError, match=r"/refusing: of another size\\x1b"):
        page.request("calibration_commit", node="/refusing")
    with pytest.raises(ValueError, match="/nobody has no service set_camera_info"):
        page.request("calibration_commit", node="/nobody")
    with pytest.raises(ValueError, match=r"'../eye' is no name of a node"):
        page.request("calibration_commit", node="../eye")
    page.request("calibration_commit", node="/taking")
    (info,) = taking.infos
    assert isinstance(info, CameraInfo) and info.distortion_model == "plumb_bob"
    assert np.array_equal(info.R, np.eye(3).ravel()) and info.P[0] > 100.0
    refusing.close()
    taking.close()


def test_a_camera_in_the_global_namespace_takes_its_calibration(server, camera):
    page = server.page()
    page.request("calibration_start", **BOARD)
    solve(page)
    (feature,) = server._features
    feature._run.topic = "/image_raw"
    with pytest.raises(ValueError, match="there is no service /set_camera_info"):
        page.request("calibration_commit")
    taking = Service("")
    told = page.request("calibration_commit")
    assert told == {"message": "the camera of /image_raw has the calibration now"}
    assert len(taking.infos) == 1
    taking.close()


def test_more_views_improve_a_result(server, camera):
    page = server.page()
    page.request("calibration_start", **BOARD)
    solve(page, 5)
    count = page.request("calibration")["views"]
    page.request("calibration_more")
    assert page.request("calibration")["result"] is None
    assert solve(page, count + 1)["error"] > 0.0


@pytest.mark.parametrize(
    "change, reason",
    [
        ({"topic": "image"}, "'image' is no name of a node or a topic"),
        ({"topic": ""}, "'' is no name"),
        ({"kind": "sphere"}, "kind is 'sphere', must be one of chessboard, circles"),
        ({"columns": 2}, "columns is 2, must be from 3 to 100"),
        ({"columns": 8.5}, "columns is 8.5, must be an integer"),
        ({"rows": 10**9}, "rows is 1e+09, must be from 3 to 100"),
        ({"square": 0}, "square is 0, must be from 0.0001 to 10"),
        ({"square": "0.05"}, "square is '0.05', must be a number"),
        ({"model": "fisheye"}, "model is 'fisheye', must be one of plumb_bob"),
        ({"kind": "charuco", "marker": 0.06}, "marker is 0.06, must be below square, 0.05"),
        ({"kind": "charuco", "dictionary": "9x9"}, "dictionary is '9x9', must be one of"),
        ({"color": "red"}, "there is no field 'color'"),
    ],
)
def test_boards_and_topics_that_cannot_be_are_refused(server, hub, change, reason):
    page = server.page()
    with pytest.raises(ValueError) as error:
        page.request("calibration_start", **{**BOARD, **change})
    assert reason in str(error.value)
    assert page.request("calibration")["topic"] == "" and hub.watching == 0


def test_the_role_view_looks_only(server):
    viewer = server.page(VIEW_TOKEN)
    assert viewer.request("calibration") == {"topic": "", "state": "nobody calibrates a camera"}
    for op in ("solve", "more", "commit", "stop"):
        with pytest.raises(ValueError, match=f"calibration_{op} needs the role control"):
            viewer.request(f"calibration_{op}")
        if op != "stop":
            with pytest.raises(ValueError, match="nobody calibrates a camera: start first"):
                server.page().request(f"calibration_{op}")
    with pytest.raises(ValueError, match="calibration_start needs the role control"):
        viewer.request("calibration_start", **BOARD)
