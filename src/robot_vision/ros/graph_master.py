"""Calls of the master's and the nodes' APIs that end in time: rospy's own wait without end."""

import contextlib
import http.client
import re
import socket
import threading
import urllib.parse
import xmlrpc.client
from typing import Any
from xml.parsers.expat import ExpatError

import rosgraph
import rospy

from ..common.files import reason
from ..common.plain_text import brief, is_name, printable

TIMEOUT = 3.0  # s
MAX_REPLY = 64 << 20  # bytes
MAX_REASON = 1000  # characters of what a master or a node says
GRAPH_NAME = re.compile("(/[A-Za-z_][A-Za-z0-9_]*)+")


def graph_name(name: str) -> str:
    """Returns the name of a node or a topic unchanged.

    Raises:
        ValueError: It cannot be such a name, or it is not a whole one, from the first slash on.
    """
    if not is_name(name) or not GRAPH_NAME.fullmatch(name):
        raise ValueError(f"{brief(name)} is no name of a node or a topic, such as /usb_cam")
    return name


class NodeCalls:
    """Calls of a node, or of the master, over one connection, for one thread at a time.

    Args:
        uri: Where its XML-RPC interface is.
        who: What errors call it.
        timeout: How long it may be silent, in s; 0 for TIMEOUT.
    """

    def __init__(self, uri: str, who: str = "the node", timeout: float = 0.0):
        self.uri = uri
        self._who = who
        self._timeout = timeout or TIMEOUT
        self._lock = threading.Lock()  # guards the connection
        self._connection: Any = None

    def raw(self, method: str, *arguments: Any) -> bytes:
        """Returns the answer as it came, in XML.

        Raises:
            TimeoutError: Something is there, but silent: it is busy, or is no such interface.
            OSError: It does not answer.
        """
        body = xmlrpc.client.dumps((rospy.get_name(), *arguments), method).encode()
        with self._lock:
            fresh = self._connection is None
            try:
                return self._post(body)
            except (OSError, http.client.HTTPException) as error:
                self._close()
                if fresh or isinstance(error, socket.timeout):
                    raise self._unreachable(error) from None
            try:  # The master may have closed a connection that was idle.
                return self._post(body)
            except (OSError, http.client.HTTPException) as error:
                self._close()
                raise self._unreachable(error) from None

    def call(self, method: str, *arguments: Any) -> Any:
        """Returns the value of the answer.

        Raises:
            TimeoutError: Something is there, but silent: see raw().
            OSError: It does not answer, or only with an error.
        """
        code, text, value = parsed(self.raw(method, *arguments), self._who)
        if code != 1:
            raise OSError(printable(text, MAX_REASON))
        return value

    def close(self) -> None:
        with self._lock:
            self._close()

    def _post(self, body: bytes) -> bytes:
        if self._connection is None:
            where = urllib.parse.urlparse(self.uri)
            self._connection = http.client.HTTPConnection(
                where.hostname or "", where.port or 80, timeout=self._timeout
            )
        self._connection.request("POST", "/RPC2", body, {"Content-Type": "text/xml"})
        response = self._connection.getresponse()
        data: bytes = response.read(MAX_REPLY + 1)
        if response.status != 200 or len(data) > MAX_REPLY:
            raise http.client.HTTPException(f"status {response.status}, {len(data)} bytes")
        return data

    def _close(self) -> None:
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def _unreachable(self, error: Exception) -> OSError:
        kind = TimeoutError if isinstance(error, socket.timeout) else OSError
        return kind(f"{self._who} at {self.uri} does not answer: {reason_of(error)}")


class MasterCalls(NodeCalls):
    """Calls of the master over one connection, for one thread at a time: see NodeCalls."""

    def __init__(self, timeout: float = 0.0):
        super().__init__(rosgraph.get_master_uri(), "the master", timeout)


def parsed(answer: bytes, who: str = "the master") -> Any:
    """Returns (code, text, value) of an answer of the master or of a node.

    Raises:
        OSError: It is none.
    """
    try:
        ((code, text, value),), _ = xmlrpc.client.loads(answer)
    except (ExpatError, xmlrpc.client.Error, ValueError, TypeError) as error:
        what = f"the answer of {who} cannot be read: {printable(str(error), MAX_REASON)}"
        raise OSError(what) from None
    return code, text, value


def has_service(name: str) -> bool:
    """Returns whether a service is there; raises OSError if the master does not answer."""
    with contextlib.closing(MasterCalls()) as master:
        return bool(parsed(master.raw("lookupService", name))[0] == 1)


def server_param(name: str) -> Any:
    """Returns a value of the parameter server, or None if it is not there.

    Raises:
        OSError: The master does not answer.
    """
    with contextlib.closing(MasterCalls()) as master:
        code, _, value = parsed(master.raw("getParam", name))
    return value if code == 1 else None


def require_master() -> None:
    """Raises OSError if the master does not answer, for which rospy would wait without end."""
    with contextlib.closing(MasterCalls()) as master:
        master.call("getPid")


def reason_of(error: Exception) -> str:
    """Returns what an error of a connection says in a line."""
    return "it is silent" if isinstance(error, socket.timeout) else printable(reason(error))
