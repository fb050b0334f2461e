#include <robot_vision/Click.h>
#include <robot_vision/DetectionArray.h>
#include <robot_vision/SegmenterConfig.h>
#include <sensor_msgs/RegionOfInterest.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cstdint>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <string>

#include "factories.hpp"
#include "robot_vision/common/throttle.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/image/overlay.hpp"
#include "robot_vision/segmentation/segmenter.hpp"
#include "ros/images/detections.hpp"
#include "ros/images/image_nodelet.hpp"
#include "ros/params/fields.hpp"

namespace robot_vision
{
namespace
{

constexpr std::uint32_t kQueueSize = 10;           // seeds that wait
constexpr std::uint32_t kMaxCoordinate = 1 << 24;  // px; sums of such numbers still fit an int

int coordinate(std::uint32_t value)
{
  return static_cast<int>(std::min(value, kMaxCoordinate));
}

}  // namespace

/// Divides `image` into segments, from the seeds on ~select and ~click.
class SegmenterWork
{
public:
  SegmenterWork(const ros::NodeHandle& /*nh*/, ros::NodeHandle pnh)
    : name_(pnh.getNamespace()),
      select_(pnh.subscribe("select", kQueueSize, &SegmenterWork::onSelect, this)),
      click_(pnh.subscribe("click", kQueueSize, &SegmenterWork::onClick, this)),
      clear_(pnh.advertiseService("clear_seeds", &SegmenterWork::onClear, this))
  {
  }

  void configure(const SegmenterConfig& config)
  {
    const auto paint = filled<SegmentPaintParams>(config);
    validate(paint);
    segmenter_.configure(filled<SegmenterParams>(config));
    paint_ = paint;
  }

  void advertise(LazyOutputs& outputs)
  {
    for (const char* name : {"labels", "mask", "processed_image"})
      outputs.advertiseImages(name);
    outputs.advertise<DetectionArray>("segments");
  }

  void process(const sensor_msgs::ImageConstPtr& message, const cv::Mat& image, LazyOutputs& outputs)
  {
    const Segmentation found = segmenter_.apply(image, message->encoding);
    if (!found.hint.empty() && throttle_.due()) ROS_WARN("%s: %s", name_.c_str(), found.hint.c_str());
    const auto publish = [&](const char* name, const ImageMaker::Fill& fill)
    {
      if (outputs.isWanted(name)) outputs.publishImage(name, message->header, fill);
    };
    publish("labels",
            [&](cv::Mat& out)
            {
              found.labels.copyTo(out);
              return "mono16";
            });
    publish("mask",
            [&](cv::Mat& out)
            {
              cv::compare(found.labels, 0, out, cv::CMP_GT);
              return "mono8";
            });
    if (outputs.isWanted("segments")) outputs.publish("segments", segmentsOf(*message, found.labels));
    publish("processed_image",
            [&](cv::Mat& out)
            {
              draw(image, message->encoding, found, out);
              return "bgr8";
            });
  }

private:
  static boost::shared_ptr<DetectionArray> segmentsOf(const sensor_msgs::Image& image, const cv::Mat& labels)
  {
    const auto message = boost::make_shared<DetectionArray>();
    message->header = image.header;
    message->width = image.width;
    message->height = image.height;
    for (const Segment& segment : findSegments(labels))
      message->detections.push_back(toDetection(segment.region, "segment", segment.label));
    return message;
  }

  void draw(const cv::Mat& image, const std::string& encoding, const Segmentation& found, cv::Mat& out) const
  {
    cv::Mat bgr;
    toBgr(image, encoding, bgr);
    paintSegments(bgr, found.labels, paint_, out);
    drawSeeds(out, segmenter_.seeds());
    if (!found.hint.empty()) drawText(out, found.hint, {10, 20});
  }

  void onSelect(const sensor_msgs::RegionOfInterest& region)
  {
    add(
        [&]
        {
          segmenter_.addRegion({coordinate(region.x_offset), coordinate(region.y_offset), coordinate(region.width),
                                coordinate(region.height)});
        });
  }

  void onClick(const Click& click)
  {
    add([&] { segmenter_.addPoint({coordinate(click.x), coordinate(click.y)}); });
  }

  template <class Add>
  void add(const Add& add_seed)
  {
    try
    {
      add_seed();
    }
    catch (const std::invalid_argument& e)
    {
      ROS_WARN("%s: no seed is added: %s; ~clear_seeds forgets all", name_.c_str(), e.what());
    }
  }

  bool onClear(std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response)
  {
    response.success = true;
    response.message = "seeds forgotten: " + std::to_string(segmenter_.seeds().size());
    segmenter_.clearSeeds();
    return true;
  }

  std::string name_;
  Segmenter segmenter_;
  SegmentPaintParams paint_;
  Throttle throttle_;
  ros::Subscriber select_;
  ros::Subscriber click_;
  ros::ServiceServer clear_;
};

using SegmenterNodelet = ImageNodelet<SegmenterConfig, SegmenterWork>;

boost::shared_ptr<nodelet::Nodelet> makeSegmenter()
{
  return boost::make_shared<SegmenterNodelet>();
}

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::SegmenterNodelet, nodelet::Nodelet)
