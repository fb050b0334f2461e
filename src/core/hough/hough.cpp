#include "robot_vision/hough/hough.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/image/conversion_buffer.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/edges/edges.hpp"
#include "straight_lines.hpp"

namespace robot_vision
{
namespace
{

#if CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 3)
constexpr bool kHasGradientAlt = true;
constexpr int kGradientAlt = cv::HOUGH_GRADIENT_ALT;
#else
constexpr bool kHasGradientAlt = false;
constexpr int kGradientAlt = cv::HOUGH_GRADIENT;
#endif

constexpr double kMaxVotesByChance = 0.75;  // of accumulator_threshold
constexpr double kMaxDistances = 6e9;       // by gradient_alt from edges to centres in an image, up to 1 ns each

bool isAlternative(const HoughParams& params)
{
  return params.method == "circles" && params.circle_method == "gradient_alt";
}

/// The edges that vote. Those of circles are cv::HoughCircles' own with HOUGH_GRADIENT.
EdgeParams edgeParams(const HoughParams& params)
{
  EdgeParams edges;
  edges.blur_size = 1;
  edges.low_threshold = params.canny_low;
  edges.high_threshold = params.canny_high;
  if (params.method == "circles")
  {
    edges.high_threshold = cvRound(params.canny_high);
    edges.low_threshold = std::max(cvRound(params.canny_high) / 2, 1);
  }
  return edges;
}

/// The edges that cv::HoughCircles uses with HOUGH_GRADIENT_ALT.
cv::Mat scharrEdges(const cv::Mat& gray, double threshold)
{
  cv::Mat dx, dy, edges;
  cv::Scharr(gray, dx, CV_16S, 1, 0);
  cv::Scharr(gray, dy, CV_16S, 0, 1);
  cv::Canny(dx, dy, edges, threshold / 2.0, threshold, true);
  return edges;
}

/// Votes that each centre would have if the edges were spread at random over the image.
double votesByChance(const cv::Mat& edges, const HoughParams& params)
{
  const double largest = params.max_radius > 0 ? params.max_radius : std::max(edges.cols, edges.rows);
  const double both_sides = 2.0 * std::max(largest - params.min_radius, 1.0);
  const auto area = static_cast<double>(edges.total());
  const double mean_chord = CV_PI / 2.0 * area / (edges.cols + edges.rows);  // by Cauchy's formula
  const double cells_per_edge = std::min(both_sides, mean_chord) / params.dp;
  return cv::countNonZero(edges) * cells_per_edge / (area / (params.dp * params.dp));
}

/// Distances between edges and centres that gradient_alt looks at, if all is full of centres: a fifth of the
/// accumulator's cells, or as many as are min_distance apart where they come in any order.
double distancesToCenters(const cv::Mat& edges, const HoughParams& params)
{
  const auto area = static_cast<double>(edges.total());
  const double apart = 0.7 / (params.min_distance * params.min_distance);
  return cv::countNonZero(edges) * area * std::min(0.2 / (params.dp * params.dp), apart);
}

std::vector<HoughCircle> findCircles(const cv::Mat& gray, const HoughParams& params)
{
  const bool alternative = isAlternative(params);
  const double criterion = alternative ? params.perfectness : params.accumulator_threshold;
  std::vector<cv::Vec4f> found;
  cv::HoughCircles(gray, found, alternative ? kGradientAlt : cv::HOUGH_GRADIENT, params.dp, params.min_distance,
                   params.canny_high, criterion, params.min_radius, params.max_radius);
  std::vector<HoughCircle> circles;
  for (const cv::Vec4f& one : found)
  {
    if (static_cast<int>(circles.size()) == params.max_results) break;
    HoughCircle circle;
    circle.center = {one[0], one[1]};
    circle.radius = one[2];
    circle.votes = cvRound(one[3]);
    circle.score = static_cast<double>(one[3]) / found[0][3];
    circles.push_back(circle);
  }
  return circles;
}

}  // namespace

void validate(const HoughParams& params)
{
  checkFields(params);
  require(params.method == "circles" || params.canny_low <= params.canny_high, "canny_high", params.canny_high,
          "at least canny_low, " + toText(params.canny_low));
  require(params.max_radius == 0 || params.max_radius > params.min_radius, "max_radius", params.max_radius,
          "0 or above min_radius, " + toText(params.min_radius));
  require(kHasGradientAlt || params.circle_method != "gradient_alt", "circle_method", params.circle_method,
          "gradient: OpenCV " CV_VERSION " has no gradient_alt, which came with 4.3");
}

struct HoughTransform::Impl
{
  explicit Impl(const HoughParams& p) : params(p), edge_detector(edgeParams(p)) {}

  HoughResult apply(const cv::Mat& image, const std::string& encoding, bool with_edges)
  {
    const cv::Mat gray = smoothed(buffer.gray(image, encoding));
    HoughResult result;
    if (isAlternative(params))
    {
      const cv::Mat edges = scharrEdges(gray, params.canny_high);
      result.too_many_edges = distancesToCenters(edges, params) > kMaxDistances;
      if (!result.too_many_edges) result.circles = findCircles(gray, params);
      if (with_edges) result.edges = edges;
      return result;
    }
    cv::Mat edges;
    edge_detector.apply(gray, "mono8", edges);
    if (params.method == "circles")
    {
      result.too_many_edges = votesByChance(edges, params) > kMaxVotesByChance * params.accumulator_threshold;
      if (!result.too_many_edges) result.circles = findCircles(gray, params);
    }
    else
      result.lines = params.method == "lines" ? findStraightLines(edges, params) : findSegments(edges, params);
    if (with_edges) result.edges = edges;
    return result;
  }

  cv::Mat smoothed(const cv::Mat& gray)
  {
    // Not a part of a larger matrix, whose other pixels OpenCV's filters would read.
    const cv::Mat whole(gray.size(), gray.type(), gray.data, gray.step);
    if (params.blur == "none") return whole;
    if (params.blur == "median")
      cv::medianBlur(whole, blurred, params.blur_size);
    else
      cv::GaussianBlur(whole, blurred, {params.blur_size, params.blur_size}, 0.0);
    return blurred;
  }

  HoughParams params;
  ConversionBuffer buffer;
  EdgeDetector edge_detector;
  cv::Mat blurred;
};

HoughTransform::HoughTransform(const HoughParams& params)
{
  validate(params);
  impl_ = std::make_unique<Impl>(params);
}

HoughTransform::HoughTransform(HoughTransform&&) = default;
HoughTransform& HoughTransform::operator=(HoughTransform&&) = default;
HoughTransform::~HoughTransform() = default;

HoughResult HoughTransform::apply(const cv::Mat& image, const std::string& encoding, bool with_edges)
{
  return impl_->apply(image, encoding, with_edges);
}

}  // namespace robot_vision
