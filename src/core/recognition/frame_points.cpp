#include "frame_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "pinhole.hpp"

namespace robot_vision
{
namespace
{

constexpr double kOffers = 0.4;  // of the distance between points that are kept, between those that are looked at

double extentOf(const std::vector<cv::Point3d>& hull)
{
  double largest = 0.0;
  for (const cv::Point3d& a : hull)
    for (const cv::Point3d& b : hull)
      largest = std::max(largest, cv::norm(a - b));
  return largest;
}

double medianDepth(const cv::Mat& depth)
{
  std::vector<float> some;
  for (int y = 4; y < depth.rows; y += 8)
    for (int x = 4; x < depth.cols; x += 8)
      if (depth.at<float>(y, x) > 0.0F) some.push_back(depth.at<float>(y, x));
  if (some.empty()) return 1.0;
  const auto middle = some.begin() + static_cast<std::ptrdiff_t>(some.size() / 2);
  std::nth_element(some.begin(), middle, some.end());
  return static_cast<double>(*middle);
}

}  // namespace

void FramePoints::begin(const RecognitionFrame& frame, bool with_planes)
{
  if (!normal_finder_ || !(camera_ == frame.camera()))
  {
    camera_ = frame.camera();
    normal_finder_ = std::make_unique<DepthNormals>(camera_);
    plane_finder_ = std::make_unique<PlaneFinder>(camera_);
  }
  normal_finder_->apply(frame.depth(), "32FC1", normals_);
  planes_ = with_planes ? &plane_finder_->find(frame.depth(), "32FC1") : nullptr;
}

/// By the labels: which planes are too large.
std::vector<char> FramePoints::largePlanes(double max_plane) const
{
  std::vector<char> is_large(256, 0);
  if (planes_ == nullptr) return is_large;
  for (std::size_t i = 0; i < planes_->planes.size(); ++i)
    is_large[i + 1] = extentOf(planes_->planes[i].hull) > max_plane ? 1 : 0;
  return is_large;
}

void FramePoints::sample(const RecognitionFrame& frame, double distance, double max_plane, int max_points,
                         OrientedPoints& points)
{
  points.points.clear();
  points.normals.clear();
  cells_.clear();
  const Pinhole camera(frame.camera().K);
  const cv::Mat& depth = frame.depth();
  const std::vector<char> is_large = largePlanes(max_plane);
  const double pixels = kOffers * distance / (medianDepth(depth) * camera.pixelWidth());
  const int step = std::max(1, static_cast<int>(std::min(pixels, 1e6)));
  for (int y = step / 2; y < depth.rows; y += step)
    for (int x = step / 2; x < depth.cols; x += step)
    {
      const auto z = static_cast<double>(depth.at<float>(y, x));
      const auto& normal = normals_.at<cv::Vec3f>(y, x);
      if (!(z > 0.0) || std::isnan(normal[0])) continue;
      if (planes_ != nullptr && is_large[planes_->labels.at<std::uint8_t>(y, x)] != 0) continue;
      const cv::Vec3d point = z * camera.ray(x, y);
      std::uint64_t cell = 0;
      for (int i = 0; i < 3; ++i)
        cell = cell << 21 |
               (static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(point[i] / distance))) & 0x1FFFFF);
      if (!cells_.insert(cell).second) continue;
      points.points.emplace_back(point);
      points.normals.push_back(normal);
    }
  const auto most = static_cast<std::size_t>(max_points);
  const std::size_t count = points.size();
  if (count <= most) return;
  for (std::size_t i = 0; i < most; ++i)
  {
    points.points[i] = points.points[i * count / most];
    points.normals[i] = points.normals[i * count / most];
  }
  points.points.resize(most);
  points.normals.resize(most);
}

}  // namespace robot_vision
