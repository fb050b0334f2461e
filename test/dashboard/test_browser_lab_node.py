"""Recording, calibrating, the view in space, the log and the graph, used by a real browser."""

import numpy as np
import pytest
import rosbag
import rospy
import support
import yaml
from frames import message
from geometry_msgs.msg import TransformStamped
from pattern_camera import PatternCamera, located
from rosgraph_msgs.msg import Log
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

from robot_vision import CalibrationScene
from robot_vision.msg import TagDetection, TagDetectionArray

pytest_plugins = ["browser", "dashboards"]  # their fixtures
OPEN = (
    "document.body.dataset.state === 'open' && robotVision.graph"
    " && robotVision.panels.tabs.size > 8"
)


@pytest.fixture
def view(page, dashboard):
    page.open(dashboard.address)
    page.wait(OPEN)
    return page


@pytest.fixture
def camera(master):
    made = PatternCamera("eye", located(160, 120))
    yield made
    made.close()


def open_tool(page, name):
    page.wait("robotVision.panels.tabs.has(arguments[0])", name)
    page.run("robotVision.panels.open(arguments[0]);", name)


def test_a_calibration_from_the_first_board_to_the_camera(view, start, tmp_path):
    kept = tmp_path / "kept.yaml"
    url = f"_camera_info_url:=file://{kept}"
    start("camera_node", "__name:=lens", "_source:=synthetic", "_scene:=calibration", url)
    open_tool(view, "calibration")
    topic = '[data-test="calibration-topic"]'
    view.wait(
        "[...document.querySelector(arguments[0]).options]"
        ".some((one) => one.value === '/lens/image_raw')",
        topic,
    )
    view.fill(topic, "/lens/image_raw")
    for name, value in (("columns", "8"), ("rows", "6"), ("millimetres", "50")):
        view.fill(f'[data-test="board-{name}"]', value)
    view.run("document.querySelector('[data-test=calibration-start]').click();")
    views = "parseInt(document.querySelector('[data-test=calibration-views]').textContent)"
    view.wait(f"{views} >= 8", seconds=60)
    view.run("document.querySelector('[data-test=calibration-solve]').click();")
    view.wait("document.querySelector('[data-test=calibration-verdict]')", seconds=60)
    assert "fx" in view.value("document.querySelector('[data-test=calibration-lines]').textContent")
    view.click('[data-test="calibration-next"]')
    assert view.value("document.querySelector('[data-test=calibration-node]').value") == "/lens"
    view.click('[data-test="calibration-commit"]')
    view.wait_for_text("/lens has the calibration now", '[data-test="calibration-answer"]')
    truth = CalibrationScene().camera
    found = yaml.safe_load(kept.read_text())["camera_matrix"]["data"]
    assert np.allclose(found, truth.K.ravel(), rtol=0.02)
    view.click('[data-test="calibration-stop"]')
    view.wait("document.querySelector('[data-test=calibration-start]')")


def test_a_bag_is_recorded_listed_downloaded_and_deleted(view, camera, browser):
    open_tool(view, "bags")
    box = f'[data-test="bag-topic"][data-name="images:{camera.topic}"]'
    view.wait("document.querySelector(arguments[0])", box)
    view.run("document.querySelector(arguments[0]).click();", box)
    view.fill('[data-test="bag-name"]', "walk")
    view.run("document.querySelector('[data-test=bag-record]').click();")
    view.wait(
        "parseInt(document.querySelector('[data-test=recording-numbers]')?.textContent"
        ".match(/, (\\d+) messages/)?.[1]) > 5"
    )
    view.click('[data-test="bag-stop"]')
    row = view.wait("document.querySelector('[data-test=bag]')?.dataset.name")
    assert row.startswith("walk") and row.endswith(".bag")
    view.run("document.querySelector('[data-test=bag-download]').click();")
    path = browser.downloads / row

    support.wait_for(lambda: path.exists() and path.stat().st_size, "the downloaded bag")
    with rosbag.Bag(str(path)) as bag:  # with the camera_info of each image
        assert bag.get_message_count(camera.topic) > 0 and bag.get_message_count() > 5
    path.unlink()
    view.click('[data-test="bag-delete"]')
    view.click('[data-test="bag-delete-sure"]')
    view.wait("document.querySelector('[data-test=no-bags]')")


def tag(header):
    """A tag half a metre before the camera."""
    one = TagDetection(family="tag36h11", id=7, size=0.2, has_pose=True)
    one.pose.pose.position.z = 0.5
    one.pose.pose.orientation.w = 1.0
    return TagDetectionArray(header=header, detections=[one])


def test_tags_are_shown_in_space(view):
    frames = rospy.Publisher("/tf", TFMessage, queue_size=5)
    tags = rospy.Publisher("/tags", TagDetectionArray, queue_size=5)
    try:
        open_tool(view, "scene3d")
        if view.count('[data-test="no-webgl"]'):
            pytest.skip("this chromium draws no WebGL")
        picture = "robotVision.panels.body.querySelector('[data-test=scene]')"

        def publish():
            header = Header(stamp=rospy.Time.now(), frame_id="eye")
            seen = TransformStamped(header=Header(stamp=header.stamp, frame_id="map"))
            seen.child_frame_id = "eye"
            seen.transform.rotation.w = 1.0
            frames.publish(TFMessage([seen]))
            tags.publish(tag(header))

        def is_listed():
            publish()
            return view.value(
                "Boolean(document.querySelector('[data-test=scene-topic][data-name=\"/tags\"]'))"
                " && [...document.querySelector('[data-test=scene-frame]').options]"
                ".some((one) => one.value === 'map')"
            )

        support.wait_for(is_listed, "frames and tags")

        def is_shown():
            publish()
            return "7" in view.value(f"{picture}.parentElement.innerText")

        support.wait_for(is_shown, "the number of the tag")
        view.click('[data-test="scene-fit"]')
        x, y, width, height = map(round, view.box('[data-test="scene"]'))
        shot = view.screenshot()[y : y + height, x : x + width]
        assert len(np.unique(shot.reshape(-1, 3), axis=0)) > 10
    finally:
        frames.unregister()
        tags.unregister()


def test_the_log_is_shown_by_its_levels(view):
    logs = rospy.Publisher("/rosout", Log, queue_size=20)
    open_tool(view, "log")
    texts = {2: "all is well", 4: "something is odd", 8: "something is broken"}

    def are_told():
        for level, text in texts.items():
            logs.publish(Log(Header(stamp=rospy.Time.now()), level, "/talker", text, "", "", 0, []))
        told = view.value("document.querySelector('[data-test=log]').innerText")
        return all(text in told for text in texts.values())

    support.wait_for(are_told, "the lines")
    level = "#panel select[aria-label='Least level']"
    view.fill(level, "4")
    shown = view.value("document.querySelector('[data-test=log]').innerText")
    assert texts[2] not in shown and texts[4] in shown and texts[8] in shown
    view.fill(level, "8")
    shown = view.value("document.querySelector('[data-test=log]').innerText")
    assert texts[4] not in shown and texts[8] in shown
    assert "talker" in shown and view.count("[data-test=log] .bad") > 0
    logs.unregister()


def test_the_graph_has_rates(view, camera):
    reader = support.Messages(camera.topic, type(message(located(2, 2), "bgr8")))
    open_tool(view, "graph")
    topic = f"t{camera.topic}"
    view.wait('document.querySelector(`[data-id="${arguments[0]}"]`)', topic)

    def is_measured():
        """Of two seconds, in which a busy machine may keep messages back."""
        view.run(
            "[...document.querySelectorAll('#panel button')]"
            ".find((one) => one.textContent === 'Measure rates').click();"
        )
        told = view.wait(
            """(() => {
              const one = document.querySelector(`[data-id="${arguments[0]}"]`);
              const text = `${one.textContent} ${one.getAttribute("aria-label")}`;
              return text.match(/([\\d.]+) Hz|nothing in/)?.[0];
            })()""",
            topic,
        )
        return told.endswith("Hz") and 1.0 < float(told.split()[0]) < 12.0

    support.wait_for(is_measured, "the rate")
    reader.close()
