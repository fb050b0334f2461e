"""The node template_matcher: what it publishes, its files, and what is selected in the image."""

import cv2
import numpy as np
import pytest
import support
from frames import Camera, Source
from sensor_msgs.msg import Image, RegionOfInterest

import robot_vision as rv
from robot_vision.msg import DetectionArray
from robot_vision.ros.messages import region_of

RNG = np.random.default_rng(1)
IMAGE = cv2.GaussianBlur(RNG.integers(0, 256, (120, 160, 3), np.uint8), (0, 0), 2.0) // 2
STAR, MOON = (
    cv2.resize(RNG.integers(60, 256, (8, 8, 3), np.uint8), size) for size in ((24, 20), (16, 22))
)
IMAGE[30:50, 40:64] = STAR
IMAGE[80:102, 100:116] = MOON
STAR_BOX, MOON_BOX = (40, 30, 24, 20), (100, 80, 16, 22)


class Desk:
    """A node, and what it says of each frame."""

    def __init__(self, start, *arguments):
        self.camera = Camera(10.0)
        topic = f"image:={self.camera.topic}"
        self.process = start("template_matcher.py", "__name:=matcher", topic, *arguments)
        self.objects = support.subscribed("/matcher/objects", DetectionArray)
        self.camera.wait_for()

    def show(self, pixels=IMAGE):
        """Sends a frame; its detections by their labels."""
        header = self.camera.show(pixels)
        found = self.objects.of(header.stamp)
        assert found.header.frame_id == "eye"
        assert (found.width, found.height) == pixels.shape[1::-1]
        return {one.label: one for one in found.detections}


def box_of(found):
    return found.box.x_offset, found.box.y_offset, found.box.width, found.box.height


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "shapes"
    made.mkdir()
    cv2.imwrite(str(made / "star.png"), STAR)
    cv2.imwrite(str(made / "moon.png"), MOON)
    return made


def test_templates_of_a_folder_are_found_field_by_field(start, folder):
    desk = Desk(start, f"_templates:={folder}")
    responses = support.subscribed("/matcher/response", Image)
    overlays = support.subscribed("/matcher/processed_image", Image)
    header = desk.camera.show(IMAGE)
    objects, response, overlay = (
        topic.of(header.stamp) for topic in (desk.objects, responses, overlays)
    )
    by_name = {one.label: one for one in objects.detections}
    assert {name: box_of(one) for name, one in by_name.items()} == {
        "star": STAR_BOX,
        "moon": MOON_BOX,
    }
    star = by_name["star"]
    assert star.id == -1 and 0.99 < star.score <= 1.0 and star.area == 24 * 20
    assert (star.center.x, star.center.y) == pytest.approx((51.5, 39.5), abs=0.2)
    corners = [(point.x, point.y) for point in star.outline]
    assert corners == [(40, 30), (63, 30), (63, 49), (40, 49)]
    best = {"star": STAR, "moon": MOON}[objects.detections[0].label]
    gray = [cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in (IMAGE, best)]
    expected = rv.response_image(rv.template_response(*gray))
    assert (response.encoding, response.header.frame_id) == ("mono8", "eye")
    rows = np.frombuffer(response.data, np.uint8).reshape(response.height, response.width)
    assert np.array_equal(rows, expected)
    drawn = np.frombuffer(overlay.data, np.uint8).reshape(IMAGE.shape)
    assert (drawn[30, 40:64] == (0, 255, 0)).all() and (drawn[80:102, 100] == (0, 255, 0)).all()
    assert np.array_equal(drawn[105:], IMAGE[105:])


def test_live_parameters_and_files(start, folder):
    desk = Desk(start, f"_templates:={folder / 'star.png'}")
    assert set(desk.show()) == {"star"}
    config = support.reconfigured("/matcher", templates=f"{folder}", threshold=0.9)
    assert config["templates"] == str(folder)
    assert set(desk.show()) == {"star", "moon"}
    flat = folder / "flat.png"
    cv2.imwrite(str(flat), np.full((9, 9), 80, np.uint8))
    for values, reason in [
        ({"templates": "star.png"}, "templates is 'star.png', must be the absolute path"),
        (
            {"templates": str(flat)},
            "flat: the template's standard deviation is 0, must be at least",
        ),
        ({"min_scale": 3.0}, "min_scale is 3, must be at most max_scale, 1"),
    ]:
        config = support.reconfigured("/matcher", **values)
        assert (config["templates"], config["min_scale"]) == (str(folder), 1.0)
        desk.process.wait_for_output(reason)
    assert set(desk.show()) == {"star", "moon"}
    support.reconfigured("/matcher", templates=str(flat), method="sqdiff", threshold=0.0)
    assert set(desk.show()) == {"flat"}


def test_a_template_larger_than_the_image_is_left_out_with_a_warning(start, folder):
    cv2.imwrite(str(folder / "wall.png"), RNG.integers(0, 256, (200, 50), np.uint8))
    desk = Desk(start, f"_templates:={folder}")
    assert set(desk.show()) == {"star", "moon"}
    desk.process.wait_for_output(f"larger than the image on {desk.camera.topic}: wall")


def test_a_selected_region_is_a_template_until_another_one_is(start, folder):
    desk = Desk(start, f"_templates:={folder / 'moon.png'}")
    select = Source("/matcher/select", RegionOfInterest)
    select.wait_for()

    def found_after(box, wanted):
        """What is found once a selection has arrived."""
        select.send(region_of(box))
        return support.wait_for(
            lambda: [found for found in [desk.show()] if wanted(found)], "the selection"
        )[0]

    found = found_after(STAR_BOX, lambda found: "selected" in found)
    assert set(found) == {"moon", "selected"} and box_of(found["selected"]) == STAR_BOX
    moved = np.roll(IMAGE, (5, 7), (0, 1))
    assert box_of(desk.show(moved)["selected"]) == (47, 35, 24, 20)
    other = (10, 60, 30, 30)
    found_after(other, lambda found: box_of(found["selected"]) == other)
    select.send(region_of((150, 60, 30, 30)))
    text = f"nothing selected on {desk.camera.topic}: region of 30x30 px at (150, 60) is not inside"
    support.wait_for(lambda: desk.show() and text in desk.process.output(), text)
    assert box_of(desk.show()["selected"]) == other
    assert set(found_after((0, 0, 0, 0), lambda found: "selected" not in found)) == {"moon"}


def test_a_region_is_cut_out_while_nobody_subscribes(start, diagnostics):
    desk = Desk(start, "_diagnostic_period:=0.1")
    desk.objects.close()
    idle = "idle: nobody subscribes"
    support.wait_for(lambda: diagnostics.next("matcher").message == idle, idle)
    desk.camera.wait_for(0)
    select = Source("/matcher/select", RegionOfInterest)
    select.wait_for()
    select.send(region_of(STAR_BOX))
    desk.camera.wait_for()  # and no longer: after some seconds the selection counts no more
    desk.camera.show(IMAGE)
    support.wait_for(lambda: diagnostics.next("matcher").message == idle, "the node to rest")
    desk.camera.wait_for(0)
    desk.objects = support.subscribed("/matcher/objects", DetectionArray)
    desk.camera.wait_for()
    assert box_of(desk.show(np.roll(IMAGE, 9, 1))["selected"]) == (49, 30, 24, 20)


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("method", "best", "method is best, must be sqdiff, sqdiff_normed"),
        ("templates", "/nowhere.png", "an image file: No such file or directory"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "template_matcher.py", name, value, text)
