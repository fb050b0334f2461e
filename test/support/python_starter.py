#!/usr/bin/env python3
"""Runs Python programs in forks of itself, so that their common imports are made only once.

    python_starter.py SOCKET

Each connection to the Unix socket SOCKET requests one program by a line of JSON: its "path",
"arguments" and "env", and the "log" file for its output. The answer is a line with the process id,
and one with the exit code (as in subprocess) when the program has ended.
"""

import functools
import gc
import importlib
import json
import os
import pkgutil
import runpy
import selectors
import signal
import socket
import sys
from typing import Any, Dict

import roslaunch  # noqa: F401  for forks that run roslaunch
import rospy
from ports import free_port

import robot_vision
import robot_vision.ros  # must come before imports of dynamic_reconfigure


def import_all() -> None:
    """Imports everything that the nodes of this package import."""
    for module in pkgutil.walk_packages(robot_vision.__path__, "robot_vision."):
        importlib.import_module(module.name)


class Starter:
    """Waits for requests and for processes to end."""

    def __init__(self, path: str):
        self._running: Dict[int, socket.socket] = {}  # process id -> connection
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(path)
        self._listener.listen(64)
        self._ends, self._writer = os.pipe()
        os.set_blocking(self._writer, False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(self._writer)

    def next_program(self) -> Dict[str, Any]:
        """Returns only in the forked processes: the program to run."""
        selector = selectors.DefaultSelector()
        selector.register(self._listener, selectors.EVENT_READ)
        selector.register(self._ends, selectors.EVENT_READ)
        while True:
            for key, _ in selector.select():
                if key.fileobj is not self._listener:
                    self._tell_of_ends()
                    continue
                connection, _ = self._listener.accept()
                program = json.loads(connection.makefile().readline())
                process = os.fork()
                if process == 0:
                    connection.close()
                    selector.close()
                    self._leave()
                    return program
                self._running[process] = connection
                connection.sendall(b"%d\n" % process)

    def _tell_of_ends(self) -> None:
        os.read(self._ends, 1024)
        while self._running:
            process, status = os.waitpid(-1, os.WNOHANG)
            if process == 0:
                return
            code = -os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)
            with self._running.pop(process) as connection:
                connection.sendall(b"%d\n" % code)

    def _leave(self) -> None:
        """Closes the files of the starter in a forked process."""
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        os.close(self._ends)
        os.close(self._writer)
        for connection in (self._listener, *self._running.values()):
            connection.close()


def become(program: Dict[str, Any]) -> None:
    """Makes this process look as if the program had been started on its own."""
    os.setsid()
    log = os.open(program["log"], os.O_WRONLY)
    for stream in (sys.stdout.fileno(), sys.stderr.fileno()):
        os.dup2(log, stream)
    os.close(log)
    os.environ.clear()
    os.environ.update(program["env"])
    os.chdir(program["cwd"])
    sys.argv[:] = [program["path"], *program["arguments"]]  # in place, as roslaunch refers to it
    sys.path[0] = os.path.dirname(program["path"])
    if "PYTHONUNBUFFERED" in program["env"]:
        sys.stdout.reconfigure(line_buffering=True)
    rospy.names.reload_mappings(sys.argv)  # rospy read them when it was imported
    # Who still calls a killed node of another test must not get to this one: see free_port().
    at_ports = {"xmlrpc_port": free_port(), "tcpros_port": free_port()}
    rospy.init_node = functools.partial(rospy.init_node, **at_ports)


import_all()
gc.freeze()  # a fork would look through all of it, and copy it by that, each time and at its end
program = Starter(sys.argv[1]).next_program()
become(program)
runpy.run_path(program["path"], run_name="__main__")
