"""Servers of actions, which end with their node."""

import contextlib
from typing import Any, Callable

import rospy
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
            It has to return when its node ends, and need not say then what became of the goal.
    """
    context = current()

    def run(goal: Any) -> None:
        try:
            execute(server, goal)
        except rospy.ROSException:
            if not context.is_ending():
                raise
        if context.is_ending() and server.is_active():
            with contextlib.suppress(rospy.ROSException):  # The topics may be closed already.
                server.set_aborted(text=f"{context.name} ends")

    bound = context.bind(run)
    server: SimpleActionServer = SimpleActionServer(context.given(name), kind, bound, False)
    context.closes(lambda: _close(server))
    server.start()
    return server


def _close(server: SimpleActionServer) -> None:
    server.need_to_terminate = True
    server.execute_thread.join(END_TIMEOUT)
    actions = server.action_server
    with actions.lock:
        actions.started = False
        # Each is None if start() did not come to make it, and the timer at a status_frequency of 0.
        if actions.status_timer:
            actions.status_timer.shutdown()
        ends = actions.goal_sub, actions.cancel_sub
        ends += actions.status_pub, actions.feedback_pub, actions.result_pub
        for topic in filter(None, ends):
            topic.unregister()
        # The timer's thread notices its end at the next period, or never while simulated time
        # stands still. It keeps the server so long, which must not keep the node.
        actions.register_goal_callback(None)
        actions.register_cancel_callback(None)
