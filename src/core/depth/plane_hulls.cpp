#include "plane_hulls.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace robot_vision
{
namespace
{

constexpr int kMinRun = 3;            // px of a plane beside each other in a row, which a single wrong pixel is not
constexpr double kFarthest = 1000.0;  // m: what is farther, or beyond the horizon of its plane, is at no known place

/// The ends of the plane's pixels in each row, as far as they are runs, in the frame of the plane.
using Ends = std::vector<std::vector<cv::Point2f>>;  // for each plane

class HullFinder
{
public:
  HullFinder(const RayTable& rays, std::vector<Plane>& planes)
    : rays_(rays), planes_(planes), ends_(planes.size()), reach_(planes.size())
  {
    for (const Plane& plane : planes)
      frames_.push_back(planeFrame(plane));
  }

  void addRow(const std::uint8_t* labels, int y)
  {
    std::fill(reach_.begin(), reach_.end(), cv::Range());
    const int width = rays_.x.cols;
    for (int begin = 0; begin < width;)
    {
      int end = begin + 1;
      while (end < width && labels[end] == labels[begin])
        ++end;
      if (labels[begin] != 0 && end - begin >= kMinRun)
      {
        cv::Range& columns = reach_[labels[begin] - std::size_t{1}];
        columns = {columns.empty() ? begin : columns.start, end};
      }
      begin = end;
    }
    for (std::size_t i = 0; i < planes_.size(); ++i)
      if (!reach_[i].empty())
        for (const int x : {reach_[i].start, reach_[i].end - 1})
          addEnd(i, x, y);
  }

  void finish()
  {
    for (std::size_t i = 0; i < planes_.size(); ++i)
    {
      if (ends_[i].empty()) continue;
      std::vector<cv::Point2f> corners;
      cv::convexHull(ends_[i], corners);  // counter-clockwise with x to the right and y up, which z points out of
      for (const cv::Point2f& corner : corners)
        planes_[i].hull.emplace_back(frames_[i] * cv::Point3d(corner.x, corner.y, 0.0));
    }
  }

private:
  /// Adds the place where the ray of a pixel meets a plane.
  void addEnd(std::size_t i, int x, int y)
  {
    const cv::Vec3d ray(rays_.x.at<float>(y, x), rays_.y.at<float>(y, x), 1.0);
    const double towards = -planes_[i].normal.dot(ray);
    if (!(towards * kFarthest > planes_[i].distance)) return;
    const cv::Vec3d point = planes_[i].distance / towards * ray;
    const cv::Vec3d local = frames_[i].rotation().t() * (point - frames_[i].translation());
    ends_[i].emplace_back(static_cast<float>(local[0]), static_cast<float>(local[1]));
  }

  const RayTable& rays_;
  std::vector<Plane>& planes_;
  std::vector<cv::Affine3d> frames_;
  Ends ends_;
  std::vector<cv::Range> reach_;  // of each plane in a row, from the first to the last pixel of its runs
};

}  // namespace

cv::Affine3d planeFrame(const Plane& plane)
{
  // The x axis is the camera's, or the y axis where that is nearly the normal.
  const cv::Vec3d& z = plane.normal;
  const cv::Vec3d along = std::abs(z[0]) < 0.9 ? cv::Vec3d(1.0, 0.0, 0.0) : cv::Vec3d(0.0, 1.0, 0.0);
  const cv::Vec3d x = cv::normalize(along - along.dot(z) * z), y = z.cross(x);
  return {cv::Matx33d(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]), -plane.distance * z};
}

void findHulls(const cv::Mat& labels, const RayTable& rays, std::vector<Plane>& planes)
{
  HullFinder finder(rays, planes);
  for (int y = 0; y < labels.rows; ++y)
    finder.addRow(labels.ptr(y), y);
  finder.finish();
}

}  // namespace robot_vision
