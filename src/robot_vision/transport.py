"""Images in a rospy node at the speed of C++: the newest frame, over any transport, without a copy.

    import rospy
    from robot_vision.transport import ImageSubscriber

    rospy.init_node("viewer")
    ImageSubscriber("image", lambda frame: print(frame.image.shape), encoding="bgr8")
    rospy.spin()

roscpp and image_transport run inside the process as a second node, <node>_images. One thread calls
all callbacks, one after the other. Of the images that arrive during a callback all but the newest
are dropped. rospy resolves names: relative and private names, remappings and namespaces work as
usual.
"""

from .ros.transport import *  # noqa: F403
from .ros.transport import __all__ as __all__
