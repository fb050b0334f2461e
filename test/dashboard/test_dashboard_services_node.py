"""Calls of services that hang, lie or end, and of a master that does."""

import contextlib
import socket
import struct
import threading

import pytest
import rosgraph
import rosgraph.network
import rospy
import support
from std_srvs.srv import SetBool, Trigger, TriggerResponse

from robot_vision.dashboard.graph_calls import TIMEOUT, call_node
from robot_vision.ros.graph_master import (
    MasterCalls,
    graph_name,
    has_service,
    require_master,
    server_param,
)

HEADER = rosgraph.network.encode_ros_handshake_header({"callerid": "/hostile"})


@contextlib.contextmanager
def serving(handler, kind=Trigger, name="/served/do"):
    service = rospy.Service(name, kind, handler)
    try:
        yield
    finally:
        service.shutdown()


def say_no_more(connection):
    # If it was closed, what the client still sends would be answered by a reset, which may come
    # before the client has read all.
    connection.shutdown(socket.SHUT_WR)


def reset(connection):
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    connection.close()


@contextlib.contextmanager
def pretending(*parts, end=say_no_more):
    """A service /hostile/do that sends these bytes to whoever connects, and may then end."""
    listener = socket.create_server(("127.0.0.1", 0))
    taken = []

    def run():
        with contextlib.suppress(OSError):
            while True:
                connection = listener.accept()[0]
                taken.append(connection)
                for part in parts:
                    connection.recv(1 << 16)
                    connection.sendall(part)
                end(connection)

    threading.Thread(target=run, daemon=True).start()
    uri = f"rosrpc://127.0.0.1:{listener.getsockname()[1]}"
    master = rosgraph.Master("/hostile")
    master.registerService("/hostile/do", uri, "http://127.0.0.1:9/")
    try:
        yield
    finally:
        master.unregisterService("/hostile/do", uri)
        # A thread in accept() wakes up only by this.
        with contextlib.suppress(OSError):
            listener.shutdown(socket.SHUT_RDWR)
        listener.close()
        for connection in taken:
            connection.close()


def test_a_service_is_called_with_its_fields():
    with serving(lambda request: (request.data, "done \u00e9"), SetBool):
        answer = call_node("/served", "do", SetBool, True)
    assert answer.success is True and answer.message == "done \u00e9"


def test_a_service_that_is_not_there_is_told():
    with pytest.raises(OSError, match="/served has no service do: it has ended"):
        call_node("/served", "do", Trigger)
    assert not has_service("/served/do")


def test_what_a_service_raises_is_told():
    def fail(_):
        raise RuntimeError("<b>broken\x1b[31m")

    with serving(fail), pytest.raises(OSError, match=r"/served/do: .*<b>broken\\x1b\[31m"):
        call_node("/served", "do", Trigger)


def test_a_service_of_another_type_is_told():
    with serving(lambda _: TriggerResponse()), pytest.raises(OSError, match=r"/served/do: .*md5"):
        call_node("/served", "do", SetBool, True)


def test_fields_of_another_type_are_refused():
    with serving(lambda _: (True, ""), SetBool), pytest.raises(ValueError, match="/served/do"):
        call_node("/served", "do", SetBool, "x" * 3)


@pytest.mark.parametrize("parts", [(), (HEADER,), (HEADER, b"\1")])
def test_a_service_that_breaks_off_is_told(parts):
    message = "/hostile/do cannot be called: it has ended the connection"
    with pretending(*parts, end=reset), pytest.raises(OSError, match=message):
        call_node("/hostile", "do", Trigger)


@pytest.mark.parametrize(
    "parts",
    [(), (HEADER,), (HEADER, b"\1"), (HEADER, b"\1" + struct.pack("<I", 100) + b"x")],
)
def test_a_service_that_hangs_is_left_in_time(parts):
    message = "/hostile/do has not answered within 0.3 s"
    with pretending(*parts, end=lambda _: None), pytest.raises(OSError, match=message):
        call_node("/hostile", "do", Trigger, timeout=0.3)


@pytest.mark.parametrize(
    "parts, says",
    [
        ((struct.pack("<I", 2**31),), "answers 2147483648 bytes, must be up to"),
        ((HEADER, b"\1" + struct.pack("<I", 2**32 - 1)), "answers 4294967295 bytes"),
        ((HEADER, b"\0" + struct.pack("<I", 3) + b"\xff<b"), "/hostile/do: .*<b"),
        ((HEADER, b"\0" + struct.pack("<I", 0)), "says no reason"),
        ((HEADER,), "has ended the connection"),
        ((b"\4\0\0\0\xff\xff\xff\xff",), "what /hostile/do answers cannot be read"),
    ],
)
def test_answers_that_are_none_are_told(parts, says):
    with pretending(*parts), pytest.raises((OSError, ValueError), match=says):
        call_node("/hostile", "do", Trigger)


def test_an_answer_of_other_bytes_is_told():
    part = b"\1" + struct.pack("<I", 3) + b"\1\2\3"
    with pretending(HEADER, part), pytest.raises(OSError, match="what /hostile/do answers"):
        call_node("/hostile", "do", Trigger)


def test_a_service_that_nobody_serves_any_more_is_told():
    with socket.create_server(("127.0.0.1", 0)) as listener:
        uri = f"rosrpc://127.0.0.1:{listener.getsockname()[1]}"
    master = rosgraph.Master("/hostile")
    master.registerService("/hostile/do", uri, "http://127.0.0.1:9/")
    try:
        with pytest.raises(OSError, match="/hostile/do cannot be called: Connection refused"):
            call_node("/hostile", "do", Trigger)
    finally:
        master.unregisterService("/hostile/do", uri)


@pytest.mark.parametrize("name", ["", "a", "/", "/a/", "//a", "/a b", "/a\n", "/\u00e9", "/1a"])
def test_names_that_are_none(name):
    with pytest.raises(ValueError, match="is no name of a node or a topic"):
        graph_name(name)


def test_parameters_of_the_server():
    rospy.set_param("/given/value", {"a": [1, "x"]})
    assert server_param("/given/value") == {"a": [1, "x"]}
    rospy.delete_param("/given")
    assert server_param("/given/value") is None


def test_a_connection_that_the_master_has_closed_is_opened_again(master):
    calls = MasterCalls()
    assert calls.call("getPid") > 0
    calls._connection.sock.shutdown(socket.SHUT_RDWR)
    assert calls.call("getPid") > 0
    calls.close()


def test_a_master_that_is_gone_or_silent_is_told(monkeypatch):
    with socket.create_server(("127.0.0.1", 0)) as listener:
        uri = f"http://127.0.0.1:{listener.getsockname()[1]}"
        monkeypatch.setenv("ROS_MASTER_URI", uri)
        with pytest.raises(OSError, match="does not answer: it is silent"):
            MasterCalls(timeout=0.2).call("getPid")
    with pytest.raises(OSError, match=f"the master at {uri}/? does not answer: .*refused"):
        require_master()


def test_the_timeouts_are_those_of_people_who_wait():
    assert 0.0 < TIMEOUT <= 5.0 < support.DEADLINE
