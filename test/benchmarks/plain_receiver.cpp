// A subscriber that does nothing with its images, the least that receiving can cost. At its end it prints JSON:
// [stamp in s, latency in ms] of each. With ~nodelet_source (a file) the camera's nodelet shows it in this process.

#include <nodelet/loader.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

int main(int argc, char** argv)
{
  ros::init(argc, argv, "plain_receiver");
  ros::NodeHandle nh;
  nodelet::Loader loader(false);
  std::string source;
  if (ros::param::get("~nodelet_source", source))
  {
    ros::param::set("/camera/source", source);
    ros::param::set("/camera/framerate", 30.0);
    if (!loader.load("/camera", "robot_vision/camera", {}, {})) return 1;
  }
  std::vector<std::pair<double, double>> arrivals;
  const auto on_image = [&arrivals](const sensor_msgs::ImageConstPtr& message)
  { arrivals.emplace_back(message->header.stamp.toSec(), (ros::Time::now() - message->header.stamp).toSec() * 1e3); };
  const ros::Subscriber subscriber =
      nh.subscribe<sensor_msgs::Image>("image", 1, on_image, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  ros::spin();
  const char* comma = "[";
  for (const auto& [stamp, latency] : arrivals)
  {
    std::printf("%s[%.9f, %.4f]", comma, stamp, latency);
    comma = ", ";
  }
  std::printf("]\n");
  return 0;
}
