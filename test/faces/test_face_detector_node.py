"""The node face_detector: what it publishes, and what it makes of bad cascades."""

import numpy as np
import pytest
import support
from faces import BACKGROUND, RATE, frame, iou
from frames import Camera
from sensor_msgs.msg import Image

from robot_vision.faces.face_detector import slowness_text
from robot_vision.msg import DetectionArray


class Person:
    """A camera at 30 Hz of its own time, and what the node says of its frames."""

    def __init__(self, start, *arguments):
        self._camera = Camera(RATE)
        self.process = start(
            "face_detector.py",
            "__name:=finder",
            f"image:={self._camera.topic}",
            "_haar_maxSize:=0",
            "_cascade_2:=''",
            *arguments,
        )
        self.faces = support.subscribed("/finder/faces", DetectionArray)
        self._camera.wait_for()

    def show(self, image):
        """Shows an image; its header and what is found."""
        header = self._camera.show(image)
        return header, self.answer(self.faces, header)

    @staticmethod
    def answer(messages, header):
        answer = messages.of(header.stamp)
        assert answer.header.frame_id == header.frame_id
        return answer

    def show_until_found(self, number=0):
        """Shows a frame until its face is found: its header, the face, and where it is."""
        image, truth = frame(number)

        def found():
            header, faces = self.show(image)
            return [(header, face, truth) for face in at(truth, faces)]

        return support.wait_for(found, "a face")[0]


def at(truth, faces):
    """The faces there: the cascades see others on the portrait's flag and suit."""
    return [face for face in faces.detections if iou(box_of(face), truth) >= 0.5]


def box_of(detection):
    box = detection.box
    return box.x_offset, box.y_offset, box.width, box.height


def test_faces_are_published_and_drawn_field_by_field(start):
    person = Person(start)
    eyes = support.subscribed("/finder/eyes", DetectionArray)
    overlays = support.subscribed("/finder/processed_image", Image)
    for _ in range(3):
        _, faces = person.show(BACKGROUND)
        assert (faces.width, faces.height, faces.detections) == (640, 480, [])
    header, face, _ = person.show_until_found()
    x, y, width, height = box_of(face)
    assert (face.label, face.predicted) == ("face", False) and face.id >= 0
    assert 0.3 < face.score <= 1.0 and face.area == width * height
    assert (face.center.x, face.center.y) == (x + (width - 1) / 2, y + (height - 1) / 2)
    right, bottom = x + width - 1, y + height - 1
    corners = [(x, y), (right, y), (right, bottom), (x, bottom)]
    assert [(point.x, point.y) for point in face.outline] == corners
    found = [eye for eye in person.answer(eyes, header).detections if eye.id == face.id]
    assert [eye.label for eye in found] == ["eye", "eye"]
    for eye in found:
        assert x < eye.center.x < x + width and y < eye.center.y < y + 0.6 * height
    overlay = person.answer(overlays, header)
    pixels = np.frombuffer(overlay.data, np.uint8).reshape(480, 640, 3)
    assert (pixels[y, x + 5 : right - 5] == (0, 255, 0)).all()
    left = found[0].box
    assert (pixels[left.y_offset, left.x_offset + 3 : left.x_offset + 9] == (255, 200, 0)).all()


def test_a_face_keeps_its_id_while_it_moves_with_a_velocity(start):
    person = Person(start)
    _, first, _ = person.show_until_found()
    for number in range(1, 20):
        image, truth = frame(number)
        (face,) = at(truth, person.show(image)[1])
        assert face.id == first.id
    before = frame(18)[1]
    speed = RATE * (truth[0] - before[0]), RATE * (truth[1] - before[1])
    assert face.has_velocity
    assert face.velocity.x == pytest.approx(speed[0], abs=0.5 * speed[0])
    assert face.velocity.y == pytest.approx(speed[1], abs=0.5 * speed[0])


def test_parameters_change_live_and_bad_ones_are_refused(start, tmp_path):
    empty = tmp_path / "empty.xml"
    empty.write_text("")
    person = Person(start)
    person.show_until_found()
    support.reconfigured("/finder", haar_maxSize=60)
    assert not person.show(BACKGROUND)[1].detections
    for number in range(3):
        for small in person.show(frame(number)[0])[1].detections:
            assert small.box.width <= 60
    support.reconfigured("/finder", haar_maxSize=0)
    _, face, truth = person.show_until_found(3)
    for name, value, text in (
        ("cascade_1", "none.xml", "cascade_1 is 'none.xml', which is in none of"),
        ("cascade_1", str(empty), f"cascade_1 is '{empty}', which is empty"),
        ("eye_cascade", "/etc/passwd", "eye_cascade is '/etc/passwd', which is no cascade"),
        ("haar_maxSize", 30, "haar_maxSize is 30, must be 0 (any) or from haar_minSize (40) to"),
    ):
        assert support.reconfigured("/finder", **{name: value})[name] != value
        person.process.wait_for_output("refused, the parameters stay as they are: " + text)
        (after,) = at(truth, person.show(frame(3)[0])[1])
        assert after.id == face.id


@pytest.mark.parametrize(
    "search_time, period, after",
    [(0.24, 0.5, ""), (0.26, 0.5, "0.52"), (0.6, 0.5, "1.20"), (0.26, 0.0, ""), (0.0, 0.5, "")],
)
def test_searches_that_take_longer_than_half_of_the_period_are_too_slow(search_time, period, after):
    text = slowness_text(search_time, period)
    assert text.startswith(f"a new face may be found after {after} s only, ") if after else not text


def test_searches_that_are_too_slow_are_told(start):
    person = Person(start, "_max_search_period:=0.01")  # A search takes a frame at least.
    person.show_until_found()
    text = "s only, max_search_period is 0.01 s"
    support.wait_for(lambda: person.show(BACKGROUND) and text in person.process.output(), text)


def test_bad_value_at_start_is_fatal(start):
    text = "cascade_2 is '/no/where.xml', there is no such file"
    support.assert_fatal_at_start(start, "face_detector.py", "cascade_2", "/no/where.xml", text)
