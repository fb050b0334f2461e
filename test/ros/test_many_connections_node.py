"""Many connect to a node at once, as when all nodes of a launch file start."""

import contextlib
import select
import socket
import urllib.parse

import rosgraph
import support

MANY = 40  # several times as many as rospy has room for


def test_all_get_a_connection_while_the_node_has_no_time(start):
    node = start("python_manager.py", "__name:=busy")
    master = rosgraph.Master("/test")
    support.wait_for(lambda: support.has_service(master, "/busy/list"), "the node")
    address = urllib.parse.urlparse(master.lookupService("/busy/list"))
    with support.standing_still(node), contextlib.ExitStack() as stack:
        waiting = []
        for _ in range(MANY):
            connection = stack.enter_context(socket.socket())
            connection.setblocking(False)
            connection.connect_ex((address.hostname, address.port))
            waiting.append(connection)
        support.wait_for(
            lambda: len(select.select([], waiting, [], 0.0)[1]) == MANY, f"{MANY} connections"
        )
        assert not any(one.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR) for one in waiting)
