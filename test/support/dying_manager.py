#!/usr/bin/env python3
"""A nodelet manager that prints what it is to load, and dies when that is the nodelet /bad.

It dies of nothing as long as the parameter /withstands is true.
It never answers that /endless is loaded, like a manager whose camera does not respond.
"""

import os
import threading

import bondpy.bondpy
import rospy
from nodelet.srv import NodeletList, NodeletLoad, NodeletLoadResponse

rospy.init_node("manager")
bonds = []


def load(request):
    if request.name == "/bad" and not rospy.get_param("/withstands", False):
        os._exit(1)
    print("loaded", request.name, request.type, flush=True)
    if request.name == "/endless":
        threading.Event().wait()
    bonds.append(bondpy.bondpy.Bond(rospy.get_name() + "/bond", request.bond_id))
    bonds[-1].start()
    return NodeletLoadResponse(True)


services = [
    rospy.Service("~load_nodelet", NodeletLoad, load),
    rospy.Service("~list", NodeletList, lambda _: [[]]),
]
rospy.spin()
