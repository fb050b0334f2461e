#!/usr/bin/env python3
"""A private master with the process id 7, as one that is restarted in a container has always."""

import private_master
from rosmaster.master_api import ROSMasterHandler

ROSMasterHandler.getPid = lambda _self, _caller: (1, "", 7)
private_master.main()
