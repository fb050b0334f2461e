"""Runs a program of this folder's VM from outside."""

import os
import pathlib
import shlex
import subprocess
import sys
from typing import Any, Dict

HERE = pathlib.Path(__file__).resolve().parent
UNAVAILABLE = 77  # exit code of vivid-vm when there can be no VM here


def run_guest(
    program: pathlib.Path, out: pathlib.Path, vivid: str, seconds: float
) -> "subprocess.CompletedProcess[str]":
    """Runs a Python program, with `/out` as its argument, beside a ROS master in the VM.

    Args:
        out: the folder that is /out there.
        vivid: options of the kernel's module.
        seconds: after which the VM is ended.
    """
    kept = ("PATH", "PYTHONPATH", "LD_LIBRARY_PATH", "CMAKE_PREFIX_PATH")
    env: Dict[str, Any] = {k: v for k, v in os.environ.items() if k in kept or k.startswith("ROS")}
    folders = [str(HERE), str(HERE.parent / "support"), os.environ.get("PYTHONPATH", "")]
    env.update(
        ROS_MASTER_URI="http://127.0.0.1:11311",  # the guest has a network of its own
        ROS_HOSTNAME="127.0.0.1",
        ROS_HOME="/tmp/ros",
        ROSCONSOLE_FORMAT="[${severity}] ${message}",
        PYTHONPATH=":".join(folders),
    )
    env.pop("ROS_LOG_DIR", None)
    command = "export {}\nrosmaster --core >master.log 2>&1 &\n{} {} /out".format(
        " ".join(f"{k}={shlex.quote(v)}" for k, v in env.items()),
        shlex.quote(sys.executable),
        shlex.quote(str(program)),
    )
    return subprocess.run(
        [str(HERE / "vivid-vm"), "run", str(out), command],
        env=dict(os.environ, VM_TIMEOUT=str(seconds), VIVID=vivid),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
