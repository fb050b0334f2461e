"""Where the database is if nothing else is said."""

import os

NAME = "robot_vision_objects.db"


def default_path() -> str:
    """Returns the path of the database in the folder that ROS_HOME names, or in ~/.ros."""
    home = os.environ.get("ROS_HOME") or os.path.join("~", ".ros")
    return os.path.join(os.path.abspath(os.path.expanduser(home)), NAME)
