#include "factories.hpp"
#include "ros/images/run_nodelet.hpp"

int main(int argc, char** argv)
{
  const char* about =
      R"(Makes of the images of a depth camera those that a depth camera in the place of a color camera would make.

Subscribes to depth/image_raw (16UC1 or 32FC1), depth/camera_info and rgb/camera_info, and for colored points to
rgb/image_raw, while somebody subscribes to depth_registered/image_raw, depth_registered/camera_info or
depth_registered/points (sensor_msgs/PointCloud2). Needs the transform between both cameras' frames on /tf_static or
/tf. Also publishes /diagnostics.
)";
  return robot_vision::runNodelet(argc, argv, "depth_registration", about, robot_vision::makeDepthRegistration);
}
