"""Clients that say nothing, say it slowly, say too much, or nonsense: others are served on."""

import asyncio
import contextlib
import os
import random
import resource
import socket
import struct
import threading
import time

import pytest
from served import TIMEOUT, TOKEN, Served

from robot_vision.dashboard import http_server, pace
from robot_vision.dashboard.handlers import GuardedHandler


@pytest.fixture
def impatient(monkeypatch):
    """A server with short timeouts."""
    monkeypatch.setattr(http_server, "HEADER_TIMEOUT", 1.5)
    monkeypatch.setattr(http_server, "BODY_TIMEOUT", 1.5)
    made = Served()
    yield made
    made.server.close()


@pytest.fixture(scope="module")
def served():
    made = Served()
    yield made
    made.server.close()


def is_well(served):
    """Whether another client gets the page."""
    return served.get("/", cookie=served.access.cookie_of("view"))[0] == 200


def is_closed_while_saying(connection, text):
    """Whether the server closes a connection on which one byte after the other comes slowly."""
    connection.settimeout(0.05)
    deadline = time.monotonic() + TIMEOUT
    for byte in text:
        try:
            connection.sendall(bytes([byte]))
            if connection.recv(4096) == b"":
                return True
        except socket.timeout:
            if time.monotonic() > deadline:
                return False
        except ConnectionError:
            return True
    return False


def endless():
    yield from b"GET / HTTP/1.1\r\nHost: localhost\r\n"
    while True:
        yield from b"X-A: b\r\n"


def test_a_request_whose_head_comes_slowly_is_given_up(impatient):
    with impatient.connect() as connection:
        assert is_closed_while_saying(connection, endless())
    assert is_well(impatient)


def test_a_request_whose_body_comes_slowly_is_given_up(impatient):
    head = f"POST / HTTP/1.1\r\nHost: {impatient.host}\r\nContent-Length: 60000\r\n"
    head += f"Cookie: {'='.join(impatient.access.cookie_of('control'))}\r\n"
    head += f"Origin: http://{impatient.host}\r\n\r\n"
    with impatient.connect() as connection:
        connection.sendall(head.encode())
        assert is_closed_while_saying(connection, iter(lambda: 0, 1))
    assert is_well(impatient)


def test_a_connection_that_says_nothing_is_given_up(impatient):
    with impatient.connect() as connection:
        assert connection.recv(1) == b""


def test_a_connection_is_kept_for_the_next_request_but_not_for_ever(impatient):
    request = f"GET /none?token={TOKEN} HTTP/1.1\r\nHost: {impatient.host}\r\n\r\n".encode()
    with impatient.connect() as connection:
        for _ in range(2):
            connection.sendall(request)
            assert connection.recv(65536).startswith(b"HTTP/1.1 404")
        assert connection.recv(65536) == b""


def test_a_stranger_gets_one_answer_for_each_connection(impatient):
    request = f"GET / HTTP/1.1\r\nHost: {impatient.host}\r\n\r\n".encode()
    answer = impatient.say(request)
    assert answer.startswith(b"HTTP/1.1 403") and b"Connection: close" in answer
    answers = b""
    with impatient.connect() as connection, contextlib.suppress(ConnectionError):
        connection.sendall(request * 20)
        while True:
            part = connection.recv(65536)
            answers += part
            if not part:
                break
    assert answers.count(b"HTTP/1.1 ") <= 1


@pytest.fixture
def many_files():
    """Lets this process have as many files open as 1,000 connections need."""
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = 4096
    if before[0] != resource.RLIM_INFINITY and before[0] < wanted:
        if before[1] != resource.RLIM_INFINITY and before[1] < wanted:
            pytest.skip(f"this user may open {before[1]} files only, {wanted} are needed")
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_NOFILE, before)


def files():
    return len(os.listdir("/proc/self/fd"))


def test_a_thousand_connections_that_say_nothing_keep_nobody_out(served, many_files):
    with served.page() as page, contextlib.ExitStack() as stack:
        before = files()
        for number in range(1000):
            stack.enter_context(served.connect())
            if number % 100 == 99:
                assert is_well(served)
                assert page.ask("ping")["time"] > 0
                with served.page() as other:
                    assert other.ask("ping")["time"] > 0
        assert files() - before < 1000 + http_server.MAX_CONNECTIONS + 50
    assert is_well(served)


def test_a_thousand_connections_that_begin_a_request_keep_nobody_out(served, many_files):
    with contextlib.ExitStack() as stack:
        for number in range(1000):
            connection = stack.enter_context(served.connect())
            connection.sendall(b"GET / HTTP/1.1\r\nHost: local")
            if number % 100 == 99:
                assert is_well(served)
    assert is_well(served)


class SlowHandler(GuardedHandler):
    """Answers when the test says so."""

    asked, go_on = threading.Event(), threading.Event()

    async def get(self):
        self.asked.set()
        while not self.go_on.is_set():
            await asyncio.sleep(0.01)
        self.finish("at last")


def test_answers_under_way_to_those_who_may_have_them_are_not_cut_off(many_files):
    served = Served(routes=[("/slow", SlowHandler)])
    with served.page() as page, contextlib.ExitStack() as stack:
        asking = stack.enter_context(served.connect())
        words = f"GET /slow?token={TOKEN} HTTP/1.1\r\nHost: {served.host}\r\n\r\n"
        asking.sendall(words.encode())
        assert SlowHandler.asked.wait(TIMEOUT)
        for _ in range(http_server.MAX_CONNECTIONS + 100):
            stack.enter_context(served.connect())
        assert is_well(served)
        assert page.ask("ping")["time"] > 0
        SlowHandler.go_on.set()
        assert asking.recv(12) == b"HTTP/1.1 200"
    served.server.close()


def test_strangers_who_read_no_answer_keep_nobody_out(served, many_files):
    """They ask so often that the answers fill all buffers, and each is written to for ever."""
    request = f"GET / HTTP/1.1\r\nHost: {served.host}\r\nAccept: text/html\r\n\r\n".encode()
    with contextlib.ExitStack() as stack:
        for _ in range(http_server.MAX_CONNECTIONS + 20):
            connection = socket.socket()
            stack.enter_context(connection)
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            connection.connect((served.address, served.port))
            connection.settimeout(0.001)
            with contextlib.suppress(socket.timeout, ConnectionError):
                connection.sendall(request * 3000)
        assert is_well(served)


class LargeHandler(GuardedHandler):
    """Answers everybody, with more than the buffers of served_large() hold."""

    def is_open(self):
        return True

    def get(self):
        self.finish("for all " * 10000)


@contextlib.contextmanager
def served_large():
    made = Served(routes=[("/large", LargeHandler)])
    made.server._sockets[0].setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
    yield made
    made.server.close()


def connected_and_answered(served, query=""):
    """A connection with an answer of which only the first bytes have been read, if any."""
    connection = socket.socket()
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    connection.settimeout(TIMEOUT)
    connection.connect((served.address, served.port))
    connection.sendall(f"GET /large{query} HTTP/1.1\r\nHost: {served.host}\r\n\r\n".encode())
    assert connection.recv(12, socket.MSG_PEEK) == b"HTTP/1.1 200"
    return connection


def test_strangers_who_read_no_answer_that_is_for_everybody_keep_nobody_out(many_files):
    with served_large() as served, contextlib.ExitStack() as stack:
        for _ in range(http_server.MAX_CONNECTIONS + 20):
            stack.enter_context(connected_and_answered(served))
        assert is_well(served)


def test_who_may_look_and_reads_no_answer_is_given_up(monkeypatch):
    monkeypatch.setattr(http_server, "UNREAD_TIMEOUT", 0.1)
    with served_large() as served:
        with connected_and_answered(served, f"?token={TOKEN}") as connection:
            connection.settimeout(0.05)
            deadline = time.monotonic() + TIMEOUT
            with pytest.raises(ConnectionError):  # what comes for a closed connection is refused
                while time.monotonic() < deadline:
                    with contextlib.suppress(socket.timeout):
                        connection.sendall(b"x" * 1000)
        assert is_well(served)


def test_who_reads_an_answer_slowly_gets_all_of_it():
    """The server looks after each part, of more bytes than the system's buffers hold."""
    with served_large() as served, connected_and_answered(served, f"?token={TOKEN}") as connection:
        answer = connection.makefile("rb")
        for _ in range(3):
            looked = threading.Event()
            served.server._loop.add_callback(served.server._server._close_unread)
            served.server._loop.add_callback(looked.set)
            assert looked.wait(TIMEOUT)
            assert len(answer.read(24000)) == 24000


@pytest.mark.parametrize(
    "text",
    [
        b"\r\n\r\n",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(range(256)) + b"\r\n\r\n",  # TLS
        b"GET\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost localhost\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: -1\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999999999\r\n\r\n",
        b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5, 6\r\n\r\nabc",
        b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: +3\r\n\r\nabc",
        b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1_0\r\n\r\n0123456789",
        b"POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n",
        b"POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n-1\r\n\r\n",
        b"POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n1\r\naxx\r\n",
        b"POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: Xchunked\r\n\r\n",
        b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: multipart/form-data; boundary=x\r\n"
        b"Content-Length: 9\r\nConnection: close\r\n\r\n--x\r\n\r\n--",
        b"GET / HTTP/1.1\r\nHost: localhost\r\nX: " + b"a" * 20000 + b"\r\n\r\n",
        b"GET / HTTP/1.1\r\n" + b"X: a\r\n" * 5000 + b"\r\n",
        b"GET /" + b"a" * 20000 + b" HTTP/1.1\r\n\r\n",
    ],
    ids=lambda text: ascii(text[:40]),
)
def test_malformed_requests_are_refused_and_forgotten(impatient, text):
    """Not as those of strangers are, whose requests are read before they get 403."""
    # The rest of what was said may come after the end, which then is a reset.
    with contextlib.suppress(ConnectionResetError):
        answer = impatient.say(text)
        assert answer == b"" or answer.startswith(b"HTTP/1.1 400")
    assert is_well(impatient)


@pytest.mark.parametrize(
    "text",
    [
        b"GET / HTTP/1.1\r\nHost: \xff\xfe\r\nConnection: close\r\n\r\n",
        b"GET /?token=%ff%fe HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
        b"GET /%ff%00 HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: localhost\r\nCookie: " + b'=;\xff;a="\\' + b"\r\n"
        b"Connection: close\r\n\r\n",
    ],
    ids=lambda text: ascii(text[:40]),
)
def test_strange_requests_are_those_of_strangers(impatient, text):
    assert impatient.say(text).startswith(b"HTTP/1.1 403")
    assert is_well(impatient)


def test_a_head_of_more_than_16_kb_is_read_no_further(served):
    request = f"GET / HTTP/1.1\r\nHost: {served.host}\r\nX: {{}}\r\n\r\n"
    assert served.say(request.format("a" * 16000).encode()).startswith(b"HTTP/1.1 403")
    with contextlib.suppress(ConnectionResetError):
        assert served.say(request.format("a" * 17000).encode()) == b""


def test_random_requests_end_nothing(served):
    source = random.Random(1)
    words = [b"GET ", b"/", b" HTTP/1.1", b"\r\n", b"Host: localhost", b"\x00", b"\xff", b": "]
    words += [b"Upgrade: websocket", b"Connection: Upgrade", b"Sec-WebSocket-Version: 13", b"/ws"]
    for _ in range(300):
        with served.connect() as connection, contextlib.suppress(ConnectionError):
            connection.sendall(b"".join(source.choices(words, k=30)) + b"\r\n\r\n")
    assert is_well(served)


def opened(served):
    """A raw WebSocket of the role control, after its handshake and the first push."""
    connection = served.connect()
    connection.sendall(
        f"GET /ws?token={TOKEN} HTTP/1.1\r\nHost: {served.host}\r\nUpgrade: websocket\r\n"
        "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: eHh4eHh4eHh4eHh4eHh4eA==\r\n\r\n".encode()
    )
    assert connection.recv(12) == b"HTTP/1.1 101"
    return connection


def frame(first, payload, length=None, mask=b"\0\0\0\0"):
    """A frame of a WebSocket; `length` is what it claims to have."""
    size = len(payload) if length is None else length
    head = struct.pack(">BBQ", first, 0xFF, size)
    return head + mask + payload


TEXT, PING, PONG, END, FINAL = 1, 9, 10, 8, 0x80


@pytest.mark.parametrize(
    "frames",
    [
        frame(FINAL | TEXT, b"", length=2**63),
        frame(FINAL | TEXT, b"x" * 65537),
        b"".join([frame(TEXT, b"x" * 60000), frame(0, b"x" * 60000)]),  # in parts
        frame(0, b"x"),  # the rest of nothing
        frame(TEXT, b"x") + frame(TEXT, b"x"),
        frame(FINAL | 0x70 | TEXT, b"x"),  # bits that mean nothing
        frame(FINAL | 5, b"x"),  # of no kind
        frame(FINAL | PING, b"x" * 200),
        frame(PING, b"x"),
        frame(FINAL | TEXT, b"\xff\xfe"),
        frame(FINAL | END, b""),
        frame(FINAL | END, b"\x03\xe8" + b"\xff"),
    ],
    ids=lambda frames: ascii(frames[:12]),
)
def test_frames_that_no_browser_sends_end_the_session_only(served, frames):
    with opened(served) as connection, contextlib.suppress(ConnectionError):
        connection.sendall(frames)
        while connection.recv(65536):
            pass
    with served.page() as page:
        assert page.ask("ping")["time"] > 0


def test_a_message_in_very_many_parts_costs_no_more_than_its_bytes(served):
    with opened(served) as connection, contextlib.suppress(ConnectionError):
        connection.sendall(frame(TEXT, b"["))
        connection.sendall(frame(0, b"[") * 20000 + frame(FINAL, b"["))
        connection.recv(65536)
        assert is_well(served)


@pytest.mark.parametrize(
    "frames",
    [
        bytes([FINAL | PING, 0x80, 0, 0, 0, 0]) * 500
        + frame(FINAL | TEXT, b'{"op":"ping","id":7}'),
        bytes([FINAL | PONG, 0x80, 0, 0, 0, 0]) * 500
        + frame(FINAL | TEXT, b'{"op":"ping","id":7}'),
        frame(TEXT, b'{"op":"ping",') + frame(0, b"") * 500 + frame(FINAL, b'"id":7}'),
    ],
    ids=["pings", "pongs", "parts"],
)
def test_frames_that_are_no_messages_are_read_slowly_too(served, monkeypatch, frames):
    """Else tornado reads nothing but these as long as they come, and nobody else is served."""
    monkeypatch.setattr(pace, "BURST", 10.0)
    waited, real = [], asyncio.sleep

    async def sleep(seconds):
        waited.append(seconds)
        await real(0)

    monkeypatch.setattr(asyncio, "sleep", sleep)
    with opened(served) as connection:
        connection.sendall(frames)
        told = b""
        while b'{"id":7,' not in told:
            told += connection.recv(65536)
    assert len(waited) > 100


def test_random_messages_are_answered_or_end_the_session(served):
    source = random.Random(2)
    words = [
        '"op"',
        '"ping"',
        '"ack"',
        '"id"',
        "1",
        "-1",
        "NaN",
        "1e999",
        "null",
        "{",
        "}",
        "[",
        "]",
    ]
    words += [":", ",", '"channel"', '"seq"', '"close_channel"', '"\\ud800"', '"\u2028"', " "]
    with served.page() as page:
        for _ in range(300):
            page.send("".join(source.choices(words, k=12)))
        assert page.ask("ping")["time"] > 0
