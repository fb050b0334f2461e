"""Calls of services that end in time: rospy's own wait without end for an answer."""

import contextlib
import io
import socket
import struct
import time
import urllib.parse
from typing import Any

import genpy
import rosgraph.network
import rospy

from ..common.plain_text import printable
from ..ros.graph_master import MAX_REASON, MasterCalls, graph_name, parsed, reason_of

TIMEOUT = 5.0  # s
MAX_REPLY = 16 << 20  # bytes of an answer
MAX_HEADER = 1 << 20  # bytes of the header before it


def call_node(node: str, service: str, kind: Any, *fields: Any, timeout: float = 0.0) -> Any:
    """Calls a node's own service, `<node>/<service>`.

    Args:
        node: The name of the node.
        service: The name of the service without the node's.
        kind: The class of the service.
        fields: The fields of the request.
        timeout: How long it may take, in s; 0 for TIMEOUT.

    Raises:
        ValueError: `node` is no name, or the fields are not what the service takes.
        OSError: There is no such service, it has not answered in time, or answered an error.
    """
    return call_service(f"{graph_name(node)}/{service}", kind, *fields, timeout=timeout)


def call_service(name: str, kind: Any, *fields: Any, timeout: float = 0.0) -> Any:
    """Calls a service by its whole name: see call_node()."""
    with contextlib.closing(MasterCalls()) as master:
        code, _, uri = parsed(master.raw("lookupService", name))
    where = urllib.parse.urlparse(str(uri))
    if code != 1 or where.hostname is None or where.port is None:
        node, _, service = name.rpartition("/")
        if not node:
            raise OSError(f"there is no service {name}")
        raise OSError(f"{node} has no service {service}: it has ended, or does not do this")
    call = _Call(name, kind, timeout or TIMEOUT)
    try:
        return call.run(where.hostname, where.port, kind._request_class(*fields))
    except socket.timeout:
        raise OSError(f"{name} has not answered within {call.timeout:g} s") from None
    except (EOFError, ConnectionResetError, BrokenPipeError):
        raise OSError(f"{name} cannot be called: it has ended the connection") from None
    except OSError as error:
        if error.errno is None:  # said here
            raise
        raise OSError(f"{name} cannot be called: {reason_of(error)}") from None
    except (genpy.SerializationError, struct.error) as error:
        raise ValueError(f"{name}: {printable(str(error), MAX_REASON)}") from None
    except (
        genpy.DeserializationError,
        rosgraph.network.ROSHandshakeException,
        UnicodeDecodeError,
    ) as error:
        says = printable(str(error), MAX_REASON)
        raise OSError(f"what {name} answers cannot be read: {says}") from None


class _Call:
    """One call of a service over TCPROS, as wiki.ros.org/ROS/TCPROS describes it."""

    def __init__(self, name: str, kind: Any, timeout: float):
        self.timeout = timeout
        self._name = name
        self._kind = kind
        self._deadline = time.monotonic() + timeout

    def run(self, host: str, port: int, request: Any) -> Any:
        with socket.create_connection((host, port), self._left()) as self._socket:
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._send(
                rosgraph.network.encode_ros_handshake_header(
                    {
                        "callerid": rospy.get_name(),
                        "service": self._name,
                        "md5sum": self._kind._md5sum,
                        "type": self._kind._type,
                    }
                )
            )
            length, header = self._block(MAX_HEADER)
            answer = rosgraph.network.decode_ros_handshake_header(length + header)
            if "error" in answer:
                raise OSError(f"{self._name}: {printable(answer['error'], MAX_REASON)}")
            body = _serialized(request)
            self._send(struct.pack("<I", len(body)) + body)
            success = self._receive(1) != b"\0"
            _, data = self._block(MAX_REPLY)
        if not success:
            says = printable(data.decode(errors="replace"), MAX_REASON)
            raise OSError(f"{self._name}: {says or 'it failed and says no reason'}")
        return self._kind._response_class().deserialize(data)

    def _left(self) -> float:
        left = self._deadline - time.monotonic()
        if left <= 0.0:
            raise socket.timeout
        return left

    def _send(self, data: bytes) -> None:
        self._socket.settimeout(self._left())
        self._socket.sendall(data)

    def _block(self, limit: int) -> Any:
        """Returns the four bytes of a length, and as many bytes as it says."""
        prefix = self._receive(4)
        (length,) = struct.unpack("<I", prefix)
        if length > limit:
            raise OSError(f"{self._name} answers {length} bytes, must be up to {limit}")
        return prefix, self._receive(length)

    def _receive(self, count: int) -> bytes:
        data = bytearray()
        while len(data) < count:
            self._socket.settimeout(self._left())
            part = self._socket.recv(min(count - len(data), 1 << 16))
            if not part:
                raise EOFError
            data += part
        return bytes(data)


def _serialized(request: Any) -> bytes:
    buffer = io.BytesIO()
    request.serialize(buffer)
    return buffer.getvalue()
