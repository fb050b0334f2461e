#include "robot_vision/stereo/rectifier.hpp"

#include <cstdint>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/common/in_this_thread.hpp"
#include "core/geometry/distortion.hpp"
#include "core/image/conversion_buffer.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/geometry/distortion_models.hpp"

namespace robot_vision
{
namespace
{

/// Whether a place in fixed point, a whole number of px and a fraction of the next, is between pixels of an image.
bool isInside(int place, int fraction, int size)
{
  return place >= 0 && place + (fraction > 0 ? 1 : 0) < size;
}

/// 255 where the maps of a camera lead into its image, which has their size. What the lens does not show they may lead
/// back into the image.
cv::Mat seenPixels(const RectifiedCamera& camera, const cv::Mat& places, const cv::Mat& fractions)
{
  constexpr int kMask = cv::INTER_TAB_SIZE - 1;
  const Undistortion lens(camera.model);
  const cv::Matx33d to_ray = (camera.P.get_minor<3, 3>(0, 0) * camera.R).inv();
  cv::Mat seen(places.size(), CV_8UC1);
  for (int y = 0; y < seen.rows; ++y)
  {
    const auto* place = places.ptr<cv::Vec2s>(y);
    const auto* fraction = fractions.ptr<std::uint16_t>(y);
    auto* out = seen.ptr<std::uint8_t>(y);
    for (int x = 0; x < seen.cols; ++x)
    {
      const bool inside = isInside(place[x][0], fraction[x] & kMask, seen.cols) &&
                          isInside(place[x][1], fraction[x] >> cv::INTER_BITS, seen.rows);
      const cv::Vec3d ray = to_ray * cv::Vec3d(x, y, 1.0);
      out[x] = inside && ray[2] > 0.0 && lens.holds({ray[0] / ray[2], ray[1] / ray[2]}) ? 255 : 0;
    }
  }
  return seen;
}

}  // namespace

struct Rectifier::Impl
{
  explicit Impl(const RectifiedCamera& of_pair) : camera(of_pair)
  {
    const CameraModel& model = camera.model;
    const cv::Matx33d P = camera.P.get_minor<3, 3>(0, 0);
    const cv::Size size(model.width, model.height);
    inThisThread(
        [&]
        {
          if (isEquidistant(model.distortion_model))
            cv::fisheye::initUndistortRectifyMap(model.K, model.D, camera.R, P, size, CV_16SC2, places, fractions);
          else
            cv::initUndistortRectifyMap(model.K, model.D, camera.R, P, size, CV_16SC2, places, fractions);
        });
    seen = seenPixels(camera, places, fractions);
  }

  RectifiedCamera camera;
  cv::Mat places;     // CV_16SC2, px in the camera's image
  cv::Mat fractions;  // CV_16UC1, of a pixel, as cv::remap has them
  cv::Mat seen;
  ConversionBuffer buffer;
};

Rectifier::Rectifier(const RectifiedCamera& camera)
{
  validate(camera);
  impl_ = std::make_unique<Impl>(camera);
}

Rectifier::~Rectifier() = default;
Rectifier::Rectifier(Rectifier&& other) noexcept = default;
Rectifier& Rectifier::operator=(Rectifier&& other) noexcept = default;

const RectifiedCamera& Rectifier::camera() const
{
  return impl_->camera;
}

void Rectifier::apply(const cv::Mat& image, const std::string& encoding, const std::string& wanted, cv::Mat& out)
{
  require(wanted == "bgr8" || wanted == "mono8", "the encoding of rectified images", wanted, "bgr8 or mono8");
  const cv::Size size = imageSize(image, encoding);
  require(size == impl_->places.size(), "the image's size", toText(size),
          toText(impl_->places.size()) + " as of the camera");
  inThisThread(
      [&]
      {
        const cv::Mat converted = impl_->buffer.as(wanted, image, encoding);
        cv::remap(converted, out, impl_->places, impl_->fractions, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
      });
}

const cv::Mat& Rectifier::seen() const
{
  return impl_->seen;
}

void StereoRectifier::setCamera(const StereoCamera& pair)
{
  const StereoGeometry geometry = geometryOf(pair);
  if (!left_ || !(left_->camera() == pair.left)) left_.emplace(pair.left);
  if (!right_ || !(right_->camera() == pair.right)) right_.emplace(pair.right);
  geometry_ = geometry;
}

}  // namespace robot_vision
