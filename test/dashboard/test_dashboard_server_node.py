"""The node dashboard: its address and its secret, its port, its end, and a restarted master."""

import os
import pathlib
import re
import socket

import pytest
import rosgraph
import rospkg
import rospy
import support
from rosgraph_msgs.msg import Log
from served import Page
from std_srvs.srv import Trigger
from tornado.httpclient import HTTPClient, HTTPClientError

ADDRESS = r"^dashboard: http://(127\.0\.0\.1:(\d+))/\?token=([0-9a-f]{32})$"
UNBUFFERED = {"PYTHONUNBUFFERED": "1"}


def address_of(process):
    """Host and token that a dashboard has printed."""
    found = support.wait_for(
        lambda: re.search(ADDRESS, process.output(), re.MULTILINE) or not process.running(),
        "the address",
    )
    assert found is not True, process.output()
    return found[1], found[3]


def page_of(process):
    host, token = address_of(process)
    return Page(f"ws://{host}/ws?token={token}", {"Origin": f"http://{host}"})


def get(url):
    return HTTPClient().fetch(url, follow_redirects=False, raise_error=False)


@pytest.fixture
def dashboard(start):
    return start("dashboard.py", "_port:=0", env=UNBUFFERED)


def test_the_printed_address_leads_to_the_page(dashboard):
    host, token = address_of(dashboard)
    answer = get(f"http://{host}/?token={token}")
    assert answer.code == 302 and "Set-Cookie" in answer.headers
    assert get(f"http://{host}/").code == 403
    page = page_of(dashboard)
    hello = page.read()["data"]
    assert (hello["role"], hello["node"], hello["max_clients"]) == ("control", "/dashboard", 32)
    assert hello["version"] == rospkg.RosPack().get_manifest("robot_vision").version
    assert abs(page.ask("ping")["time"] - hello["time"]) < support.DEADLINE
    page.end()


def test_what_a_page_is_told_first_is_known_before(dashboard):
    """rospkg's manifests take seconds, for which nobody would be served."""
    page = page_of(dashboard)
    page.read()
    page.end()
    assert "rosdep" not in dashboard.output()


def test_the_secret_is_printed_and_nowhere_else(start, dashboard):
    logs = support.Messages("/rosout", Log)
    _, token = address_of(dashboard)
    rospy.wait_for_service("/dashboard/print_address", support.DEADLINE)
    answer = rospy.ServiceProxy("/dashboard/print_address", Trigger)()
    assert answer.success and token not in answer.message
    support.wait_for(lambda: dashboard.output().count(token) == 2, "the address again")
    assert token not in str(rospy.get_param("/"))
    words = "__name:=other", "_port:=0", "_token:=my-own-secret", "_view_token:=my-view-secret"
    other = start("dashboard.py", *words, env=UNBUFFERED)
    other.wait_for_output("to look only: http://127.0.0.1:")
    support.wait_for(
        lambda: any("set on the parameter server" in one.msg for one in logs.received), "its log"
    )
    secrets = (token, "my-own-secret", "my-view-secret")
    assert not [one.msg for one in logs.received if any(secret in one.msg for secret in secrets)]
    assert "port: 0" in other.output() and "token:" not in other.output()
    files = [
        path for path in pathlib.Path(os.environ["ROS_HOME"]).rglob("log/**/*") if path.is_file()
    ]
    assert all(any(node in path.name for path in files) for node in ("dashboard", "other"))
    for path in files:
        text = path.read_text(errors="replace")
        assert not any(secret in text for secret in secrets), path


@pytest.mark.parametrize(
    "parameter, told",
    [
        ("_token:=short", "token is a text of 5 letters, must be 8 to 128 letters"),
        ("_token:=12345678", "token is of type int, must be a string"),
        ("_view_token:=none", "view_token is a text of 4 letters, must be"),
        ("_address:=192.0.2.1", "address is '192.0.2.1', port 8080: nothing can listen there"),
        ("_hosts:=[a b]", "hosts has 'a b', must have names as robot.local"),
        ("_max_clients:=0", "max_clients is 0, must be from 1 to 1000"),
        ("_bag_folder:=bags", "bag_folder is 'bags', must be an absolute path"),
    ],
)
def test_a_bad_parameter_is_fatal_in_one_line(start, parameter, told):
    process = start("dashboard.py", parameter)
    assert process.exit_code() == 1
    assert told in process.output() and "Traceback" not in process.output()
    assert "?token=" not in process.output()


def test_nobody_else_may_reach_it_without_a_token(start):
    process = start("dashboard.py", "_address:=0.0.0.0", "_token:=none")
    assert process.exit_code() == 1
    assert "token is 'none' and address '0.0.0.0': all who reach this machine" in process.output()
    alone = start("dashboard.py", "_port:=0", "_address:=127.0.0.1", env=UNBUFFERED)
    alone.wait_for_output("dashboard: http://127.0.0.1:")
    host = re.search(r"dashboard: http://(\S+)/\n", alone.output())[1]
    assert get(f"http://{host}/").code == 200


def test_others_reach_it_by_the_machine_s_name_where_it_listens_for_them(start):
    process = start("dashboard.py", "_address:=0.0.0.0", "_port:=0", env=UNBUFFERED)
    process.wait_for_output("?token=")
    port, token = re.search(r":(\d+)/\?token=(\w+)", process.output()).groups()
    for name, code in ((socket.gethostname(), 302), ("127.0.0.1", 302), ("evil.example", 403)):
        request = f"GET /?token={token} HTTP/1.0\r\nHost: {name}:{port}\r\n\r\n"
        with socket.create_connection(("127.0.0.1", int(port)), support.DEADLINE) as connection:
            connection.sendall(request.encode())
            assert connection.recv(12) == f"HTTP/1.1 {code}".encode()


def test_the_next_port_is_taken_and_in_the_end_a_line_says_so(start):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        process = start("dashboard.py", f"_port:={port}", "_port_tries:=20", env=UNBUFFERED)
        host, _ = address_of(process)
        assert port < int(host.partition(":")[2]) < port + 20
        other = start("dashboard.py", "__name:=other", f"_port:={port}", "_port_tries:=1")
        assert other.exit_code() == 1
        assert f"port {port} is taken at 127.0.0.1; ~port names another one" in other.output()
        assert "Traceback" not in other.output()


def test_it_ends_at_once_whatever_its_pages_do(start):
    process = start("dashboard.py", "_port:=0", env=UNBUFFERED, fork=False)
    host, _ = address_of(process)
    pages = [page_of(process) for _ in range(3)]
    name, port = host.split(":")
    silent = [socket.create_connection((name, int(port)), support.DEADLINE) for _ in range(20)]
    pages[0].ask("ping")  # It has taken all connections when it answers.
    process.interrupt()
    assert process.prompt_exit_code() == 0, process.output()
    assert "Traceback" not in process.output()
    assert pages[0].wait_for_end() == (1001, "the dashboard ends")
    for connection in silent:
        assert connection.recv(1) == b""
        connection.close()
    for page in pages:
        page.end()


IN_THE_JOURNAL = """
import os
status = os.fstat(1)
os.environ["JOURNAL_STREAM"] = f"{status.st_dev}:{status.st_ino}"
from robot_vision.dashboard.dashboard import main
main()
"""


def test_what_is_kept_in_the_journal_has_no_token(run_script):
    process = run_script(IN_THE_JOURNAL, "_port:=0", "_view_token:=my-view-secret")
    process.wait_for_output("is kept in a log")
    path = pathlib.Path(re.search(r"the address is in (\S+),", process.output())[1])
    assert path.parent == pathlib.Path(os.environ["ROS_HOME"]) and path.stat().st_mode == 0o100600
    text = path.read_text()
    host, _, token = re.match(ADDRESS, text.splitlines()[0]).groups()
    assert get(f"http://{host}/?token={token}").code == 302 and "?token=my-view-secret" in text
    rospy.wait_for_service("/dashboard/print_address", support.DEADLINE)
    answer = rospy.ServiceProxy("/dashboard/print_address", Trigger)()
    assert answer.message == f"the address is in {path}"
    assert token not in process.output() and "my-view-secret" not in process.output()


def test_while_nobody_looks_it_subscribes_to_nothing(dashboard):
    page = page_of(dashboard)
    page.read()
    page.end()
    rospy.wait_for_service("/dashboard/print_address", support.DEADLINE)
    _, subscribers, _ = rosgraph.Master("/test").getSystemState()
    assert [topic for topic, nodes in subscribers if "/dashboard" in nodes] == []


def test_pages_stay_when_the_master_is_another_one_and_the_node_registers_again(start):
    master = support.Master(start)
    process = start("dashboard.py", "_port:=0", env={**UNBUFFERED, **master.env})
    page = page_of(process)
    page.read()
    service = "/dashboard/print_address"
    support.wait_for(lambda: support.has_service(master.api, service), "the service")
    master.end()
    assert page.ask("ping")
    master.begin()
    support.wait_for(lambda: support.has_service(master.api, service), "the service again")
    assert page.ask("ping")
    page.end()


def test_a_browser_is_opened_by_a_code_that_is_good_once(start, tmp_path):
    note = tmp_path / "note"
    program = tmp_path / "xdg-open"
    program.write_text(f'#!/bin/sh\necho "$1" > {note}.new && /bin/mv {note}.new {note}\n')
    program.chmod(0o755)
    env = {**UNBUFFERED, "DISPLAY": ":7", "PATH": f"{tmp_path}:{os.environ['PATH']}"}
    process = start("dashboard.py", "_port:=0", "_open_browser:=true", env=env)
    host, token = address_of(process)
    support.wait_for(note.exists, "the browser")
    url = note.read_text().strip()
    assert url.startswith(f"http://{host}/?code=") and token not in url
    answer = get(url)
    assert answer.code == 302 and "HttpOnly" in answer.headers["Set-Cookie"]
    cookie = answer.headers["Set-Cookie"].partition(";")[0]
    page = Page(f"ws://{host}/ws", {"Origin": f"http://{host}", "Cookie": cookie})
    assert page.read()["data"]["role"] == "control"
    page.end()
    assert get(url).code == 403


def test_a_token_of_before_does_not_open_the_next_dashboard(start):
    first = start("dashboard.py", "_port:=0", env=UNBUFFERED)
    host, token = address_of(first)
    first.interrupt()
    assert first.exit_code() == 0
    port = host.partition(":")[2]
    second = start("dashboard.py", f"_port:={port}", "_port_tries:=20", env=UNBUFFERED)
    host, _ = address_of(second)
    assert get(f"http://{host}/?token={token}").code == 403
    with pytest.raises(HTTPClientError, match="403"):
        Page(f"ws://{host}/ws?token={token}")
