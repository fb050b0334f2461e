"""The master of a test leaves the processes of other tests alone."""

import os
import threading
import xmlrpc.server

import private_master
import pytest
import rosgraph
import support

NOWHERE = "http://127.0.0.1:1/"
QUESTION, UPDATE, SHUTDOWN = "getPid", "publisherUpdate", "shutdown"


class OwnNode:
    """A node of this process, and the names of the methods that masters have called."""

    def __init__(self, server):
        self.uri = f"http://127.0.0.1:{server.server_address[1]}/"
        self.calls = []
        for name in (QUESTION, UPDATE, SHUTDOWN):
            server.register_function(self._noting(name), name)

    def _noting(self, name):
        def called(*_):
            self.calls.append(name)
            return 1, "", os.getpid()

        return called

    def comes_and_goes(self, master):
        """Has it subscribe, be found dead as one of its name comes, and subscribe once more."""
        for name, topic in (("/node", "/first"), ("/again", "/second")):
            self._api(master, name).registerSubscriber(topic, "std_msgs/String", self.uri)
            self._api(master, "/else").registerPublisher(topic, "std_msgs/String", NOWHERE)
            self._api(master, name).registerPublisher("/third", "std_msgs/String", NOWHERE)

    @staticmethod
    def _api(master, name):
        return rosgraph.Master(name, master.env["ROS_MASTER_URI"])


@pytest.fixture
def node():
    with xmlrpc.server.SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield OwnNode(server)
        server.shutdown()


def test_processes_of_the_test_are_told(start, node):
    node.comes_and_goes(support.Master(start))
    told = [QUESTION, UPDATE, QUESTION, SHUTDOWN] * 2
    support.wait_for(lambda: len(node.calls) == len(told), "calls of the master")
    assert node.calls == told


def test_processes_of_other_tests_are_asked_only_who_they_are(start, node):
    node.comes_and_goes(support.Master(start, env={private_master.MARK: "1"}))
    support.wait_for(lambda: len(node.calls) == 4, "questions of the master")
    assert node.calls == [QUESTION] * 4


def test_what_a_test_starts_is_of_the_test(start):
    started = start("/usr/bin/sleep", 60)
    forked = start("python_manager.py")
    me = str(os.getpid())
    assert private_master.is_of_test(started.pid, me) and private_master.is_of_test(forked.pid, me)
    assert not private_master.is_of_test(started.pid, me + "0")
    started.kill()
    started.exit_code()
    assert not private_master.is_of_test(started.pid, me)
