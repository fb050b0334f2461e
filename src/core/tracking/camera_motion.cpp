#include "robot_vision/tracking/camera_motion.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>
#include <utility>

#include "core/features/flow_image.hpp"
#include "core/features/similarity.hpp"
#include "core/image/conversion_buffer.hpp"
#include "flow_corners.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMinSide = 32;       // px, of a shrunk image that has points
constexpr double kMaxScale = 2.0;  // from one frame to the next

const cv::TermCriteria kCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 10, 0.03);

/// The pixels of a shrunk image that belong to boxes of the whole one: 255, and 0 elsewhere. Empty without boxes.
cv::Mat maskOf(const std::vector<cv::Rect2d>& boxes, const cv::Size& size, int shrinking)
{
  if (boxes.empty()) return {};
  cv::Mat mask(size, CV_8UC1, cv::Scalar(0));
  const auto pixel = [shrinking](double value, int limit)
  { return cvRound(std::clamp(value / shrinking, 0.0, static_cast<double>(limit))); };
  for (const cv::Rect2d& box : boxes)
  {
    const cv::Point from(pixel(box.x, size.width), pixel(box.y, size.height));
    const cv::Point to(pixel(box.x + box.width, size.width), pixel(box.y + box.height, size.height));
    if (from.x < to.x && from.y < to.y) mask(cv::Rect(from, to)).setTo(255);
  }
  return mask;
}

/// Points of two frames that belong together, px of the whole image.
struct PointPairs
{
  std::vector<cv::Point2f> from, to;
};

PointPairs followed(FlowImage& last, FlowImage& newest, const FlowParams& flow, const std::vector<cv::Point2f>& points,
                    int shrinking)
{
  PointPairs pairs;
  if (points.empty()) return pairs;
  std::vector<cv::Point2f> moved;
  std::vector<uchar> found;
  std::vector<float> unused;
  cv::calcOpticalFlowPyrLK(last.pyramid(flow), newest.pyramid(flow), points, moved, found, unused,
                           {flow.window, flow.window}, flow.levels, kCriteria);
  const auto whole = [shrinking](const cv::Point2f& p)
  { return (p + cv::Point2f(0.5F, 0.5F)) * static_cast<float>(shrinking); };
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (!found[i] || !isInside(newest.size(), moved[i])) continue;
    pairs.from.push_back(whole(points[i]));
    pairs.to.push_back(whole(moved[i]));
  }
  return pairs;
}

int countAgreeing(const Similarity& motion, const PointPairs& pairs, double tolerance)
{
  int count = 0;
  for (std::size_t i = 0; i < pairs.from.size(); ++i)
    if (cv::norm(motion(cv::Point2d(pairs.from[i])) - cv::Point2d(pairs.to[i])) <= tolerance) ++count;
  return count;
}

}  // namespace

struct CameraMotion::Impl
{
  /// The gray image shrunk by a whole number; what is left of the rows and columns then is cut off.
  cv::Mat shrink(const cv::Mat& gray)
  {
    shrinking = (gray.cols + params.width - 1) / params.width;
    if (shrinking == 1) return gray;
    const cv::Size size(gray.cols / shrinking, gray.rows / shrinking);
    if (size.empty()) return gray(cv::Rect(0, 0, 1, 1));
    cv::resize(gray(cv::Rect({0, 0}, size * shrinking)), small, size, 0.0, 0.0, cv::INTER_AREA);
    return small;
  }

  std::optional<Similarity> motion(const std::vector<cv::Rect2d>& leave_out)
  {
    const cv::Size size = newest.size();
    if (last.size() != size || std::min(size.width, size.height) < kMinSide) return std::nullopt;
    const cv::Mat mask = maskOf(leave_out, size, shrinking);
    const FlowParams flow{params.window, params.levels, 0.0};
    const std::vector<cv::Point2f> corners = flowCorners(last.pyramid(flow)[1], mask, params.points);
    const PointPairs pairs = followed(last, newest, flow, corners, shrinking);
    const double tolerance = params.tolerance * shrinking;
    const std::optional<Similarity> fit = fitSimilarity(pairs.from, pairs.to, tolerance, params.min_points);
    if (!fit || fit->scale() > kMaxScale || fit->scale() < 1.0 / kMaxScale) return std::nullopt;
    agreeing = countAgreeing(*fit, pairs, tolerance);
    const int least = std::max(params.min_points, cvCeil(params.min_share * static_cast<double>(corners.size())));
    return agreeing >= least ? fit : std::nullopt;
  }

  CameraMotionParams params;
  ConversionBuffer buffer;
  cv::Mat small;
  FlowImage last, newest;
  cv::Size image_size;
  int shrinking = 1;
  int agreeing = 0;
};

CameraMotion::CameraMotion(const CameraMotionParams& params) : impl_(std::make_unique<Impl>())
{
  validate(params);
  impl_->params = params;
}

CameraMotion::~CameraMotion() = default;
CameraMotion::CameraMotion(CameraMotion&&) noexcept = default;
CameraMotion& CameraMotion::operator=(CameraMotion&&) noexcept = default;

cv::Matx23d CameraMotion::update(const cv::Mat& image, const std::string& encoding,
                                 const std::vector<cv::Rect2d>& leave_out)
{
  Impl& me = *impl_;
  for (std::size_t i = 0; i < leave_out.size(); ++i)
    for (const double value : {leave_out[i].x, leave_out[i].y, leave_out[i].width, leave_out[i].height})
      requireFinite("leave_out[" + std::to_string(i) + "]", value);
  const cv::Mat gray = me.buffer.gray(image, encoding);
  const bool follows = gray.size() == me.image_size;
  std::swap(me.last, me.newest);
  me.newest.set(me.shrink(gray));
  me.image_size = gray.size();
  const std::optional<Similarity> motion = follows ? me.motion(leave_out) : std::nullopt;
  if (!motion) me.agreeing = 0;
  return motion.value_or(Similarity()).matrix();
}

bool CameraMotion::known() const
{
  return impl_->agreeing > 0;
}

int CameraMotion::points() const
{
  return impl_->agreeing;
}

void CameraMotion::reset()
{
  impl_->image_size = {};
  impl_->agreeing = 0;
}

}  // namespace robot_vision
