"""What the Python nodes share. Only this room and the nodes themselves need rospy."""

import roslib.launcher

# dynamic_reconfigure loads its manifest when it is imported, to add a path that catkin has made
# superfluous. For that rospkg would import rosdep, which is a quarter of all that a node imports,
# and complain where `rosdep init` was never run. This line says that it was loaded already.
roslib.launcher._bootstrapped.append("dynamic_reconfigure")
