"""The master of a test leaves the processes of other tests alone."""

import os
import socket
import threading
import xmlrpc.server

import private_master
import pytest
import rosgraph
import support

NOWHERE = "http://127.0.0.1:1/"
UPDATE, SHUTDOWN = "publisherUpdate", "shutdown"


class OwnNode:
    """A node of this process, and the names of the methods that masters have called."""

    def __init__(self, server):
        self.uri = f"http://127.0.0.1:{server.server_address[1]}/"
        self.calls = []
        for name in (UPDATE, SHUTDOWN):
            server.register_function(self._noting(name), name)

    def _noting(self, name):
        def called(*_):
            self.calls.append(name)
            return 1, "", os.getpid()

        return called


def comes_and_goes(uri, master):
    """Has a node subscribe, be found dead as one of its name comes, and subscribe once more."""

    def api(name):
        return rosgraph.Master(name, master.env["ROS_MASTER_URI"])

    for name, topic in (("/node", "/first"), ("/again", "/second")):
        api(name).registerSubscriber(topic, "std_msgs/String", uri)
        api("/else").registerPublisher(topic, "std_msgs/String", NOWHERE)
        api(name).registerPublisher("/third", "std_msgs/String", NOWHERE)


@pytest.fixture
def node():
    with xmlrpc.server.SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield OwnNode(server)
        server.shutdown()


def test_processes_of_the_test_are_told(start, node):
    comes_and_goes(node.uri, support.Master(start))
    told = [UPDATE, SHUTDOWN] * 2
    support.wait_for(lambda: len(node.calls) == len(told), "calls of the master")
    assert node.calls == told


def test_processes_of_other_tests_are_not_connected_to(start, tmp_path):
    log = tmp_path / "master.log"
    with socket.socket() as another:
        another.bind(("127.0.0.1", 0))
        another.listen()
        another.setblocking(False)
        env = {private_master.MARK: "1", "ROS_LOG_DIR": str(tmp_path)}
        address = f"127.0.0.1:{another.getsockname()[1]}"
        comes_and_goes(f"http://{address}/", support.Master(start, env=env))
        refused = f"exception=no process of this test listens at {address}"
        support.wait_for(lambda: log.exists() and log.read_text().count(refused) == 2, refused)
        with pytest.raises(BlockingIOError):
            another.accept()


def test_a_port_is_that_of_the_process_which_listens():
    me = str(os.getpid())
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        port = bound.getsockname()[1]
        assert not private_master.is_port_of_test(port, me)
        bound.listen()
        assert private_master.is_port_of_test(port, me)
        assert not private_master.is_port_of_test(port, "1")
    assert not private_master.is_port_of_test(port, me)


def test_what_a_test_starts_is_of_the_test(start):
    started = start("/usr/bin/sleep", 60)
    forked = start("python_manager.py")
    me = str(os.getpid())
    # A process has no environment yet when it has just become another program.
    support.wait_for(lambda: private_master.is_of_test(started.pid, me), "the program")
    assert private_master.is_of_test(forked.pid, me)
    assert not private_master.is_of_test(started.pid, me + "0")
    started.kill()
    started.exit_code()
    assert not private_master.is_of_test(started.pid, me)
