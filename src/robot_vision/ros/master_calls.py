"""Several questions to the master in one request: a list of calls, as roslaunch sends it."""

import xmlrpc.client
from typing import Any, List, Sequence, Tuple

import rosgraph


def ask_master(calls: Sequence[Tuple[Any, ...]]) -> List[Any]:
    """Returns the answers to calls of the ROS Master and Parameter Server API.

    A master that takes no lists is asked for each.

    Args:
        calls: A method's name and its arguments, of which the first one is the name of the node.

    Raises:
        One of UNREACHABLE_ERRORS of registration.py: There is no master, or none that answers.
    """
    master = xmlrpc.client.ServerProxy(rosgraph.get_master_uri())
    together = xmlrpc.client.MultiCall(master)
    for method, *arguments in calls:
        getattr(together, method)(*arguments)
    try:
        return list(together())
    except (xmlrpc.client.Fault, ValueError):  # The latter is for answers of another form.
        return [getattr(master, method)(*arguments) for method, *arguments in calls]
