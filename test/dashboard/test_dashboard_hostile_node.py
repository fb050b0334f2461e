"""Hostile clients of the running node: it serves others on, says little, and ends at once."""

import contextlib
import random
import re
import resource
import socket

import pytest
import support
from served import Page

CONNECTIONS = 1000


@pytest.fixture
def many_files():
    """Lets this process have 1,000 connections open."""
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = 2 * CONNECTIONS
    if before[0] != resource.RLIM_INFINITY and before[0] < wanted:
        if before[1] != resource.RLIM_INFINITY and before[1] < wanted:
            pytest.skip(f"this user may open {before[1]} files only, {wanted} are needed")
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_NOFILE, before)


FEW_FILES = """
import resource
from robot_vision.dashboard.dashboard import main

resource.setrlimit(resource.RLIMIT_NOFILE, (512, 512))
main()
"""


@pytest.fixture
def dashboard(run_script):
    """A dashboard that may have fewer files open than there will be connections, and its page."""
    process = run_script(FEW_FILES, "_port:=0", "__name:=dashboard", env={"PYTHONUNBUFFERED": "1"})
    process.wait_for_output("?token=")
    host, token = re.search(r"http://(\S+)/\?token=(\w+)", process.output()).groups()
    page = Page(f"ws://{host}/ws?token={token}")
    yield process, host, token, page
    page.end()


def connect(host):
    name, port = host.split(":")
    return socket.create_connection((name, int(port)), support.DEADLINE)


def test_it_outlives_connections_beyond_the_files_that_it_may_open(dashboard, many_files):
    process, host, token, page = dashboard
    with contextlib.ExitStack() as stack:
        for number in range(CONNECTIONS):
            connection = stack.enter_context(connect(host))
            if number % 2:
                connection.sendall(b"GET / HT")
            if number % 100 == 99:
                assert page.ask("ping")["time"] > 0
                other = Page(f"ws://{host}/ws?token={token}")
                assert other.ask("ping")["time"] > 0
                other.end()
        process.interrupt()
        assert process.prompt_exit_code() == 0, process.output()
    assert "Too many open files" not in process.output()
    assert "Traceback" not in process.output()


def test_nonsense_makes_neither_noise_nor_an_end(dashboard):
    process, host, _, page = dashboard
    before = process.output()
    source = random.Random(3)
    pieces = [
        b"GET /",
        b"\x1b[2J",
        b"\x00\xff",
        b" HTTP/1.1\r\n",
        b"Host: ",
        host.encode(),
        b"\r\n",
    ]
    for _ in range(200):
        with connect(host) as connection, contextlib.suppress(ConnectionError):
            connection.sendall(b"".join(source.choices(pieces, k=20)) + b"\r\n\r\n")
    for _ in range(100):
        page.send(
            "".join(source.choices(['{"op":', '"graph"', "}", "NaN", "[", "\x1b", "\x00"], k=8))
        )
    assert page.ask("ping")["time"] > 0
    noise = process.output()[len(before) :]
    assert noise.count("\n") <= 10 and all(line.isprintable() for line in noise.splitlines()), noise
    assert "Traceback" not in noise
    assert process.running()
