#include "robot_vision/depth/depth_normals.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/image/row_bands.hpp"
#include "inverse_depth.hpp"
#include "robot_vision/depth/depth_image.hpp"

namespace robot_vision
{
namespace
{

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Where neighbours are of one surface: 255, else 0, of each pixel with the one on its right, and with the one below.
struct Links
{
  cv::Mat across, along;  // CV_8UC1; the last column and the last row are 0

  void find(const cv::Mat& inverse, float max_ratio)
  {
    across.create(inverse.size(), CV_8UC1);
    along.create(inverse.size(), CV_8UC1);
    along.row(inverse.rows - 1).setTo(0);
    for (int y = 0; y < inverse.rows; ++y)
    {
      const auto* const row = inverse.ptr<float>(y);
      compare(row, row + 1, inverse.cols - 1, max_ratio, across.ptr(y));
      across.at<std::uint8_t>(y, inverse.cols - 1) = 0;
      if (y + 1 < inverse.rows) compare(row, inverse.ptr<float>(y + 1), inverse.cols, max_ratio, along.ptr(y));
    }
  }

  static void compare(const float* a, const float* b, int count, float max_ratio, std::uint8_t* flags)
  {
    for (int i = 0; i < count; ++i)
      flags[i] = isOneSurface(a[i], b[i], max_ratio) ? 255 : 0;
  }

  /// Writes 255 for pixels that are of one surface with their eight neighbours, else 0.
  void findInside(cv::Mat& inside) const
  {
    inside.create(across.size(), CV_8UC1);
    inside.setTo(0);
    for (int y = 1; y + 1 < inside.rows; ++y)
    {
      const std::uint8_t *const above = across.ptr(y - 1), *const row = across.ptr(y), *const below = across.ptr(y + 1);
      const std::uint8_t *const up = along.ptr(y - 1), *const down = along.ptr(y);
      std::uint8_t* const flags = inside.ptr(y);
      for (int x = 1; x + 1 < inside.cols; ++x)
        flags[x] = above[x - 1] & above[x] & row[x - 1] & row[x] & below[x - 1] & below[x] & up[x - 1] & up[x] &
                   up[x + 1] & down[x - 1] & down[x] & down[x + 1];
    }
  }
};

/// Integral images of w, u w and v w (u and v: column and row), with a row and a column of zeros before them.
void integrate(const cv::Mat& inverse, cv::Mat& sums)
{
  sums.create(inverse.rows + 1, inverse.cols + 1, CV_64FC3);
  sums.row(0).setTo(cv::Scalar::all(0.0));
  for (int y = 0; y < inverse.rows; ++y)
  {
    const auto* const row = inverse.ptr<float>(y);
    const auto* const above = sums.ptr<cv::Vec3d>(y);
    auto* const to = sums.ptr<cv::Vec3d>(y + 1);
    to[0] = cv::Vec3d();
    double plain = 0.0, across = 0.0;
    for (int x = 0; x < inverse.cols; ++x)
    {
      plain += row[x];
      across += static_cast<double>(x) * row[x];
      to[x + 1] = above[x + 1] + cv::Vec3d(plain, across, y * plain);
    }
  }
}

}  // namespace

struct DepthNormals::Impl
{
  Impl(const CameraModel& c, const NormalParams& p) : camera((validate(c), c)), params((validate(p), p))
  {
    rays = rayTable(camera);
  }

  void apply(const cv::Mat& depth, const std::string& encoding, cv::Mat& normals)
  {
    checkDepth(depth, encoding, {camera.width, camera.height});
    invertDepth(depth, encoding, rays, inverse);
    links.find(inverse, static_cast<float>(1.0 + params.max_jump));
    links.findInside(inside);
    cv::distanceTransform(inside, distance, cv::DIST_C, 3);
    integrate(inverse, sums);
    normals.create(inverse.size(), CV_32FC3);
    parallelForRows(normals.rows, params.threads, kMinRows,
                    [&](int, const cv::Range& rows)
                    {
                      for (int y = rows.start; y < rows.end; ++y)
                        findNormals(y, normals.ptr<cv::Vec3f>(y));
                    });
  }

  void findNormals(int y, cv::Vec3f* normals) const
  {
    const auto* const to_outside = distance.ptr<float>(y);  // px to the next pixel that is not inside
    for (int x = 0; x < camera.width; ++x)
    {
      const int radius =
          std::min(params.radius, cvRound(to_outside[x]));  // what is beside those inside belongs to them
      normals[x] = radius > 0 ? normal(x, y, radius) : cv::Vec3f::all(kNan);
    }
  }

  /// By the least squares of inverse depth in the square around a pixel.
  cv::Vec3f normal(int x, int y, int radius) const
  {
    const auto* const top = sums.ptr<cv::Vec3d>(y - radius);
    const auto* const bottom = sums.ptr<cv::Vec3d>(y + radius + 1);
    const int left = x - radius, right = x + radius + 1;
    const cv::Vec3d sum = bottom[right] - bottom[left] - top[right] + top[left];
    const double side = 2.0 * radius + 1.0, count = side * side;
    const double spread = count * radius * (radius + 1.0) / 3.0;  // sum of the squares of the distance in one direction
    const cv::Vec2d slope((sum[1] - x * sum[0]) / spread, (sum[2] - y * sum[0]) / spread);  // 1/m per px
    return facing(slope, sum[0] / count, x, y);
  }

  /// The normal of a plane from its inverse depth at a pixel and how that changes along rows and columns.
  cv::Vec3f facing(const cv::Vec2d& slope, double inverse_depth, int x, int y) const
  {
    const auto ray = [&](int column, int row)
    { return cv::Vec2d(rays.x.at<float>(row, column), rays.y.at<float>(row, column)); };
    const cv::Vec2d across = 0.5 * (ray(x + 1, y) - ray(x - 1, y)), along = 0.5 * (ray(x, y + 1) - ray(x, y - 1));
    const cv::Vec2d at = ray(x, y);
    const double det = across[0] * along[1] - across[1] * along[0];
    const double a = (slope[0] * along[1] - slope[1] * across[1]) / det;
    const double b = (slope[1] * across[0] - slope[0] * along[0]) / det;
    const double c = inverse_depth - a * at[0] - b * at[1];
    const double length = std::sqrt(a * a + b * b + c * c);
    return {static_cast<float>(-a / length), static_cast<float>(-b / length), static_cast<float>(-c / length)};
  }

  CameraModel camera;
  NormalParams params;
  RayTable rays;
  Links links;
  cv::Mat inverse, inside, distance, sums;
};

DepthNormals::DepthNormals(const CameraModel& camera, const NormalParams& params)
  : impl_(std::make_unique<Impl>(camera, params))
{
}

DepthNormals::~DepthNormals() = default;

void DepthNormals::apply(const cv::Mat& depth, const std::string& encoding, cv::Mat& normals)
{
  impl_->apply(depth, encoding, normals);
}

}  // namespace robot_vision
