"""Who listens to the topics of this process."""

import rospy

IMAGES = "_images"  # the end of the name that the images of a Python process have in the graph


def listeners_elsewhere(output: rospy.Publisher) -> int:
    """Returns how many connections of other processes a topic has.

    A process connects to itself where one of its nodes listens to a topic on which another one, or
    the same, publishes.
    """
    process = rospy.names.get_name()
    own = {process, process + IMAGES}
    return sum(connection.endpoint_id not in own for connection in output.impl.connections)
