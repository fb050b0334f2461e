"""The node face_recognizer, behind a face detector that this test plays."""

import contextlib
import copy
import itertools
import os
import pathlib
import re
import shutil
import sys
import threading
import time

import cv2
import numpy as np
import pytest
import rosgraph
import rospy
import support
from diagnostic_msgs.msg import DiagnosticStatus
from frames import Source, message, new_topic
from people import ANNA, BERT, CARLA, DORA, photograph, photographs
from sensor_msgs.msg import Image

from robot_vision.faces.face_images import find_face
from robot_vision.faces.face_recognizer import messages_of
from robot_vision.faces.gallery import CACHE, Gallery
from robot_vision.faces.identities import MEMORY, Identity
from robot_vision.msg import Detection, DetectionArray, FaceIdentityArray
from robot_vision.ros.frame_pairs import FramePairs
from robot_vision.ros.messages import region_of
from robot_vision.ros.recent import MAX_BYTES
from robot_vision.srv import EnrollFace, EnrollFolder, ForgetName, ListNames
from robot_vision.transport import Frame

# With these, each image counts, and a busy machine has time for all that is enrolled.
AT_ONCE = ("_votes:=1", "_rate:=100.0", "_enroll_timeout:=60.0")
BLANK = np.full((240, 320, 3), 90, np.uint8)


def face(box, number=-1, **values):
    return Detection(label="face", id=number, score=0.9, box=region_of(box), **values)


def faces_of(image, number=-1):
    """What a detector says of an image with one face."""
    return [face(find_face(image), number)]


class Door:
    """A camera, a face detector, and the node that tells who comes in."""

    def __init__(self, start, *arguments, listen=True):
        topic = new_topic()
        self._stamps = itertools.count(1)
        self._lock = threading.Lock()
        self.images = Source(topic)
        self.faces = Source(topic + "/faces", DetectionArray)
        arguments = [f"image:={topic}", f"faces:={topic}/faces", *arguments]
        self.process = start("face_recognizer.py", "__name:=door", *arguments)
        self.outputs = []
        if listen:
            self.listen()

    def listen(self):
        """Subscribes to all that the node publishes, which makes it work."""
        self.outputs = [
            support.subscribed("/door/faces", DetectionArray),
            support.subscribed("/door/identities", FaceIdentityArray),
            support.subscribed("/door/processed_image", Image),
        ]
        self.images.wait_for()
        self.faces.wait_for()

    def listen_no_more(self):
        """Has the node idle."""
        while self.outputs:
            self.outputs.pop().close()
        self.images.wait_for(0)
        self.faces.wait_for(0)

    def restart_detector(self):
        """Another publisher of faces, whose ids begin anew."""
        topic = self.faces.topic
        self.faces.close()
        # Another detector is another node. To a node that it is connected with rospy connects no
        # second time.
        support.wait_for(lambda: not support.receives("/door", topic), f"no connection to {topic}")
        self.faces = Source(topic, DetectionArray)
        self.faces.wait_for()

    def restart_clock(self):
        """From now on stamps are those of the beginning."""
        self._stamps = itertools.count(0)  # of which no answer has come

    def send(self, pixels, detections, faces_first=False):
        """An image and the faces in it; their stamp."""
        with self._lock:
            image = message(pixels, "bgr8")
            image.header.stamp = rospy.Time(next(self._stamps), 5)
            image.header.frame_id = "eye"
            height, width = pixels.shape[:2]
            found = DetectionArray(image.header, width, height, detections)
            one, other = (self.images.send, image), (self.faces.send, found)
            for send, what in (other, one) if faces_first else (one, other):
                send(what)
            return image.header.stamp

    def answer(self, stamp):
        """What came out of the frame of this stamp: faces, identities, image."""
        answers = [output.of(stamp) for output in self.outputs]
        assert all(answer.header.frame_id == "eye" for answer in answers)
        return answers

    def look(self, person, number=20, of=1):
        """Who the node says that a person in a new image is."""
        image, _ = photograph(person, number)
        _, identities, _ = self.answer(self.send(image, faces_of(image, of)))
        (identity,) = identities.identities
        assert identity.id == of and identity.known == (identity.name != "unknown")
        return identity.name

    @contextlib.contextmanager
    def showing(self, images, faces=faces_of):
        """Shows images again and again, of which no two are the same to the bit."""
        shown = [(image, faces(image)) for image in images]
        over = threading.Event()

        def play():
            for number, (image, detections) in enumerate(itertools.cycle(shown)):
                another = image.copy()
                for face in detections:
                    box = face.box
                    another[box.y_offset + box.height // 2, box.x_offset + box.width // 2] = (
                        number % 256
                    )
                self.send(another, detections)
                if over.wait(0.05):
                    return

        player = threading.Thread(target=play)
        player.start()
        try:
            yield
        finally:
            over.set()
            player.join()


def call(name, kind, *arguments):
    rospy.wait_for_service("/door/" + name, support.DEADLINE)
    return rospy.ServiceProxy("/door/" + name, kind)(*arguments)


def known():
    answer = call("list_names", ListNames)
    return dict(zip(answer.names, answer.pictures))


def enroll(name, images=0):
    return call("enroll", EnrollFace, name, images)


@pytest.fixture(scope="module")
def two_people(tmp_path_factory):
    """The folder of a gallery of theirs."""
    path = tmp_path_factory.mktemp("gallery") / "faces"
    gallery = Gallery(str(path))
    gallery.add("Anna", photographs(ANNA, 8))
    gallery.add("Zoë", photographs(BERT, 8))
    return path


@pytest.fixture
def folder(two_people, tmp_path):
    """A gallery of two people, of the test's own."""
    return pathlib.Path(shutil.copytree(str(two_people), str(tmp_path / "faces")))


def test_two_people_are_told_apart_and_a_third_is_unknown(start, folder):
    door = Door(start, f"_gallery:={folder}", *AT_ONCE)
    assert known() == {"Anna": 8, "Zoë": 8}
    right = []
    for number in range(20, 28):
        found = [door.look(person, number, of=person) for person in (ANNA, BERT, CARLA, DORA)]
        right.append(found == ["Anna", "Zoë", "unknown", "unknown"])
    assert np.mean(right) >= 0.85


def test_outputs_agree_with_the_faces_that_came_in(start, folder):
    door = Door(start, f"_gallery:={folder}", *AT_ONCE)
    door.look(
        DORA, 20, of=DORA
    )  # A node without faces draws a note, so the first ones are another's.
    left, right = (photograph(person, 20)[0] for person in (BERT, CARLA))
    image = np.hstack([left, right])
    x, y, width, height = find_face(right)
    boxes = [find_face(left), (320 + x, y, width, height)]
    sent = [face(boxes[0], 7), face(boxes[1], 9)]
    faces, identities, overlay = door.answer(door.send(image, sent))
    assert (faces.width, faces.height) == (640, 240)
    assert [(one.id, one.label) for one in faces.detections] == [(7, "Zoë"), (9, "unknown")]
    assert [one.box for one in faces.detections] == [one.box for one in sent]
    assert [one.score for one in faces.detections] == [1.0, 1.0]
    zoe, stranger = identities.identities
    assert (zoe.id, zoe.name, zoe.known) == (7, "Zoë", True)
    assert (stranger.id, stranger.name, stranger.known) == (9, "unknown", False)
    assert 0.0 < zoe.distance <= 80.0 < stranger.distance
    drawn = np.frombuffer(overlay.data, np.uint8).reshape(image.shape)
    for (left, top, across, _), color in zip(boxes, [(0, 255, 0), (0, 0, 255)]):
        assert (drawn[top, left : left + across] == color).all(axis=1).mean() > 0.9
    outside = (drawn != image).any(axis=2)
    for left, top, across, down in boxes:
        outside[max(top - 30, 0) : top + down + 3, max(left - 3, 0) : left + across + 60] = False
    assert not outside.any()
    faces, identities, _ = door.answer(door.send(image, []))
    assert not faces.detections and not identities.identities


def test_message_that_came_in_is_not_changed():
    """Other nodes that share the process, and the message, still need the detector's words."""
    header = stamped(DetectionArray, 3.5).header
    faces = DetectionArray(header, 320, 240, [face((10, 20, 30, 40), 7, predicted=True)])
    before = copy.deepcopy(faces)
    named, whose = messages_of(faces, [Identity("Zoë", 50.0, 0.6)])
    named.header.seq = whose.header.seq = 99  # as rospy does when it publishes
    assert faces == before
    (one,) = named.detections
    assert (one.label, one.score, one.id, one.predicted) == ("Zoë", 0.6, 7, True)


def remembered(seen):
    """What `seen` tells of a new face, by its id, if no face was forgotten meanwhile."""
    ids = itertools.count(10, 2)

    def told():
        begin = time.monotonic()
        names = seen(next(ids))
        return names if time.monotonic() - begin < MEMORY else None

    return support.wait_for(told, "faces without a pause")


def test_name_is_voted_and_kept(start, folder):
    door = Door(start, f"_gallery:={folder}", "_votes:=5", "_rate:=100.0")

    def seen(of):
        names = []
        for number in range(20, 32):
            names.append(door.look(ANNA if number != 27 else CARLA, number, of))
            time.sleep(0.02)  # longer than between two looks
        names.append(door.look(BERT, 20, of + 1))  # another face, another vote
        return [*names, door.look(ANNA, 33, of)]

    *names, other, last = remembered(seen)
    assert names[0] == "unknown" and set(names[5:]) == {"Anna"}
    assert (other, last) == ("unknown", "Anna")


def test_looks_are_limited(start, folder):
    door = Door(start, f"_gallery:={folder}", "_votes:=1", "_rate:=0.1")

    def seen(of):
        return of, [door.look(ANNA, of=of), door.look(CARLA, of=of)]  # who is not looked at

    of, names = remembered(seen)
    assert names == ["Anna", "Anna"]
    assert door.look(CARLA, of=2) == "unknown"
    assert door.look(CARLA, of=-1) == "unknown" and door.look(ANNA, of=-1) == "Anna"
    assert call("forget_name", ForgetName, "Anna").success
    assert door.look(ANNA, of=of) == "unknown"  # at once


def test_names_are_not_handed_on_when_the_detector_begins_anew(start, folder):
    door = Door(start, f"_gallery:={folder}", "_votes:=1", "_rate:=0.1")
    assert door.look(ANNA) == "Anna"
    door.restart_detector()
    assert door.look(BERT) == "Zoë"
    door.restart_clock()
    assert door.look(CARLA) == "unknown"


def test_predicted_face_keeps_its_name_unseen(start, folder):
    door = Door(start, f"_gallery:={folder}", *AT_ONCE)

    def seen(of):
        name = door.look(ANNA, of=of)
        unseen = [face((10, 10, 50, 50), one, predicted=True) for one in (of, of + 1)]
        _, identities, _ = door.answer(door.send(BLANK, unseen))
        return [name, *(one.name for one in identities.identities)]

    assert remembered(seen) == ["Anna", "Anna", "unknown"]


def test_faces_may_come_before_their_image_or_late(start, folder):
    door = Door(start, f"_gallery:={folder}", *AT_ONCE)
    anna, carla = photograph(ANNA, 20)[0], photograph(CARLA, 20)[0]
    for first in (True, False):
        stamp = door.send(anna, faces_of(anna, 1), faces_first=first)
        assert door.answer(stamp)[1].identities[0].name == "Anna"
    # The image is that of the stamp, not the newest one.
    late = message(anna, "bgr8")
    late.header.stamp, late.header.frame_id = rospy.Time(1000), "eye"
    found = DetectionArray(late.header, 320, 240, faces_of(anna, 3))
    deadline = time.monotonic() + support.DEADLINE
    while not any(m.header.stamp == late.header.stamp for m in door.outputs[1].received):
        assert time.monotonic() < deadline
        door.images.send(late)
        newer = message(carla, "bgr8")
        newer.header.stamp = rospy.Time.now()
        door.images.send(newer)
        time.sleep(0.05)
        door.faces.send(found)
    assert door.answer(late.header.stamp)[1].identities[0].name == "Anna"


def test_images_do_not_wait_while_nobody_listens(start, folder, diagnostics):
    door = Door(start, f"_gallery:={folder}", "_diagnostic_period:=0.1", *AT_ONCE)
    anna = photograph(ANNA, 20)[0]
    waits = message(anna, "bgr8")
    waits.header.stamp = rospy.Time(0, 7)
    door.images.send(waits)
    support.wait_for(
        lambda: diagnostics.value("door", "frames received") == "1", "the image in the node"
    )
    door.listen_no_more()
    door.listen()
    door.faces.send(DetectionArray(waits.header, 320, 240, faces_of(anna)))
    assert door.look(ANNA) == "Anna"
    assert all(m.header.stamp != waits.header.stamp for o in door.outputs for m in o.received)


def test_enrolling_from_the_live_image_without_subscribers(start, tmp_path):
    door = Door(start, f"_gallery:={tmp_path / 'faces'}", *AT_ONCE, listen=False)

    def subscribed():
        topics = dict(rosgraph.Master("/test").getSystemState()[1])
        return {
            node
            for topic in (door.images.topic, door.faces.topic)
            for node in topics.get(topic, [])
            if node.startswith("/door")
        }

    assert known() == {} and not subscribed()
    with door.showing([photograph(ANNA, number)[0] for number in range(11)]):
        answer = enroll("Anna", 6)
    assert answer.success and answer.pictures > 3, answer
    support.wait_for(lambda: not subscribed(), "the end of the work")
    with door.showing([photograph(BERT, number)[0] for number in range(11)]):
        answer = enroll("李")
    assert answer.success and answer.message.startswith(f"{answer.pictures} images of 李 added")
    assert set(known()) == {"Anna", "李"}
    kept = [name for name in os.listdir(str(tmp_path / "faces" / "李")) if name[0] != "."]
    assert len(kept) == answer.pictures
    door.process.interrupt()
    assert door.process.exit_code() == 0

    door = Door(start, f"_gallery:={tmp_path / 'faces'}", *AT_ONCE)
    assert [door.look(p, of=p) for p in (ANNA, BERT, CARLA)] == ["Anna", "李", "unknown"]


def test_enrolling_fails_clearly_and_changes_nothing(start, folder):
    options = (*AT_ONCE, "_enroll_timeout:=1.5")
    door = Door(start, f"_gallery:={folder}", *options)
    anna = photograph(ANNA, 20)[0]
    twice = faces_of(anna) * 2
    with_unseen = [*faces_of(anna, 1), face((5, 5, 40, 40), 2, predicted=True)]
    cases = [
        (lambda image: with_unseen, "took 0 of 2 images; .* showed several faces, within"),
        (lambda image: [], "took 0 of 2 images; .* showed no face, within 1.5 s"),
        (lambda image: twice, "took 0 of 2 images; .* showed several faces, within"),
        (lambda image: [face((5, 5, 40, 40))], "took 0 of 2 images; .* showed no clear face"),
    ]

    def says(text):
        answer = enroll("Eve", 2)
        assert not answer.success and answer.pictures == 0
        return re.search(text, answer.message)

    for faces, text in cases:
        with door.showing([anna], faces):
            support.wait_for(lambda says_this=text: says(says_this), text)
        assert door.look(ANNA, of=-1) == "Anna"
    started = time.monotonic()
    answer = enroll("Eve", 2)
    told = "took 0 of 2 images; saw no others, within 1.5 s"
    assert not answer.success and told in answer.message
    assert re.search(f"within 1.5 s: .*no faces on {door.faces.topic} for ", answer.message)
    assert time.monotonic() - started >= 1.5
    for name, count, text in [
        ("../Eve", 1, "must not hold"),
        ("", 1, "a name of 0 characters, must have 1 to 60"),
        ("unknown", 1, "nobody can be called 'unknown'"),
        ("Eve", 101, "pictures is 101, must be from 1 to 100"),
    ]:
        answer = enroll(name, count)
        assert not answer.success and text in answer.message
    assert known() == {"Anna": 8, "Zoë": 8}
    assert sorted(os.listdir(str(folder))) == [CACHE, "Anna", "Zoë"]
    assert door.look(ANNA, 25, of=-1) == "Anna"


def test_who_is_missing_is_told_wherever_somebody_looks(start, folder, diagnostics):
    """In the answer, the log, the overlay and the diagnostics."""
    door = Door(start, f"_gallery:={folder}", "_enroll_timeout:=1.5", "_diagnostic_period:=0.1")
    door.faces.close()
    nobody = f"nobody publishes faces on {door.faces.topic}"
    support.wait_for(lambda: nobody in enroll("Eve", 2).message, nobody)

    def warned():
        door.images.send(message(BLANK, "bgr8"))
        return f"{nobody}: is there a face detector?" in door.process.output()

    support.wait_for(warned, nobody)
    overlay = door.outputs[-1].wait(1)[0]
    pixels = np.frombuffer(overlay.data, np.uint8).reshape(BLANK.shape)
    assert (pixels[:30] != BLANK[:30]).any() and np.array_equal(pixels[40:], BLANK[40:])

    def status_says():
        door.images.send(message(BLANK, "bgr8"))
        status = diagnostics.next("door")
        return status.message.startswith(nobody) and status.level == DiagnosticStatus.WARN

    support.wait_for(status_says, "the warning in the diagnostics")
    assert diagnostics.value("door", "frames published") == "0"


def answers_of(ask, times=1):
    """The answers of a service that is asked in threads, and the threads; the node may end."""
    answers = []

    def wait():
        with contextlib.suppress(rospy.ServiceException):
            answers.append(ask())

    threads = [threading.Thread(target=wait, daemon=True) for _ in range(times)]
    for thread in threads:
        thread.start()
    return answers, threads


def assert_ended(threads):
    for thread in threads:
        thread.join(support.DEADLINE)
        assert not thread.is_alive()


def test_one_is_enrolled_at_a_time_and_the_node_ends_meanwhile(start, folder):
    door = Door(start, f"_gallery:={folder}", "_enroll_timeout:=600.0")
    answers, waiting = answers_of(lambda: enroll("Eve"), 2)
    (refused,) = support.wait_for(lambda: answers, "the refusal of one of the two")
    assert not refused.success and refused.message == "somebody else is being enrolled"
    door.process.interrupt()
    assert door.process.prompt_exit_code() == 0
    assert_ended(waiting)
    assert not any(answer.success for answer in answers)


def test_node_ends_while_a_folder_is_enrolled(start, tmp_path):
    photo = cv2.resize(photograph(ANNA, 0)[0], (1600, 1200))
    for name in ("Anna", "Eve"):
        (tmp_path / "course" / name).mkdir(parents=True)
        cv2.imwrite(str(tmp_path / "course" / name / "0.bmp"), photo)
    eve = tmp_path / "course" / "Eve"
    for number in range(1, 300):
        (eve / f"{number}.bmp").symlink_to(eve / "0.bmp")
    door = Door(start, f"_gallery:={tmp_path / 'faces'}", listen=False)
    assert known() == {}
    answers, waiting = answers_of(
        lambda: call("enroll_folder", EnrollFolder, str(tmp_path / "course"), "")
    )
    support.wait_for(lambda: known() == {"Anna": 1}, "the first name, while the second is read")
    door.process.interrupt()
    assert door.process.prompt_exit_code() == 0, door.process.output()
    assert_ended(waiting)
    assert not any(answer.success for answer in answers)


def test_folders_are_enrolled_listed_and_forgotten(start, tmp_path):
    course = tmp_path / "course"
    for name, person in [("Anna", ANNA), ("Zoë", BERT)]:
        (course / name).mkdir(parents=True)
        for number in range(4):
            cv2.imwrite(str(course / name / f"{number}.png"), photograph(person, number)[0])
    (course / "Anna" / "broken.jpg").write_text("")
    door = Door(start, f"_gallery:={tmp_path / 'faces'}", *AT_ONCE)
    assert door.look(ANNA) == "unknown"
    answer = call("enroll_folder", EnrollFolder, str(course), "")
    assert answer.success and answer.pictures == 8
    assert answer.message == "8 images of people added, 1 problems"
    assert answer.problems == [f"{course}/Anna/broken.jpg: no image that OpenCV can read"]
    assert known() == {"Anna": 4, "Zoë": 4}
    assert [door.look(p, of=p) for p in (ANNA, BERT, CARLA)] == ["Anna", "Zoë", "unknown"]
    answer = call("enroll_folder", EnrollFolder, str(course / "Zoë"), "Bert")
    assert answer.success and known() == {"Anna": 4, "Bert": 4, "Zoë": 4}
    for name in ("Bert", "Zoë"):
        answer = call("forget_name", ForgetName, name)
        assert answer.success and answer.pictures == 4
    assert known() == {"Anna": 4} and os.listdir(str(tmp_path / "faces" / "Anna"))
    assert [door.look(p, of=p) for p in (ANNA, BERT)] == ["Anna", "unknown"]
    for name in ("Zoë", "..", "course"):
        assert not call("forget_name", ForgetName, name).success
    for folder, text in [
        ("course", "must be an absolute path"),
        ("/nowhere", "/nowhere cannot be read: No"),
    ]:
        answer = call("enroll_folder", EnrollFolder, folder, "")
        assert not answer.success and text in answer.message
    answer = call("enroll_folder", EnrollFolder, str(course), "Eve")  # no images of its own
    assert not answer.success and answer.pictures == 0
    assert answer.message.endswith(f": {course}: there are no images in it")
    answer = call("enroll_folder", EnrollFolder, str(course / "Anna"), "")  # a person's own
    assert not answer.success and answer.pictures == 0
    assert answer.message.startswith(f"{course}/Anna must have a folder for each person, as Anna/1")
    assert course.exists() and door.look(ANNA) == "Anna"


def test_forgotten_are_not_named_though_the_file_of_faces_cannot_be_written(start, folder):
    door = Door(start, f"_gallery:={folder}", *AT_ONCE)
    assert door.look(ANNA) == "Anna"
    (folder / CACHE).unlink()
    (folder / CACHE).mkdir()
    answer = call("forget_name", ForgetName, "Anna")
    assert not answer.success and answer.pictures == 8
    assert answer.message.startswith("Anna is forgotten; .faces")
    assert door.look(ANNA) == "unknown" and known() == {"Zoë": 8}


def test_distance_of_strangers_is_changed_live(start, folder):
    door = Door(start, f"_gallery:={folder}", *AT_ONCE)
    assert door.look(ANNA) == "Anna"
    support.reconfigured("/door", max_distance=1.0)
    assert door.look(ANNA, 21) == "unknown"
    support.reconfigured("/door", max_distance=1000.0)
    assert door.look(CARLA, 21) in ("Anna", "Zoë")
    config = support.reconfigured("/door", max_distance=-1.0, votes=0)
    assert (config["max_distance"], config["votes"]) == (1000.0, 1)
    door.process.wait_for_output("refused, the parameters stay as they are: ")


def test_damaged_gallery_is_told_mended_and_used(start, folder):
    (folder / CACHE).write_bytes((folder / CACHE).read_bytes()[:-100])
    (folder / "Anna" / "9.png").write_bytes((folder / "Anna" / "1.png").read_bytes()[:500])
    door = Door(start, f"_gallery:={folder}", *AT_ONCE)
    door.process.wait_for_output(".faces is made anew from the images: it is damaged")
    door.process.wait_for_output("Anna/9.png is not used: PNG of 500 bytes is damaged or truncated")
    assert [door.look(p, of=p) for p in (ANNA, BERT)] == ["Anna", "Zoë"]


def test_gallery_that_cannot_be_made_is_told_when_it_is_needed(start):
    door = Door(start, "_gallery:=/proc/faces", *AT_ONCE)
    with door.showing([photograph(ANNA, number)[0] for number in range(2)]):
        answer = enroll("Anna", 2)
    assert not answer.success and "/proc/faces" in answer.message
    assert known() == {} and door.look(ANNA) == "unknown"


@pytest.mark.parametrize(
    "box, predicted, text",
    [
        ((310, 230, 0, 10), False, "the box 0x10 at (310, 230) is not in the image of 320x240"),
        ((330, 10, 20, 20), True, "the box 20x20 at (330, 10) is not in the image of 320x240"),
        ((0, 0, 2**32 - 1, 9), False, "the box 4294967295x9, must have sides of at most 640 px"),
        ((0, 0, 9, 2**32 - 1), True, "the box 9x4294967295, must have sides of at most 640 px"),
    ],
)
def test_boxes_that_cannot_be_used_are_refused(start, folder, box, predicted, text):
    door = Door(start, f"_gallery:={folder}", *AT_ONCE)
    door.send(photograph(ANNA, 20)[0], [face(box, 1, predicted=predicted)])
    door.process.wait_for_output("faces that cannot be used: " + text)
    assert door.look(ANNA) == "Anna"
    assert "Traceback" not in door.process.output()


def test_only_the_best_of_thousands_of_faces_are_looked_at(start, folder):
    door = Door(start, f"_gallery:={folder}", *AT_ONCE)
    many = [face((x, y, 20, 20)) for y in range(50) for x in range(60)]
    for one, rank in zip(many, np.random.default_rng(1).permutation(len(many))):
        one.score = 1.0 - rank / len(many)
    named, identities, _ = door.answer(door.send(BLANK, many))
    best = sorted(many, key=lambda one: one.score, reverse=True)[:100]
    assert [one.box for one in named.detections] == [one.box for one in best]
    assert len(identities.identities) == 100
    text = "3000 detections in a message: only the 100 of the highest score are looked at"
    door.process.wait_for_output(text)
    assert door.look(ANNA) == "Anna"


@pytest.mark.parametrize("faces_first", [False, True])
def test_faces_of_an_image_of_another_size_are_refused(start, folder, diagnostics, faces_first):
    door = Door(start, f"_gallery:={folder}", "_diagnostic_period:=0.1", *AT_ONCE)
    anna = photograph(ANNA, 20)[0]
    image = message(anna, "bgr8")
    image.header.stamp = rospy.Time(500)
    faces = DetectionArray(image.header, 640, 480, faces_of(anna))
    one, other = (door.images.send, image), (door.faces.send, faces)
    for send, what in (other, one) if faces_first else (one, other):
        send(what)
    door.process.wait_for_output("faces of an image of 640x480, not 320x240")
    support.wait_for(lambda: diagnostics.value("door", "frames refused") == "1", "the refused one")
    assert door.look(ANNA) == "Anna"


def test_missing_faces_and_those_of_another_camera_are_told(start, folder, diagnostics):
    often, short = "_diagnostic_period:=0.2", "_enroll_timeout:=1"
    door = Door(start, f"_gallery:={folder}", *AT_ONCE, often, short)
    image = message(BLANK, "bgr8")
    seconds = itertools.count(1000)

    def tell():
        image.header.stamp = rospy.Time(next(seconds))
        door.images.send(image)
        output = door.process.output()
        return re.search(f"no faces on {door.faces.topic} for .* is there a face detector", output)

    support.wait_for(tell, "the warning that there is no detector")

    text = f"no images on {door.images.topic} have the stamps of {door.faces.topic}: is it another"

    def send_of_others():
        image.header.stamp = rospy.Time(next(seconds))
        found = stamped(DetectionArray, next(seconds) + 0.5)
        found.width, found.height = 320, 240
        door.images.send(image)
        door.faces.send(found)

    def tell_of_others():  # until it is told: the node takes the newest only
        send_of_others()
        return text in door.process.output()

    support.wait_for(tell_of_others, "the warning that the faces are another camera's")
    status = support.wait_for(
        lambda: (
            send_of_others() or [one for one in [diagnostics.next("door")] if text in one.message]
        ),
        "that in the status",
    )
    assert status[0].level == DiagnosticStatus.WARN
    answers = []
    call_of_enroll = threading.Thread(
        target=lambda: answers.append(call("enroll", EnrollFace, "Emil", 1))
    )
    call_of_enroll.start()
    while call_of_enroll.is_alive():
        send_of_others()
        call_of_enroll.join(0.05)
    assert not answers[0].success and text in answers[0].message
    assert door.look(ANNA) == "Anna"


def test_default_gallery_is_in_the_folder_of_ros(start, tmp_path):
    cv2.imwrite(str(tmp_path / "photo.png"), photograph(ANNA, 0)[0])
    start("face_recognizer.py", "__name:=door", env={"ROS_HOME": str(tmp_path / "home")})
    assert call("enroll_folder", EnrollFolder, str(tmp_path), "Anna").pictures == 1
    assert (tmp_path / "home" / "robot_vision" / "faces" / "Anna" / "1.png").is_file()


def test_bad_value_at_start_is_fatal(start):
    text = "gallery is '/etc/passwd', must be a folder"
    support.assert_fatal_at_start(start, "face_recognizer.py", "gallery", "/etc/passwd", text)


def stamped(kind, secs):
    made = kind()
    made.header.stamp = rospy.Time.from_sec(secs)
    return made


def frames_of(seconds, image=BLANK):
    return [Frame(image, "bgr8", stamped(DetectionArray, s).header) for s in seconds]


def held(frames):
    """How often each of these frames is held."""
    return [sys.getrefcount(frame) for frame in frames]


def test_pairs_hold_only_what_may_be_needed():
    pairs = FramePairs()
    seconds = [0.1 * n for n in range(100)]
    frames = frames_of(seconds)
    before = held(frames)
    assert [pairs.message_of(frame) for frame in frames] == [None] * 100
    assert pairs.frame_of(stamped(DetectionArray, seconds[75])) is None  # too late
    assert pairs.frame_of(stamped(DetectionArray, seconds[85])) is frames[85]
    assert pairs.frame_of(stamped(DetectionArray, seconds[84])) is None  # 85 was later
    assert pairs.frame_of(stamped(DetectionArray, seconds[99])) is frames[99]
    assert held(frames) == before
    waits = stamped(DetectionArray, 200)
    assert pairs.frame_of(waits) is None
    assert pairs.message_of(Frame(BLANK, "bgr8", waits.header)) is waits


def test_pairs_wait_for_a_detector_that_is_far_behind():
    pairs = FramePairs()
    frames = frames_of([n / 30.0 for n in range(90)])
    for number, frame in enumerate(frames):
        pairs.message_of(frame)
        if number >= 30:  # 1 s behind
            assert (
                pairs.frame_of(stamped(DetectionArray, (number - 30) / 30.0)) is frames[number - 30]
            )
    assert not pairs.apart()


def test_pairs_hold_no_more_than_their_bytes_nor_of_another_time():
    pairs = FramePairs()
    large = np.zeros((2000, 2000, 3), np.uint8)
    frames = frames_of([0.01 * n for n in range(50)], large)
    before = held(frames)
    assert [pairs.message_of(frame) for frame in frames] == [None] * 50
    kept = [now > then for now, then in zip(held(frames), before)]
    assert sum(kept) == MAX_BYTES // large.nbytes and all(kept[-5:])
    (earlier,) = frames_of([0.001])
    pairs.message_of(earlier)
    assert held(frames) == before
    pairs.clear()
    assert pairs.frame_of(stamped(DetectionArray, 0.001)) is None


def test_pairs_are_apart_only_while_nothing_fits():
    pairs = FramePairs()
    for number in range(20):  # before the first frame
        pairs.frame_of(stamped(DetectionArray, 0.1 * number))
        assert not pairs.apart()
    pairs.clear()
    for frame in frames_of(range(100, 110)):
        pairs.message_of(frame)
        assert not pairs.apart()
        pairs.frame_of(stamped(DetectionArray, frame.header.stamp.to_sec() + 0.5))
    assert pairs.apart()
    for frame in frames_of(range(120, 125)):
        pairs.message_of(frame)
        assert pairs.frame_of(stamped(DetectionArray, frame.header.stamp.to_sec())) is frame
        assert not pairs.apart()


def test_pairs_with_slop_are_of_the_nearest_stamps():
    pairs = FramePairs(slop=0.02)
    early, near, late = frames_of([1.0, 1.015, 1.033])
    for frame in (early, near, late):
        assert pairs.message_of(frame) is None
    assert pairs.frame_of(stamped(DetectionArray, 1.02)) is near
    assert pairs.frame_of(stamped(DetectionArray, 1.0)) is None  # dropped, as 1.015 was taken
    assert pairs.frame_of(stamped(DetectionArray, 1.052)) is late
    waits = stamped(DetectionArray, 1.1)
    assert pairs.frame_of(waits) is None
    (too_late, fits) = frames_of([1.121, 1.119])
    assert pairs.distance() == float("inf")
    assert pairs.message_of(too_late) is None
    assert pairs.distance() == pytest.approx(0.021)
    assert pairs.message_of(fits) is waits


def test_pairs_of_frames_hold_no_more_than_their_bytes_of_either():
    pairs = FramePairs()
    large = np.zeros((2000, 2000, 3), np.uint8)
    frames = frames_of([0.01 * n for n in range(50)], large)
    before = held(frames)
    assert [pairs.frame_of(frame) for frame in frames] == [None] * 50
    kept = [now > then for now, then in zip(held(frames), before)]
    assert sum(kept) == MAX_BYTES // large.nbytes and all(kept[-5:])
