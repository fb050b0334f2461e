"""The files of the page: those that are in its folder, and no others."""

import os
from typing import Dict, Tuple

from tornado.web import HTTPError

from ..common.files import read_file
from .access import COOKIES, ROLES
from .handlers import GuardedHandler, require_room
from .sessions import Sessions

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "page")
MAX_SIZE = 1 << 20  # bytes of a file
MAX_COOKIES = 16  # of dashboards that a browser keeps: each start without a token makes another
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
}


def file_table(folder: str = FOLDER) -> Dict[str, Tuple[str, str]]:
    """Returns path and content type of each file of the page by its name.

    Raises:
        ValueError: The package is not whole: it has no page.
    """
    names = sorted(os.listdir(folder)) if os.path.isdir(folder) else []
    table = {}
    for name in names:
        kind = TYPES.get(os.path.splitext(name)[1])
        if kind and not name.startswith("."):
            table[name] = (os.path.join(folder, name), kind)
    if "index.html" not in table:
        raise ValueError(f"{folder} has no index.html: robot_vision is not installed completely")
    return table


class FileHandler(GuardedHandler):
    """Gives a file of the page; files are read each time, as somebody may work on them."""

    def initialize(self, table: Dict[str, Tuple[str, str]]) -> None:
        self._table = table

    def get(self, name: str = "index.html") -> None:
        if name not in self._table:
            raise HTTPError(404)
        path, kind = self._table[name]
        self.set_header("Content-Type", kind)
        self.set_header("Cache-Control", "no-cache")  # asked for again, and not sent if the same
        self.set_header("Cross-Origin-Resource-Policy", "same-origin")
        self.finish(read_file(path, MAX_SIZE))


class StartHandler(FileHandler):
    """Gives the page itself, and takes the token out of the address that was printed."""

    _code_role = ""

    def initialize(self, table: Dict[str, Tuple[str, str]], sessions: Sessions) -> None:
        super().initialize(table)
        self._sessions = sessions

    def get(self) -> None:
        role = self._role_of_address()
        if role:
            name, value = self.access.cookie_of(role)
            self.set_cookie(name, value, path="/", httponly=True, samesite="Strict")
            self._clear_other_cookies(role)
        if not self.request.query_arguments.keys() & {"token", "code"}:
            require_room(self._sessions)
            super().get()
        elif self.request.headers.get("Sec-Fetch-Site") == "cross-site":
            # Browsers follow a redirection without the cookie where a link of another site led
            # here, as it is a strict one. This is followed as a link of our own.
            self.set_header("Refresh", "0; url=/")
            self.finish("The dashboard opens.")
        else:
            self.redirect("/")

    def is_open(self) -> bool:
        code = self.request.query_arguments.get("code", [b""])[0]
        self._code_role = self.access.role_of_code(code)
        return bool(self._code_role)

    def _clear_other_cookies(self, role: str) -> None:
        """Clears that of another role here, as the address that was opened last gives the role.

        Of those of other dashboards the first ones are cleared, which the browser has had longest.
        """
        ours = {one: self.access.cookie_of(one)[0] for one in ROLES}
        there = [name for name in self.request.cookies if name.startswith(COOKIES)]
        others = [name for name in there if name not in ours.values()]
        old = others[: max(len(others) + 1 - MAX_COOKIES, 0)]
        for name in old + [ours[one] for one in ROLES if one != role and ours[one] in there]:
            self.clear_cookie(name)

    def _role_of_address(self) -> str:
        token = self.request.query_arguments.get("token", [b""])[0]
        return self._code_role or self.access.role_of_token(token)
