"""The hub of images without a master: who gets which image, and what that costs."""

import functools
import struct
import threading
import types

import cv2
import numpy as np
import pytest
import support
from exif import sideways, sideways_png

from robot_vision.dashboard import image_stream, image_topics
from robot_vision.dashboard.channels import JPEG, PNG
from robot_vision.dashboard.graph_state import State, is_image
from robot_vision.dashboard.image_hub import ImageHub
from robot_vision.dashboard.image_source import RosSubscriptions
from robot_vision.dashboard.image_topics import ImageTopics, Route
from robot_vision.dashboard.message_topics import RawMessage
from robot_vision.dashboard.orientation import without_exif
from robot_vision.dashboard.pictures import SIZES, Display, Picture, Wish, rounded_up
from robot_vision.ros.transport import FrameError

IMAGE, COMPRESSED = image_topics.IMAGE, image_topics.COMPRESSED_IMAGE
JPEG_DATA = cv2.imencode(".jpg", np.zeros((30, 40, 3), np.uint8))[1].tobytes()
PNG_DATA = cv2.imencode(".png", np.zeros((20, 50, 3), np.uint8))[1].tobytes()


class Frame:
    """What ImageSubscriber gives."""

    def __init__(self, image, encoding="bgr8", time=12.5):
        self.image, self.encoding, self.time = image, encoding, time


def image(value=0, width=64, height=48):
    return np.full((height, width, 3), value, np.uint8)


class Topics(ImageTopics):
    """Topics as a test has them."""

    def __init__(self, **kinds):
        super().__init__()
        self.kinds = {f"/{name}": kind for name, kind in kinds.items()}
        self.asked = 0

    def refresh(self):
        self.asked += 1
        self._types = dict(self.kinds)


class Subscriptions(RosSubscriptions):
    """Subscriptions that a test fills."""

    def __init__(self):
        super().__init__(lambda *arguments, **named: self._subscribe(*arguments, **named))
        self.pixels = {}
        self.bytes = {}
        self.log = []

    def _subscribe(self, topic, callback, transport):
        self.log.append(f"+{topic} {transport}")
        self.pixels[topic] = callback
        return types.SimpleNamespace(unregister=lambda: self._leave(topic, self.pixels))

    def raw(self, topic, callback):
        self.log.append(f"+{topic}")
        self.bytes[topic] = callback
        return lambda: self._leave(topic, self.bytes)

    def _leave(self, topic, of):
        self.log.append(f"-{topic}")
        del of[topic]


class Viewer(image_stream.Viewer):
    """A viewer with credit for some pictures."""

    def __init__(self, credit=1000):
        self.credit = credit
        self.pictures, self.kinds, self.data, self.errors = [], [], [], []

    @property
    def ready(self):
        return self.credit > 0

    def show(self, picture, kind, data):
        self.credit -= 1
        self.pictures.append(picture)
        self.kinds.append(kind)
        self.data.append(data)
        support.arrived.set()

    def fail(self, text):
        self.errors.append(text)
        support.arrived.set()

    def wait(self, count):
        support.wait_for(lambda: len(self.data) >= count, f"{count} pictures")
        return cv2.imdecode(np.frombuffer(self.data[count - 1], np.uint8), cv2.IMREAD_UNCHANGED)


@pytest.fixture
def ros():
    return Subscriptions()


@pytest.fixture
def hub(ros):
    made = ImageHub(Topics(eye=IMAGE, ear=IMAGE, jpeg=COMPRESSED, text="std_msgs/String"), ros)
    yield made
    made.close()


def test_without_a_viewer_nothing_is_subscribed_and_the_master_not_asked(hub, ros):
    assert ros.log == [] and hub.topics.asked == 0


def test_viewers_of_a_topic_share_one_subscription_which_ends_after_the_last(hub, ros):
    handles = [hub.view("/eye", Wish(), Viewer()) for _ in range(3)]
    handles.append(hub.watch("/eye", print))
    assert ros.log == ["+/eye auto"]
    for handle in handles:
        handle.close()
        handle.close()
    support.wait_for(lambda: ros.log == ["+/eye auto", "-/eye"], "the end of the subscription")


def test_who_comes_back_at_once_finds_the_subscription_there(hub, ros):
    for _ in range(5):
        hub.view("/eye", Wish(), Viewer()).close()
    assert ros.log == ["+/eye auto"]


def test_viewers_who_want_the_same_share_one_encoding(hub, ros, monkeypatch):
    made = []

    def encoded(picture, display):
        made.append(display)
        return b"x"

    monkeypatch.setattr(image_stream, "encoded", encoded)
    viewers = [Viewer() for _ in range(8)]
    for at, viewer in enumerate(viewers):
        hub.view("/eye", Wish(needed=30 + at), viewer)  # nearly the same tiles
    for count in range(1, 4):
        ros.pixels["/eye"](Frame(image()))
        for viewer in viewers:
            support.wait_for(
                lambda viewer=viewer, count=count: len(viewer.data) == count, "a picture"
            )
    assert len(made) == 3 and hub.encodings() == 3
    assert all(viewer.data[0] is viewers[0].data[0] for viewer in viewers)


def test_other_sizes_and_qualities_are_other_encodings(hub, ros):
    big = np.random.default_rng(2).integers(0, 256, (960, 1280, 3), np.uint8)
    wishes = [
        Wish(needed=640),
        Wish(needed=639),
        Wish(needed=320),
        Wish(needed=640, quality=20),
    ]
    viewers = [Viewer() for _ in wishes]
    for viewer, wish in zip(viewers, wishes):
        hub.view("/eye", wish, viewer)
    ros.pixels["/eye"](Frame(big))
    shapes = [viewer.wait(1).shape[:2] for viewer in viewers]
    assert shapes == [(480, 640), (480, 640), (240, 320), (480, 640)]
    assert hub.encodings() == 3
    assert viewers[0].data[0] is viewers[1].data[0]
    assert len(viewers[3].data[0]) < len(viewers[0].data[0])


def test_sizes_larger_than_the_image_share_the_one_as_it_is(hub, ros):
    viewers = [Viewer() for _ in range(3)]
    for viewer, needed in zip(viewers, (0, 640, 1920)):
        hub.view("/eye", Wish(needed=needed), viewer)
    ros.pixels["/eye"](Frame(image()))
    assert [viewer.wait(1).shape for viewer in viewers] == [(48, 64, 3)] * 3
    assert hub.encodings() == 1


def test_a_viewer_gets_time_and_original_size_with_the_picture(hub, ros):
    viewer = Viewer()
    hub.view("/eye", Wish(needed=160), viewer)
    ros.pixels["/eye"](Frame(image(120, 640, 480), time=99.25))
    shown = viewer.wait(1)
    assert shown.shape == (120, 160, 3) and abs(int(shown[60, 80, 0]) - 120) < 3
    picture = viewer.pictures[0]
    assert (picture.stamp, picture.width, picture.height) == (99.25, 640, 480)


def test_a_stalled_viewer_costs_no_encoding_and_harms_no_other(hub, ros):
    stalled, other = Viewer(credit=1), Viewer()
    hub.view("/eye", Wish(needed=30), stalled)
    hub.view("/eye", Wish(), other)
    hub.view("/ear", Wish(), Viewer(credit=0))
    for count in range(1, 11):
        ros.pixels["/eye"](Frame(image(count)))
        ros.pixels["/ear"](Frame(image(count)))
        other.wait(count)
    assert len(stalled.data) == 1
    assert hub.encodings() == 10


def test_who_becomes_ready_gets_the_newest_at_once_and_only_once(hub, ros):
    viewer, other = Viewer(credit=1), Viewer()
    handle = hub.view("/eye", Wish(), viewer)
    hub.view("/eye", Wish(), other)
    for value in (10, 20, 30):
        ros.pixels["/eye"](Frame(image(value)))
        other.wait(value // 10)
    viewer.credit = 5
    handle.wake()
    assert abs(int(viewer.wait(2)[0, 0, 0]) - 30) < 3  # of 20 it never hears
    assert viewer.data[1] is other.data[2]
    handle.wake()
    assert len(viewer.data) == 2


def test_who_comes_later_gets_the_newest_image_of_a_still_topic(hub, ros):
    hub.view("/eye", Wish(), Viewer(credit=0))
    ros.pixels["/eye"](Frame(image(77)))
    late, other_size = Viewer(), Viewer()
    hub.view("/eye", Wish(), late)
    hub.view("/eye", Wish(width=10), other_size, passed=False)
    assert abs(int(late.wait(1)[0, 0, 0]) - 77) < 3
    assert other_size.wait(1).shape == (8, 10, 3)
    assert other_size.pictures[0].received == late.pictures[0].received  # it is as old for all


def test_while_one_is_encoded_newer_ones_replace_each_other(hub, ros, monkeypatch):
    begun, go_on = threading.Semaphore(0), threading.Semaphore(0)

    def encoded(picture, display):
        begun.release()
        assert go_on.acquire(timeout=support.DEADLINE)
        return bytes([picture.frame.image[0, 0, 0]])

    monkeypatch.setattr(image_stream, "encoded", encoded)
    viewer = Viewer()
    hub.view("/eye", Wish(), viewer)
    ros.pixels["/eye"](Frame(image(1)))
    assert begun.acquire(timeout=support.DEADLINE)
    for value in (2, 3, 4):
        ros.pixels["/eye"](Frame(image(value)))
    go_on.release(2)
    viewer_data = support.wait_for(lambda: len(viewer.data) == 2 and viewer.data, "two pictures")
    assert viewer_data == [b"\1", b"\4"]


def test_a_topic_that_is_slow_to_encode_does_not_hold_up_another(hub, ros, monkeypatch):
    if hub._pool._max_workers < 2:
        pytest.skip("one core has one thread that encodes")
    go_on = threading.Event()

    def encoded(picture, display):
        if picture.width > 100:
            assert go_on.wait(support.DEADLINE)
        return b"x"

    monkeypatch.setattr(image_stream, "encoded", encoded)
    quick, slow = Viewer(), Viewer()
    hub.view("/eye", Wish(), slow)
    hub.view("/ear", Wish(), quick)
    ros.pixels["/eye"](Frame(image(1, 3840, 2160)))
    for count in (1, 2, 3):
        ros.pixels["/ear"](Frame(image(count)))
        support.wait_for(lambda count=count: len(quick.data) == count, "the other topic")
    assert slow.data == []
    go_on.set()
    support.wait_for(lambda: slow.data, "the slow topic")


def has_tried(hub, count):
    return hub.encodings() == count


def test_what_cannot_be_shown_is_told_once_and_the_next_image_is_shown(hub, ros):
    viewer = Viewer()
    hub.view("/eye", Wish(), viewer)
    for _ in range(3):
        tried = hub.encodings()
        ros.pixels["/eye"](Frame(np.zeros((4, 4, 2), np.float32), "32FC2"))
        support.wait_for(functools.partial(has_tried, hub, tried + 1), "an error")
    ros.pixels["/eye"](Frame(image(50)))
    viewer.wait(1)
    assert len(viewer.errors) == 1
    assert viewer.errors[0].startswith("/eye: encoding '32FC2' cannot be shown")


def test_size_and_encoding_may_change_while_somebody_looks(hub, ros):
    viewer = Viewer()
    hub.view("/eye", Wish(needed=160), viewer)
    frames = [
        (Frame(image(9)), (48, 64, 3)),
        (Frame(np.zeros((1080, 1920), np.uint8), "mono8"), (90, 160)),
        (Frame(np.full((2, 300), 3000, np.uint16), "16UC1"), (1, 160)),
        (Frame(np.zeros((1, 1, 4), np.uint8), "bgra8"), (1, 1, 3)),
    ]
    for count, (frame, shape) in enumerate(frames, 1):
        ros.pixels["/eye"](frame)
        assert viewer.wait(count).shape == shape


def compressed(data, form=b"bgr8; jpeg compressed bgr8", stamp=(7, 500000000), kind=COMPRESSED):
    message = struct.pack("<III", 1, *stamp)
    for field in (b"eye", form, data):
        message += struct.pack("<I", len(field)) + field
    return RawMessage(kind, "", message, 1000.0, "/camera", ros_time=2.5)


def test_a_jpeg_goes_on_as_it_came_to_all_viewers_whatever_their_size(hub, ros):
    viewers = [Viewer() for _ in range(8)]
    for at, viewer in enumerate(viewers):
        hub.view("/jpeg", Wish(needed=10 * at, quality=1 + at), viewer)
    ros.bytes["/jpeg"](compressed(JPEG_DATA))
    for viewer in viewers:
        assert viewer.data == [JPEG_DATA] and viewer.kinds == [JPEG]
        picture = viewer.pictures[0]
        assert (picture.stamp, picture.received) == (7.5, 1000.0)
        assert (picture.width, picture.height) == (40, 30)
    assert hub.encodings() == 0 and ros.log == ["+/jpeg"]


def test_a_png_goes_on_as_png(hub, ros):
    viewer = Viewer()
    hub.view("/jpeg", Wish(), viewer)
    ros.bytes["/jpeg"](compressed(PNG_DATA, b"png", stamp=(0, 0)))
    assert (viewer.data, viewer.kinds) == ([PNG_DATA], [PNG])
    assert viewer.pictures[0].stamp == 2.5  # of ROS' clock when it came, as it has none


FILL = b"\xff\xd8\xff"  # before a marker there may be any number of the last byte


@pytest.mark.parametrize(
    "turned, upright",
    [
        pytest.param(sideways(JPEG_DATA), JPEG_DATA, id="jpeg"),
        pytest.param(sideways(sideways(JPEG_DATA)), JPEG_DATA, id="twice"),
        pytest.param(FILL + sideways(JPEG_DATA)[2:], FILL + JPEG_DATA[2:], id="fill"),
        pytest.param(sideways_png(PNG_DATA), PNG_DATA, id="png"),
        pytest.param(sideways_png(PNG_DATA, before=b"IEND"), PNG_DATA, id="behind"),
    ],
)
def test_no_browser_is_told_to_turn_an_image(hub, ros, turned, upright):
    viewer = Viewer()
    hub.view("/jpeg", Wish(), viewer)
    ros.bytes["/jpeg"](compressed(turned, b""))
    assert viewer.data == [upright]


@pytest.mark.parametrize("data", [JPEG_DATA, PNG_DATA, b"", b"\xff\xd8\xff\xe1"])
@pytest.mark.parametrize("kind", [JPEG, PNG])
def test_what_has_no_orientation_stays_as_it_is(kind, data):
    assert without_exif(kind, data) is data


@pytest.mark.parametrize(
    "raw, words",
    [
        (compressed(b""), "0 bytes are neither"),
        (compressed(JPEG_DATA[:-9]), "truncated"),
        (compressed(PNG_DATA, b"16UC1; compressedDepth png"), "compressedDepth cannot be shown"),
        (compressed(JPEG_DATA)._replace(data=b""), "cut off"),
        (compressed(JPEG_DATA)._replace(data=compressed(JPEG_DATA).data[:-1]), "cut off"),
        (compressed(JPEG_DATA)._replace(data=compressed(JPEG_DATA).data + b"x"), "must have"),
        (compressed(JPEG_DATA)._replace(data=b"\xff" * 30), "cut off"),
        (compressed(JPEG_DATA, kind="std_msgs/String"), "is of std_msgs/String, must be of"),
    ],
)
def test_a_damaged_message_is_told_in_words_and_the_next_one_shown(hub, ros, raw, words):
    viewer = Viewer()
    hub.view("/jpeg", Wish(), viewer)
    ros.bytes["/jpeg"](raw)
    ros.bytes["/jpeg"](compressed(JPEG_DATA))
    assert words in viewer.errors[0] and viewer.data == [JPEG_DATA]


def test_a_topic_that_changes_its_type_is_followed(hub, ros):
    viewer = Viewer()
    hub.view("/eye", Wish(), viewer)
    hub.topics.kinds["/eye"] = COMPRESSED
    support.wait_for(lambda: "/eye" in ros.bytes, "the other type")
    ros.bytes["/eye"](compressed(JPEG_DATA))
    hub.topics.kinds["/eye"] = "std_msgs/String"
    support.wait_for(lambda: viewer.errors, "the type that has no images")
    assert "is of std_msgs/String, must be of sensor_msgs/Image" in viewer.errors[0]
    hub.topics.kinds["/eye"] = IMAGE
    support.wait_for(lambda: "/eye" in ros.pixels, "the first type")
    ros.pixels["/eye"](Frame(image()))
    viewer.wait(2)
    assert ros.log == ["+/eye auto", "-/eye", "+/eye", "-/eye", "+/eye auto"]


def test_a_topic_that_is_not_there_yet_is_waited_for(hub, ros):
    viewer = Viewer()
    hub.view("/later", Wish(), viewer)
    assert ros.log == []
    hub.topics.kinds["/later"] = IMAGE
    support.wait_for(lambda: "/later" in ros.pixels, "the topic")
    del hub.topics.kinds["/later"]  # as a new master does not know it
    asked = hub.topics.asked
    support.wait_for(lambda: hub.topics.asked > asked + 1, "another look")
    ros.pixels["/later"](Frame(image()))
    viewer.wait(1)


@pytest.mark.parametrize(
    "topic, words",
    [
        ("/text", "is of std_msgs/String, must be of"),
        ("eye", "is no name"),
        ("/a b", "is no name"),
        ("", "is no name"),
        ("/<script>", "is no name"),
    ],
)
def test_what_has_no_images_is_refused_in_words(hub, ros, topic, words):
    for call in (
        lambda: hub.view(topic, Wish(), Viewer()),
        lambda: hub.watch(topic, print),
        lambda: hub.newest(topic, 0.1),
    ):
        with pytest.raises(ValueError, match=words):
            call()
    assert ros.log == []


def test_what_was_refused_is_forgotten(hub):
    for number in range(5):
        with pytest.raises(ValueError, match="is no name"):
            hub.view(f"eye{number}", Wish(), Viewer())
    support.wait_for(lambda: not hub._open, "the end of what nobody has got")


def test_a_look_that_fails_is_not_the_last_one(hub):
    hub.watch("/eye", print)
    fail, refresh = threading.Event(), hub.topics.refresh
    hub.topics.refresh = lambda: fail.set() or 1 / 0
    assert fail.wait(support.DEADLINE)
    hub.topics.refresh, asked = refresh, hub.topics.asked
    support.wait_for(lambda: hub.topics.asked > asked, "another look")


def test_an_image_without_pixels_is_not_subscribed_to_again_and_again(hub, ros):
    hub.watch("/eye", print)
    with pytest.raises(FrameError):
        ros.pixels["/eye"](Frame(np.zeros((0, 0, 3), np.uint8)))
    viewer = Viewer()
    hub.view("/eye", Wish(), viewer, passed=True)
    asked = hub.topics.asked
    support.wait_for(lambda: hub.topics.asked > asked + 1, "another look")
    assert ros.log == ["+/eye auto"]
    ros.pixels["/eye"](Frame(image()))
    viewer.wait(1)
    assert len(ros._shared.take(("/eye", "auto"))._callbacks) == 2


def test_images_come_while_another_topic_is_subscribed_to(hub, ros, monkeypatch):
    viewer, gate, entered = Viewer(), threading.Event(), threading.Event()
    hub.view("/eye", Wish(), viewer)
    subscribe = ros._subscribe

    def hanging(topic, callback, transport):
        entered.set()
        assert gate.wait(support.DEADLINE)
        return subscribe(topic, callback, transport)

    monkeypatch.setattr(ros, "_subscribe", hanging)
    other = threading.Thread(target=lambda: hub.watch("/ear", print))
    other.start()
    assert entered.wait(support.DEADLINE)
    sender = threading.Thread(target=lambda: ros.pixels["/eye"](Frame(image())), daemon=True)
    sender.start()
    viewer.wait(1)
    gate.set()
    other.join(support.DEADLINE)
    sender.join(support.DEADLINE)


def test_the_newest_frame_is_that_of_a_viewer_or_is_waited_for(hub, ros):
    hub.watch("/eye", lambda frame: None)
    frame = Frame(image(5))
    ros.pixels["/eye"](frame)
    assert hub.newest("/eye", 0.0) is frame
    with pytest.raises(OSError, match=r"no image has come on /ear within 0\.01 s"):
        hub.newest("/ear", 0.01)
    answers = []
    asker = threading.Thread(target=lambda: answers.append(hub.newest("/ear", support.DEADLINE)))
    asker.start()
    ros.pixels["/ear"](frame)
    asker.join(support.DEADLINE)
    assert answers == [frame]


def test_a_callback_that_fails_keeps_no_image_from_others(hub, ros):
    frames, viewer = [], Viewer()
    hub.watch("/eye", lambda frame: 1 / 0)
    hub.watch("/eye", frames.append)
    hub.view("/eye", Wish(), viewer)
    ros.pixels["/eye"](Frame(image()))
    viewer.wait(1)
    assert len(frames) == 1


def test_pixels_of_a_compressed_topic_come_by_its_transport(ros):
    topics = Topics(**{"eye": IMAGE, "eye/compressed": COMPRESSED, "photo": COMPRESSED})
    hub = ImageHub(topics, ros)
    hub.watch("/eye/compressed", print)
    assert ros.log == ["+/eye compressed"]
    with pytest.raises(ValueError, match="must end in /compressed"):
        hub.watch("/photo", print)
    hub.close()


@pytest.mark.parametrize("passed", [True, False])
def test_depths_that_are_compressed_are_decoded_by_their_transport(ros, passed):
    hub = ImageHub(Topics(**{"eye/compressedDepth": COMPRESSED}), ros)
    viewer = Viewer()
    hub.view("/eye/compressedDepth", Wish(), viewer, passed)
    assert ros.log == ["+/eye compressedDepth"]
    ros.pixels["/eye"](Frame(np.full((48, 64), 1500, np.uint16), "16UC1"))
    assert viewer.wait(1).shape[:2] == (48, 64)
    hub.close()


@pytest.mark.parametrize("base", [True, False])
def test_depths_are_listed_once(base):
    topics = ImageTopics()
    topics._types = {"/eye/compressedDepth": COMPRESSED, **({"/eye": IMAGE} if base else {})}
    topics._publishers = dict.fromkeys(topics._types, frozenset(["/node"]))
    graph = State({name: {"/node"} for name in topics._types}, {}, {}, topics._types, {"/node"})
    shown = [name for name in graph.topics if is_image(name, graph.types, graph.publishers)]
    assert topics.images() == shown == ["/eye" if base else "/eye/compressedDepth"]


def mjpeg_topics(parameter, monkeypatch, nodes=("/cam",)):
    topics = ImageTopics()
    topics._types = {"/cam/image_raw": IMAGE, "/cam/image_raw/compressed": COMPRESSED}
    topics._publishers = dict.fromkeys(topics._types, frozenset(nodes))
    asked = []
    monkeypatch.setattr(image_topics, "server_param", lambda name: asked.append(name) or parameter)
    return topics, asked


def test_an_mjpeg_camera_passes_on_what_it_sends(monkeypatch):
    topics, asked = mjpeg_topics("mjpeg", monkeypatch)
    for _ in range(3):
        assert topics.route("/cam/image_raw", True) == Route("/cam/image_raw/compressed")
    assert asked == ["/cam/pixel_format"]
    assert topics.route("/cam/image_raw", False) == Route("/cam/image_raw", "auto")


@pytest.mark.parametrize("parameter", ["yuyv", None, 3])
def test_of_another_camera_pixels_are_taken(monkeypatch, parameter):
    topics, _ = mjpeg_topics(parameter, monkeypatch)
    assert topics.route("/cam/image_raw", True) == Route("/cam/image_raw", "auto")


def test_a_compressed_topic_of_another_node_is_not_the_cameras(monkeypatch):
    topics, _ = mjpeg_topics("mjpeg", monkeypatch)
    topics._publishers["/cam/image_raw/compressed"] = frozenset(["/republish"])
    assert topics.route("/cam/image_raw", True) == Route("/cam/image_raw", "auto")


@pytest.mark.parametrize(
    "needed, size", [(0, 0), (1, 160), (160, 160), (161, 240), (700, 960), (3840, 3840), (9999, 0)]
)
def test_sizes_are_rounded_up_to_a_few(needed, size):
    assert rounded_up(needed) == size
    assert size in (0, *SIZES)


@pytest.mark.parametrize(
    "wish, size",
    [
        (Wish(), (1920, 1080)),
        (Wish(needed=600), (640, 360)),
        (Wish(needed=9000), (1920, 1080)),
        (Wish(width=100), (100, 56)),
        (Wish(height=100), (178, 100)),
        (Wish(width=3000, height=50), (3000, 50)),
        (Wish(width=1), (1, 1)),
    ],
)
def test_a_wish_becomes_a_size_with_the_images_shape(wish, size):
    picture = Picture(0.0, 0.0, 1920, 1080, Frame(image(0, 1920, 1080)))
    assert wish.of(picture) == Display(JPEG, *size, 80, False)


@pytest.mark.parametrize(
    "needed, size", [(400, (480, 853)), (1080, (1080, 1920)), (0, (1080, 1920))]
)
def test_an_image_on_its_side_has_the_width_that_is_needed(needed, size):
    display = Wish(needed=needed).of(Picture(0.0, 0.0, 1080, 1920, object()))
    assert (display.width, display.height) == size


@pytest.mark.parametrize(
    "wish, source, size",
    [
        (Wish(width=8192, height=8192), (64, 64), (2048, 2048)),
        (Wish(width=8192), (64, 16), (4096, 1024)),
        (Wish(width=8000, height=4000), (4000, 2000), (4000, 2000)),  # no more than it came with
        (Wish(width=4000, height=3000), (4000, 3000), (4000, 3000)),
        (Wish(width=2048, height=2048), (64, 64), (2048, 2048)),
        (Wish(), (8000, 6000), (8000, 6000)),
    ],
)
def test_an_image_is_made_larger_up_to_4_megapixels(wish, source, size):
    display = wish.of(Picture(0.0, 0.0, *source, object()))
    assert (display.width, display.height) == size
