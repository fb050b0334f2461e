#include "factories.hpp"
#include "ros/images/run_nodelet.hpp"

namespace
{

constexpr const char* kAbout = R"(Changes gain, offset and gamma of a camera's images.

Subscribes to image while somebody subscribes to ~processed_image. Also publishes /diagnostics.
)";

}  // namespace

int main(int argc, char** argv)
{
  return robot_vision::runNodelet(argc, argv, "brightness", kAbout, robot_vision::makeBrightness);
}
