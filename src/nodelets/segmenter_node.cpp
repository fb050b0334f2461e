#include "factories.hpp"
#include "ros/images/run_nodelet.hpp"

int main(int argc, char** argv)
{
  const char* about = R"(Divides a camera's images into segments.

Subscribes to image while somebody subscribes to ~labels (mono16), ~mask (mono8), ~segments
(robot_vision/DetectionArray) or ~processed_image (bgr8). Takes seeds from ~select (sensor_msgs/RegionOfInterest) and
~click (robot_vision/Click), until ~clear_seeds (std_srvs/Trigger). Also publishes /diagnostics.
)";
  return robot_vision::runNodelet(argc, argv, "segmenter", about, robot_vision::makeSegmenter);
}
