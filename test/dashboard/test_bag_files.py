"""The folder of bags: names that lead nowhere else, and bags that are damaged or mean harm."""

import os
import pathlib
import struct

import pytest
import rosbag
import rospy
from std_msgs.msg import Header, String

from robot_vision.dashboard import bag_files
from robot_vision.dashboard.bag_files import MAX_NAME, BagFolder, require_bag_name, stem_of
from robot_vision.dashboard.bag_format import MAX_HEADER
from robot_vision.dashboard.bag_progress import BagProgress
from robot_vision.dashboard.encoding import to_json


@pytest.fixture
def folder(tmp_path):
    made = BagFolder(str(tmp_path / "bags"))
    made.make()
    return made


def write_bag(path, count=10, start=100.0, compression="none"):
    """A bag with `count` texts on /text, one a second, and half as many headers on /head."""
    with rosbag.Bag(str(path), "w", compression=compression, chunk_threshold=200) as bag:
        for number in range(count):
            bag.write("/text", String("x" * 50), rospy.Time(start + number))
            if number % 2 == 0:
                bag.write("/head", Header(), rospy.Time(start + number))
    return path


def in_folder(folder, name):
    return os.path.join(folder.path, name)


HOSTILE_NAMES = [
    "",
    ".bag",
    "..bag",
    "../outside.bag",
    "..",
    "a/../../outside.bag",
    "/etc/passwd",
    "/etc/x.bag",
    "a/b.bag",
    "a\\b.bag",
    ".hidden.bag",
    "a.bag/",
    "a.bag\n",
    "a\n.bag",
    "a\0.bag",
    "a b.bag",
    "%2e%2e%2foutside.bag",
    "ä.bag",
    "\u0661.bag",
    "a.bag.active",
    "a.yaml",
    "a",
    "x" * MAX_NAME + ".bag",
]


@pytest.mark.parametrize("name", HOSTILE_NAMES)
def test_a_name_that_could_be_another_file_is_refused_everywhere(folder, tmp_path, name):
    write_bag(tmp_path / "outside.bag")
    for call in (require_bag_name, folder.open, folder.delete):
        with pytest.raises(ValueError, match=r"the name of a bag is .*, must be letters, digits"):
            call(name)
    assert (tmp_path / "outside.bag").exists()


@pytest.mark.parametrize(
    "name", ["a.bag", "2026-11-26-16-50-00.bag", "_a.b-1.bag", "A" * 96 + ".bag"]
)
def test_plain_names_are_names_of_bags(name):
    assert require_bag_name(name) == name


@pytest.mark.parametrize(
    "wanted, stem",
    [
        ("hello", "hello"),
        ("hello.bag", "hello"),
        ("a b/c", "a_b_c"),
        ("../../etc/passwd", "_etc_passwd"),
        ("...hidden", "hidden"),
        ("-O", "O"),
        ("küche", "k_che"),
        ("x" * 500, "x" * 96),
        ("a\nb\0c", "a_b_c"),
    ],
)
def test_what_is_wanted_as_a_name_becomes_one(folder, wanted, stem):
    assert stem_of(wanted).strip("_") == stem.strip("_")
    assert require_bag_name(folder.free_name(wanted))


@pytest.mark.parametrize("wanted", ["", "   ", "...", "///", ".bag", "\0"])
def test_without_a_name_a_bag_is_named_by_the_time(wanted):
    assert len(stem_of(wanted)) == len("2026-11-26-16-50-00") and stem_of(wanted)[:2] == "20"


def test_an_existing_bag_or_an_unfinished_one_gives_the_next_a_number(folder):
    write_bag(in_folder(folder, "a.bag"))
    open(in_folder(folder, "a-1.bag.active"), "wb").close()
    os.symlink("nowhere", in_folder(folder, "a-2.bag"))
    assert folder.free_name("a") == "a-3.bag"
    long = "y" * 200
    write_bag(in_folder(folder, folder.free_name(long)))
    assert folder.free_name(long) == "y" * 94 + "-1.bag"


def test_links_folders_and_pipes_are_no_bags(folder, tmp_path):
    outside = write_bag(tmp_path / "outside.bag")
    os.symlink(str(outside), in_folder(folder, "link.bag"))
    os.mkdir(in_folder(folder, "folder.bag"))
    os.mkfifo(in_folder(folder, "pipe.bag"))
    os.symlink(str(outside), in_folder(folder, "link.bag.active"))
    assert folder.bags() == [] and folder.unfinished() == []
    for name in ("link.bag", "folder.bag", "pipe.bag", "missing.bag"):
        for call in (folder.open, folder.delete):
            with pytest.raises(OSError, match=f"{name} cannot be read: "):
                call(name)
    assert outside.exists() and os.path.islink(in_folder(folder, "link.bag"))


@pytest.mark.parametrize("compression", ["none", "bz2", "lz4"])
def test_the_list_says_what_rosbag_says(folder, compression):
    path = write_bag(in_folder(folder, "a.bag"), compression=compression)
    (bag,) = folder.bags()
    with rosbag.Bag(path) as truth:
        topics = truth.get_type_and_topic_info()[1]
        assert bag["start"] == pytest.approx(truth.get_start_time())
        assert bag["duration"] == pytest.approx(truth.get_end_time() - truth.get_start_time())
    assert (bag["name"], bag["size"], bag["problem"]) == ("a.bag", os.path.getsize(path), "")
    assert bag["topics"] == [
        {"name": name, "type": topics[name].msg_type, "count": topics[name].message_count}
        for name in ("/head", "/text")
    ]
    assert [topic["count"] for topic in bag["topics"]] == [5, 10]


def test_an_empty_bag_has_no_topics(folder):
    write_bag(in_folder(folder, "a.bag"), count=0)
    (bag,) = folder.bags()
    assert (bag["start"], bag["duration"], bag["topics"], bag["problem"]) == (0.0, 0.0, [], "")


def test_the_newest_bag_comes_first_and_a_changed_one_is_read_again(folder):
    for age, name in enumerate(["new.bag", "middle.bag", "old.bag"]):
        os.utime(write_bag(in_folder(folder, name)), (1000 - age, 1000 - age))
    assert [bag["name"] for bag in folder.bags()] == ["new.bag", "middle.bag", "old.bag"]
    write_bag(in_folder(folder, "old.bag"), count=3)
    assert folder.bags()[0]["topics"][1]["count"] == 3


def test_a_folder_that_is_not_there_has_no_bags_and_free_space(tmp_path):
    folder = BagFolder(str(tmp_path / "a" / "b"))
    assert folder.bags() == [] and folder.unfinished() == []
    assert folder.free_space() > 0 and not os.path.exists(folder.path)


def test_a_deleted_bag_is_gone_and_no_other(folder):
    for name in ("a.bag", "b.bag"):
        write_bag(in_folder(folder, name))
    write_bag(in_folder(folder, "a.bag.active"))
    folder.delete("a.bag")
    assert sorted(os.listdir(folder.path)) == ["a.bag.active", "b.bag"]
    folder.delete("a.bag", unfinished=True)
    assert os.listdir(folder.path) == ["b.bag"]


def test_an_unfinished_bag_is_not_offered_but_named(folder):
    write_bag(in_folder(folder, "a.bag.active"))
    assert folder.bags() == [] and folder.unfinished() == ["a.bag"]
    with pytest.raises(OSError, match=r"a\.bag cannot be read: No such file"):
        folder.open("a.bag")


def field(name, value):
    return struct.pack("<I", len(name) + 1 + len(value)) + name + b"=" + value


def record(fields, data=b"", length=None):
    header = b"".join(field(*one) for one in fields)
    return struct.pack("<I", len(header)) + header + struct.pack("<I", length or len(data)) + data


MAGIC = b"#ROSBAG V2.0\n"


def with_index(index, position=None):
    def head(at):
        return MAGIC + record([(b"op", b"\3"), (b"index_pos", struct.pack("<Q", at))])

    return head(position or len(head(0))) + index


INFO = [
    (b"op", b"\6"),
    (b"start_time", struct.pack("<II", 1, 0)),
    (b"end_time", struct.pack("<II", 2, 0)),
]
HOSTILE_BAGS = {
    "nothing": b"",
    "a text": b"hello\n" * 100,
    "of version 1.2": b"#ROSBAG V1.2\n" + bytes(100),
    "only magic": MAGIC,
    "a header without end": MAGIC + b"\xff\xff\xff\xff",
    "a large header": MAGIC + struct.pack("<I", MAX_HEADER + 1) + bytes(MAX_HEADER + 1),
    "a field without end": MAGIC + struct.pack("<I", 8) + b"\xff\xff\xff\xff=abc" + bytes(4),
    "a field without name": MAGIC
    + struct.pack("<I", 8)
    + struct.pack("<I", 4)
    + b"abcd"
    + bytes(4),
    "no op": MAGIC + record([(b"index_pos", bytes(8))]),
    "a long op": MAGIC + record([(b"op", b"\3\3")]),
    "an unknown op": MAGIC + record([(b"op", b"\x63")]),
    "no index": MAGIC + record([(b"op", b"\3"), (b"index_pos", bytes(8))]),
    "a short position": MAGIC + record([(b"op", b"\3"), (b"index_pos", b"abc")]),
    "an index behind the end": with_index(b"", 1 << 40),
    "an index in the header": with_index(b"", 5),
    "data without end": with_index(record(INFO, length=0xFFFFFFFF)),
    "a connection without number": with_index(record([(b"op", b"\7"), (b"topic", b"/a")])),
    "a connection of garbage": with_index(
        record([(b"op", b"\7"), (b"conn", bytes(4)), (b"topic", b"/a")], b"\xff\xff\xff\xff")
    ),
    "times that are none": with_index(record([(b"op", b"\6"), (b"start_time", b"x")])),
}


@pytest.mark.parametrize("content", HOSTILE_BAGS.values(), ids=list(HOSTILE_BAGS))
def test_a_damaged_bag_is_listed_with_its_problem_in_a_line(folder, content):
    with open(in_folder(folder, "a.bag"), "wb") as file:
        file.write(content)
    (bag,) = folder.bags()
    assert bag["topics"] is None and bag["problem"] and "\n" not in bag["problem"]
    assert bag["size"] == len(content)


def test_a_bag_cut_anywhere_is_listed_or_has_a_problem(folder):
    whole = pathlib.Path(write_bag(in_folder(folder, "a.bag"))).read_bytes()
    for size in [*range(0, 4200, 401), *range(4200, len(whole), 37)]:
        with open(in_folder(folder, "a.bag"), "wb") as file:
            file.write(whole[:size])
        (bag,) = folder.bags()
        assert bag["topics"] is None and bag["problem"], size


def test_flipped_bytes_are_a_problem_or_wrong_numbers_but_no_crash(folder):
    whole = pathlib.Path(write_bag(in_folder(folder, "a.bag"))).read_bytes()
    for place in [*range(60), *range(len(whole) - 900, len(whole), 7)]:
        damaged = bytearray(whole)
        damaged[place] ^= 0xFF
        with open(in_folder(folder, "a.bag"), "wb") as file:
            file.write(damaged)
        (bag,) = folder.bags()
        assert (bag["topics"] is None) == bool(bag["problem"])
        assert bag["duration"] >= 0.0


def test_names_in_a_bag_are_cut_and_a_topic_is_counted_once(folder):
    long = b"/" + b"\xff" * 5000
    connections = b"".join(
        record(
            [(b"op", b"\7"), (b"conn", struct.pack("<I", number)), (b"topic", long)],
            field(b"type", b"std_msgs/String"),
        )
        for number in range(3)
    )
    counts = b"".join(struct.pack("<II", number, 2) for number in range(5))
    with open(in_folder(folder, "a.bag"), "wb") as file:
        file.write(with_index(connections + record(INFO, counts)))
    ((topic,),) = [bag["topics"] for bag in folder.bags()]
    assert topic["count"] == 6 and topic["type"] == "std_msgs/String"
    assert len(topic["name"]) == 256 and topic["name"][1:] == "\ufffd" * 255


def test_an_index_with_too_many_entries_is_a_problem(folder, monkeypatch):
    write_bag(in_folder(folder, "a.bag"))
    monkeypatch.setattr("robot_vision.dashboard.bag_summary.MAX_RECORDS", 10)
    assert folder.bags()[0]["problem"] == "its index has more entries than are read"
    write_bag(in_folder(folder, "a.bag"), count=12)
    monkeypatch.setattr("robot_vision.dashboard.bag_summary.MAX_INDEX", 1 << 9)
    assert folder.bags()[0]["problem"] == "its index has 0 MB, more than is read"


def test_bags_for_which_there_is_no_time_are_read_the_next_time(folder, monkeypatch):
    write_bag(in_folder(folder, "a.bag"))
    monkeypatch.setattr(bag_files, "READING_TIME", -1.0)
    (bag,) = folder.bags()
    assert (bag["topics"], bag["problem"]) == (None, "not read yet")
    monkeypatch.undo()
    assert len(folder.bags()[0]["topics"]) == 2


def test_the_topics_of_the_oldest_bags_are_left_out_of_a_list_that_would_be_too_long(
    folder, monkeypatch
):
    for age, name in enumerate(["new.bag", "middle.bag", "old.bag"]):
        os.utime(write_bag(in_folder(folder, name)), (1000 - age, 1000 - age))
    size = len(to_json(folder.bags()[0]["topics"]))
    monkeypatch.setattr(bag_files, "MAX_CONTENTS", 2 * size)
    listed = folder.bags()
    assert [bool(bag["topics"]) for bag in listed] == [True, True, False]
    assert listed[2]["problem"] == bag_files.NOT_LISTED and listed[2]["duration"] == 9.0
    folder.delete("new.bag")
    assert [bag["problem"] for bag in folder.bags()] == ["", ""]


def test_messages_are_counted_while_a_bag_is_written(folder):
    path = in_folder(folder, "a.bag.active")
    with rosbag.Bag(path, "w", chunk_threshold=150) as bag, folder.open("a.bag", True) as file:
        progress = BagProgress(file)
        for number in range(1, 8):
            bag.write("/text", String("x" * 50), rospy.Time(number))
            bag.write("/head", Header(), rospy.Time(number))
            bag.flush()
            progress.update()
            assert progress.counts == {"/text": number, "/head": number} and progress.known
            assert progress.size() == os.path.getsize(path)


@pytest.mark.parametrize(
    "content", [MAGIC + b"\xff\xff\xff\xff", MAGIC + record([(b"op", b"\x63")])]
)
def test_what_is_written_and_no_bag_is_not_counted(folder, content):
    with open(in_folder(folder, "a.bag.active"), "wb") as file:
        file.write(content)
    with folder.open("a.bag", unfinished=True) as file:
        progress = BagProgress(file)
        progress.update()
        assert not progress.known and progress.counts == {}
