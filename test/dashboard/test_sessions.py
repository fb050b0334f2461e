"""Sessions of pages over real sockets: requests in order, channels, limits, and their end."""

import asyncio
import json
import struct
import threading
import time

import pytest
from served import TIMEOUT, VIEW_TOKEN, Served

from robot_vision.dashboard import pace, page_socket, sessions
from robot_vision.dashboard.fields import Number, Text
from robot_vision.dashboard.operations import Operation

HEADER = struct.Struct("<BBHIddII")


class Feature:
    """Operations that the tests look into."""

    def __init__(self):
        self.session = self.channel = None
        self.ready, self.ended = [], threading.Event()
        self.threads, self.done = set(), []
        self.gate = threading.Event()
        self.entered = threading.Event()
        number = Number(0, 1e6, integer=True)
        self.operations = [
            Operation("open", self._open, "view", {"channel": number}),
            Operation("wait", self._wait, "view"),
            Operation("beside", self._wait, "view", beside=True),
            Operation("note", self._note, "view", {"value": number}),
            Operation("fail", self._fail, "view", {"kind": Text()}),
            Operation("change", lambda *_: "changed"),
        ]

    def _open(self, session, fields):
        self.session = session
        self.channel = session.channel(fields["channel"])
        self.channel.on_ready(lambda: self.ready.append(1))
        self.channel.on_close(lambda: self.done.append("channel"))
        session.on_close(self.ended.set)

    def _wait(self, _session, _fields):
        self.entered.set()
        assert self.gate.wait(TIMEOUT)
        return "waited"

    def _note(self, _session, fields):
        self.threads.add(threading.current_thread().name)
        self.done.append(fields["value"])
        return fields["value"]

    def _fail(self, _session, fields):
        kinds = {"value": ValueError, "os": FileNotFoundError, "type": TypeError, "own": OwnError}
        raise kinds[fields["kind"]]("a secret\nreason")


class OwnError(Exception):
    pass


@pytest.fixture
def feature():
    made = Feature()
    yield made
    made.gate.set()


@pytest.fixture
def served(feature):
    made = Served(
        *feature.operations,
        hello=lambda: {"node": "/dashboard", "version": "1.0"},
        max_clients=2,
        expected=(OwnError,),
    )
    yield made
    made.server.close()


@pytest.fixture
def page(served):
    with served.page() as made:
        yield made


def frame_of(message):
    return HEADER.unpack(message[:32]), message[32:]


def test_a_page_is_told_first_who_it_is(served):
    for token, role in ((VIEW_TOKEN, "view"), ("token-to-control", "control")):
        with served.page(token) as page:
            data = {"role": role, "node": "/dashboard", "version": "1.0", "max_clients": 2}
            assert page.read() == {"push": "hello", "data": data}


def test_the_view_role_may_look_but_not_control(served):
    with served.page(VIEW_TOKEN) as page:
        assert page.ask("note", value=1) == 1
        with pytest.raises(ValueError, match="change needs the role control"):
            page.ask("change")
    with served.page() as page:
        assert page.ask("change") == "changed"


def test_requests_of_a_page_run_in_order_in_one_thread(page, feature):
    page.read()
    for number in range(100):
        page.send({"op": "note", "id": number, "value": number})
    answers = [page.read() for _ in range(100)]
    assert answers == [{"id": number, "result": number} for number in range(100)]
    assert feature.done == list(range(100))
    assert len(feature.threads) == 1


def test_what_runs_beside_others_holds_up_none_of_them(page, feature):
    page.read()
    page.send({"op": "beside", "id": 1000})
    assert feature.entered.wait(TIMEOUT)
    assert page.ask("note", value=1) == 1
    feature.gate.set()
    assert page.read() == {"id": 1000, "result": "waited"}


def test_one_that_waits_holds_up_neither_pings_nor_other_pages(served, page, feature):
    page.send({"op": "wait", "id": 1000})
    assert feature.entered.wait(TIMEOUT)
    assert page.ask("ping")["time"] > 1e9
    with served.page() as other:
        assert other.ask("note", value=3) == 3
    feature.gate.set()
    assert page.read() == {"id": 1000, "result": "waited"}


def test_a_page_whose_requests_pile_up_is_not_read_until_they_are_done(page, feature):
    page.read()
    page.send({"op": "wait", "id": 1})
    assert feature.entered.wait(TIMEOUT)
    count = sessions.MAX_BACKLOG + 5
    for number in range(count):
        page.send({"op": "note", "id": number, "value": number})
    page.send({"op": "ping", "id": 5000})
    assert feature.done == []
    feature.gate.set()
    numbers = [page.read()["id"] for _ in range(count + 2)]
    # The ping is answered at once when it is read, which is not before the backlog gets shorter.
    assert numbers[0] == 1 and numbers.index(5000) >= 5
    assert feature.done == list(range(count))


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("value", r"^a secret\\nreason$"),
        ("os", r"^a secret\\nreason$"),
        ("own", r"^a secret\\nreason$"),
        ("type", "^internal error; the log"),
    ],
)
def test_errors_are_told_in_words_and_those_of_programmers_are_not(page, kind, expected):
    with pytest.raises(ValueError, match=expected):
        page.ask("fail", kind=kind)
    assert page.ask("note", value=1) == 1


def test_at_most_two_frames_are_in_flight_and_the_newest_replaces_the_one_that_waits(page, feature):
    page.ask("open", channel=7)
    channel = feature.channel
    assert channel.ready
    for number in range(10):
        channel.send_binary(1, number + 0.5, number + 0.75, 640, 480, b"jpeg %d" % number)
    assert not channel.ready
    for seq in (1, 2):
        header, payload = frame_of(page.read())
        assert header == (1, 0, 7, seq, seq - 0.5, seq - 0.25, 640, 480)
        assert payload == b"jpeg %d" % (seq - 1)
    page.send({"op": "ack", "channel": 7, "seq": 1})
    header, payload = frame_of(page.read())
    assert (header[3], payload) == (3, b"jpeg 9")
    assert not channel.ready and feature.ready == []
    page.send({"op": "ack", "channel": 7, "seq": 2})
    assert page.ask("ping")
    assert channel.ready and feature.ready == [1]


def test_messages_of_a_channel_have_its_number_and_their_own(page, feature):
    page.ask("open", channel=65535)
    feature.channel.send_message({"a": [float("nan"), 1]}, 1.5, 2.5)
    assert page.read() == {
        "push": "message",
        "channel": 65535,
        "seq": 1,
        "stamp": 1.5,
        "received": 2.5,
        "data": {"a": [None, 1]},
    }


@pytest.mark.parametrize("seq", [0, 3, -1, "1", 1.0, None, True, [1], {"a": 1}])
def test_frames_that_were_not_sent_are_not_acknowledged(page, feature, seq):
    page.ask("open", channel=7)
    for number in range(3):
        feature.channel.send_binary(1, 0, 0, 1, 1, b"%d" % number)
    page.send({"op": "ack", "channel": 7, "seq": seq})
    for channel in (8, "7", None, [7], True):
        page.send({"op": "ack", "channel": channel, "seq": 1})
    assert page.ask("ping")
    assert not feature.channel.ready
    assert len(page.frames) == 2


@pytest.mark.parametrize("size", [0, 93, 94, 65503, 65504, 300000])
def test_frames_of_any_size_arrive_whole(page, feature, size):
    page.ask("open", channel=7)
    payload = bytes(index % 251 for index in range(size))
    feature.channel.send_binary(1, 0, 0, 1, 1, payload)
    feature.channel.send_binary(1, 0, 0, 1, 1, b"next")
    assert frame_of(page.read())[1] == payload
    assert frame_of(page.read())[1] == b"next"


def test_a_frame_is_acknowledged_once(page, feature):
    page.ask("open", channel=7)
    for _ in range(2):
        feature.channel.send_binary(1, 0, 0, 1, 1, b"x")
    page.ask("ping")
    for _ in range(3):
        page.send({"op": "ack", "channel": 7, "seq": 2})
    page.ask("ping")
    assert feature.ready == [1]


def test_a_channel_that_is_open_cannot_be_opened_again_before_it_is_closed(page, feature):
    page.ask("open", channel=7)
    first = feature.channel
    with pytest.raises(ValueError, match="channel 7 is open already"):
        page.ask("open", channel=7)
    page.ask("close_channel", channel=7)
    assert first.closed and feature.done == ["channel"]
    page.ask("close_channel", channel=7)  # It may be on its way twice.
    page.ask("open", channel=7)
    first.send_binary(1, 0, 0, 1, 1, b"late")
    feature.channel.send_binary(1, 0, 0, 1, 1, b"new")
    assert frame_of(page.read())[1] == b"new"


@pytest.mark.parametrize("number", [0, 65536])
def test_channels_have_numbers_of_16_bits(page, number):
    with pytest.raises(ValueError, match=r"channel is .*, must be from 1 to 65535"):
        page.ask("open", channel=number)


def test_a_page_has_at_most_64_channels(page):
    for number in range(1, 65):
        page.ask("open", channel=number)
    with pytest.raises(ValueError, match="64 open channels"):
        page.ask("open", channel=65)
    page.ask("close_channel", channel=64)
    page.ask("open", channel=65)


def test_the_end_of_a_page_closes_its_channels(served, feature):
    with served.page() as page:
        page.ask("open", channel=7)
    assert feature.ended.wait(TIMEOUT)
    assert feature.channel.closed and feature.session.closed and not feature.channel.ready
    assert feature.done == ["channel"]
    called = []
    feature.session.on_close(lambda: called.append("session"))
    feature.channel.on_close(lambda: called.append("channel"))
    assert called == ["session", "channel"]
    with pytest.raises(ValueError, match="the session is closed"):
        feature.session.channel(8)
    feature.session.push("late", {})


def test_pushes_of_one_kind_and_key_replace_one_another(page, feature):
    page.ask("open", channel=1)
    stopped = threading.Event()

    def stop_the_loop():
        stopped.set()
        assert feature.gate.wait(TIMEOUT)

    feature.session._call(stop_the_loop)
    assert stopped.wait(TIMEOUT)
    for number in range(5):
        feature.session.push("graph", {"number": number})
        feature.session.push("values", {"number": number}, key=f"/node_{number % 2}")
    feature.gate.set()
    found = [page.read() for _ in range(3)]
    assert [(one["push"], one["data"]["number"]) for one in found] == [
        ("values", 3),
        ("graph", 4),
        ("values", 4),
    ]


def test_a_page_that_reads_nothing_is_closed_and_harms_no_other(served, feature):
    with served.page() as stalled, served.page() as other:
        stalled.ask("open", channel=1)
        session = feature.session
        part = {"text": "x" * (1 << 20)}
        number = 0
        while not session.closed and number < 100:  # The system's buffers take some of them.
            session.push("log", part, key=str(number))
            number += 1
            assert other.ask("note", value=number) == number
            if session._outbox._closed:
                break
        assert session._outbox._closed, "a hundred megabytes wait"
        assert sum(message.size for message in session._outbox._messages.values()) == 0
        code, reason = stalled.wait_for_end()
        assert (code, reason) == (1008, "the page does not read what it is sent")
        assert other.ask("note", value=1) == 1


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        ("", "is no JSON"),
        ("\x00", "is no JSON"),
        ("[]", "no JSON object"),
        ("[" * 60000, "nested too deeply"),
        ('{"op": "note", "id": 1, "value": NaN}', "NaN"),
        ('{"op": "note", "id": 1, "value": 1e999}', "value is inf"),
        ('{"op": "note", "id": 1, "value": {"a": 1}}', "value is"),
        ('{"op": "note", "id": 1}', "the field value is missing"),
        ('{"op": "note", "id": NaN, "value": 1}', "NaN"),
        ('{"op": "note", "id": "1", "value": 1}', "id is '1'"),
        ('{"op": "note", "value": 1}', "id is None"),
        ('{"op": ["note"], "id": 1}', "no operation"),
        ('{"op": "__init__", "id": 1}', "no operation"),
        ('{"id": 1}', "no operation None"),
        ('{"op": "note", "id": 1, "value": ' + "9" * 50000 + "}", "more than 40 digits"),
    ],
    ids=lambda value: value[:20],
)
def test_malformed_messages_are_answered_in_words(page, message, expected):
    page.read()
    page.send(message)
    answer = page.read()
    assert expected in answer["error"] and len(json.dumps(answer)) < 1000
    assert page.ask("note", value=1) == 1


def test_a_message_that_is_too_long_ends_the_session(page):
    page.read()
    page.send("x" * 65537)
    page.wait_for_end()


def test_a_page_sends_no_bytes(page):
    page.read()
    page.send(b'{"op": "note", "id": 1, "value": 1}')
    assert page.wait_for_end() == (1003, "pages send text only")


def test_a_failure_of_ours_ends_the_session_and_not_only_its_answers(page, monkeypatch):
    def fail(_text):
        raise RuntimeError("a secret reason")

    page.read()
    monkeypatch.setattr(page_socket, "parse_request", fail)
    page.send({"op": "note", "id": 1, "value": 1})
    code, reason = page.wait_for_end()
    assert code == 1011 and "secret" not in reason


def test_a_page_that_floods_is_read_slowly(page, monkeypatch):
    monkeypatch.setattr(pace, "BURST", 10.0)
    waited = []
    real = asyncio.sleep

    async def sleep(seconds):
        waited.append(seconds)
        await real(0)

    monkeypatch.setattr(asyncio, "sleep", sleep)
    page.read()
    for number in range(500):
        page.send({"op": "ping", "id": number})
    for number in range(500):
        assert page.read()["id"] == number
    assert sum(waited) > 0


def test_frames_that_were_drawn_may_come_at_any_rate(page, feature, monkeypatch):
    waited = []
    monkeypatch.setattr(pace, "MAX_RATE", 0.001)
    monkeypatch.setattr(asyncio, "sleep", waited.append)  # awaiting None would fail
    page.ask("open", channel=1)
    for seq in range(1, 1000):
        feature.channel.send_binary(1, 0, 0, 1, 1, b"x")
        assert frame_of(page.read())[0][3] == seq
        page.send({"op": "ack", "channel": 1, "seq": seq})
    assert waited == []


def test_there_are_as_many_pages_as_there_may_be(served):
    with served.page() as first, served.page():
        status, _, text = served.get("/ws?token=" + VIEW_TOKEN)
        assert status == 503 and "~max_clients" in text
        status, _, text = served.get("/", cookie=served.access.cookie_of("view"))
        assert status == 503 and "close another one" in text
        assert first.ask("note", value=1) == 1
        first.end_now()
        deadline = time.monotonic() + TIMEOUT
        while served.get("/", cookie=served.access.cookie_of("view"))[0] != 200:
            assert time.monotonic() < deadline, "there is no room again"


def test_the_end_of_the_server_is_told_to_its_pages(served):
    with served.page() as page:
        page.read()
        served.server.close()
        assert page.wait_for_end() == (1001, "the dashboard ends")
