#include "robot_vision/depth/depth_registration.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include "cell_kernels.hpp"
#include "core/geometry/rigid_motion.hpp"
#include "core/image/row_bands.hpp"
#include "depth_kernels.hpp"
#include "drawn_band.hpp"
#include "registration_lens.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/depth/depth_image.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxSide = 8192;  // px
const char* const kTransform = "the transform from the depth camera to the color camera";

const CameraModel& checked(const CameraModel& camera, const std::string& name)
{
  validate(camera);
  requireRange("the width of the " + name + " camera", camera.width, 1, kMaxSide);
  requireRange("the height of the " + name + " camera", camera.height, 1, kMaxSide);
  return camera;
}

/// The steps in the color image from one pixel of the depth image to the next one, halved.
HalfCell halfCell(const CameraModel& depth_camera, const CameraModel& color_camera, const cv::Matx33d& rotation)
{
  const auto half = [&](int axis)
  {
    const double steps = kSubpixels / 2.0 / depth_camera.K(axis, axis);
    return cv::Point(cvRound(steps * color_camera.K(0, 0) * rotation(0, axis)),
                     cvRound(steps * color_camera.K(1, 1) * rotation(1, axis)));
  };
  return {half(0), half(1)};
}

/// The rows of the color image that vertices of a row of the depth image are in, also in part.
cv::Range reachedBy(const std::int32_t* v, const float* w, int count)
{
  std::int32_t top = std::numeric_limits<std::int32_t>::max(), bottom = std::numeric_limits<std::int32_t>::min();
  for (int i = 0; i < count; ++i)
  {
    top = w[i] > 0.0F ? std::min(top, v[i]) : top;
    bottom = w[i] > 0.0F ? std::max(bottom, v[i]) : bottom;
  }
  if (top > bottom) return {0, 0};
  return {top >> kSubpixelBits, (bottom >> kSubpixelBits) + 2};
}

}  // namespace

struct DepthRegistration::Impl
{
  Impl(const CameraModel& depth, const CameraModel& color, const cv::Affine3d& depth_to_color,
       const RegistrationParams& p)
    : depth_camera(checked(depth, "depth")), color_camera(checked(color, "color")), params((validate(p), p))
  {
    requireRigid(depth_to_color, kTransform);
    rays = rayTable(depth_camera);
    const double ratio =
        std::max(color_camera.K(0, 0), color_camera.K(1, 1)) / std::min(depth_camera.K(0, 0), depth_camera.K(1, 1));
    radius = lensRadius(color_camera, 1.0 + 2.0 * ratio);  // with the cells along the border of the image
    const cv::Size size(depth_camera.width, depth_camera.height);
    u.create(size, CV_32SC1);
    v.create(size, CV_32SC1);
    w.create(size, CV_32FC1);
    reached.resize(static_cast<std::size_t>(size.height));
    bands.resize(static_cast<std::size_t>(params.threads));
    setTransform(depth_to_color);
  }

  void setTransform(const cv::Affine3d& depth_to_color)
  {
    requireRigid(depth_to_color, kTransform);
    projection = projection32(color_camera, depth_to_color, radius);
    half = halfCell(depth_camera, color_camera, depth_to_color.rotation());
  }

  void apply(const cv::Mat& depth, const std::string& encoding, cv::Mat& registered)
  {
    checkDepth(depth, encoding, {depth_camera.width, depth_camera.height});
    parallelForRows(depth.rows, params.threads, kMinRows, [&](int, const cv::Range& rows) { project(depth, rows); });
    registered.create(color_camera.height, color_camera.width, depthType(encoding));
    parallelForRows(registered.rows, params.threads, kMinRows,
                    [&](int i, const cv::Range& rows)
                    {
                      DrawnBand& band = bands[static_cast<std::size_t>(i)];
                      draw(rows, band);
                      write(rows, band, registered);
                    });
  }

  void project(const cv::Mat& depth, const cv::Range& rows)
  {
    std::vector<float> metres(static_cast<std::size_t>(depth.cols));
    for (int y = rows.start; y < rows.end; ++y)
    {
      if (depth.type() == CV_16UC1)
        kernels<DepthKernels>().metres(depth.ptr<std::uint16_t>(y), depth.cols, metres.data());
      const float* const depths = depth.type() == CV_16UC1 ? metres.data() : depth.ptr<float>(y);
      const RayRow through{rays.x.ptr<float>(y), rays.y.ptr<float>(y)};
      const VertexRow row = vertices(y);
      kernels<ProjectionKernels>().project(depths, through, projection, depth.cols, row.u, row.v, row.w);
      reached[static_cast<std::size_t>(y)] = reachedBy(row.v, row.w, depth.cols);
    }
  }

  VertexRow vertices(int y) { return {u.ptr<std::int32_t>(y), v.ptr<std::int32_t>(y), w.ptr<float>(y)}; }

  /// Draws all cells that are in these rows of the color image, or may be.
  void draw(const cv::Range& rows, DrawnBand& band)
  {
    band.reset(color_camera.width, rows, static_cast<float>(1.0 + params.max_jump), half);
    const int beyond = (std::abs(half.right.y) + std::abs(half.down.y)) / kSubpixels + 1;  // of quarters of cells
    for (int y = 0; y + 1 < depth_camera.height; ++y)
    {
      const cv::Range upper = reached[static_cast<std::size_t>(y)], lower = reached[static_cast<std::size_t>(y) + 1];
      if (upper.empty() && lower.empty()) continue;
      const cv::Range both = upper.empty() ? lower : lower.empty() ? upper : joined(upper, lower);
      if (both.end + beyond > rows.start && both.start - beyond < rows.end)
        band.draw(vertices(y), vertices(y + 1), depth_camera.width - 1);
    }
  }

  static cv::Range joined(const cv::Range& a, const cv::Range& b)
  {
    return {std::min(a.start, b.start), std::max(a.end, b.end)};
  }

  static void write(const cv::Range& rows, const DrawnBand& band, cv::Mat& registered)
  {
    const CellKernels& to = kernels<CellKernels>();
    for (int y = rows.start; y < rows.end; ++y)
      if (registered.type() == CV_16UC1)
        to.millimetres(band.row(y), registered.cols, registered.ptr<std::uint16_t>(y));
      else
        to.metres(band.row(y), registered.cols, registered.ptr<float>(y));
  }

  CameraModel depth_camera, color_camera;
  RegistrationParams params;
  RayTable rays;
  double radius = 0.0;  // see lensRadius()
  Projection32 projection{};
  HalfCell half;
  cv::Mat u, v, w;                 // see VertexRow
  std::vector<cv::Range> reached;  // rows of the color image, for each row of the depth image
  std::vector<DrawnBand> bands;    // one for each thread
};

DepthRegistration::DepthRegistration(const CameraModel& depth_camera, const CameraModel& color_camera,
                                     const cv::Affine3d& depth_to_color, const RegistrationParams& params)
  : impl_(std::make_unique<Impl>(depth_camera, color_camera, depth_to_color, params))
{
}

DepthRegistration::~DepthRegistration() = default;

void DepthRegistration::setTransform(const cv::Affine3d& depth_to_color)
{
  impl_->setTransform(depth_to_color);
}

void DepthRegistration::apply(const cv::Mat& depth, const std::string& encoding, cv::Mat& registered)
{
  impl_->apply(depth, encoding, registered);
}

}  // namespace robot_vision
