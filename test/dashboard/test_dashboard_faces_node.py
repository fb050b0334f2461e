"""The people that face_recognizer knows, in the dashboard."""

import base64
import os
import threading

import cv2
import numpy as np
import pytest
import rospy
import support
from feature_page import FeaturePage, RefusedError
from people import ANNA, photographs

from robot_vision.dashboard import face_feature
from robot_vision.dashboard.face_feature import FaceFeature
from robot_vision.dashboard.settings import Settings
from robot_vision.faces.gallery import Gallery


@pytest.fixture
def page(master):
    made = FeaturePage(FaceFeature(Settings()))
    yield made
    made.close()


@pytest.fixture
def gallery(start, tmp_path):
    """The gallery of a running node, with one image of Anna."""
    folder = tmp_path / "gallery"
    Gallery(str(folder)).add("Anna", photographs(ANNA, 1))
    start("face_recognizer.py", "__name:=door", "image:=/nobody", f"_gallery:={folder}")
    rospy.wait_for_service("/door/forget_name", support.DEADLINE)  # the last of all
    return folder


def test_people_are_listed_shown_and_forgotten(page, gallery):
    assert page.request("faces", node="/door") == {"people": [{"name": "Anna", "pictures": 1}]}
    jpeg = base64.b64decode(page.request("face_picture", node="/door", name="Anna")["jpeg"])
    image = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert max(image.shape) == 96
    (file,) = [name for name in os.listdir(gallery / "Anna") if name.endswith(".png")]
    whole = cv2.imread(str(gallery / "Anna" / file))
    small = cv2.resize(whole, image.shape[1::-1], interpolation=cv2.INTER_AREA)
    assert np.abs(image.astype(int) - small).mean() < 6.0
    with pytest.raises(RefusedError, match="index is 1, there are 1 images of 'Anna'"):
        page.request("face_picture", node="/door", name="Anna", index=1)
    assert "forgotten" in page.request("forget_face", node="/door", name="Anna")["message"]
    assert page.request("faces", node="/door") == {"people": []}


@pytest.mark.parametrize("name", ["../..", "/etc", "..", ".hidden", "a/b", "\\x", "", "Nobody"])
def test_only_people_who_are_listed_are_shown(page, gallery, name):
    with pytest.raises(RefusedError, match=r"name|nobody"):
        page.request("face_picture", node="/door", name=name)


def test_links_out_of_the_gallery_are_refused(page, gallery, tmp_path):
    secret = tmp_path / "secret.png"
    cv2.imwrite(str(secret), np.zeros((9, 9, 3), np.uint8))
    os.symlink(secret, gallery / "Anna" / "0.png")
    with pytest.raises(RefusedError, match="out of the gallery"):
        page.request("face_picture", node="/door", name="Anna")


def test_enrolling_says_what_is_missing(page, start, tmp_path):
    start(
        "face_recognizer.py",
        "__name:=door",
        "image:=/nobody",
        f"_gallery:={tmp_path / 'empty'}",
        "_enroll_timeout:=0.5",
    )
    rospy.wait_for_service("/door/enroll", support.DEADLINE)
    with pytest.raises(RefusedError, match="within"):
        page.request("enroll", node="/door", name="Bert", pictures=1)
    with pytest.raises(RefusedError, match="must not hold /"):
        page.request("enroll", node="/door", name="a/b", pictures=1)
    with pytest.raises(RefusedError, match="/gone has no service enroll"):
        page.request("enroll", node="/gone", name="Bert")


class Called:
    """Plays the services of a node, whose enrolling lasts as long as a test wants."""

    def __init__(self):
        self.timeouts = []
        self.go_on = threading.Event()

    def __call__(self, _node, service, kind, *_fields, timeout=0.0):
        if service == "list_names":
            return kind._response_class()
        self.timeouts.append(timeout)
        assert self.go_on.wait(support.DEADLINE)
        return kind._response_class(True, "enrolled", 1)


def test_enrolling_may_take_as_long_as_the_node_says_and_holds_up_nothing(page, monkeypatch):
    called = Called()
    monkeypatch.setattr(face_feature, "call_node", called)
    rospy.set_param("/slow/enroll_timeout", 123.0)
    rospy.set_param("/odd/enroll_timeout", "soon")
    asked = [page.start("enroll", node=node, name="Bert") for node in ("/slow", "/odd", "/none")]
    assert page.request("faces", node="/slow") == {"people": []}
    called.go_on.set()
    assert [page.answer_to(number)["pictures"] for number in asked] == [1, 1, 1]
    assert sorted(called.timeouts) == [20.0, 20.0, 133.0]
