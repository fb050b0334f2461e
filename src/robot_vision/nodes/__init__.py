"""What the package's Python nodes share; the only part of robot_vision that needs rospy."""

import rospkg.manifest

# dynamic_reconfigure has its own manifest read when it is imported. rospkg would then look for the
# keys of rosdep, which no node needs, and complain where `rosdep init` has never been run.
rospkg.manifest._static_rosdep_view = False
