"""Where the address with its token goes if what the dashboard prints is kept for others to read."""

import contextlib
import os

import rospkg


def is_kept(descriptor: int) -> bool:
    """Returns whether what is written to a descriptor is kept where others may read it.

    That is systemd's journal, and the log file that roslaunch makes of nodes with output="log".
    """
    status = os.fstat(descriptor)
    if os.environ.get("JOURNAL_STREAM") == f"{status.st_dev}:{status.st_ino}":
        return True
    path = os.path.realpath(f"/proc/self/fd/{descriptor}")
    return path.startswith(os.path.join(os.path.realpath(rospkg.get_log_dir()), ""))


def write_address(node: str, text: str) -> str:
    """Writes a text into the node's file in ROS_HOME, which only this user may read.

    Args:
        node: The whole name of the node.

    Returns:
        The path of the file.

    Raises:
        OSError: It cannot be written.
    """
    name = node.strip("/").replace("/", "_") + "_address.txt"
    path = os.path.join(rospkg.get_ros_home(), name)
    with contextlib.suppress(FileNotFoundError):  # so that it is nobody else's file, nor a link
        os.unlink(path)
    with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        file.write(text)
    return path
