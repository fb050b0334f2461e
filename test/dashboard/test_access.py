"""Who is let in: names of the machine, origins, tokens, cookies, roles."""

import re
import socket
from http.cookies import SimpleCookie

import pytest

from robot_vision.dashboard.access import Access, is_loopback, split_host

TOKEN, VIEW_TOKEN = "token-to-control", "token-to-view"


class Connection:
    """A connection that has reached an address of this machine."""

    def __init__(self, address):
        self.stream = self.socket = self
        self._address = address

    def getsockname(self):
        return self._address, 8080


class Request:
    """What Access reads of a request of tornado."""

    def __init__(self, token=None, cookie=None, reached="127.0.0.1", **headers):
        self.query_arguments = {} if token is None else {"token": [token.encode()]}
        self.cookies = SimpleCookie()
        if cookie is not None:
            self.cookies[cookie[0]] = cookie[1]
        self.headers = headers
        self.connection = Connection(reached)


def access(**options):
    return Access(**{"token": TOKEN, "view_token": VIEW_TOKEN, **options})


@pytest.mark.parametrize(
    ("host", "expected"),
    [
        ("localhost", "localhost"),
        ("LocalHost:8080", "localhost"),
        ("127.0.0.1:1", "127.0.0.1"),
        ("[::1]:8080", "::1"),
        ("[0:0:0:0:0:0:0:1]", "::1"),
        ("robot-7.local:8080", "robot-7.local"),
        *[(host, None) for host in ("", ":8080", "a b", "a,b", "a@b", "a/b", "::1", "[::1", "a:b")],
        ("localhost:8080:8080", None),
        ("localhost:123456", None),
        ("localhost\n", None),
        ("x" * 254, None),
    ],
)
def test_a_host_header_is_a_name_and_maybe_a_port(host, expected):
    assert split_host(host) == expected


LOCAL = ("localhost", "localhost:8080", "localhost:9000", "127.0.0.1:8080", "[::1]:8080")
FOREIGN = (
    "",
    "evil.example",
    "evil.example:8080",
    "localhost.evil.example",
    "127.0.0.1.evil.example",
    "evil.example, localhost",
    "localhost@evil.example",
    "127.0.0.2",
    "0.0.0.0",
    "[::]",
    "2130706433",  # 127.0.0.1 as one number
    "localhost.",
)


@pytest.mark.parametrize("address", ["127.0.0.1", "::1", "localhost"])
def test_a_local_dashboard_has_local_names_only(address):
    made = access(address=address)
    assert [host for host in LOCAL if not made.host_allowed(Request(Host=host))] == []
    names = (*FOREIGN, socket.gethostname() + ".evil", "192.168.0.7")
    assert [host for host in names if made.host_allowed(Request(Host=host))] == []
    assert not made.host_allowed(Request())
    # An address by which others reach the machine is none of a dashboard that listens locally.
    assert not made.host_allowed(Request(Host="192.168.0.7", reached="192.168.0.7"))


@pytest.mark.parametrize(
    "address", ["127.0.0.2", "0:0:0:0:0:0:0:1", "127.0.0.1", "192.168.0.7", "robot-wifi"]
)
def test_the_address_that_is_printed_is_let_in(address):
    made = access(address=address)
    host = made.url(address).split("/")[2]
    assert made.host_allowed(Request(Host=host))
    assert not made.host_allowed(Request(Host="127.0.0.3:8080"))


def test_a_dashboard_for_others_also_has_the_machine_s_names_and_the_address_that_was_reached():
    made = access(address="0.0.0.0", name="robot-for-others")
    name = socket.gethostname()
    hosts = (*LOCAL, name, f"{name}:8080", f"{name}.local", "robot-for-others")
    assert [host for host in hosts if not made.host_allowed(Request(Host=host))] == []
    assert made.host_allowed(Request(Host="192.168.0.7:8080", reached="192.168.0.7"))
    assert made.host_allowed(Request(Host="[fe80::1]:8080", reached="fe80::1%eth0"))
    assert not made.host_allowed(Request(Host="192.168.0.8:8080", reached="192.168.0.7"))
    assert [host for host in FOREIGN if made.host_allowed(Request(Host=host))] == []


def test_hosts_adds_names_and_origins():
    made = access(hosts=["Robot.Example", "https://proxy.example"])
    for host in ("robot.example", "ROBOT.example:80", "proxy.example"):
        assert made.host_allowed(Request(Host=host))
    assert not made.host_allowed(Request(Host="evil.example"))
    assert made.origin_allowed(Request(Host="proxy.example", Origin="https://proxy.example"))
    assert not made.origin_allowed(Request(Host="robot.example", Origin="https://robot.example"))


@pytest.mark.parametrize("host", ["", "a b", "ftp://a", "https://", "https://a/path", "a/b", "*"])
def test_what_is_no_name_is_refused(host):
    with pytest.raises(ValueError, match=r"hosts has .* must have names"):
        access(hosts=[host])


@pytest.mark.parametrize(
    ("origin", "allowed"),
    [
        ("http://localhost:8080", True),
        ("https://localhost:8080", False),
        ("http://localhost", False),
        ("http://localhost:8081", False),
        ("http://127.0.0.1:8080", False),  # another origin for a browser
        ("http://localhost:8080/", False),
        ("http://localhost:8080.evil.example", False),
        ("http://evil.example", False),
        ("null", False),
        ("", False),
        ("localhost:8080", False),
    ],
)
def test_the_origin_is_exactly_that_of_the_page(origin, allowed):
    request = Request(Host="localhost:8080", Origin=origin)
    assert access().origin_allowed(request) is allowed


def test_no_origin_is_not_ours():
    assert not access().origin_allowed(Request(Host="localhost:8080"))
    assert not access().origin_allowed(Request(Origin="http://"))


@pytest.mark.parametrize(
    ("token", "role"),
    [
        (TOKEN, "control"),
        (VIEW_TOKEN, "view"),
        (TOKEN[:-1], ""),
        (TOKEN + "x", ""),
        (TOKEN.upper(), ""),
        ("", ""),
        ("töken", ""),
        ("x" * 100000, ""),
    ],
)
def test_a_token_of_the_address_gives_a_role(token, role):
    assert access().role_of(Request(token=token)) == role
    assert access().role_of(Request(token=token), by_url_only=True) == role


@pytest.mark.parametrize("role", ["view", "control"])
def test_a_cookie_gives_the_role_it_was_made_for(role):
    made = access()
    cookie = made.cookie_of(role)
    assert not any(token in part for token in (TOKEN, VIEW_TOKEN) for part in cookie)
    assert made.role_of(Request(cookie=cookie)) == role
    assert made.role_of(Request(cookie=cookie, token="wrong")) == role
    assert made.role_of(Request(cookie=cookie), by_url_only=True) == ""


def test_dashboards_behind_the_same_name_have_cookies_of_their_own():
    """Tunnels lead from two ports of one machine to the same port of two others."""
    tokens = TOKEN, TOKEN, "another-token"
    names = [access(token=token).cookie_of("control")[0] for token in tokens]
    assert names[0] == names[1] != names[2]
    assert not any(TOKEN in name or len(name) > 40 for name in names)


def test_the_cookie_of_a_role_has_nothing_of_the_token_of_the_other_one():
    """Who may only look could try words, without asking the dashboard, until one gives that."""
    roles = {"view": "token", "control": "view_token"}
    for role, others_token in roles.items():
        assert access(**{others_token: "another-token"}).cookie_of(role) == access().cookie_of(role)


@pytest.mark.parametrize("value", ["", TOKEN, "x", "é", "0" * 64, access().cookie_of("view")[1]])
def test_another_cookie_gives_none(value):
    made = access()
    name = made.cookie_of("control")[0]
    assert made.role_of(Request(cookie=(name, value))) == ""
    assert made.role_of(Request(cookie=("other", made.cookie_of("control")[1]))) == ""


def test_without_a_view_token_an_empty_one_gives_no_role():
    made = access(view_token="")
    for request in (Request(), Request(token=""), Request(cookie=made.cookie_of("view"))):
        assert made.role_of(request) == ""


def test_tokens_are_compared_in_constant_time(monkeypatch):
    compared = []

    def compare(a, b):
        compared.append((bytes(a), bytes(b)))
        return a == b

    monkeypatch.setattr("hmac.compare_digest", compare)
    made = access()
    made.role_of(Request(token="guess"))
    for role in ("view", "control"):
        made.role_of(Request(cookie=(made.cookie_of(role)[0], "guess")))
    assert {b for a, b in compared if a == b"guess"} == {
        TOKEN.encode(),
        VIEW_TOKEN.encode(),
        made.cookie_of("view")[1].encode(),
        made.cookie_of("control")[1].encode(),
    }


def test_tokens_are_made_at_random():
    made = [Access(view_token="random") for _ in range(2)]
    tokens = [token for one in made for token in (one.token, one.view_token)]
    assert len(set(tokens)) == 4
    assert all(re.fullmatch("[0-9a-f]{32}", token) for token in tokens)


def test_a_code_lets_one_browser_in_once():
    made = access()
    assert made.role_of_code(b"") == ""
    address, code = made.url_with_code("127.0.0.1").split("?code=")
    assert address == "http://127.0.0.1:8080/" and len(code) == 32
    assert made.role_of_code(b"guess") == ""
    assert made.role_of_code(code.encode()) == "control"
    assert made.role_of_code(code.encode()) == ""
    assert made.role_of_code(b"") == ""


@pytest.mark.parametrize(
    "token", ["short", "x" * 129, "with blank", "new\nline", "tökentöken", "a&b=cdefg"]
)
def test_a_token_is_refused_that_could_be_guessed_or_fits_no_address(token):
    for name in ("token", "view_token"):
        with pytest.raises(
            ValueError, match=f"{name} is a text of {len(token)} letters, must be"
        ) as refused:
            access(**{name: token})
        assert token not in str(refused.value)


def test_one_token_cannot_have_two_roles():
    with pytest.raises(ValueError, match="the same"):
        access(view_token=TOKEN)
    with pytest.raises(ValueError, match="token is none"):
        access(token="none")


@pytest.mark.parametrize("address", ["127.0.0.1", "127.1.2.3", "::1", "localhost"])
def test_only_this_machine_may_go_without_a_token(address):
    made = Access(address, token="none")
    assert made.role_of(Request()) == "control"
    assert "token" not in made.url(address)


@pytest.mark.parametrize(
    "address", ["0.0.0.0", "::", "192.168.0.7", "robot.local", "127.0.0.1.evil", ""]
)
def test_others_are_always_asked_for_a_token(address):
    assert not is_loopback(address)
    with pytest.raises(ValueError, match=r"it has to be 127\.0\.0\.1"):
        Access(address, token="none")
    made = Access(address)
    assert len(made.token) == 32
    assert made.role_of(Request()) == ""


@pytest.mark.parametrize(
    ("address", "expected"),
    [
        ("127.0.0.1", f"http://127.0.0.1:8080/?token={TOKEN}"),
        ("::1", f"http://[::1]:8080/?token={TOKEN}"),
        ("0.0.0.0", f"http://robot:8080/?token={TOKEN}"),
        ("::", f"http://robot:8080/?token={TOKEN}"),
    ],
)
def test_the_printed_address_is_one_that_can_be_opened(address, expected):
    made = access(address=address, name="robot")
    assert made.url(address) == expected
    assert made.url(address, "view") == expected.replace(TOKEN, VIEW_TOKEN)
