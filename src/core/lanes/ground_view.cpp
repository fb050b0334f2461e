#include "robot_vision/lanes/ground_view.hpp"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kMinViewSide = 20, kMaxViewSide = 1000;  // px
constexpr double kMaxRayError = 1e-3;  // on the plane z = 1, of a pixel that a lens cannot show there

cv::Size viewSize(const GroundParams& params)
{
  return {cvRound(params.view_width / params.resolution), cvRound((params.far - params.near) / params.resolution)};
}

}  // namespace

void validate(const GroundParams& params)
{
  checkFields(params);
  require(params.far > params.near, "far", params.far, "above near, " + toText(params.near));
  for (const double length : {params.far - params.near, params.view_width})
  {
    const double side = length / params.resolution;
    require(side >= kMinViewSide && side <= kMaxViewSide, "resolution", params.resolution,
            "such that " + toText(length) + " m are 20 to 1000 px");
  }
  require(params.near_row > params.far_row, "near_row", params.near_row, "below far_row, " + toText(params.far_row));
  require(params.near_right > params.near_left, "near_right", params.near_right, "right of near_left");
  require(params.far_right > params.far_left, "far_right", params.far_right, "right of far_left");
}

GroundView::GroundView(const GroundParams& params, const CameraModel& camera)
  : params_((validate(params), params)), image_size_((validate(camera), camera.width), camera.height), camera_(camera)
{
  makeMap();
}

GroundView::GroundView(const GroundParams& params, double lane_width, const cv::Size& size)
  : params_((validate(params), params)), image_size_(size)
{
  require(lane_width > 0.0 && std::isfinite(lane_width), "lane_width", lane_width, "above 0 (m)");
  require(!size.empty(), "the size of the image", toText(size.area()) + " px", "above 0");
  const auto pixel = [&size](double x, double y)
  { return cv::Point2f(static_cast<float>(x * size.width - 0.5), static_cast<float>(y * size.height - 0.5)); };
  const auto near = static_cast<float>(params.near), far = static_cast<float>(params.far);
  const auto side = static_cast<float>(lane_width / 2.0);
  const cv::Point2f floor[] = {{near, side}, {near, -side}, {far, -side}, {far, side}};
  const cv::Point2f image[] = {pixel(params.near_left, params.near_row), pixel(params.near_right, params.near_row),
                               pixel(params.far_right, params.far_row), pixel(params.far_left, params.far_row)};
  const cv::Mat found = cv::getPerspectiveTransform(floor, image);
  floor_to_image_ = cv::Matx33d(found.ptr<double>());
  // Its scale is arbitrary: positive is what is before the camera.
  if ((floor_to_image_ * cv::Vec3d(params.far, 0.0, 1.0))[2] < 0.0) floor_to_image_ = -1.0 * floor_to_image_;
  makeMap();
}

cv::Point2d GroundView::throughLens(const cv::Point2d& place) const
{
  const double sine = std::sin(params_.pitch), cosine = std::cos(params_.pitch);
  const double ahead = place.x - params_.camera_x, left = place.y - params_.camera_y, down = params_.camera_height;
  const cv::Point3d point(-left, down * cosine - ahead * sine, ahead * cosine + down * sine);
  const cv::Point2d pixel = camera_.project(point);
  if (camera_.D.empty() || std::isnan(pixel.x)) return pixel;
  // The polynomial of a lens is good for what the lens sees. Far outside it may lead back into the image.
  const cv::Point2d ray(point.x / point.z, point.y / point.z);
  return cv::norm(camera_.ray(pixel) - ray) < kMaxRayError * (1.0 + cv::norm(ray)) ? pixel : cv::Point2d(kNan, kNan);
}

cv::Point2d GroundView::toImage(const cv::Point2d& place) const
{
  if (params_.ground == "camera") return throughLens(place);
  const cv::Vec3d seen = floor_to_image_ * cv::Vec3d(place.x, place.y, 1.0);
  return seen[2] > 0.0 ? cv::Point2d(seen[0] / seen[2], seen[1] / seen[2]) : cv::Point2d(kNan, kNan);
}

cv::Point2d GroundView::toView(const cv::Point2d& place) const
{
  return {(params_.view_width / 2.0 - place.y) / params_.resolution - 0.5,
          (params_.far - place.x) / params_.resolution - 0.5};
}

cv::Point2d GroundView::toGround(const cv::Point2d& view) const
{
  return {params_.far - (view.y + 0.5) * params_.resolution,
          params_.view_width / 2.0 - (view.x + 0.5) * params_.resolution};
}

void GroundView::makeMap()
{
  const cv::Size size = viewSize(params_);
  cv::Mat map(size, CV_32FC2, cv::Scalar::all(-1.0));
  seen_ = cv::Mat::zeros(size, CV_8UC1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
    {
      const cv::Point2d pixel = toImage(toGround(cv::Point2d(x, y)));
      const bool inside =
          pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x <= image_size_.width - 1 && pixel.y <= image_size_.height - 1;
      if (!inside) continue;  // NaN is not inside either
      map.at<cv::Point2f>(y, x) = cv::Point2f(pixel);
      seen_.at<unsigned char>(y, x) = 255;
    }
  require(cv::countNonZero(seen_) > 0, "the view from above", "black",
          "of floor that the camera sees: near, far and how it is mounted say where that is");
  cv::convertMaps(map, cv::noArray(), map_, map_fraction_, CV_16SC2);
}

void GroundView::fromAbove(const cv::Mat& bgr, cv::Mat& view) const
{
  checkPixels(bgr, "bgr8");
  require(bgr.size() == image_size_, "the image", toText(bgr.size()), "of the camera's size, " + toText(image_size_));
  cv::remap(bgr, view, map_, map_fraction_, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  view.setTo(cv::Scalar::all(0), seen_ == 0);
}

}  // namespace robot_vision
