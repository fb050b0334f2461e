"""The Foxglove WebSocket protocol, version 1, as far as a server that can only be read needs it.

https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md: texts are JSON objects with an "op",
messages of topics are binary.
"""

import json
import struct
from typing import Any, Dict, Iterable, List, NamedTuple, Tuple

from ..common.plain_text import brief, printable

SUBPROTOCOL = "foxglove.websocket.v1"
INFO, WARNING, ERROR = 0, 1, 2  # levels of a status
MAX_SUBSCRIPTIONS = 200  # of a client, and in one message
MAX_ID = 0xFFFFFFFF
_MESSAGE_DATA = struct.Struct("<BIQ")  # opcode, subscription, log time in ns


class TopicChannel(NamedTuple):
    """A topic that can be subscribed to.

    Attributes:
        id: A number that no other topic or type has had.
        topic: Its name.
        type: Its type, such as std_msgs/String.
        schema: The definition of the type and all that it is made of.
    """

    id: int
    topic: str
    type: str
    schema: str


def server_info(name: str, session: str) -> str:
    """Returns what a client is told first: there are no capabilities, messages are only read."""
    return _text("serverInfo", name=name, capabilities=[], metadata={}, sessionId=session)


def advertise(channels: Iterable[TopicChannel]) -> str:
    """Returns the message that tells of new channels."""
    return _text(
        "advertise",
        channels=[
            {
                "id": channel.id,
                "topic": channel.topic,
                "encoding": "ros1",
                "schemaName": channel.type,
                "schema": channel.schema,
                "schemaEncoding": "ros1msg",
            }
            for channel in channels
        ],
    )


def unadvertise(ids: Iterable[int]) -> str:
    """Returns the message that tells of channels that are gone."""
    return _text("unadvertise", channelIds=sorted(ids))


def status(level: int, message: str) -> str:
    """Returns a message for the person at the client."""
    return _text("status", level=level, message=message)


def message_data(subscription: int, time: int) -> bytes:
    """Returns what comes before the bytes of a message.

    Args:
        subscription: The client's number of the subscription.
        time: When the message had come, in ns.
    """
    return _MESSAGE_DATA.pack(1, subscription, max(time, 0))


class Subscribe(NamedTuple):
    """What a client wants: numbers of subscriptions and channels."""

    pairs: Tuple[Tuple[int, int], ...]


class Unsubscribe(NamedTuple):
    """The numbers of subscriptions that a client wants no more."""

    ids: Tuple[int, ...]


def parse_client_text(text: str) -> Any:
    """Returns Subscribe or Unsubscribe of a client's message.

    Raises:
        ValueError: It is damaged, or asks for what this server cannot do.
    """
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        raise ValueError("a message is no JSON") from None
    if not isinstance(message, dict):
        raise ValueError("a message is no JSON object")
    op = message.get("op")
    if op == "subscribe":
        pairs = _objects(message, "subscriptions")
        return Subscribe(tuple((_id(pair, "id"), _id(pair, "channelId")) for pair in pairs))
    if op == "unsubscribe":
        ids = _list(message, "subscriptionIds")
        return Unsubscribe(tuple(_id({"subscriptionIds": one}, "subscriptionIds") for one in ids))
    raise ValueError(f"op is {_shown(op)}, this server knows only subscribe and unsubscribe")


def _objects(message: Dict[str, Any], name: str) -> List[Dict[str, Any]]:
    found = _list(message, name)
    if not all(isinstance(one, dict) for one in found):
        raise ValueError(f"{name} has something that is no JSON object")
    return found


def _list(message: Dict[str, Any], name: str) -> List[Any]:
    found = message.get(name)
    if not isinstance(found, list) or len(found) > MAX_SUBSCRIPTIONS:
        raise ValueError(f"{name} must be a list of at most {MAX_SUBSCRIPTIONS}")
    return found


def _id(of: Dict[str, Any], name: str) -> int:
    value = of.get(name)
    if type(value) is not int or not 0 <= value <= MAX_ID:
        raise ValueError(f"{name} is {_shown(value)}, must be an integer from 0 to {MAX_ID}")
    return value


def _shown(value: Any) -> str:
    return printable(value, 60) if isinstance(value, str) else brief(value)


def _text(op: str, **fields: Any) -> str:
    return json.dumps({"op": op, **fields}, separators=(",", ":"))
