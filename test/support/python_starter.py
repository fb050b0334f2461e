#!/usr/bin/env python3
"""Runs Python programs in forks of itself: what they all import is imported once, not by each.

    python_starter.py SOCKET

Each connection to SOCKET, a Unix one, asks for one program, as a line of JSON: its "path",
"arguments", "env", and the "log" that takes its output. It is answered by a line with the number of
the process, and by one with its exit code (as subprocess has it) when it has ended.
"""

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

import roslaunch  # noqa: F401  for forks that run it
import rospy

import robot_vision
import robot_vision.ros  # before what imports dynamic_reconfigure


def import_all() -> None:
    """What the nodes of this package import."""
    for module in pkgutil.walk_packages(robot_vision.__path__, "robot_vision."):
        importlib.import_module(module.name)


class Starter:
    """Waits for requests and for ends of processes."""

    def __init__(self, path: str):
        self._running: Dict[int, socket.socket] = {}  # the connections, by process
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(path)
        self._listener.listen(64)
        self._ends, self._writer = os.pipe()
        os.set_blocking(self._writer, False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(self._writer)

    def next_program(self) -> Dict[str, Any]:
        """Returns in the process of each program; in this one, never."""
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
        """Closes all that is not the program's."""
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        os.close(self._ends)
        os.close(self._writer)
        for connection in (self._listener, *self._running.values()):
            connection.close()


def become(program: Dict[str, Any]) -> None:
    """Makes this process what it would be if the program had been started by itself."""
    os.setsid()
    log = os.open(program["log"], os.O_WRONLY)
    for stream in (sys.stdout.fileno(), sys.stderr.fileno()):
        os.dup2(log, stream)
    os.close(log)
    os.environ.clear()
    os.environ.update(program["env"])
    os.chdir(program["cwd"])
    sys.argv[:] = [program["path"], *program["arguments"]]  # in place: roslaunch holds on to it
    sys.path[0] = os.path.dirname(program["path"])
    if "PYTHONUNBUFFERED" in program["env"]:
        sys.stdout.reconfigure(line_buffering=True)
    rospy.names.reload_mappings(sys.argv)  # it has read them when it was imported


import_all()
program = Starter(sys.argv[1]).next_program()
become(program)
runpy.run_path(program["path"], run_name="__main__")
