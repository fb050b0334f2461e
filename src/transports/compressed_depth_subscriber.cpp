#include <image_transport/simple_subscriber_plugin.h>
#include <sensor_msgs/CompressedImage.h>

#include <pluginlib/class_list_macros.hpp>

#include "robot_vision/compressed_depth.hpp"
#include "ros/image_message.hpp"
#include "ros/throttle.hpp"

namespace robot_vision
{

/// The other end of "compressedDepth".
class CompressedDepthSubscriber : public image_transport::SimpleSubscriberPlugin<sensor_msgs::CompressedImage>
{
public:
  std::string getTransportName() const override { return "compressedDepth"; }

protected:
  void internalCallback(const sensor_msgs::CompressedImageConstPtr& message, const Callback& user_cb) override
  {
    sensor_msgs::ImagePtr image;
    try
    {
      const auto fill = [&](cv::Mat& pixels)
      { return decompressDepth(message->format, message->data.data(), message->data.size(), pixels); };
      image = pictures_.make(fill);
      image->header = message->header;
    }
    catch (const std::exception& e)
    {
      if (refused_.due()) ROS_ERROR("refused a frame on %s: %s", getTopic().c_str(), e.what());
      return;
    }
    user_cb(image);
  }

private:
  ImageMaker pictures_;
  Throttle refused_;
};

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::CompressedDepthSubscriber, image_transport::SubscriberPlugin)
