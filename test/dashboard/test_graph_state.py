"""What the master says, put in order: nodes, nodelets, images, views."""

import pytest
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

from robot_vision.dashboard.graph_state import (
    MAX_TOPICS,
    base_of,
    is_image,
    parameter_nodes,
    state_of,
    with_nodelets,
)
from robot_vision.dashboard.graph_status import Status, number_in, status_of
from robot_vision.dashboard.graph_views import Views

IMAGE, INFO = "sensor_msgs/Image", "sensor_msgs/CameraInfo"
COMPRESSED = "sensor_msgs/CompressedImage"
FOUND = "robot_vision/DetectionArray"


def state(publishing, subscribing=(), serving=(), types=()):
    kinds = (publishing, subscribing, serving)
    return state_of([[[name, list(nodes)] for name, nodes in kind] for kind in kinds], types)


def status(message="", level=0):
    return Status(level, message, {}, 0.0)


def test_the_images_of_a_python_node_are_its_own():
    made = state(
        [("/a/mask", ["/a_images"]), ("/a/objects", ["/a"])],
        [("/image", ["/a_images", "/b_images"])],
        [("/a/set", ["/a"])],
    )
    assert made.publishers == {"/a/mask": {"/a"}, "/a/objects": {"/a"}}
    assert made.subscribers == {"/image": {"/a", "/b_images"}}  # there is no /b
    assert made.nodes == {"/a", "/b_images"}
    assert made.services == {"/a/set": "/a"}


def test_nodelets_get_what_begins_with_their_names():
    made = state(
        [("/edges/out", ["/manager"]), ("/edges_2/out", ["/manager"]), ("/x", ["/manager"])],
        [],
        [("/edges/set", ["/manager"]), ("/manager/list", ["/manager"])],
    )
    made = with_nodelets(made, ["/edges", "/edges_2", "/gone"])
    assert made.publishers["/edges/out"] == {"/edges"}
    assert made.publishers["/edges_2/out"] == {"/edges_2"}
    assert made.publishers["/x"] == {"/manager"}
    assert made.services == {"/edges/set": "/edges", "/manager/list": "/manager"}
    assert made.nodes == {"/manager", "/edges", "/edges_2"}


def test_a_nodelet_whose_loader_has_its_name_gets_what_its_manager_publishes():
    descriptions = "parameter_descriptions"
    made = state(
        [
            (f"/edges/{descriptions}", ["/manager"]),
            ("/edges/out", ["/manager"]),
            (f"/tracker/{descriptions}", ["/tracker"]),
            ("/rosout", ["/edges", "/manager", "/tracker"]),
        ],
        [("/tracker/select", ["/tracker", "/manager"]), ("/edges/out", ["/manager"])],
    )
    made = with_nodelets(made, ["/edges", "/tracker"])
    assert made.publishers["/edges/out"] == {"/edges"}
    assert made.subscribers["/edges/out"] == {"/manager"}  # another nodelet
    assert made.subscribers["/tracker/select"] == {"/tracker", "/manager"}


def test_parameters_of_transports_are_no_nodes():
    ends = ("/cam", "/cam/image_raw/compressed", "/cam/image_raw/theora")
    made = state([(f"{name}/parameter_descriptions", ["/cam"]) for name in ends])
    assert parameter_nodes(made) == {"/cam"}


def test_thousands_of_topics_are_cut():
    made = state([(f"/t{index}", ["/a"]) for index in range(MAX_TOPICS + 10)])
    assert len(made.topics) == MAX_TOPICS


@pytest.mark.parametrize(
    "topic, published, expected",
    [
        ("/a", {"/a": IMAGE}, True),
        ("/a/compressed", {"/a": IMAGE, "/a/compressed": "sensor_msgs/CompressedImage"}, False),
        ("/a/compressed", {"/a/compressed": "sensor_msgs/CompressedImage"}, True),
        ("/a", {"/a": FOUND}, False),
        ("/a", {}, False),
    ],
)
def test_images_are_told_by_type(topic, published, expected):
    assert is_image(topic, published, published) is expected


@pytest.mark.parametrize("end", ["", "/compressed", "/compressedDepth", "/theora"])
def test_the_base_of_a_transport(end):
    assert base_of("/cam/image_raw" + end) == "/cam/image_raw"


def test_a_view_is_found_by_types_and_not_by_names():
    made = state(
        [("/other/things", ["/x"]), ("/x/note", ["/x"]), ("/x/processed_image", ["/x"])],
        [("/cam/image_raw/compressed", ["/x"])],
        types=[
            ("/other/things", FOUND),
            ("/x/note", "std_msgs/String"),
            ("/x/processed_image", "std_msgs/String"),
            ("/cam/image_raw/compressed", "sensor_msgs/CompressedImage"),
        ],
    )
    (view,) = Views().of(made, {})
    assert view == {
        "node": "/x",
        "title": "x",
        "image": "/cam/image_raw",
        "overlays": ["/other/things"],
        "processed": "",
    }


@pytest.mark.parametrize(
    "message, image",
    [
        ("running on /cam/image_raw", "/cam/image_raw"),
        ("no frames on /cam/image_raw", "/cam/image_raw"),
        ("running on /cam/image_raw; 3 frames refused", "/cam/image_raw"),
        ("idle: nobody subscribes", ""),
        ("running on <b>", ""),
    ],
)
def test_the_status_tells_the_image(message, image):
    made = state([("/x/objects", ["/x"])], types=[("/x/objects", FOUND)])
    (view,) = Views().of(made, {"/x": status(message)})
    assert view["image"] == image


def test_of_two_images_none_is_guessed():
    made = state(
        [("/x/objects", ["/x"])],
        [("/a", ["/x"]), ("/b", ["/x"])],
        types=[("/x/objects", FOUND), ("/a", IMAGE), ("/b", IMAGE)],
    )
    assert Views().of(made, {})[0]["image"] == ""


def test_the_image_is_remembered_until_the_node_ends():
    views = Views()
    types = [("/x/objects", FOUND), ("/a", IMAGE)]
    working = state([("/x/objects", ["/x"])], [("/a", ["/x"])], types=types)
    resting = state([("/x/objects", ["/x"])], types=types)
    assert views.of(working, {})[0]["image"] == "/a"
    assert views.of(resting, {})[0]["image"] == "/a"
    assert views.of(state([]), {}) == []
    assert views.of(resting, {})[0]["image"] == ""


def test_cameras_have_one_view_for_each_camera_info():
    names = ("left/image_raw", "left/image_mono", "left/camera_info", "right/image")
    types = [
        (f"/rig/{name}", INFO if name.endswith("info") else IMAGE)
        for name in (*names, "right/camera_info")
    ]
    made = state([(topic, ["/rig"]) for topic, _ in types], types=types)
    views = Views().of(made, {})
    assert [view["image"] for view in views] == ["/rig/left/image_raw", "/rig/right/image"]
    assert [view["title"] for view in views] == ["rig/left/image_raw", "rig/right/image"]
    assert all(view["overlays"] == [] and view["node"] == "/rig" for view in views)


@pytest.mark.parametrize("end", ["/compressed", "/compressedDepth"])
def test_cameras_that_are_played_compressed_have_a_view(end):
    played = [(f"/cam/image_raw{end}", COMPRESSED), ("/cam/camera_info", INFO)]
    made = state([(topic, ["/play"]) for topic, _ in played], types=played)
    (view,) = Views().of(made, {})
    assert (view["node"], view["image"]) == ("/play", played[0][0])


def test_a_transport_without_a_base_is_nobodys_image():
    types = [("/compressed", COMPRESSED), ("/finder/objects", FOUND)]
    made = state([("/compressed", ["/play"]), ("/finder/objects", ["/finder"])], types=types)
    (view,) = Views().of(made, {})
    assert (view["node"], view["image"]) == ("/finder", "")


def test_a_node_that_works_on_what_is_played_compressed_shows_that():
    types = [("/cam/image_raw/compressed", COMPRESSED), ("/finder/objects", FOUND)]
    publishing = [("/cam/image_raw/compressed", ["/play"]), ("/finder/objects", ["/finder"])]
    statuses = {"/finder": status("running on /cam/image_raw")}
    views = Views()
    assert views.of(state(publishing, types=types), statuses)[0]["image"] == types[0][0]
    types, publishing = [*types, ("/cam/image_raw", IMAGE)], [*publishing, ("/cam/image_raw", "/c")]
    assert views.of(state(publishing, types=types), {})[0]["image"] == "/cam/image_raw"


def test_what_makes_images_of_a_camera_from_others_stays_one_while_it_works():
    types = [("/rig/depth/image_raw", IMAGE), ("/rig/depth/camera_info", INFO), ("/in", IMAGE)]
    publishing = [(topic, ["/rig"]) for topic, _ in types[:2]]
    for subscribing in ([], [("/in", ["/rig"])]):
        (view,) = Views().of(state(publishing, subscribing, types=types), {})
        assert view["image"] == "/rig/depth/image_raw"


def test_an_image_without_camera_info_is_no_camera():
    made = state([("/x/image_raw", ["/x"])], types=[("/x/image_raw", IMAGE)])
    assert Views().of(made, {}) == []


def test_a_status_has_numbers_or_null():
    message = DiagnosticStatus(level=1, message="bad\x1b[31m")
    message.values = [
        KeyValue("output rate (Hz)", "29.97"),
        KeyValue("output age (ms)", "nan"),
        KeyValue("processing time (ms)", "<b>"),
    ]
    made = status_of(message, 10.0).as_json(11.0)
    assert (made["rate"], made["age"], made["processing"]) == (29.97, None, None)
    assert made["level"] == 1 and "\x1b" not in made["message"]
    assert made["values"]["processing time (ms)"] == "<b>"


def test_a_node_that_is_silent_is_stale():
    made = status("running on /a").as_json(7.4)
    assert made["level"] == 3 and made["message"] == "no status for 7 s"


@pytest.mark.parametrize("text, number", [("1e3", 1000.0), ("inf", None), ("", None), (None, None)])
def test_numbers_in_texts(text, number):
    assert number_in(text) == number


def test_a_hostile_status_is_cut():
    message = DiagnosticStatus(message="m" * 100000)
    message.values = [KeyValue(f"k{index}" * 100, "v" * 10000) for index in range(10000)]
    made = status_of(message, 0.0)
    assert len(made.message) <= 300 and len(made.values) <= 64
    assert all(len(key) <= 100 and len(value) <= 300 for key, value in made.values.items())
