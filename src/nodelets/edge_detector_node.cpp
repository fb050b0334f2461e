#include "factories.hpp"
#include "ros/images/run_nodelet.hpp"

namespace
{

constexpr const char* kAbout = R"(Finds edges in a camera's images.

Subscribes to image while somebody subscribes to ~processed_image (mono8). Also publishes /diagnostics.
)";

}  // namespace

int main(int argc, char** argv)
{
  return robot_vision::runNodelet(argc, argv, "edge_detector", kAbout, robot_vision::makeEdgeDetector);
}
