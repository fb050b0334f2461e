#include "factories.hpp"
#include "ros/images/run_nodelet.hpp"

int main(int argc, char** argv)
{
  const char* about =
      R"(Does operations on a camera's images, one after the other: ~chain names them ("gaussian, canny").

Subscribes to image while somebody subscribes to ~processed_image or to ~steps/NAME, the result of an operation, and to
second if the chain needs another image and ~use_second is set. Also publishes /diagnostics.
)";
  return robot_vision::runNodelet(argc, argv, "filter", about, robot_vision::makeFilter);
}
