#include <robot_vision/StereoMatcherConfig.h>

#include <array>
#include <boost/make_shared.hpp>
#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <string>

#include "factories.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/stereo/depth_from_disparity.hpp"
#include "robot_vision/stereo/epipolar.hpp"
#include "robot_vision/stereo/rectifier.hpp"
#include "robot_vision/stereo/stereo_matcher.hpp"
#include "ros/images/image_nodelet.hpp"
#include "ros/params/fields.hpp"
#include "ros/stereo/stereo_input.hpp"
#include "ros/stereo/stereo_messages.hpp"
#include "ros/stereo/stereo_points.hpp"

namespace robot_vision
{
namespace
{

constexpr char kLeftColor[] = "left/image_rect_color";

/// What somebody subscribes to, asked once for each pair: subscribers come at any time.
struct Wanted
{
  explicit Wanted(const LazyOutputs& outputs)
    : disparity(outputs.isWanted("disparity")),
      disparity_image(outputs.isWanted("disparity_image")),
      depth(outputs.isWanted("depth")),
      points(outputs.isWanted("points")),
      camera_info(outputs.isWanted("camera_info")),
      left_color(outputs.isWanted(kLeftColor)),
      epipolar(outputs.isWanted("epipolar"))
  {
  }

  bool matches() const { return disparity || disparity_image || depth || points; }

  bool disparity, disparity_image, depth, points, camera_info, left_color, epipolar;
};

}  // namespace

/// Publishes disparities, depth and points of a pair of cameras, and views of the pair.
class StereoMatcherWork
{
public:
  StereoMatcherWork(const ros::NodeHandle& /*nh*/, const ros::NodeHandle& /*pnh*/) {}

  void configure(const StereoMatcherConfig& config)
  {
    const auto depth = filled<StereoDepthParams>(config);
    const auto epipolar = filled<EpipolarParams>(config);
    validate(depth);
    validate(epipolar);
    matcher_ = std::make_unique<StereoMatcher>(filled<StereoParams>(config));
    depth_params_ = depth;
    epipolar_params_ = epipolar;
  }

  static void advertise(LazyOutputs& outputs)
  {
    outputs.advertise<stereo_msgs::DisparityImage>("disparity");
    outputs.advertise<sensor_msgs::PointCloud2>("points");
    outputs.advertise<sensor_msgs::CameraInfo>("camera_info");
    for (const char* name : {"disparity_image", "depth", kLeftColor, "epipolar"})
      outputs.advertiseImages(name);
  }

  void process(const StereoFrame& frame, LazyOutputs& outputs)
  {
    const std_msgs::Header& header = frame.messages.images[kLeft]->header;
    const Wanted wanted(outputs);
    const bool rows = wanted.epipolar && epipolar_params_.epipolar == "rectified";
    if (wanted.epipolar && !rows) publishLines(frame, outputs);
    const bool colors = wanted.left_color || wanted.points || rows;
    if (!wanted.matches() && !colors && !wanted.camera_info) return;
    const StereoCamera camera = stereoCamera(frame);
    rectifier_.setCamera(camera);
    if (wanted.camera_info) outputs.publish("camera_info", rectifiedInfo(header, camera.left));
    if (colors) rectify(frame, kLeft, "bgr8", left_color_);
    if (wanted.left_color) publishColor(header, outputs);
    if (rows) publishRows(frame, outputs);
    if (!wanted.matches()) return;
    match(frame);
    publishDisparity(header, wanted, outputs);
    publishDepth(header, wanted, outputs);
  }

private:
  void rectify(const StereoFrame& frame, std::size_t side, const std::string& wanted, cv::Mat& out)
  {
    Rectifier& rectifier = side == kLeft ? rectifier_.left() : rectifier_.right();
    rectifier.apply(frame.images[side], frame.messages.images[side]->encoding, wanted, out);
  }

  void publishColor(const std_msgs::Header& header, LazyOutputs& outputs) const
  {
    outputs.publishImage(kLeftColor, header,
                         [&](cv::Mat& out)
                         {
                           left_color_.copyTo(out);
                           return "bgr8";
                         });
  }

  /// The images as they come, with the lines of what looks alike in both.
  void publishLines(const StereoFrame& frame, LazyOutputs& outputs) const
  {
    std::array<cv::Mat, 2> bgr;
    for (const std::size_t side : {kLeft, kRight})
      toBgr(frame.images[side], frame.messages.images[side]->encoding, bgr[side]);
    outputs.publishImage("epipolar", frame.messages.images[kLeft]->header,
                         [&](cv::Mat& out)
                         {
                           drawEpipolarLines(bgr[kLeft], bgr[kRight], epipolar_params_, out);
                           return "bgr8";
                         });
  }

  void publishRows(const StereoFrame& frame, LazyOutputs& outputs)
  {
    cv::Mat right_color;
    rectify(frame, kRight, "bgr8", right_color);
    outputs.publishImage("epipolar", frame.messages.images[kLeft]->header,
                         [&](cv::Mat& out)
                         {
                           drawRectifiedPair(left_color_, right_color, epipolar_params_, out);
                           return "bgr8";
                         });
  }

  void match(const StereoFrame& frame)
  {
    for (const std::size_t side : {kLeft, kRight})
      rectify(frame, side, "mono8", gray_[side]);
    matcher_->match(gray_[kLeft], gray_[kRight], "mono8", disparity_, rectifier_.left().seen(),
                    rectifier_.right().seen());
  }

  void publishDisparity(const std_msgs::Header& header, const Wanted& wanted, LazyOutputs& outputs) const
  {
    if (wanted.disparity)
      outputs.publish("disparity", toDisparityImage(header, disparity_, *matcher_, rectifier_.geometry()));
    if (!wanted.disparity_image) return;
    const StereoParams& params = matcher_->params();
    outputs.publishImage("disparity_image", header,
                         [&](cv::Mat& out)
                         {
                           disparityToColors(disparity_, params.min_disparity,
                                             params.min_disparity + params.disparities, out);
                           return "bgr8";
                         });
  }

  void publishDepth(const std_msgs::Header& header, const Wanted& wanted, LazyOutputs& outputs)
  {
    if (!wanted.depth && !wanted.points) return;
    depthFromDisparity(disparity_, rectifier_.geometry(), depth_);
    if (wanted.depth)
      outputs.publishImage("depth", header,
                           [&](cv::Mat& out)
                           {
                             encodeDepth(depth_, depth_params_.depth_encoding, out);
                             return depth_params_.depth_encoding;
                           });
    if (!wanted.points) return;
    outputs.publish("points", points_.cloud(header, rectifier_.left().camera(), depth_, left_color_));
  }

  std::unique_ptr<StereoMatcher> matcher_;
  StereoDepthParams depth_params_;
  EpipolarParams epipolar_params_;
  StereoRectifier rectifier_;
  // Of the last pair; they keep their memory.
  std::array<cv::Mat, 2> gray_;
  cv::Mat left_color_, disparity_, depth_;
  StereoPoints points_;
};

using StereoMatcherNodelet = ImageNodelet<StereoMatcherConfig, StereoMatcherWork, StereoInput>;

boost::shared_ptr<nodelet::Nodelet> makeStereoMatcher()
{
  return boost::make_shared<StereoMatcherNodelet>();
}

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::StereoMatcherNodelet, nodelet::Nodelet)
