#include "factories.hpp"
#include "ros/images/run_nodelet.hpp"

int main(int argc, char** argv)
{
  const char* about = R"(Finds edges in a camera's images.

Subscribes to image while somebody subscribes to ~processed_image (mono8). Also publishes /diagnostics.
)";
  return robot_vision::runNodelet(argc, argv, "edge_detector", about, robot_vision::makeEdgeDetector);
}
