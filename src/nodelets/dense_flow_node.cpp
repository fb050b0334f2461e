#include "factories.hpp"
#include "ros/images/run_nodelet.hpp"

int main(int argc, char** argv)
{
  const char* about = R"(Finds how far each pixel of a camera's images has moved since the last frame.

Subscribes to image while somebody subscribes to ~flow (32FC2: px to the right and down), ~mean or ~median
(px/s) or ~processed_image (bgr8: directions as colors, or arrows). Also publishes /diagnostics.
)";
  return robot_vision::runNodelet(argc, argv, "dense_flow", about, robot_vision::makeDenseFlow);
}
