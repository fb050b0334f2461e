"""The node filter: chains of operations, their steps, and what is refused."""

import cv2
import numpy as np
import rospy
import support
from frames import Source, message, new_topic, noise, pixels
from sensor_msgs.msg import Image

BGR = noise("bgr8", 48, 64)
GRAY = cv2.cvtColor(BGR, cv2.COLOR_BGR2GRAY)


class Chain:
    """A filter node that always listens, and what it makes of frames."""

    def __init__(self, start, chain, *arguments):
        self._source = Source(new_topic())
        words = ["__name:=filter", f"image:={self._source.topic}", f"_chain:={chain}"]
        self.process = start("filter_node", *words, "_always_subscribe:=true", *arguments)
        self._source.wait_for()
        self._sent = 0

    def send(self, image, encoding):
        """Sends an image to the node, and returns its stamp."""
        sent = message(image, encoding)
        self._sent += 1
        sent.header.stamp = rospy.Time(self._sent)
        sent.header.frame_id = "eye"
        self._source.send(sent)
        return sent.header.stamp

    def results(self, image, encoding, *topics):
        """The pixels and the encodings of these topics for an image; the header is the image's."""
        messages = [support.subscribed(f"/filter/{topic}", Image) for topic in topics]
        stamp = self.send(image, encoding)
        answers = [topic.of(stamp) for topic in messages]
        for name, topic in zip(topics, messages):
            self.close(name, topic)
        assert all(answer.header.frame_id == "eye" for answer in answers)
        return [(pixels(answer), answer.encoding) for answer in answers]

    def close(self, name, topic):
        """Ends a subscription, and waits until the node knows of it."""
        topic.close()
        support.wait_for(lambda: not support.sends("/filter", f"/filter/{name}"), "its end")

    def publishes(self, name):
        return support.publishers_of(f"/filter/{name}") == ["/filter"]


def is_result(result, expected, encoding):
    return np.array_equal(result[0], expected) and result[1] == encoding


def test_a_chain_and_its_steps_equal_opencv(start):
    chain = Chain(start, "gaussian, gray, erode, canny, erode", "_gaussian_size:=7")
    blurred = cv2.GaussianBlur(BGR, (7, 7), 0)
    gray = cv2.cvtColor(blurred, cv2.COLOR_BGR2GRAY)
    eroded = cv2.erode(gray, np.ones((3, 3)))
    edges = cv2.Canny(eroded, 50, 150)
    names = ("gaussian", "gray", "erode", "canny", "erode_2")
    topics = [f"steps/{name}" for name in names]
    results = chain.results(BGR, "bgr8", *topics, "processed_image")
    last = cv2.erode(edges, np.ones((3, 3)))
    expected = [blurred, gray, eroded, edges, last, last]
    for result, image, encoding in zip(results, expected, ["bgr8", *["mono8"] * 5]):
        assert is_result(result, image, encoding)
    (alone,) = chain.results(BGR, "bgr8", "steps/erode")  # without processed_image
    assert is_result(alone, eroded, "mono8")


def test_the_chain_and_its_parameters_change_live(start):
    chain = Chain(start, "box")
    assert is_result(
        chain.results(BGR, "bgr8", "processed_image")[0], cv2.blur(BGR, (5, 5)), "bgr8"
    )
    config = support.reconfigured("/filter", chain="resize, channel", resize_scale=0.25)
    assert config["chain"] == "resize, channel"
    assert not chain.publishes("steps/box") and chain.publishes("steps/channel")
    small = cv2.resize(BGR, (16, 12))
    step, result = chain.results(BGR, "bgr8", "steps/resize", "processed_image")
    assert is_result(step, small, "bgr8") and is_result(result, small[..., 1], "mono8")
    support.reconfigured("/filter", chain="")
    assert is_result(chain.results(GRAY, "mono8", "processed_image")[0], GRAY, "mono8")


def test_the_other_image_is_that_of_another_topic(start, diagnostics):
    second = Source(new_topic())
    words = "_use_second:=true", f"second:={second.topic}", "_diagnostic_period:=0.02"
    chain = Chain(start, "difference", *words)
    answers = support.subscribed("/filter/processed_image", Image)

    def is_refused(text):  # /diagnostics has each error, the log one in some seconds
        return chain.send(BGR, "bgr8") and text in diagnostics.value("filter", "last error")

    second.wait_for()
    none = f"no image has come on {second.topic} yet"
    support.wait_for(lambda: is_refused(none), none)
    other = cv2.flip(BGR, 1)
    second.send(message(other, "bgr8"))
    expected = cv2.absdiff(BGR, other)

    def arrived():  # the two topics are not in step
        chain.send(BGR, "bgr8")
        return answers.received

    assert is_result((pixels(support.wait_for(arrived, "a result")[0]), "bgr8"), expected, "bgr8")
    second.send(message(GRAY, "mono8"))
    gray = cv2.absdiff(BGR, cv2.cvtColor(GRAY, cv2.COLOR_GRAY2BGR))

    def changed():
        chain.send(BGR, "bgr8")
        return np.array_equal(pixels(answers.received[-1]), gray)

    support.wait_for(changed, "a result with the newest of the other images")
    second.close()
    text = f"nobody publishes the other image on {second.topic}"
    support.wait_for(lambda: is_refused(text), text)
    alone = [chain.send(BGR, "bgr8") for _ in range(3)]
    second = Source(second.topic)
    second.wait_for()
    support.wait_for(lambda: is_refused("no image has come on"), "the end of the old image")
    second.send(message(BGR[:40], "bgr8"))
    support.wait_for(lambda: is_refused("64x40, must be 64x48"), "the refusal of another size")
    second.send(message(other, "bgr8"))
    last = chain.send(BGR, "bgr8")

    def again():
        stamps = [answer.header.stamp for answer in answers.received]
        assert not {*alone} & {*stamps}
        return chain.send(BGR, "bgr8") and max(stamps) > last

    support.wait_for(again, "results with another publisher")


REFUSED = [
    ({"chain": "box, magic"}, "chain: 'magic' is no operation, must be one of adaptive_"),
    ({"median_size": 6}, "median_size is 6, must be odd and from 1 to 255"),
    ({"chain": "kernel", "kernel_rows": "1 2; 3"}, "kernel: rows must have the same number"),
    ({"chain": "sobel", "sobel_dx": 0}, "sobel: dx and dy are 0, one must be 1 or 2"),
    ({"threshold_kind": "round"}, "threshold_kind is 'round', must be binary, binary_inv, "),
]


def test_what_cannot_be_is_refused_and_the_chain_stays(start):
    chain = Chain(start, "box", "_box_size:=3")
    for values, reason in REFUSED:
        config = support.reconfigured("/filter", **values)
        assert config["chain"] == "box" and config["median_size"] == 5
        chain.process.wait_for_output("refused, the parameters stay as they are: " + reason)
    (result,) = chain.results(BGR, "bgr8", "processed_image")
    assert is_result(result, cv2.blur(BGR, (3, 3)), "bgr8")


def test_a_frame_that_an_operation_cannot_take_is_refused_by_its_name(start):
    chain = Chain(start, "roi", "_roi_x:=50")
    assert chain.results(BGR, "bgr8", "processed_image")[0][0].shape == (48, 14, 3)
    images = support.subscribed("/filter/processed_image", Image)
    chain.send(BGR[:, :40], "bgr8")
    chain.process.wait_for_output("roi: x, y are 50, 0, must be inside of the image of 40x48")
    chain.close("processed_image", images)
    assert chain.results(BGR, "bgr8", "processed_image")[0][0].shape == (48, 14, 3)
