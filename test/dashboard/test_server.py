"""What the dashboard's server lets in over HTTP, and what it answers; without ROS."""

import base64
import re
import socket

import pytest
from served import TIMEOUT, TOKEN, VIEW_TOKEN, Page, Served
from tornado.httpclient import HTTPClientError

from robot_vision.dashboard import server as server_module
from robot_vision.dashboard.access import COOKIES
from robot_vision.dashboard.handlers import GuardedHandler, GuardedSocket, Refused
from robot_vision.dashboard.page_files import FOLDER, file_table
from robot_vision.dashboard.page_socket import PageSocket
from robot_vision.dashboard.server import bind
from robot_vision.dashboard.web_video_viewer import MAX_UNSENT


class ControlHandler(GuardedHandler):
    needs = "control"

    def get(self):
        self.finish(f"for {self.role}")

    def post(self):
        self.finish(f"posted by {self.role}")


class OpenHandler(GuardedHandler):
    def is_open(self):
        return True

    def get(self):
        self.finish(f"open for {self.role or 'all'}")


class FailingHandler(GuardedHandler):
    def get(self):
        raise RuntimeError("a secret reason")


class RefusingHandler(GuardedHandler):
    def get(self):
        raise Refused(400, "<b>no</b>", self.get_query_argument("text"))


class UrlSocket(GuardedSocket):
    by_url_only = True

    def open(self):
        self.write_message(f"for {self.role}")


ROUTES = [
    ("/control", ControlHandler),
    ("/open", OpenHandler),
    ("/failing", FailingHandler),
    ("/refusing", RefusingHandler),
    ("/url", UrlSocket),
]


@pytest.fixture(scope="module")
def served():
    made = Served(routes=ROUTES)
    yield made
    made.server.close()


@pytest.fixture(scope="module")
def cookie(served):
    return served.access.cookie_of("control")


@pytest.fixture(scope="module")
def view_cookie(served):
    return served.access.cookie_of("view")


PATHS = ("/", "/page/index.html", "/ws", "/control", "/url", "/none", "/open")


def test_the_printed_address_gives_a_cookie_and_then_the_page(served):
    for token, role in ((TOKEN, "control"), (VIEW_TOKEN, "view")):
        status, headers, _ = served.get(f"/?token={token}")
        assert (status, headers["Location"]) == (302, "/")
        given = headers["Set-Cookie"]
        assert token not in given
        cookie = re.match("(robot_vision_dashboard_[0-9a-f]{8})=([0-9a-f]{64});", given).groups()
        flags = set(given.split("; ")[1:])
        assert flags == {"HttpOnly", "Path=/", "SameSite=Strict"}
        status, _, body = served.get("/", cookie=cookie)
        with open(f"{FOLDER}/index.html") as file:
            assert (status, body) == (200, file.read())
        assert served.get("/control", cookie=cookie)[0] == {"control": 200, "view": 403}[role]


@pytest.mark.parametrize("count, cleared", [(0, 0), (3, 0), (15, 0), (16, 1), (20, 5)])
def test_the_oldest_of_many_cookies_of_dashboards_are_cleared(served, count, cleared):
    old = [f"{COOKIES}{number:08d}" for number in range(count)]
    cookie = served.access.cookie_of("control")
    cookies = "; ".join(f"{name}=x" for name in ["other", *old, cookie[0]])
    request = f"GET /?token={TOKEN} HTTP/1.1\r\nHost: {served.host}\r\nConnection: close\r\n"
    answer = served.say(f"{request}Cookie: {cookies}\r\n\r\n".encode()).decode()
    given = re.findall("Set-Cookie: ([^=]+)=([^;]*);", answer)
    assert [name for name, value in given if value in ("", '""')] == old[:cleared]
    assert cookie in given


@pytest.mark.parametrize("first, then", [("control", "view"), ("view", "control")])
def test_the_address_that_was_opened_last_gives_the_role(served, first, then):
    token = {"control": TOKEN, "view": VIEW_TOKEN}[then]
    name, value = served.access.cookie_of(first)
    request = f"GET /?token={token} HTTP/1.1\r\nHost: {served.host}\r\nConnection: close\r\n"
    answer = served.say(f"{request}Cookie: {name}={value}\r\n\r\n".encode()).decode()
    given = re.findall("Set-Cookie: ([^=]+)=([^;]*);", answer)
    assert sorted(given) == sorted([(name, '""'), served.access.cookie_of(then)])


def test_a_link_of_another_site_leads_to_the_page_too(served):
    """Browsers send a strict cookie not even after the redirection that a foreign link led to."""
    status, headers, _ = served.get(f"/?token={TOKEN}", Sec_Fetch_Site="cross-site")
    assert (status, headers["Refresh"]) == (200, "0; url=/")
    assert "Set-Cookie" in headers
    status, headers, _ = served.get("/?token=wrong-one", Sec_Fetch_Site="cross-site")
    assert status == 403 and "Set-Cookie" not in headers


def test_a_code_opens_the_page_once(served, cookie):
    code = served.access.url_with_code("127.0.0.1").partition("?code=")[2]
    assert served.get(f"/?code={code}", Host="evil.example")[0] == 403
    assert served.get(f"/control?code={code}")[0] == 403
    status, headers, _ = served.get(f"/?code={code}")
    assert status == 302 and "=".join(cookie) in headers["Set-Cookie"]
    status, headers, _ = served.get(f"/?code={code}")
    assert status == 403 and "Set-Cookie" not in headers


@pytest.mark.parametrize("path", [path for path in PATHS if path != "/open"])
@pytest.mark.parametrize(
    "query", ["", "?token=", "?token=guess-it", f"?token={TOKEN[:-1]}", "?x=1"]
)
def test_without_a_token_nothing_is_shown_but_how_to_get_in(served, path, query):
    own = "http://" + served.host
    status, headers, body = served.get(path + query, Origin=own)
    assert status == 403 and "Open the address that the dashboard has printed" in body
    assert "Set-Cookie" not in headers
    status, _, body = served.get(path + query, "GET", "0" * 64, Origin=own, Accept="text/html")
    assert status == 403 and "Open the address that the dashboard has printed" in body
    assert body.startswith("<!DOCTYPE html>")


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize(
    "host",
    ["evil.example", "localhost.evil.example:80", "192.168.0.7", "", "localhost, evil.example"],
)
def test_another_host_gets_nothing_even_with_the_token(served, cookie, path, host):
    for query in ("", f"?token={TOKEN}"):
        status, headers, body = served.get(path + query, Host=host, cookie=cookie)
        assert status == 403 and "not known by the name" in body
        assert "Set-Cookie" not in headers


def test_a_request_without_a_host_gets_nothing(served):
    answer = served.say(f"GET /?token={TOKEN} HTTP/1.0\r\n\r\n".encode())
    assert answer.startswith(b"HTTP/1.1 403 ") and b"Set-Cookie" not in answer


def test_the_page_of_another_port_can_neither_post_nor_talk(served, cookie):
    other = "http://127.0.0.1:1"
    for origin in (other, "null", "https://" + served.host, f"http://localhost:{served.port}"):
        status, _, body = served.get("/control", "POST", cookie, Origin=origin, Content_Length="0")
        assert status == 403 and "own page" in body
        status, _, body = served.get("/ws", cookie=cookie, Origin=origin)
        assert status == 403 and "own page" in body
        # A token in the URL makes no difference.
        assert served.get(f"/ws?token={TOKEN}", Origin=origin)[0] == 403
    own = "http://" + served.host
    answer = served.get("/control", "POST", cookie, Origin=own, Content_Length="0")
    assert (answer[0], answer[2]) == (200, "posted by control")


def test_a_post_or_a_socket_with_the_cookie_but_no_origin_is_refused(served, cookie):
    assert served.get("/control", "POST", cookie, Content_Length="0")[0] == 403
    assert served.get("/ws", cookie=cookie)[0] == 403


@pytest.mark.parametrize("role", ["control", "view"])
def test_our_own_page_opens_the_socket_by_its_cookie(served, role):
    cookie = "=".join(served.access.cookie_of(role))
    for name in ("127.0.0.1", "localhost"):
        origin = f"http://{name}:{served.port}"
        page = Page(f"ws://{name}:{served.port}/ws", {"Cookie": cookie, "Origin": origin})
        assert page.read()["data"]["role"] == role
        page.end()


def test_a_socket_for_other_programs_takes_the_token_of_the_url_only(served, cookie):
    """Browsers send the cookie along with requests of pages of other ports of this machine."""
    headers = {"Origin": "https://app.example", "Cookie": "=".join(cookie)}
    with pytest.raises(HTTPClientError, match="403"):
        Page(f"ws://{served.host}/url", headers)
    loop_text = Page(f"ws://{served.host}/url?token={VIEW_TOKEN}", headers)
    assert loop_text._run(loop_text._socket.read_message) == "for view"
    loop_text.end()


def test_the_view_role_gets_what_it_may_see(served, view_cookie):
    assert served.get("/", cookie=view_cookie)[0] == 200
    status, _, body = served.get("/control", cookie=view_cookie)
    assert status == 403 and "may look, but not control" in body


def test_what_is_open_needs_no_token_but_the_right_host(served, cookie):
    assert served.get("/open")[2] == "open for all"
    assert served.get("/open", cookie=cookie)[2] == "open for control"
    assert served.get("/open", Host="evil.example")[0] == 403


@pytest.mark.parametrize("path", [*PATHS, "/failing", "/page/../server.py"])
def test_every_answer_has_the_headers_that_keep_a_browser_safe(served, cookie, path):
    for given in (cookie, None):
        _, headers, _ = served.get(path, cookie=given, Accept="text/html")
        policy = dict(part.split(" ", 1) for part in headers["Content-Security-Policy"].split("; "))
        assert policy["default-src"] in ("'self'", "'none'")
        assert policy["frame-ancestors"] == "'none'" == policy["base-uri"]
        assert "unsafe" not in headers["Content-Security-Policy"]
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert headers["X-Frame-Options"] == "DENY"
        assert headers["Referrer-Policy"] == "no-referrer"
        assert headers["Cache-Control"] in ("no-store", "no-cache")
        assert "Server" not in headers


def test_the_page_has_the_policy_of_its_contract(served, cookie):
    _, headers, _ = served.get("/", cookie=cookie)
    for part in ("img-src 'self' blob: data:", "style-src 'self'", "connect-src 'self'"):
        assert part in headers["Content-Security-Policy"].split("; ")
    assert headers["Cross-Origin-Resource-Policy"] == "same-origin"


def test_the_error_page_shows_its_own_style_only(served):
    _, headers, body = served.get("/", Accept="text/html")
    policy = headers["Content-Security-Policy"]
    assert policy.startswith("default-src 'none'; style-src 'sha256-")
    assert "<script" not in body and " style=" not in body


@pytest.mark.parametrize(
    "path",
    [
        "/page/",
        "/page/../server.py",
        "/page/..%2fserver.py",
        "/page/%2e%2e/server.py",
        "/page/..\\server.py",
        "/page/....//server.py",
        "/page//etc/passwd",
        "/page/%2fetc%2fpasswd",
        "/page/index.html%00.js",
        "/page/index.html/",
        "/page/none.js",
        "/page/__init__.py",
        "/../../../../etc/passwd",
        "//etc/passwd",
        "/index.html",
        "/static/index.html",
        "/page/" + "a" * 4000,
        "http://127.0.0.1/page/none",
    ],
    ids=lambda path: path[:30],
)
def test_only_the_files_of_the_page_are_given(served, cookie, path):
    status, _, body = served.get(path, cookie=cookie)
    assert status == 404
    assert "root:" not in body and "import" not in body


def test_the_table_has_the_files_of_the_page_and_nothing_beside(tmp_path):
    for name in (
        "index.html",
        "main.js",
        "style.css",
        "icon.svg",
        ".hidden.js",
        "notes.txt",
        "a.py",
    ):
        (tmp_path / name).write_text(name)
    (tmp_path / "folder").mkdir()
    assert sorted(file_table(str(tmp_path))) == ["icon.svg", "index.html", "main.js", "style.css"]
    with pytest.raises(
        ValueError, match=r"no index\.html: robot_vision is not installed completely"
    ):
        file_table(str(tmp_path / "folder"))


@pytest.mark.parametrize("method", ["PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "NONE"])
def test_other_methods_are_refused(served, cookie, method):
    headers = {"Origin": "http://" + served.host, "Content_Length": "0"}
    assert served.get("/", method, cookie, **headers)[0] == 405


def test_what_a_client_says_is_shown_as_text(served, cookie):
    path = "/refusing?text=%3Cscript%3Ealert(1)%3C/script%3E"
    _, headers, body = served.get(path, cookie=cookie, Accept="text/html")
    assert "<script" not in body and "&lt;script&gt;alert(1)" in body and "<b>" not in body
    assert headers["Content-Security-Policy"].startswith("default-src 'none'")
    _, headers, body = served.get(path, cookie=cookie)
    assert headers["Content-Type"].startswith("text/plain") and "<script>" in body


def test_a_failure_is_not_told(served, cookie):
    status, _, body = served.get("/failing", cookie=cookie, Accept="text/html")
    assert status == 500 and "secret" not in body and "Traceback" not in body


def test_a_page_that_is_still_the_same_is_not_sent_again(served, cookie):
    etag = served.get("/", cookie=cookie)[1]["Etag"]
    status, _, body = served.get("/", cookie=cookie, If_None_Match=etag)
    assert (status, body) == (304, "")


def test_the_loopback_address_may_be_that_of_ipv6():
    try:
        served = Served(address="::1")
    except ValueError as error:
        pytest.skip(f"no IPv6: {error}")
    host = f"[::1]:{served.port}"
    assert served.access.url("::1") == f"http://{host}/?token={TOKEN}"
    status, headers, _ = served.get(f"/?token={TOKEN}", Host=host)
    assert status == 302 and "Set-Cookie" in headers
    page = Page(f"ws://{host}/ws?token={TOKEN}", {"Origin": f"http://{host}"})
    assert page.read()["data"]["role"] == "control"
    page.end()
    served.server.close()


def test_names_that_the_user_gives_lead_here():
    served = Served(hosts=["robot.example", "https://proxy.example"])
    cookie = served.access.cookie_of("control")
    assert served.get("/", Host="robot.example", cookie=cookie)[0] == 200
    upgrade = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec_WebSocket_Version": "13"}
    upgrade["Sec_WebSocket_Key"] = base64.b64encode(b"x" * 16).decode()
    for origin, status in (("https://proxy.example", 101), ("https://robot.example", 403)):
        head = f"GET /ws HTTP/1.1\r\nHost: robot.example\r\nOrigin: {origin}\r\n"
        head += f"Cookie: {'='.join(cookie)}\r\n"
        head += "".join(f"{key.replace('_', '-')}: {text}\r\n" for key, text in upgrade.items())
        with served.connect() as connection:
            connection.sendall(head.encode() + b"\r\n")
            assert connection.recv(12) == f"HTTP/1.1 {status}".encode()
    served.server.close()


def test_the_next_port_is_taken_if_one_is_taken():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        sockets = bind("127.0.0.1", port, 20)
        assert port < sockets[0].getsockname()[1] < port + 20
        for one in sockets:
            one.close()
        with pytest.raises(ValueError, match=f"port {port} is taken at 127.0.0.1; ~port names"):
            bind("127.0.0.1", port)


def test_all_ports_may_be_taken(monkeypatch):
    tried = []

    def refuse(port, address):
        tried.append((port, address))
        raise OSError(server_module.errno.EADDRINUSE, "in use")

    monkeypatch.setattr(server_module, "bind_sockets", refuse)
    with pytest.raises(ValueError, match="ports 65534 to 65535 are all taken at localhost; ~port"):
        bind("localhost", 65534, 10)
    assert tried == [(65534, "localhost"), (65535, "localhost")]


@pytest.mark.parametrize("address", ["192.0.2.1", "no.such.name.invalid", "a..b", "256.1.1.1"])
def test_an_address_of_another_machine_is_an_error_in_one_line(address):
    with pytest.raises(ValueError, match=f"address is '{re.escape(address)}', port 8080: nothing"):
        bind(address, 8080, 10)


def test_the_system_keeps_little_of_what_a_page_does_not_read(monkeypatch):
    kept = []
    opened = PageSocket.open

    def look(page):
        opened(page)
        connection = page.ws_connection.stream.socket
        kept.append(connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT))

    monkeypatch.setattr(PageSocket, "open", look)
    served = Served()
    with served.page() as page:
        assert page.ask("ping")
    served.server.close()
    assert kept == [MAX_UNSENT]


def test_a_server_that_ends_leaves_its_port_free():
    served = Served()
    with served.connect(), served.page() as page:
        page.read()
        served.server.close()
    assert not served.server._thread.is_alive()
    with socket.socket() as again:
        again.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        again.settimeout(TIMEOUT)
        again.bind(("127.0.0.1", served.port))
