"""How a node starts."""

import http.client
import signal
import sys
import time
import xmlrpc.client

import rosgraph
import rospy


def init_node(name: str) -> None:
    """Makes this process the node `name`, as rospy.init_node does, once the master is there.

    rospy would wait for the master deaf to Ctrl-C. Here SIGINT ends the process with exit code 0
    while it waits.
    """
    before = signal.signal(signal.SIGINT, lambda *_: sys.exit(0))
    master = rosgraph.Master("/" + name)
    waiting = False
    while True:
        try:
            master.getPid()
            break
        except (OSError, rosgraph.MasterException, http.client.HTTPException, xmlrpc.client.Error):
            if not waiting:
                print(f"waiting for the master at {master.master_uri}", file=sys.stderr, flush=True)
            waiting = True
            time.sleep(0.1)
    signal.signal(signal.SIGINT, before)
    rospy.init_node(name)
