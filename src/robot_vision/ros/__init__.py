"""What the package's Python nodes share; the only part of robot_vision that needs rospy."""

import roslib.launcher

# dynamic_reconfigure has its own manifest read when it is imported, for a path that catkin has made
# needless. rospkg would then import rosdep, a quarter of what a node imports, and complain where
# `rosdep init` has never been run. So it is told that this has been done.
roslib.launcher._bootstrapped.append("dynamic_reconfigure")
