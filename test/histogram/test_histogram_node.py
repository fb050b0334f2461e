"""The node histogram: what it publishes of whole images, regions and selections."""

import cv2
import numpy as np
import pytest
import support
from frames import Camera, Source, pixels
from sensor_msgs.msg import Image, RegionOfInterest
from std_msgs.msg import Float64

import robot_vision as rv
from robot_vision.msg import Histogram

BLUE, GREEN = (200, 60, 20), (60, 180, 40)
LEFT = RegionOfInterest(x_offset=20, y_offset=30, width=40, height=50)
IMAGE = np.full((240, 320, 3), GREEN, np.uint8)
IMAGE[:, :80] = BLUE
TOPICS = {
    "histogram": Histogram,
    "processed_image": Image,
    "histogram_2d": Image,
}


class Counter:
    """A camera, the node, and what it says of each frame."""

    def __init__(self, start, *arguments, topics=TOPICS):
        self.camera = Camera(30.0)
        self.topic = self.camera.topic
        words = "__name:=count", f"image:={self.topic}"
        self.process = start("histogram.py", *words, *arguments)
        self.messages = {}
        for name, kind in topics.items():
            self.listen(name, kind)
        self.camera.wait_for()

    def listen(self, name, kind):
        self.messages[name] = support.subscribed(f"/count/{name}", kind)

    def show(self, image, *names, encoding="bgr8"):
        """Sends a frame, and returns what is said of it on these topics."""
        stamp = self.camera.show(image, encoding).stamp
        answers = [self.messages[name].of(stamp) for name in names]
        assert all(answer.header.frame_id == "eye" for answer in answers)
        return answers if len(answers) > 1 else answers[0]

    def refused(self, image, text, encoding="bgr8"):
        """Asserts that a frame is refused in these words."""
        self.camera.show(image, encoding)
        self.process.wait_for_output(text)

    def select(self, region):
        selections = Source("/count/select", RegionOfInterest)
        selections.wait_for()
        selections.send(region)

    def selected(self, region, image=IMAGE):
        """The histogram of a region that the topic selects."""
        self.select(region)
        return support.wait_for(
            lambda: [
                found
                for found in [self.show(image, "histogram")]
                if found.region.width == region.width
            ],
            "the histogram of the region",
        )[0]


def test_the_whole_image_then_a_selection(start):
    counter = Counter(start)
    found, overlay, plane = counter.show(IMAGE, "histogram", "processed_image", "histogram_2d")
    assert (found.space, found.channels, found.bins) == ("bgr", ["blue", "green", "red"], 64)
    assert (found.low, found.high) == ((0, 0, 0), (256, 256, 256))
    region = found.region
    assert (region.x_offset, region.y_offset, region.width, region.height) == (0, 0, 320, 240)
    counts = np.reshape(found.counts, (3, 64))
    for channel, values in zip(counts, np.moveaxis(IMAGE, 2, 0)):
        assert np.array_equal(channel, np.histogram(values, 64, (0, 256))[0])
    assert np.array_equal(pixels(overlay), rv.plot_histogram(IMAGE, rv.compute_histogram(IMAGE)))
    expected = rv.draw_hue_saturation(rv.hue_saturation_histogram(IMAGE))
    assert np.array_equal(pixels(plane), expected)

    counter.listen("back_projection", Image)
    counter.listen("similarity", Float64)
    counter.show(IMAGE, "histogram")
    counter.process.wait_for_output("no ~back_projection and no ~similarity: no region")
    assert not counter.messages["similarity"].received
    found = counter.selected(LEFT)
    assert (found.region.x_offset, found.region.y_offset) == (20, 30)
    assert found.counts[BLUE[0] // 4] == sum(found.counts[:64]) == 40 * 50
    names = ("processed_image", "histogram_2d", "back_projection")
    overlay, plane, projection = counter.show(IMAGE, *names)
    assert (overlay.encoding, plane.encoding, projection.encoding) == ("bgr8", "bgr8", "mono8")
    drawn = pixels(overlay)
    assert (drawn[30, 21:59] == 255).all() and (drawn[79, 21:59] == 255).all()
    part = IMAGE[30:80, 20:60]
    assert np.array_equal(pixels(plane), rv.draw_hue_saturation(rv.hue_saturation_histogram(part)))
    white = pixels(projection)
    assert (white[:, :78] == 255).all() and not white[:, 82:].any()
    colors = rv.hue_saturation_histogram(part), rv.hue_saturation_histogram(IMAGE)
    alike = counter.messages["similarity"].wait()[0].data
    assert alike == pytest.approx(rv.compare_histograms(*colors), abs=1e-6)
    assert 0.0 < alike < 0.9

    # The selection is remembered: the same colors at another place, and none of them.
    projection = counter.show(IMAGE[:, ::-1], "back_projection")
    assert (pixels(projection)[:, 242:] == 255).all() and not pixels(projection)[:, :238].any()
    support.reconfigured("/count", comparison="intersection", disc=1)
    projection = counter.show(np.full_like(IMAGE, GREEN), "back_projection")
    assert not pixels(projection).any()
    similarity = counter.messages["similarity"].received
    support.wait_for(lambda: similarity[-1].data == 0.0, "no intersection")
    assert counter.selected(RegionOfInterest(width=320, height=240)).region.height == 240


def test_a_selection_without_a_color_is_compared_with_nothing(start):
    topics = {"histogram": Histogram, "back_projection": Image, "similarity": Float64}
    counter = Counter(start, "_min_saturation:=80", "_comparison:=chi_square", topics=topics)
    gray = np.full_like(IMAGE, 128)
    assert counter.selected(LEFT, gray).region.width == 40
    counter.process.wait_for_output(
        "no pixel of the selection has min_saturation, 80, and min_value, 0"
    )
    counter.show(IMAGE, "histogram")
    counter.show(IMAGE, "histogram")  # the one before is done with
    for name in ("back_projection", "similarity"):
        assert not counter.messages[name].received


def test_sixteen_bits_and_live_parameters(start):
    counter = Counter(start, "_space:=gray", "_bins:=1024")
    wide = np.random.default_rng(1).integers(0, 65536, (240, 320), np.uint16)
    found, overlay = counter.show(wide, "histogram", "processed_image", encoding="mono16")
    assert (found.channels, found.bins, found.high) == (["gray"], 1024, (65536,))
    assert np.array_equal(found.counts, np.histogram(wide, 1024, (0, 65536))[0])
    assert pixels(overlay).shape == (240, 320, 3)
    support.reconfigured("/count", space="hsv", bins=30, plot="beside")
    found, overlay = counter.show(IMAGE, "histogram", "processed_image")
    assert (found.space, found.channels) == ("hsv", ["hue", "saturation", "value"])
    assert found.high == (180, 256, 256) and len(found.counts) == 90
    hue = cv2.cvtColor(np.uint8([[BLUE]]), cv2.COLOR_BGR2HSV)[0, 0, 0]
    assert found.counts[hue // 6] == 80 * 240
    assert pixels(overlay).shape == (240, 640, 3)
    assert support.reconfigured("/count", scale="root")["scale"] == "linear"
    counter.process.wait_for_output("scale is root, must be linear or log")
    counter.refused(np.zeros((240, 320), np.float32), "(32FC1, 320x240): ", encoding="32FC1")


def test_a_region_of_parameters_and_one_outside_of_the_image(start):
    counter = Counter(start, "_x:=250", "_y:=30", "_height:=100")
    found = counter.show(IMAGE, "histogram")
    assert (found.region.x_offset, found.region.width, found.region.height) == (250, 70, 100)
    assert sum(found.counts) == 3 * 70 * 100
    support.reconfigured("/count", x=300, width=50)
    found = counter.show(IMAGE, "histogram")
    assert (found.region.x_offset, found.region.width) == (250, 70)  # as before
    counter.process.wait_for_output(
        f"nothing selected on {counter.topic}: region of 50x100 px at (300, 30) is not inside the "
        "image of 320x240"
    )
    counter.refused(IMAGE[:100], "(bgr8, 320x100): region of 70x100 px at (250, 30) is not inside")
    support.reconfigured("/count", x=0, y=0, width=0, height=0)
    assert counter.show(IMAGE, "histogram").region.width == 320


def test_a_region_is_remembered_while_nobody_subscribes(start, diagnostics):
    counter = Counter(start, "_diagnostic_period:=0.1")
    for topic in counter.messages.values():
        topic.close()
    idle = "idle: nobody subscribes"
    support.wait_for(lambda: diagnostics.next("count").message == idle, idle)
    counter.camera.wait_for(0)
    counter.select(LEFT)
    counter.camera.wait_for()  # and no longer: after some seconds the selection counts no more
    counter.camera.show(IMAGE)
    support.wait_for(lambda: diagnostics.next("count").message == idle, "the node to rest")
    counter.camera.wait_for(0)
    counter.listen("histogram", Histogram)
    counter.listen("back_projection", Image)
    counter.camera.wait_for()
    found, projection = counter.show(IMAGE[:, ::-1].copy(), "histogram", "back_projection")
    assert (found.region.x_offset, found.region.width) == (20, 40)
    assert (pixels(projection)[:, 242:] == 255).all() and not pixels(projection)[:, :238].any()


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("disc", 4, "disc is 4, must be odd and from 1 to 31"),
        ("comparison", "eyes", "comparison is eyes, must be correlation, chi_square"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "histogram.py", name, value, text)
