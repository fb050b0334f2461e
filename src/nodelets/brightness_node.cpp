#include "factories.hpp"
#include "ros/images/run_nodelet.hpp"

int main(int argc, char** argv)
{
  const char* about = R"(Changes gain, offset and gamma of a camera's images.

Subscribes to image while somebody subscribes to ~processed_image. Also publishes /diagnostics.
)";
  return robot_vision::runNodelet(argc, argv, "brightness", about, robot_vision::makeBrightness);
}
