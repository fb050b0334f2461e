"""When demo_status begins to print its table, with reports that a test sends."""

import types

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from fake_params import use_params

from robot_vision.demo import demo_status
from robot_vision.demo.demo_status import LAST_WITHOUT_NEWS, TOPICS, DemoStatus

HEADS = tuple(name + " " for name in TOPICS)


@pytest.fixture
def demo(monkeypatch, capsys):
    """demo.report(NODE...) reports a round; then it gives the nodes of the tables printed since.

    demo.services has those that are there, demo.started the work of threads that were started.
    """
    made = types.SimpleNamespace(services=set(), started=[])
    use_params(monkeypatch, {"~dashboard": True})
    callbacks = []
    context = types.SimpleNamespace(
        resolve=lambda name: f"/vision/{name}",
        subscriber=lambda _topic, _type, callback: callbacks.append(callback),
        thread=lambda work, _name: types.SimpleNamespace(start=lambda: made.started.append(work)),
    )
    monkeypatch.setattr(demo_status, "current", lambda: context)
    monkeypatch.setattr(demo_status, "has_service", lambda service: service in made.services)
    DemoStatus()

    def report(*nodes):
        for node in nodes:
            status = DiagnosticStatus(name=node + ": frames", message="running")
            callbacks[0](DiagnosticArray(status=[status]))
        lines = capsys.readouterr().out.splitlines()
        return [line.split()[0] for line in lines if line.startswith(HEADS)]

    made.report = report
    return made


def test_the_first_table_has_all_nodes_however_slowly_they_start(demo):
    demo.services.add("/vision/dashboard/print_address")
    for count in range(1, len(TOPICS)):
        for _ in range(LAST_WITHOUT_NEWS // 2):
            assert demo.report(*list(TOPICS)[:count]) == []
    assert demo.report(*TOPICS) == [*TOPICS]
    assert demo.started == [demo_status.print_address]


def test_the_first_table_is_printed_after_the_address(demo):
    for _ in range(LAST_WITHOUT_NEWS // 2):
        assert demo.report(*TOPICS) == []
    demo.services.add("/vision/dashboard/print_address")
    assert demo.report(*TOPICS) == [*TOPICS]
    assert demo.report(*TOPICS) == [*TOPICS] and len(demo.started) == 1


def test_a_node_that_does_not_come_is_not_waited_for(demo):
    here = list(TOPICS)[:-1]
    tables = [demo.report(*here) for _ in range(LAST_WITHOUT_NEWS + 3)]
    assert tables == [[]] * (LAST_WITHOUT_NEWS + 2) + [here]
    assert demo.started == [demo_status.print_address]
