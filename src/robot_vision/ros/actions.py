"""Servers of actions, which end with their node."""

import contextlib
from typing import Any, Callable

from actionlib import SimpleActionServer

from .context import current

__all__ = ["SimpleActionServer", "action_server"]
END_TIMEOUT = 1.0  # s that a goal has to end when its node does


def action_server(
    name: str, kind: Any, execute: Callable[[SimpleActionServer, Any], Any]
) -> SimpleActionServer:
    """Returns a server of an action that is started.

    Args:
        name: The action's.
        kind: Its type, the message that ends in Action.
        execute: A function that is called with the server and each goal, in a thread of its own.
            It has to return when its node ends.
    """
    context = current()
    bound = context.bind(lambda goal: execute(server, goal))
    server: SimpleActionServer = SimpleActionServer(context.given(name), kind, bound, False)
    context.closes(lambda: _close(server))
    server.start()
    return server


def _close(server: SimpleActionServer) -> None:
    server.need_to_terminate = True
    server.execute_thread.join(END_TIMEOUT)
    with contextlib.suppress(AttributeError):  # Of what start() did not come to make.
        server.action_server.stop()
