"""The costs of processes, and what they hold: given figures, what is said of them."""

import os
import socket

import demo_cost
import psutil
import pytest
from demo_cost import DemoCost
from holdings import (
    Holdings,
    holdings_of,
    holdings_table,
    master_connections,
    not_given_back,
)
from process_costs import LOADERS, ProcessCost, memory_of, name_of, total

KEPT = {"vision": Holdings(40, 30, 120.0), "rosmaster": Holdings(20, 12, 30.0)}


@pytest.mark.parametrize(
    "command, name",
    [
        ("/usr/bin/python3 /ws/lib/hsv_tracker.py __name:=red __log:=/l", "red"),
        ("/usr/lib/nodelet/nodelet manager __name:=vision", "vision"),
        ("/usr/lib/nodelet/nodelet load robot_vision/camera vision __name:=usb_cam", LOADERS),
        ("/usr/bin/python3.11 /usr/bin/roslaunch robot_vision demo.launch", "roslaunch"),
        ("/usr/bin/rosmaster --core -p 1", "rosmaster"),
        ("", "python"),
    ],
)
def test_a_process_has_the_name_of_its_node_or_program(command, name):
    assert name_of(command.split()) == name


def test_the_memory_of_a_process_has_its_parts():
    everything = memory_of(os.getpid())
    parts = memory_of(os.getpid(), ["Pss_Anon", "Pss_File", "Pss_Shmem"])
    assert everything > 1.0 and parts == pytest.approx(everything, rel=0.1)


def test_a_table_has_a_line_for_each_process_of_any_way():
    first = DemoCost({"vision": ProcessCost(20.0, 70.0), "a": ProcessCost(1.0, 60.0)}, {"a": 7.0})
    both = {"vision": ProcessCost(40.0, 150.0), "rosmaster": ProcessCost(2.0, 30.0)}
    last = DemoCost(both, {"a": 3.0}, {"vision": ProcessCost(35.0, 120.0)})
    costs = {"several": first, "one": last}
    lines = demo_cost.cost_table(costs).splitlines()
    assert lines[0] == "| process | CPU: several | PSS | CPU: one | PSS |"
    assert lines[2:] == [
        "| vision | 20.0 | 70.0 | 40.0 | 150.0 |",
        "| a | 1.0 | 60.0 | - | - |",
        "| rosmaster | - | - | 2.0 | 30.0 |",
        "| all, 2, 2 processes | 21.0 | 130.0 | 42.0 | 180.0 |",
    ]
    assert "| a | 7.0 | 3.0 |" in demo_cost.start_table(costs)
    assert total(first.processes) == ProcessCost(21.0, 130.0, 2)
    assert [(one.value, one.most) for one in demo_cost.goals(last)] == [
        (42.0, demo_cost.CORE),
        (180.0, demo_cost.MEMORY),
        (35.0, demo_cost.CORE),
        (120.0, demo_cost.MEMORY),
        (150.0, demo_cost.MEMORY),
        (3.0, demo_cost.START),
    ]


@pytest.mark.parametrize(
    "after, words",
    [
        (Holdings(40, 30, 120.0), []),
        (Holdings(39, 28, 90.0), []),
        (Holdings(40, 30, 131.0), []),
        (Holdings(41, 30, 120.0), ["41 descriptors, 40 before"]),
        (Holdings(40, 31, 120.0), ["31 threads, 30 before"]),
        (Holdings(40, 30, 145.0), ["145.0 MB, 120.0 before"]),
    ],
)
def test_what_a_process_keeps_is_told(after, words):
    lines = not_given_back(KEPT, {**KEPT, "vision": after}, {"a": (180, 175)})
    assert lines == [f"vision has {text}" for text in words]


def test_what_the_master_keeps_is_not_told():
    assert not not_given_back(KEPT, {**KEPT, "rosmaster": Holdings(21, 13, 60.0)}, {})


def test_a_process_that_has_gone_and_a_node_that_stands_are_told():
    lines = not_given_back(
        KEPT, {"vision": KEPT["vision"]}, {"a": (180, 20), "b": (40, 39), "c": (6, 0)}
    )
    assert lines == ["rosmaster has gone", "a gave 20 results, 180 before in the same time"]
    text = holdings_table(KEPT, {"vision": KEPT["vision"]}, {"a": (180, 90)})
    assert "| vision | 40 | 40 | 30 | 30 | 120.0 | 120.0 |" in text
    assert "| rosmaster | 20 | - | 12 | - | 30.0 | - |" in text
    assert "| a | 180 | 90 |" in text


def test_what_a_process_opens_is_counted():
    own = psutil.Process()

    def descriptors():
        return holdings_of(own.pid)[name_of(own.cmdline())].descriptors

    before = descriptors()
    opened = [os.open(os.devnull, os.O_RDONLY) for _ in range(5)]
    try:
        assert descriptors() == before + len(opened)
    finally:
        for descriptor in opened:
            os.close(descriptor)


def test_connections_to_the_master_do_not_count():
    own = psutil.Process()
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        before = master_connections(own, port)
        with socket.create_connection(("127.0.0.1", port)), server.accept()[0]:
            assert before == (0, 0) and master_connections(own, port) == (1, 1)
            assert master_connections(own, port + 1) == (0, 0)
