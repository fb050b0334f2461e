"""The nodelet segmenter: its topics field by field, and seeds that come over topics."""

import cv2
import numpy as np
import pytest
import rospy
import support
from frames import Camera, Source, pixels
from segment_images import DISCS, discs
from sensor_msgs.msg import Image, RegionOfInterest
from std_srvs.srv import Trigger

import robot_vision as rv
from robot_vision.msg import Click, DetectionArray

IMAGE, OWNER = discs(noise=4.0)
OUTPUTS = {
    "labels": Image,
    "mask": Image,
    "segments": DetectionArray,
    "processed_image": Image,
}


class Room:
    """A camera, somebody who points at its images, and what the node says of them."""

    def __init__(self, start, *arguments):
        self.camera = Camera(30.0)
        self.regions = Source("/segmenter/select", RegionOfInterest)
        self.clicks = Source("/segmenter/click", Click)
        words = "__name:=segmenter", f"image:={self.camera.topic}"
        self.process = start("segmenter_node", *words, *arguments)
        self.outputs = {
            name: support.Messages(f"/segmenter/{name}", kind) for name, kind in OUTPUTS.items()
        }
        for source in (self.camera, self.regions, self.clicks):
            source.wait_for()
        for messages in self.outputs.values():
            support.wait_for(messages.connected, "the node's topics")

    def show(self, image=IMAGE, encoding="bgr8"):
        """The answers to an image by the names of their topics."""
        header = self.camera.show(image, encoding)
        answers = {name: output.of(header.stamp) for name, output in self.outputs.items()}
        assert all(answer.header.frame_id == "eye" for answer in answers.values())
        return answers

    def show_until(self, condition):
        """Shows the image until the answer is as expected: seeds and frames come on their own."""
        return support.wait_for(
            lambda: next((one for one in [self.show()] if condition(one)), None), "such an answer"
        )


def expected_labels(method, **values):
    params = rv.SegmenterParams()
    params.method = method
    for name, value in values.items():
        setattr(params, name, value)
    return rv.Segmenter(params).apply(IMAGE).labels


def test_labels_mask_segments_and_overlay_of_a_frame(start):
    room = Room(start, "_method:=distance_transform", "_scale:=1.0")
    answers = room.show()
    labels = expected_labels("distance_transform", scale=1.0)
    encodings = {name: answers[name].encoding for name in OUTPUTS if name != "segments"}
    assert encodings == {"labels": "mono16", "mask": "mono8", "processed_image": "bgr8"}
    assert np.array_equal(pixels(answers["labels"]), labels) and labels.max() == len(DISCS)
    assert np.array_equal(pixels(answers["mask"]), np.where(labels > 0, 255, 0))
    overlay = rv.paint_segments(IMAGE, labels)
    assert np.array_equal(pixels(answers["processed_image"]), overlay)
    message = answers["segments"]
    assert (message.width, message.height) == IMAGE.shape[1::-1]
    expected = rv.find_segments(labels)
    assert len(message.detections) == len(expected) == len(DISCS)
    for found, segment in zip(message.detections, expected):
        region, box = segment.region, found.box
        assert (found.label, found.id, found.score) == ("segment", segment.label, 1.0)
        assert (box.x_offset, box.y_offset, box.width, box.height) == region.box
        assert (found.center.x, found.center.y) == pytest.approx(region.center)
        assert [(p.x, p.y) for p in found.outline] == list(map(tuple, region.outline.tolist()))
        circle = found.circle_center.x, found.circle_center.y, found.circle_radius
        assert circle == pytest.approx((*region.circle_center, region.circle_radius))
        assert found.area == region.area
    gray = cv2.cvtColor(IMAGE, cv2.COLOR_BGR2GRAY)
    assert np.array_equal(pixels(room.show(gray, "mono8")["labels"]), labels)


def test_seeds_come_over_topics_and_are_cleared(start):
    room = Room(start, "_automatic:=false", "_scale:=1.0", "_min_area:=0.0")
    answers = room.show()
    assert not pixels(answers["labels"]).any() and not answers["segments"].detections
    text = pixels(answers["processed_image"])
    assert (text != IMAGE)[:30].any() and np.array_equal(text[40:], IMAGE[40:])
    room.process.wait_for_output("watershed has no seeds")

    segmenter = rv.Segmenter(watershed())
    region = (60, 60, 20, 15)
    segmenter.add_region(region)
    room.regions.send(RegionOfInterest(x_offset=60, y_offset=60, width=20, height=15))
    expected = segmenter.apply(IMAGE).labels
    assert expected[70, 70] == 1 and not expected[200, 200]
    room.show_until(lambda one: np.array_equal(pixels(one["labels"]), expected))
    segmenter.add_point((145, 70))
    room.clicks.send(Click(x=145, y=70))
    expected = segmenter.apply(IMAGE).labels
    assert expected[70, 145] == 2
    answers = room.show_until(lambda one: np.array_equal(pixels(one["labels"]), expected))
    assert sorted(one.id for one in answers["segments"].detections) == [1, 2]
    clean = rv.paint_segments(IMAGE, expected)
    drawn = (pixels(answers["processed_image"]) != clean).any(axis=2)
    assert drawn[60, 60:80].all() and drawn[60:140, 130:160].any()  # the seeds
    assert not drawn[:55].any()

    room.regions.send(RegionOfInterest(width=0, height=5))
    room.process.wait_for_output("no seed is added: the region's size is 0x5")
    answer = rospy.ServiceProxy("/segmenter/clear_seeds", Trigger)()
    assert answer.success and answer.message == "seeds forgotten: 2"
    assert not pixels(room.show()["labels"]).any()


def watershed():
    params = rv.SegmenterParams()
    params.automatic, params.scale, params.min_area = False, 1.0, 0.0
    return params


def test_it_runs_as_a_nodelet(start):
    manager = support.NodeletManager(start)
    camera = Camera(30.0)
    rospy.set_param("/divider", {"method": "distance_transform", "scale": 1.0})
    assert manager.load("/divider", "segmenter", {"/image": camera.topic})
    labels = support.subscribed("/divider/labels", Image)
    camera.wait_for()
    answer = labels.of(camera.show(IMAGE).stamp)
    assert np.array_equal(pixels(answer), expected_labels("distance_transform", scale=1.0))
    assert manager.unload("/divider")
    assert manager.process.running()


def test_parameters_are_changed_live(start):
    room = Room(start, "_scale:=1.0", "_method:=k_means", "_clusters:=2")
    assert pixels(room.show()["labels"]).max() == 2
    config = support.reconfigured("/segmenter", clusters=3, paint="mean", opacity=1.0)
    assert config["clusters"] == 3
    answers = room.show()
    assert pixels(answers["labels"]).max() == 3
    colors = np.unique(pixels(answers["processed_image"]).reshape(-1, 3), axis=0)
    assert len(colors) <= 4  # three and the border's white
    config = support.reconfigured("/segmenter", method="magic", clusters=5)
    assert (config["method"], config["clusters"]) == ("k_means", 3)
    room.process.wait_for_output("refused, the parameters stay as they are: method is magic")


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("method", "magic", "method is magic, must be watershed, grab_cut"),
        ("paint", "red", "paint is red, must be distinct or mean"),
        ("clusters", 33, "clusters is 33, must be from 1 to 32"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "segmenter_node", name, value, text)
