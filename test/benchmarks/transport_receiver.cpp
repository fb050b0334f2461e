// A subscriber of image_transport that does nothing with its images. At its end it prints JSON: [stamp in s, latency in
// ms] of each.

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <cstdio>
#include <utility>
#include <vector>

int main(int argc, char** argv)
{
  ros::init(argc, argv, "transport_receiver");
  ros::NodeHandle nh;
  std::vector<std::pair<double, double>> arrivals;
  const auto on_image = [&arrivals](const sensor_msgs::ImageConstPtr& message)
  { arrivals.emplace_back(message->header.stamp.toSec(), (ros::Time::now() - message->header.stamp).toSec() * 1e3); };
  {
    image_transport::ImageTransport it(nh);
    const image_transport::TransportHints hints("raw", ros::TransportHints().tcpNoDelay());
    const image_transport::Subscriber subscriber =
        it.subscribe(nh.resolveName("image"), 1, on_image, ros::VoidPtr(), hints);
    ros::spin();
  }
  std::printf("[");
  const char* comma = "";
  for (const auto& [stamp, latency] : arrivals)
  {
    std::printf("%s[%.9f, %.4f]", comma, stamp, latency);
    comma = ", ";
  }
  std::printf("]\n");
  return 0;
}
