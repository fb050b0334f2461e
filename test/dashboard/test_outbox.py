"""What waits for a page that reads slowly, or not at all."""

import pytest
from slow_peer import Peer

from robot_vision.dashboard.outbox import MAX_PACED, MAX_WAITING, Message


@pytest.fixture
def peer():
    made = Peer()
    yield made
    made.end()


def text(content, handed=lambda: None):
    return Message((content,), False, handed)


def test_messages_go_out_in_order(peer):
    peer.read_all()
    peer.outbox.put(text("a"))
    peer.outbox.put(Message((b"head", b"payload"), True))
    peer.outbox.put(text("b"))
    peer.turn()
    assert peer.taken == [("a", False), (b"headpayload", True), ("b", False)]


def test_the_newest_with_a_key_replaces_the_one_that_waits(peer):
    for number in range(5):
        peer.outbox.put(text(f"status {number}"), "status")
        peer.outbox.put(text(f"line {number}"))
        peer.turn()
    assert [message for message, _ in peer.taken] == ["status 0"]  # is on its way already
    peer.read_all()
    rest = [message for message, _ in peer.taken[1:]]
    assert rest == ["line 0", "line 1", "line 2", "line 3", "status 4", "line 4"]


def test_a_message_is_handed_over_when_it_is_written_and_not_before(peer):
    handed = []
    for number in range(3):
        peer.outbox.put(text("x", lambda number=number: handed.append(number)))
    assert handed == []
    peer.turn()
    assert handed == [0]
    peer.read_all()
    assert handed == [0, 1, 2]


def test_what_nobody_wants_any_more_is_not_sent(peer):
    peer.outbox.put(text("on its way"))
    peer.turn()
    peer.outbox.put(text("a"), ("channel", 1))
    peer.outbox.put(text("b"), ("channel", 2))
    peer.outbox.discard(lambda key: key == ("channel", 1))
    peer.read_all()
    assert [message for message, _ in peer.taken] == ["on its way", "b"]


def test_a_peer_that_reads_nothing_is_given_up_when_a_megabyte_waits(peer):
    peer.outbox.put(text("on its way"))
    peer.turn()
    part = "x" * (MAX_WAITING // 4)
    for _ in range(4):
        peer.outbox.put(text(part))
    peer.turn()
    assert peer.events == []
    for _ in range(3):
        peer.outbox.put(text("x"))
    peer.turn()
    assert peer.events == ["overflow"]
    peer.read_all()
    assert len(peer.taken) == 1


def test_a_peer_that_reads_gets_messages_of_any_size(peer):
    peer.read_all()
    large = "x" * (2 * MAX_WAITING)
    for key in (None, "graph", "graph"):
        peer.outbox.put(text(large), key)
        peer.turn()
    peer.outbox.put(text("small"))
    peer.outbox.put(text(large))
    peer.turn()
    assert peer.events == []
    assert [len(message) for message, _ in peer.taken] == [len(large)] * 3 + [5, len(large)]


def test_what_replaces_others_can_wait_for_ever(peer):
    part = "x" * (MAX_WAITING // 3)
    for _ in range(20):
        peer.outbox.put(text(part), "status")
        peer.outbox.discard(lambda key: key == "other")
        peer.turn()
    peer.outbox.put(text(part + "y"), "other")
    peer.outbox.discard(lambda key: key == "other")
    peer.turn()
    assert peer.events == []


def test_frames_do_not_count_as_their_channels_bound_them(peer):
    for number in range(4):
        peer.outbox.put(Message((b"", b"x" * MAX_WAITING), True, paced=True), number)
        peer.outbox.put(Message(("x" * MAX_WAITING,), paced=True), ("message", number))
    peer.turn()
    assert peer.events == []


def test_who_waits_for_room_is_told_once_when_there_is_some(peer):
    frame = Message((b"", b"x" * MAX_PACED), True, paced=True)
    told = []

    def has_room():
        told.append(len(peer.taken))

    assert not peer.outbox.is_full(has_room)
    peer.outbox.put(text("on its way"))
    peer.turn()
    for number in range(2):
        peer.outbox.put(frame, number)
    assert peer.outbox.is_full(has_room) and peer.outbox.is_full(has_room)
    peer.turn()
    assert told == []
    peer.outbox.discard(lambda key: key == 0)
    peer.read_all()
    assert told == [1] and not peer.outbox.is_full(has_room)
    peer.read_all()
    assert told == [1]


def test_nothing_waits_for_a_peer_that_is_gone(peer):
    peer.broken = True
    handed = []
    for _ in range(3):
        peer.outbox.put(text("x", lambda: handed.append(1)))
    peer.turn()
    assert peer.events == ["gone"]
    peer.outbox.put(text("x", lambda: handed.append(1)))
    peer.turn()
    assert handed == [1]
