"""Live parameters in the dashboard: told, set, refused with a reason, saved, changed by others."""

import threading

import pytest
import rospy
import support
from dynamic_reconfigure.encoding import encode_config
from dynamic_reconfigure.msg import Config, ConfigDescription, Group, ParamDescription
from dynamic_reconfigure.srv import Reconfigure
from feature_page import FeaturePage, RefusedError, subscribes

from robot_vision.dashboard import parameter_feature, parameter_node
from robot_vision.dashboard.parameter_description import parameters_in
from robot_vision.dashboard.parameter_feature import ParameterFeature
from robot_vision.dashboard.settings import Settings
from robot_vision.ros.configs import MotionDetectorConfig


@pytest.fixture
def feature(master):
    made = ParameterFeature(Settings())
    yield made
    made.close()


@pytest.fixture
def page(feature):
    made = FeaturePage(feature)
    yield made
    made.close()


@pytest.fixture
def motion(start):
    process = start("motion_detector.py", "__name:=motion", "image:=/nobody")
    rospy.wait_for_service("/motion/save_parameters", support.DEADLINE)  # the last of both
    return process


@pytest.fixture
def reasons(monkeypatch):
    """reasons(node): waits until what a node logs is read, for which there is time from then on."""
    monkeypatch.setattr(parameter_node, "REASON_TIMEOUT", support.DEADLINE)
    return lambda node: support.wait_for(lambda: support.sends(node, "/rosout"), "its log")


def by_name(told):
    return {one["name"]: one for one in parameters_in(told["groups"])}


def test_a_node_tells_all_that_sliders_and_switches_need(page, motion):
    told = page.request("parameters", node="/motion")
    assert told["node"] == "/motion" and told["save"] is True
    found = by_name(told)
    assert set(found) == set(MotionDetectorConfig.defaults) == set(told["values"])
    blur = found["blur_size"]
    assert (blur["type"], blur["min"], blur["max"], blur["default"]) == ("int", 1, 99, 21)
    assert blur["unit"] == "px, odd" and "px" not in blur["description"]
    assert found["ignore_light"]["type"] == "bool"
    assert told["values"]["blur_size"] == 21 and told["values"]["ignore_light"] is False


def test_values_are_set_and_pushed(page, motion):
    page.request("parameters", node="/motion")
    answer = page.request(
        "set_parameters", node="/motion", values={"threshold": 30, "ignore_light": True}
    )
    assert answer["refused"] == {}
    assert (answer["values"]["threshold"], answer["values"]["ignore_light"]) == (30.0, True)
    pushed = page.wait_for_push("values", lambda data: data["values"]["threshold"] == 30.0)
    assert pushed["node"] == "/motion" and pushed["values"] == answer["values"]


def test_a_refused_value_has_the_reason_that_the_node_logs(page, motion, reasons):
    page.request("parameters", node="/motion")
    reasons("/motion")
    answer = page.request("set_parameters", node="/motion", values={"blur_size": 20})
    assert answer["values"]["blur_size"] == 21
    assert answer["refused"]["blur_size"].startswith("blur_size is 20, must be odd")


def test_values_that_fit_are_set_though_others_do_not(page, motion):
    answer = page.request(
        "set_parameters", node="/motion", values={"threshold": "x", "none": 1, "hold": 2.5}
    )
    assert answer["values"]["hold"] == 2.5
    assert set(answer["refused"]) == {"threshold", "none"}


def test_what_others_change_is_pushed(page, motion):
    page.request("parameters", node="/motion")
    # The client of dynamic_reconfigure would take the dashboard's bytes in this process.
    rospy.ServiceProxy("/motion/set_parameters", Reconfigure)(encode_config({"dilate": 7}))
    page.wait_for_push("values", lambda data: data["values"]["dilate"] == 7)


def test_what_changes_while_parameters_are_told_is_not_lost(page, motion, monkeypatch):
    has_service = parameter_feature.has_service

    def change(name):
        rospy.ServiceProxy("/motion/set_parameters", Reconfigure)(encode_config({"dilate": 7}))
        return has_service(name)

    monkeypatch.setattr(parameter_feature, "has_service", change)
    told = page.request("parameters", node="/motion")
    assert told["values"]["dilate"] != 7  # It has changed after that.
    page.wait_for_push("values", lambda data: data["values"]["dilate"] == 7)


def test_a_node_that_tells_nothing_is_not_looked_at_any_more(page, feature, monkeypatch):
    monkeypatch.setattr(parameter_node, "DESCRIPTION_TIMEOUT", 0.1)
    with pytest.raises(RefusedError, match="has not told its parameters"):
        page.request("parameters", node="/nobody")
    assert not subscribes("/nobody/parameter_updates") and not feature._looking


def test_two_pages_share_a_subscription_that_ends_with_the_last(page, feature, motion):
    other = FeaturePage(feature, role="view")
    page.request("parameters", node="/motion")
    other.request("parameters", node="/motion")
    assert subscribes("/motion/parameter_updates")
    page.request("close_parameters", node="/motion")
    assert subscribes("/motion/parameter_updates")
    other.close()
    support.wait_for(lambda: not subscribes("/motion/parameter_updates"), "the end")
    assert not subscribes("/motion/parameter_descriptions") and not subscribes("/rosout")


def test_a_nodelet_tells_its_reasons_too(page, start, reasons):
    start("edge_detector_node", "__name:=edges", "image:=/nobody")
    rospy.wait_for_service("/edges/set_parameters", support.DEADLINE)
    page.request("parameters", node="/edges")
    reasons("/edges")
    answer = page.request("set_parameters", node="/edges", values={"aperture": 4})
    assert answer["values"]["aperture"] == 3
    assert answer["refused"]["aperture"].startswith("aperture is 4, must be")


def test_parameters_are_saved_in_the_file_of_the_node(page, start, tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("hold: 1.0  # s\n")
    start("motion_detector.py", "__name:=motion", "image:=/nobody", f"_config_file:={file}")
    rospy.wait_for_service("/motion/save_parameters", support.DEADLINE)
    page.request("set_parameters", node="/motion", values={"hold": 3.5})
    answer = page.request("save_parameters", node="/motion")
    assert answer["message"] == f"saved in {file}"
    assert "hold: 3.5  # s" in file.read_text()


def test_a_node_that_cannot_save_says_the_reason(page, motion):
    with pytest.raises(RefusedError, match="not saved: ~config_file does not name a file"):
        page.request("save_parameters", node="/motion")


@pytest.mark.parametrize("node", ["motion", "/<b>", "", "/a b", "/a/", "//a"])
def test_names_that_are_none_are_refused(page, node):
    with pytest.raises(RefusedError, match="is no name of a node"):
        page.request("parameters", node=node)
    with pytest.raises(RefusedError, match="is no name of a node"):
        page.request("set_parameters", node=node, values={"a": 1})


def test_a_node_that_is_not_there_is_told(page, monkeypatch):
    monkeypatch.setattr("robot_vision.dashboard.parameter_node.DESCRIPTION_TIMEOUT", 0.1)
    with pytest.raises(RefusedError, match="/gone has not told its parameters within"):
        page.request("parameters", node="/gone")
    assert not subscribes("/gone/parameter_updates")
    with pytest.raises(RefusedError, match="/gone has no service save_parameters"):
        page.request("save_parameters", node="/gone")


class ForeignNode:
    """Parameters of this process under another name, as a node of others has them."""

    def __init__(self, name, answer, edit=""):
        self._topics = [
            rospy.Publisher(f"{name}/{topic}", kind, queue_size=1, latch=True)
            for topic, kind in (
                ("parameter_descriptions", ConfigDescription),
                ("parameter_updates", Config),
            )
        ]
        description = ConfigDescription(
            groups=[
                Group(
                    name="<script>",
                    parameters=[
                        ParamDescription(
                            name="<b>gain", type="int", description="<i>x</i>", edit_method=edit
                        )
                    ],
                )
            ]
        )
        description.min, description.max, description.dflt = map(self.config, (0, 10, 1))
        self._topics[0].publish(description)
        self._topics[1].publish(self.config(1))
        self._service = rospy.Service(f"{name}/set_parameters", Reconfigure, answer)

    @staticmethod
    def config(value):
        return encode_config({"<b>gain": value})

    def close(self):
        for topic in self._topics:
            topic.unregister()
        self._service.shutdown()


def test_a_value_that_a_foreign_node_clamps_is_told(page):
    node = ForeignNode("/foreign", lambda _: ForeignNode.config(10))
    told = page.request("parameters", node="/foreign")
    assert told["save"] is False and told["groups"][0]["name"] == "<script>"
    assert by_name(told)["<b>gain"]["description"] == "<i>x</i>"
    answer = page.request("set_parameters", node="/foreign", values={"<b>gain": 99})
    node.close()
    assert answer["refused"] == {"<b>gain": "the node keeps <b>gain = 10"}
    assert answer["values"] == {"<b>gain": 10}


def test_a_node_that_never_answers_holds_up_nobody_else(page, feature, motion, monkeypatch):
    monkeypatch.setattr("robot_vision.dashboard.graph_calls.TIMEOUT", 3.0)
    asked, hangs = threading.Event(), threading.Event()

    def hang(_):
        asked.set()
        hangs.wait(support.DEADLINE)

    node = ForeignNode("/hung", hang)
    page.request("parameters", node="/hung")
    number = page.start("set_parameters", node="/hung", values={"<b>gain": 2})
    support.wait_for(asked.is_set, "the call")
    monkeypatch.setattr("robot_vision.dashboard.graph_calls.TIMEOUT", support.DEADLINE)
    other = FeaturePage(feature)
    answer = other.request("set_parameters", node="/motion", values={"hold": 2.0})
    assert answer["values"]["hold"] == 2.0
    with pytest.raises(RefusedError, match="/hung/set_parameters has not answered within 3 s"):
        page.answer_to(number)
    hangs.set()
    other.close()
    node.close()


def test_the_names_of_colors_are_choices(page, start):
    rospy.set_param("/tracker/colors", {"red": {"low": [0, 9, 9], "high": [9, 255, 255]}})
    start("hsv_tracker.py", "__name:=tracker", "image:=/nobody")
    rospy.wait_for_service("/tracker/set_parameters", support.DEADLINE)
    told = page.request("parameters", node="/tracker")
    assert [one["value"] for one in by_name(told)["color"]["choices"]] == ["red"]
