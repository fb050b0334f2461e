#include "factories.hpp"
#include "ros/images/run_nodelet.hpp"

int main(int argc, char** argv)
{
  const char* about = R"(Finds disparities, depth and points in the images of a calibrated pair of cameras.

Subscribes to left/image_raw, left/camera_info, right/image_raw and right/camera_info while somebody subscribes to
~disparity (stereo_msgs/DisparityImage), ~disparity_image (bgr8), ~depth (32FC1 or 16UC1), ~camera_info (of the
rectified left images), ~points (sensor_msgs/PointCloud2), ~left/image_rect_color or ~epipolar (bgr8). Also publishes
/diagnostics.
)";
  return robot_vision::runNodelet(argc, argv, "stereo_matcher", about, robot_vision::makeStereoMatcher);
}
