#include <ros/ros.h>

#include <atomic>

#include "factories.hpp"
#include "ros/run_nodelet.hpp"

int main(int argc, char** argv)
{
  std::atomic<int> end_code{0};
  const auto make = [&end_code]
  {
    return robot_vision::makeCamera(
        [&end_code](int code)
        {
          end_code = code;
          ros::requestShutdown();
        });
  };
  const int exit_code = robot_vision::runNodelet(argc, argv, "camera", make);
  return exit_code != 0 ? exit_code : end_code.load();
}
