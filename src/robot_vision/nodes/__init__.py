"""What the package's Python nodes share; the only part of robot_vision that needs rospy."""
