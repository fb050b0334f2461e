"""What becomes a user who is not root, in tests that run as root."""

import os
import subprocess

import pytest
import support

import robot_vision

NOBODY = 65534  # the user's and the group's number
BECOME_NOBODY = ["setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups"]

needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="only root can become another user")


def skip_unless_all_may_look() -> None:
    """Skips the test where other users may not look into this checkout, as below /root."""
    for path in (support.executable("camera_node"), robot_vision.__file__):
        if subprocess.run([*BECOME_NOBODY, "test", "-r", path], check=False).returncode:
            pytest.skip(f"{path} is where only root may look")
