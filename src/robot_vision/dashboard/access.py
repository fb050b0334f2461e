"""Who may use the dashboard: names of the machine, origins of pages, tokens and roles."""

import hashlib
import hmac
import ipaddress
import re
import secrets
import socket
from typing import Any, Iterable, Optional, Set, Tuple

from ..common.plain_text import brief

ROLES = ("control", "view")
LOOPBACK_NAMES = ("localhost", "127.0.0.1", "::1")
ALL_ADDRESSES = {"0.0.0.0", "::"}  # of the machine, to listen on
RANDOM_BYTES = 16  # of a token that is made
COOKIES = "robot_vision_dashboard_"  # what the names of the cookies of all dashboards begin with
TOKEN = re.compile(r"[A-Za-z0-9._~-]{8,128}")
TOKEN_WORDS = "8 to 128 letters of A-Z, a-z, 0-9, '.', '_', '~' and '-'"
NO_TOKEN = "none"  # as token: nobody is asked for one, which is for the loopback address only
MADE = "random"  # as token: one that is made at each start


class Access:
    """Decides what a request may do.

    A request has to name this machine in its Host header, or a page of another one could have its
    own name lead here (DNS rebinding). What changes something has to come from our own page, and
    everything needs a token: that of the address, or the cookie that was made of it.

    Args:
        address: The address that the server listens on.
        port: Its port.
        token: The token for the role control; "" makes one, "none" asks nobody for one.
        view_token: The token for the role view; "" is none, "random" makes one.
        hosts: Further names of this machine, or origins as https://robot.example.
        name: The name of this machine for others; by default its host name.

    Raises:
        ValueError: A token or a host cannot be one, or there has to be a token.
    """

    def __init__(
        self,
        address: str = "127.0.0.1",
        port: int = 8080,
        token: str = "",
        view_token: str = "",
        hosts: Iterable[str] = (),
        name: str = "",
    ):
        self.port = port
        self.name = name or socket.gethostname()
        self.local = is_loopback(address)
        self.token = "" if token == NO_TOKEN else checked_token("token", token or MADE)
        self.view_token = checked_token("view_token", view_token) if view_token else ""
        if not self.token and not self.local:
            raise ValueError(
                f"token is '{NO_TOKEN}' and address '{address}': all who reach this machine "
                "could control it; without a token it has to be 127.0.0.1"
            )
        if self.token and self.token == self.view_token:
            raise ValueError("token and view_token are the same, must be different ones")
        if not self.token and self.view_token:
            raise ValueError("view_token is set, but token is none: all pages may control")
        # The address may be another one of 127.0.0.0/8, or the name of one of several interfaces.
        self._hosts: Set[str] = {*LOOPBACK_NAMES, _canonical(address.lower())} - ALL_ADDRESSES
        if not self.local:
            self._hosts.update(machine_names(), {self.name.lower()})
        self._origins: Set[str] = set()
        for host in hosts:
            self._add_host(host)
        self._code = ""  # that lets one browser in, once

    def role_of(self, request: Any, by_url_only: bool = False) -> str:
        """Returns "control", "view" or "" for a tornado request.

        Args:
            request: The request.
            by_url_only: Whether only a token in the URL counts. Browsers send the cookie along with
                requests of other pages of this machine.
        """
        if not self.token:
            return "control"
        given = request.query_arguments.get("token", [])
        role = self.role_of_token(given[0]) if given else ""
        return role or ("" if by_url_only else self._role_of_cookies(request.cookies))

    def url(self, address: str, role: str = "control") -> str:
        """Returns the address of the page for a role, as it is printed."""
        token = self._token_of(role)
        return self._url(address, f"?token={token}" if token else "")

    def url_with_code(self, address: str) -> str:
        """Returns an address that lets one browser in, once.

        Everybody on this machine can read the command line that a browser is started with.
        """
        self._code = secrets.token_hex(RANDOM_BYTES)
        return self._url(address, f"?code={self._code}")

    def _url(self, address: str, query: str) -> str:
        host = self.name if address in ALL_ADDRESSES else address
        return f"http://{f'[{host}]' if ':' in host else host}:{self.port}/{query}"

    def role_of_code(self, code: bytes) -> str:
        """Returns "control" for the code that was made, the first time, else ""."""
        known, right = self._code, hmac.compare_digest(code, self._code.encode())
        if known and right:
            self._code = ""
            return "control"
        return ""

    def role_of_token(self, token: bytes) -> str:
        """Returns "control", "view" or "" for a token of a URL."""
        role = ""
        for known, its_role in ((self.view_token, "view"), (self.token, "control")):
            if known and hmac.compare_digest(token, known.encode()):
                role = its_role
        return role

    def cookie_of(self, role: str) -> Tuple[str, str]:
        """Returns name and value of the cookie for a role, which do not tell the token.

        Browsers give the cookies of a machine to all its ports, and tunnels may lead from them to
        dashboards of several machines. So the name is another one for each token. It has nothing of
        the other role's token, which could be tried by it until it is found.
        """
        token = self._token_of(role)
        return COOKIES + _digest(token, b"name")[:8], _digest(token, b"cookie")

    def host_allowed(self, request: Any) -> bool:
        """Returns whether the Host header names this machine, at any port: there are tunnels."""
        host = split_host(request.headers.get("Host", ""))
        return host in self._hosts or (not self.local and host == _own_address(request))

    def origin_allowed(self, request: Any) -> bool:
        """Returns whether the Origin header is that of our own page."""
        origin, host = (request.headers.get(name, "") for name in ("Origin", "Host"))
        return bool(host and origin == "http://" + host) or origin in self._origins

    def _token_of(self, role: str) -> str:
        return self.token if role == "control" else self.view_token

    def _role_of_cookies(self, cookies: Any) -> str:
        for role in filter(self._token_of, ROLES):
            name, value = self.cookie_of(role)
            given = cookies[name].value if name in cookies else ""
            if hmac.compare_digest(given.encode("utf-8", "replace"), value.encode()):
                return role
        return ""

    def _add_host(self, host: str) -> None:
        scheme, separator, name = host.rpartition("://")
        known = split_host(name)
        if known is None or scheme not in ("", "http", "https"):
            raise ValueError(
                f"hosts has {brief(host)}, must have names as robot.local or "
                "origins as https://robot.example"
            )
        self._hosts.add(known)
        if separator:
            self._origins.add(host.lower())


def checked_token(name: str, token: str) -> str:
    """Returns a token as a parameter gives it, or a made one; raises ValueError if it is none."""
    if token == MADE:
        return secrets.token_hex(RANDOM_BYTES)
    if not TOKEN.fullmatch(token):  # not shown, as it is meant to be a secret
        raise ValueError(f"{name} is a text of {len(token)} letters, must be {TOKEN_WORDS}")
    return token


def split_host(host: str) -> Optional[str]:
    """Returns the name or address of a Host header without the port, or None if it is malformed."""
    match = re.fullmatch(
        r"(?:\[([0-9a-fA-F:.]{2,45})\]|([A-Za-z0-9._-]{1,253}))(?::\d{1,5})?", host
    )
    if not match:
        return None
    return _canonical((match.group(1) or match.group(2)).lower())


def is_loopback(address: str) -> bool:
    """Returns whether an address to listen on is reached from this machine only."""
    if address == "localhost":
        return True
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False


def machine_names() -> Set[str]:
    """Returns the names by which others know this machine."""
    name = socket.gethostname().lower()
    short = name.partition(".")[0]
    return {name, short, f"{short}.local", socket.getfqdn().lower()} - {""}


def _canonical(host: str) -> str:
    try:
        return str(ipaddress.ip_address(host))
    except ValueError:
        return host


def _own_address(request: Any) -> Optional[str]:
    """The address at which the request has reached this machine, or None."""
    stream = getattr(request.connection, "stream", None)
    try:
        address: Tuple[Any, ...] = stream.socket.getsockname()
    except (AttributeError, OSError):
        return None
    return _canonical(str(address[0]).partition("%")[0].replace("::ffff:", ""))


def _digest(token: str, purpose: bytes) -> str:
    return hmac.new(token.encode(), purpose, hashlib.sha256).hexdigest()
