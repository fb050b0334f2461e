"""A gallery of people on the disk: kept, imported, mended, and never left."""

import concurrent.futures
import contextlib
import errno
import hashlib
import itertools
import os
import shutil
import struct
import tempfile
import threading
from unittest.mock import Mock

import cv2
import numpy as np
import pytest
from exif import sideways
from people import ANNA, BERT, CARLA, photograph, photographs

import robot_vision.faces.face_cache
import robot_vision.faces.gallery_files
from robot_vision.faces.face_cache import HEAD
from robot_vision.faces.face_images import find_face
from robot_vision.faces.gallery import CACHE, Added, Gallery, Removed
from robot_vision.faces.gallery_files import MAX_FILE

ESCAPES = ["", ".", "..", "../Anna", "/tmp/Anna", "a/b", "a\\b", ".Anna", " Anna", "Anna ", "a\nb"]
ESCAPES += [
    "a\u202eb",
    "a\u200bb",
    "\ufeffa",
    "a\0b",
    "a\x1bb",
    "\u2028",
    "\udc80",
    "x" * 61,
    "unknown",
]


@pytest.fixture(scope="module")
def two_people(tmp_path_factory):
    folder = tmp_path_factory.mktemp("two people") / "faces"
    gallery = Gallery(str(folder))
    assert gallery.add("Anna", photographs(ANNA, 3)).pictures == 3
    assert gallery.add("Bert", photographs(BERT, 2)).pictures == 2
    return folder


@pytest.fixture
def folder(two_people, tmp_path):
    """A gallery of two people."""
    return shutil.copytree(two_people, tmp_path / "faces")


@pytest.fixture
def searched(monkeypatch):
    """The images in which a face has been looked for."""
    images = []

    def find(image):
        images.append(image)
        return find_face(image)

    monkeypatch.setattr("robot_vision.faces.face_images.find_face", find)
    return images


def loaded(folder):
    """The gallery of a folder, and the problems with it."""
    gallery = Gallery(str(folder))
    return gallery, gallery.load()


def same_faces(one, other):
    (faces, labels), (others, others_labels) = one.training(), other.training()
    key = [(label, face.tobytes()) for face, label in zip(faces, labels)]
    other_key = [(label, face.tobytes()) for face, label in zip(others, others_labels)]
    return one.names() == other.names() and sorted(key) == sorted(other_key)


def files(folder):
    """All files below a folder, and what they hold."""
    return {
        str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()
    }


def test_what_was_added_is_there_after_a_start_without_a_search(folder, searched):
    gallery, problems = loaded(folder)
    assert not problems and not searched
    assert list(gallery.names().items()) == [("Anna", 3), ("Bert", 2)]
    faces, labels = gallery.training()
    assert sorted(labels) == ["Anna"] * 3 + ["Bert"] * 2 and len(faces) == 5
    names = ["Anna/1.png", "Anna/2.png", "Anna/3.png", "Bert/1.png", "Bert/2.png"]
    assert sorted(files(folder)) == [CACHE, *names]
    image = cv2.imread(str(folder / "Anna" / "2.png"))
    assert np.array_equal(image, photograph(ANNA, 1)[0])


def test_gallery_that_is_not_there_is_empty_and_made_when_needed(tmp_path):
    folder = tmp_path / "new" / "faces"
    gallery, problems = loaded(folder)
    assert not problems and gallery.names() == {} and gallery.training() == ([], [])
    assert not folder.exists()
    gallery.add("Anna", photographs(ANNA, 1))
    assert folder.stat().st_mode & 0o777 == 0o700  # faces are nobody else's business
    assert same_faces(gallery, loaded(folder)[0])


def test_gallery_that_is_no_folder_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match=r"gallery is '.*/file', must be a folder"):
        Gallery(str(tmp_path / "file"))


@pytest.mark.parametrize(
    "name", ["Zoë", "李", "Ann-Marie O'Neil", "x" * 60, "😀" * 60, "~", "$HOME"]
)
def test_names_of_all_scripts(tmp_path, name):
    gallery = Gallery(str(tmp_path))
    gallery.add(name, photographs(ANNA, 1))
    gallery, problems = loaded(tmp_path)
    assert not problems and gallery.names() == {name: 1}
    assert gallery.forget(name).pictures == 1
    assert os.listdir(tmp_path) == [CACHE]


def test_names_that_read_the_same_are_one_person(tmp_path):
    composed, decomposed = "Zo\u00eb", "Zoe\u0308"
    gallery = Gallery(str(tmp_path / "faces"))
    gallery.add(decomposed, photographs(ANNA, 1))
    (tmp_path / "course" / decomposed).mkdir(parents=True)
    cv2.imwrite(str(tmp_path / "course" / decomposed / "1.png"), photograph(ANNA, 1)[0])
    assert gallery.import_folder(str(tmp_path / "course")).pictures == 1
    gallery.add(composed, photographs(ANNA, 1, first=2))
    assert gallery.names() == {composed: 3}
    (tmp_path / "faces" / decomposed).mkdir()
    other, (problem,) = loaded(tmp_path / "faces")
    assert other.names() == {composed: 3}
    assert problem.endswith(r"its name must be in Unicode's form NFC, 'Zoe\u0308' is not")
    assert gallery.forget(decomposed).pictures == 3


@pytest.mark.parametrize("name", ESCAPES)
def test_names_that_are_none_change_nothing(folder, name):
    gallery = loaded(folder)[0]
    before = files(folder.parent)
    for use in (
        lambda: gallery.add(name, photographs(CARLA, 1)),
        lambda: gallery.forget(name),
        lambda: (name and gallery.import_folder(str(folder), name)) or gallery.forget(name),
    ):
        with pytest.raises(ValueError, match=r"name|nobody"):
            use()
    assert files(folder.parent) == before


def test_links_out_of_the_gallery_are_not_followed(folder):
    outside = folder.parent / "outside"
    shutil.copytree(str(folder / "Bert"), str(outside))
    (folder / "Eve").symlink_to(outside)
    (folder / "Anna" / "9.png").symlink_to(outside / "1.png")
    (folder / CACHE).unlink()
    (folder / CACHE).symlink_to(outside / "1.png")
    before = files(outside)
    gallery, problems = loaded(folder)
    assert gallery.names() == {"Anna": 3, "Bert": 2}
    assert sum("leads out of the gallery" in problem for problem in problems) == 4, problems
    for use in (lambda: gallery.add("Eve", photographs(CARLA, 1)), lambda: gallery.forget("Eve")):
        with pytest.raises(ValueError, match="leads out of the gallery"):
            use()
    assert files(outside) == before


def test_link_to_another_name_is_none_of_its_own(folder):
    (folder / "Anne").symlink_to("Anna")
    before = files(folder)
    gallery, problems = loaded(folder)
    assert problems == [f"{folder}/Anne is not used: it is a symbolic link, must be a folder"]
    assert gallery.names() == {"Anna": 3, "Bert": 2}
    for use in (lambda: gallery.add("Anne", photographs(CARLA, 1)), lambda: gallery.forget("Anne")):
        with pytest.raises(ValueError, match="it is a symbolic link"):
            use()
    assert files(folder) == before


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: data[: len(data) // 2],
        lambda data: b"",
        lambda data: HEAD,
        lambda data: b"robot_vision faces 0\n" + data[len(HEAD) :],
        lambda data: HEAD + hashlib.sha256(b"5\n").hexdigest().encode() + b"5\n",
        lambda data: data[:-5000] + bytes([data[-5000] ^ 1]) + data[-4999:],
        lambda data: np.random.default_rng(1).bytes(len(data)),
    ],
)
def test_damaged_file_of_faces_is_made_anew(folder, damage, searched):
    good, _ = loaded(folder)
    data = (folder / CACHE).read_bytes()
    (folder / CACHE).write_bytes(damage(data))
    gallery, problems = loaded(folder)
    assert len(problems) == 1 and ".faces is made anew from the images: it is " in problems[0]
    assert same_faces(gallery, good) and len(searched) == 5
    assert (folder / CACHE).read_bytes() == data
    assert not loaded(folder)[1] and len(searched) == 5


def test_file_of_faces_that_is_a_pipe_is_told_and_left_and_one_far_too_large_is_made_anew(folder):
    data = (folder / CACHE).read_bytes()
    (folder / CACHE).unlink()
    os.mkfifo(str(folder / CACHE))
    gallery, (not_read, not_written) = loaded(folder)
    assert not_read == ".faces is made anew from the images: it is no file"
    assert not_written.endswith("the next start takes longer: it is no file")
    assert gallery.names() == {"Anna": 3, "Bert": 2} and (folder / CACHE).is_fifo()
    (folder / CACHE).unlink()
    assert not loaded(folder)[1] and (folder / CACHE).read_bytes() == data
    os.truncate(str(folder / CACHE), 2 << 30)
    (problem,) = loaded(folder)[1]
    assert problem.endswith("it has 2048 MB, must have at most 1024")
    assert (folder / CACHE).read_bytes() == data


def test_images_changed_by_hand_are_noticed(folder, searched):
    shutil.copy(str(folder / "Bert" / "2.png"), str(folder / "Bert" / "copy.png"))
    (folder / "Anna" / "1.png").unlink()
    (folder / "Anna" / "2.png").rename(folder / "Anna" / "first.png")
    (folder / "Zoë").mkdir()
    cv2.imwrite(str(folder / "Zoë" / "photo.JPG"), photograph(CARLA, 0)[0])
    gallery, problems = loaded(folder)
    assert not problems and gallery.names() == {"Anna": 2, "Bert": 2, "Zoë": 1}
    assert len(searched) == 1  # the new one
    shutil.rmtree(str(folder / "Bert"))
    gallery, problems = loaded(folder)
    assert not problems and gallery.names() == {"Anna": 2, "Zoë": 1} and len(searched) == 1


def test_what_cannot_be_used_is_told_skipped_and_kept(folder):
    good, _ = loaded(folder)
    anna = folder / "Anna"
    png = (anna / "1.png").read_bytes()
    (anna / "half.png").write_bytes(png[: len(png) // 2])
    (anna / "empty.jpg").write_bytes(b"")
    (anna / "text.png").write_text("no image")
    (anna / "claims.png").write_bytes(png[:16] + struct.pack(">II", 30000, 30000) + png[24:])
    cv2.imwrite(str(anna / "wall.png"), np.full((200, 200, 3), 90, np.uint8))
    os.mkfifo(str(anna / "pipe.png"))
    (anna / "folder.png").mkdir()
    with open(str(anna / "huge.png"), "wb") as file:
        file.truncate(MAX_FILE + 1)
    (folder / "loose.png").write_bytes(png)
    with open(os.fsencode(anna) + b"/\xff.png", "wb") as file:
        file.write(b"odd")
    os.mkdir(os.fsencode(folder) + b"/\xfe")
    (anna / "notes.txt").write_text("not an image, and nobody says so")
    (folder / ".hidden").mkdir()
    kept = set(os.listdir(str(anna)))
    for _ in range(2):
        gallery, problems = loaded(folder)
        assert same_faces(gallery, good)
        told = "\n".join(sorted(problems)).encode().decode()  # fit for a message
        for name, reason in [
            ("Anna/half.png", f"PNG of {len(png) // 2} bytes is damaged or truncated"),
            ("Anna/empty.jpg", "no image that OpenCV can read"),
            ("Anna/text.png", "no image that OpenCV can read"),
            ("Anna/claims.png", "claims to be of 30000x30000, the most is 67108864"),
            ("Anna/wall.png", "no face is found in it"),
            ("Anna/pipe.png", "it is no file"),
            ("Anna/folder.png", "it is no file"),
            ("Anna/huge.png", "it has 64 MB, must have at most 64"),
            ("Anna/\ufffd.png", "no image that OpenCV can read"),
            ("loose.png", "images belong into a folder with the person's name"),
            ("\ufffd", "the name '\\udcfe' must not hold"),
        ]:
            assert f"{folder}/{name} is not used: {reason}" in told
        assert len(problems) == 11, told
    assert set(os.listdir(str(anna))) == kept


def test_images_are_turned_as_their_exif_says(tmp_path):
    """Those in a gallery, and those that are imported."""
    lying = np.ascontiguousarray(np.rot90(photograph(ANNA, 0)[0]))
    for people in ("faces", "course"):
        (tmp_path / people / "Anna").mkdir(parents=True)
        file = sideways(cv2.imencode(".jpg", lying)[1].tobytes())
        (tmp_path / people / "Anna" / "1.jpg").write_bytes(file)
    gallery, problems = loaded(tmp_path / "faces")
    assert not problems and gallery.names() == {"Anna": 1}
    assert Gallery(str(tmp_path / "others")).import_folder(str(tmp_path / "course")).pictures == 1


def test_images_without_a_face_and_known_ones_are_not_added(folder):
    gallery = loaded(folder)[0]
    wall = np.full((200, 200, 3), 90, np.uint8)
    images = {"the wall": wall, **photographs(ANNA, 2, first=2)}
    added = gallery.add("Anna", images)
    assert (added.pictures, added.present) == (1, 1)
    assert added.problems == ["the wall: no face is found in it"]
    assert gallery.names()["Anna"] == 4 and (folder / "Anna" / "4.png").exists()
    assert gallery.add("Wall", {"it": wall}).pictures == 0
    assert not (folder / "Wall").exists()


def test_folders_of_images_are_imported_once(tmp_path):
    source = tmp_path / "course"
    for name, person in [("Anna", ANNA), ("Zoë", CARLA), (".git", BERT), ("unknown", BERT)]:
        (source / name).mkdir(parents=True)
        for number in range(3):
            large = cv2.resize(photograph(person, number)[0], None, fx=4, fy=4)
            cv2.imwrite(str(source / name / f"{number}.jpg"), large)
    (source / "Anna" / "broken.png").write_text("")
    (source / "readme.txt").write_text("")
    before = files(source)
    gallery = Gallery(str(tmp_path / "faces"))
    added = gallery.import_folder(str(source))
    assert (added.pictures, added.present, len(added.problems)) == (6, 0, 2)
    assert added.problems == [
        f"{source}/Anna/broken.png: no image that OpenCV can read",
        f"{source}/unknown: nobody can be called 'unknown'",
    ]
    assert gallery.names() == {"Anna": 3, "Zoë": 3}
    assert same_faces(gallery, loaded(tmp_path / "faces")[0])
    again = gallery.import_folder(str(source))
    assert (again.pictures, again.present) == (0, 6)
    assert gallery.import_folder(str(source / "unknown"), "Bert").pictures == 3
    assert gallery.names() == {"Anna": 3, "Bert": 3, "Zoë": 3}
    assert files(source) == before
    with pytest.raises(OSError, match=r"/nowhere cannot be read: No such file or directory$"):
        gallery.import_folder(str(tmp_path / "nowhere"))


def test_a_folder_that_cannot_be_read_does_not_stop_the_import():
    with tempfile.TemporaryDirectory() as place:  # tmp_path is closed to others
        os.chmod(place, 0o777)
        source = os.path.join(place, "photos")
        for name in ("Anna", "Mia", "Zoë"):
            os.makedirs(os.path.join(source, name))
            path = os.path.join(source, name, "1.png")
            cv2.imwrite(path, photograph(ANNA, 1)[0])
        mia = os.path.join(source, "Mia")
        os.chmod(mia, 0o000)
        with somebody_else():
            gallery = Gallery(os.path.join(place, "faces"))
            added = gallery.import_folder(source)
            told = [f"{mia}: {mia} cannot be read: Permission denied"]
            assert added == Added(2, problems=told)
            assert gallery.names() == {"Anna": 1, "Zoë": 1}


def test_what_an_imported_folder_lacks_is_told(tmp_path):
    source = tmp_path / "photos"
    (source / "Anna").mkdir(parents=True)
    cv2.imwrite(str(source / "Anna" / "1.jpg"), photograph(ANNA, 1)[0])
    gallery = Gallery(str(tmp_path / "faces"))
    with pytest.raises(ValueError, match="photos/Anna must have a folder for each person, as Anna"):
        gallery.import_folder(str(source / "Anna"))
    (added, none) = gallery.import_folder(str(source)), gallery.import_folder(str(source), "Eve")
    assert (added.pictures, added.problems) == (1, [])
    assert (none.pictures, none.problems) == (0, [f"{source}: there are no images in it"])
    for number in (1, 2):
        cv2.imwrite(str(source / f"{number}.jpg"), photograph(BERT, number)[0])
    again = gallery.import_folder(str(source))
    assert (again.present, again.problems) == (1, [f"{source}: 2 images in no person's folder"])


def test_gallery_is_not_imported_into_itself(folder):
    gallery = loaded(folder)[0]
    before = files(folder)
    for source, name in [("", ""), ("", "Eve"), ("Anna", "Anna"), ("Anna", "")]:
        with pytest.raises(ValueError, match=r"faces.* is in the gallery"):
            gallery.import_folder(str(folder / source), name)
    around = folder.parent / "around"
    around.mkdir()
    (around / "Anna").symlink_to(folder / "Anna")
    added = gallery.import_folder(str(around))
    assert added == Added(problems=[f"{around}/Anna: {around}/Anna is in the gallery"])
    assert files(folder) == before


def test_import_is_given_up_between_two_images(folder, searched):
    source = folder.parent / "source"
    for name in ("Carla", "Eve"):
        (source / name).mkdir(parents=True)
        for number, image in enumerate(photographs(CARLA, 3).values()):
            cv2.imwrite(str(source / name / f"{number}.png"), image)
    gallery = loaded(folder)[0]
    with pytest.raises(InterruptedError, match=r"given up at .*Eve/1\.png"):
        gallery.import_folder(str(source), given_up=lambda: len(searched) >= 2 * 4)
    assert gallery.names() == {"Anna": 3, "Bert": 2, "Carla": 3}
    assert same_faces(gallery, loaded(folder)[0])


def test_names_are_told_while_faces_are_searched(folder, monkeypatch):
    searching, go_on = threading.Event(), threading.Event()

    def find(image):
        searching.set()
        assert go_on.wait(30.0)
        return find_face(image)

    gallery = loaded(folder)[0]
    monkeypatch.setattr("robot_vision.faces.face_images.find_face", find)
    with concurrent.futures.ThreadPoolExecutor(2) as threads:
        adding = threads.submit(gallery.add, "Carla", photographs(CARLA, 2))
        assert searching.wait(30.0)
        try:
            names = threads.submit(gallery.names).result(10.0)
        finally:
            go_on.set()
        assert names == {"Anna": 3, "Bert": 2} and adding.result(30.0).pictures == 2
    assert gallery.names() == {"Anna": 3, "Bert": 2, "Carla": 2}


def test_forgotten_are_gone_with_all_images_but_no_other_files(folder):
    gallery = loaded(folder)[0]
    (folder / "Anna" / "damaged.png").write_text("")
    (folder / "Bert" / "notes.txt").write_text("mine")
    assert gallery.forget("Anna") == Removed(4)
    assert gallery.forget("Bert") == Removed(2)
    assert sorted(files(folder)) == [CACHE, "Bert/notes.txt"]
    assert len((folder / CACHE).read_bytes()) < 200  # no face is left in it
    assert gallery.names() == {} == loaded(folder)[0].names()
    with pytest.raises(ValueError, match="nobody is called 'Anna'"):
        gallery.forget("Anna")


def test_forgotten_are_gone_though_the_file_of_faces_cannot_be_written(folder, monkeypatch):
    gallery = loaded(folder)[0]
    refuse = Mock(side_effect=OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))
    monkeypatch.setattr("robot_vision.faces.face_cache.replace_file", refuse)
    removed = gallery.forget("Anna")
    assert removed.pictures == 3
    (problem,) = removed.problems
    assert problem.startswith(".faces cannot be written") and "No space left" in problem
    assert gallery.names() == {"Bert": 2}
    assert sorted(files(folder)) == ["Bert/1.png", "Bert/2.png"]


def test_who_cannot_be_forgotten_whole_keeps_the_rest(folder, monkeypatch):
    gallery = loaded(folder)[0]
    unlink = os.unlink

    def keep_the_second(path):
        if str(path).endswith("2.png"):
            raise PermissionError(errno.EPERM, os.strerror(errno.EPERM))
        unlink(path)

    monkeypatch.setattr(os, "unlink", keep_the_second)
    removed = gallery.forget("Anna")
    monkeypatch.undo()
    problem = f"{folder}/Anna/2.png cannot be removed: Operation not permitted"
    assert removed == Removed(2, [problem])
    assert gallery.names() == {"Anna": 1, "Bert": 2}
    assert same_faces(gallery, loaded(folder)[0])
    assert gallery.forget("Anna") == Removed(1)


def test_all_images_are_written_or_none(folder, monkeypatch):
    gallery = loaded(folder)[0]
    before = files(folder)
    whole = robot_vision.faces.gallery_files.add_file

    def fill_the_disk(folder, stem, suffix, data):
        if len(os.listdir(folder)) == 2:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return whole(folder, stem, suffix, data)

    monkeypatch.setattr(robot_vision.faces.gallery_files, "add_file", fill_the_disk)
    for name in ("Bert", "Carla"):
        with pytest.raises(OSError, match="No space left"):
            gallery.add(name, photographs(CARLA, 3))
    assert gallery.names() == {"Anna": 3, "Bert": 2}
    assert files(folder) == before and not (folder / "Carla").exists()
    monkeypatch.undo()
    assert gallery.add("Carla", photographs(CARLA, 3)).pictures == 3


def test_lost_file_of_faces_costs_a_search_only(folder, monkeypatch):
    gallery = loaded(folder)[0]
    refuse = Mock(side_effect=OSError(errno.EROFS, os.strerror(errno.EROFS)))
    monkeypatch.setattr("robot_vision.faces.face_cache.replace_file", refuse)
    added = gallery.add("Carla", photographs(CARLA, 2))
    assert added.pictures == 2
    (problem,) = added.problems
    assert problem == ".faces cannot be written, the next start takes longer: Read-only file system"
    assert same_faces(gallery, loaded(folder)[0])
    monkeypatch.undo()
    again, problems = loaded(folder)
    assert not problems and same_faces(gallery, again)


@pytest.mark.parametrize(
    "module, name, call, images",
    [
        (robot_vision.faces.gallery_files, "add_file", 3, 2),  # between two images
        (os, "link", 3, 2),  # in an image
        (robot_vision.faces.face_cache, "replace_file", 1, 4),  # before the file of faces
        (os, "replace", 1, 4),  # in it
    ],
    ids=["between images", "in an image", "before the faces", "in the faces"],
)
def test_crash_while_adding_leaves_a_gallery_that_loads(folder, module, name, call, images):
    """A fork of this process ends in one of its calls of a function."""
    child = os.fork()
    if child == 0:
        calls, original = itertools.count(1), getattr(module, name)

        def crash(*arguments):
            if next(calls) == call:
                os._exit(9)
            return original(*arguments)

        try:
            cv2.setNumThreads(0)  # a fork does not have the threads of its parent
            gallery = loaded(folder)[0]
            setattr(module, name, crash)
            gallery.add("Carla", photographs(CARLA, 4))
        finally:
            os._exit(0)
    assert os.WEXITSTATUS(os.waitpid(child, 0)[1]) == 9
    gallery, problems = loaded(folder)
    assert not problems
    assert gallery.names() == {"Anna": 3, "Bert": 2, "Carla": images}
    assert gallery.add("Carla", photographs(CARLA, 4)).pictures == 4 - images
    assert same_faces(gallery, loaded(folder)[0])
    assert gallery.forget("Carla") == Removed(4)  # whole and unfinished images, and faces
    assert sorted(files(folder)) == [
        CACHE,
        *(f"Anna/{n}.png" for n in (1, 2, 3)),
        "Bert/1.png",
        "Bert/2.png",
    ]


def test_files_left_by_a_crash_of_a_process_of_the_same_number_are_in_nobodys_way(folder):
    gallery = loaded(folder)[0]
    (folder / f"{CACHE}.{os.getpid()}.tmp").write_text("")
    for number in range(1, 9):
        (folder / "Anna" / f".{number}.{os.getpid()}.tmp").write_text("")
    assert gallery.add("Anna", photographs(CARLA, 2)) == Added(2)
    assert same_faces(gallery, loaded(folder)[0])


@contextlib.contextmanager
def somebody_else():
    """Without root's right to write everywhere."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(65534)
    try:
        yield
    finally:
        os.seteuid(0)


def test_gallery_that_cannot_be_written_is_used(folder):
    with tempfile.TemporaryDirectory() as place:  # tmp_path is closed to others
        faces = os.path.join(place, "faces")
        shutil.copytree(str(folder), faces)
        os.unlink(os.path.join(faces, CACHE))
        os.mkdir(os.path.join(faces, "Locked"), 0o000)
        for path in (place, faces, os.path.join(faces, "Anna"), os.path.join(faces, "Bert")):
            os.chmod(path, 0o555)
        before = files(folder / "Anna")
        with somebody_else():
            gallery, problems = loaded(faces)
            assert gallery.names() == {"Anna": 3, "Bert": 2}
            assert sorted(problems) == [
                ".faces cannot be written, the next start takes longer: Permission denied",
                f"{faces}/Locked is not used: Permission denied",
            ]
            for use in (
                lambda: gallery.add("Anna", photographs(CARLA, 1)),
                lambda: gallery.add("Carla", photographs(CARLA, 1)),
            ):
                with pytest.raises(PermissionError):
                    use()
            removed = gallery.forget("Anna")
            assert removed.pictures == 0
            assert removed.problems[:3] == [
                f"{faces}/Anna/{n}.png cannot be removed: Permission denied" for n in (1, 2, 3)
            ]
            assert gallery.names() == {"Anna": 3, "Bert": 2}
        assert sorted(os.listdir(os.path.join(faces, "Anna"))) == sorted(before)
