"""Channels to a page that reads slowly or lies: what they keep is bounded, and the newest."""

import json
import threading

import pytest
from slow_peer import Peer

from robot_vision.dashboard import outbox
from robot_vision.dashboard.channels import HEADER, Channel


@pytest.fixture
def peer():
    made = Peer()
    yield made
    made.end()


@pytest.fixture
def channel(peer):
    return Channel(7, peer.outbox)


def send(channel, number):
    channel.send_binary(1, 0.0, 0.0, 1, 1, b"%d" % number)


def frames(peer):
    """Numbers and payloads of the frames that were written."""
    return [(HEADER.unpack(message[:32])[3], int(message[32:])) for message, _ in peer.taken]


def test_a_page_that_acknowledges_what_it_has_not_been_sent_gets_no_more_of_it(peer, channel):
    for number in range(1, 30):
        send(channel, number)
        peer.turn()
        for seq in range(1, 31):
            channel.acknowledge(seq)
        assert len(peer.outbox._messages) <= 2
    assert frames(peer) == [(1, 1)]
    peer.read_all()
    assert frames(peer) == [(1, 1), (2, 2), (3, 3)]
    assert channel.acknowledge(2)
    peer.turn()
    assert frames(peer)[-1] == (4, 29)


def test_only_what_is_expected_counts_as_acknowledged(peer, channel):
    peer.read_all()
    send(channel, 1)
    assert not channel.acknowledge(1)
    peer.turn()
    assert [channel.acknowledge(seq) for seq in (0, 2, True, 1.0, "1", None, [1])] == [False] * 7
    assert channel.acknowledge(1)
    assert not channel.acknowledge(1)


def test_payloads_are_shared_while_they_wait(peer, channel):
    payload = bytes(1000)
    others = [Channel(number, peer.outbox) for number in range(8, 16)]
    for one in (channel, *others):
        one.send_binary(1, 0.0, 0.0, 1, 1, payload)
    assert all(message.parts[1] is payload for message in peer.outbox._messages.values())


def waiting(peer):
    return sum(message.size for message in peer.outbox._messages.values())


def test_what_all_channels_have_waiting_is_bounded(peer, monkeypatch):
    size = 1000
    monkeypatch.setattr(outbox, "MAX_PACED", 10 * size)
    channels = [Channel(number, peer.outbox) for number in range(1, 65)]
    for _ in range(3):
        for one in channels:
            if one.ready:
                one.send_binary(1, 0.0, 0.0, 1, 1, bytes(size))
        peer.turn()
    assert 10 * size <= waiting(peer) <= 11 * (size + HEADER.size)
    assert not any(one.ready for one in channels)


def test_each_channel_has_its_turn_when_a_page_reads_again(peer, monkeypatch):
    size = 1000
    monkeypatch.setattr(outbox, "MAX_PACED", 10 * size)
    channels = [Channel(number, peer.outbox) for number in range(1, 65)]
    woken = set()
    for one in channels:
        one.on_ready(lambda one=one: woken.add(one))
        one.send_message({"text": "old" + "x" * size}, 0.0, 0.0)
        one.send_message({"text": "new" + "x" * size}, 0.0, 0.0)
        one.send_message({"text": "newest"}, 0.0, 0.0)
    peer.read_all()
    got = {}
    for message, _ in peer.taken:
        told = json.loads(message)
        got[told["channel"]] = told["data"]["text"]
    begun = [one for one in channels if len(one._in_flight) == 2]  # before there was no room
    assert len(got) == 64 and len(begun) < 12
    assert all(text == "newest" or channels[number - 1] in begun for number, text in got.items())
    assert woken == set(channels) - set(begun) and all(one.ready for one in woken)


def test_what_waits_of_a_channel_that_is_closed_is_not_sent(peer, channel):
    send(channel, 1)
    peer.turn()
    other = Channel(8, peer.outbox)
    send(channel, 2)
    send(channel, 3)
    send(other, 4)
    channel.close()
    channel.close()
    send(channel, 5)
    peer.read_all()
    assert [payload for _, payload in frames(peer)] == [1, 4]
    assert not channel.acknowledge(1) or not channel.ready


def test_numbers_begin_again_after_the_last_of_32_bits(peer, channel):
    peer.read_all()
    channel._seq = 0xFFFFFFFE
    for number in range(3):
        send(channel, number)
        peer.turn()
        channel.acknowledge(frames(peer)[-1][0])
    assert [seq for seq, _ in frames(peer)] == [0xFFFFFFFF, 1, 2]


def test_many_threads_may_send(peer, channel):
    peer.read_all()
    threads = [threading.Thread(target=send, args=(channel, number)) for number in range(50)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for _ in range(3):
        peer.turn()
        for seq in list(channel._in_flight):
            channel.acknowledge(seq)
    assert not channel._in_flight
    assert [seq for seq, _ in frames(peer)] == [1, 2, 3]
