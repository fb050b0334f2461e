#include "factories.hpp"
#include "ros/images/run_nodelet.hpp"

namespace
{

constexpr const char* kAbout = R"(Changes gain, offset and gamma of a camera's pictures.

Subscribes to image, while somebody subscribes to ~processed_image. Publishes /diagnostics, too.
)";

}  // namespace

int main(int argc, char** argv)
{
  return robot_vision::runNodelet(argc, argv, "brightness", kAbout, robot_vision::makeBrightness);
}
