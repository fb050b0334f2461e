#include "stereo_messages.hpp"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <stdexcept>

#include "robot_vision/common/range.hpp"
#include "ros/images/camera_info.hpp"
#include "ros/images/image_message.hpp"

namespace robot_vision
{
namespace
{

constexpr double kStep = 1.0 / 16.0;  // px, between two disparities of OpenCV

/// One camera of the pair. Throws std::invalid_argument, which does not name the topic.
RectifiedCamera rectifiedCamera(const sensor_msgs::Image& image, const sensor_msgs::CameraInfo& info)
{
  const RectifiedCamera camera{cameraModel(info), cv::Matx33d(info.R.data()), cv::Matx34d(info.P.data())};
  const bool fits = info.width == image.width && info.height == image.height;
  require(fits || !isCalibrated(camera.model.K), "its size", sizeText(info.width, info.height),
          sizeText(image.width, image.height) + " as of the image");
  validate(camera);
  return camera;
}

/// What `make` returns; what it throws begins with `where`.
template <class Make>
auto about(const std::string& where, const Make& make)
{
  try
  {
    return make();
  }
  catch (const std::invalid_argument& e)
  {
    throw std::invalid_argument("camera_info on " + where + ": " + e.what());
  }
}

}  // namespace

StereoCamera stereoCamera(const StereoFrame& frame)
{
  const auto camera = [&frame](std::size_t side)
  {
    const StereoPair& pair = frame.messages;
    const sensor_msgs::Image& image = *pair.images[side];
    const cv::Size size(static_cast<int>(image.width), static_cast<int>(image.height));
    return about(frame.topics.infos[side], [&] { return rectifiedCamera(image, *ofImages(pair.infos[side], size)); });
  };
  const StereoCamera pair{camera(kLeft), camera(kRight)};
  return about(frame.topics.infos[kLeft] + " and " + frame.topics.infos[kRight],
               [&]
               {
                 validate(pair);
                 return pair;
               });
}

sensor_msgs::CameraInfoPtr rectifiedInfo(const std_msgs::Header& header, const RectifiedCamera& left)
{
  const auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  const CameraModel model = rectifiedModel(left);
  info->header = header;
  info->width = static_cast<std::uint32_t>(model.width);
  info->height = static_cast<std::uint32_t>(model.height);
  info->distortion_model = model.distortion_model;
  info->D.assign(5, 0.0);
  const cv::Matx33d R = cv::Matx33d::eye();
  std::copy_n(model.K.val, info->K.size(), info->K.begin());
  std::copy_n(R.val, info->R.size(), info->R.begin());
  std::copy_n(left.P.val, info->P.size(), info->P.begin());
  return info;
}

stereo_msgs::DisparityImagePtr toDisparityImage(const std_msgs::Header& header, const cv::Mat& disparity,
                                                const StereoMatcher& matcher, const StereoGeometry& geometry)
{
  const auto message = boost::make_shared<stereo_msgs::DisparityImage>();
  const double lowest = matcher.params().min_disparity - geometry.offset;
  message->header = header;
  message->f = static_cast<float>(geometry.fx);
  message->T = static_cast<float>(geometry.baseline);
  message->min_disparity = static_cast<float>(lowest);
  message->max_disparity = static_cast<float>(lowest + matcher.params().disparities - 1);
  message->delta_d = static_cast<float>(kStep);
  const cv::Rect window = matcher.window(disparity.size());
  message->valid_window.x_offset = static_cast<std::uint32_t>(window.x);
  message->valid_window.y_offset = static_cast<std::uint32_t>(window.y);
  message->valid_window.width = static_cast<std::uint32_t>(window.width);
  message->valid_window.height = static_cast<std::uint32_t>(window.height);
  message->image.header = header;
  layOut(disparity.size(), "32FC1", message->image);
  cv::Mat out = writablePixels(message->image);
  const auto none = static_cast<float>(lowest - 1.0), offset = static_cast<float>(geometry.offset);
  for (int y = 0; y < out.rows; ++y)
  {
    const auto* from = disparity.ptr<float>(y);
    std::transform(from, from + out.cols, out.ptr<float>(y),
                   [=](float found) { return std::isnan(found) ? none : found - offset; });
  }
  return message;
}

}  // namespace robot_vision
