#include "robot_vision/contours/contours.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "contour_measures.hpp"
#include "core/image/conversion_buffer.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/edges/edges.hpp"

namespace robot_vision
{
namespace
{

using Outline = std::vector<cv::Point>;

constexpr double kMaxChanges = 1e6;  // along the rows of a mask: some seconds, which grow with the square
constexpr double kSparse = 4.0;      // pixels for each of them; noise has two, the edges of a photograph eight

const std::map<std::string, int> kModes = {
    {"external", cv::RETR_EXTERNAL}, {"list", cv::RETR_LIST}, {"ccomp", cv::RETR_CCOMP}, {"tree", cv::RETR_TREE}};
const std::map<std::string, int> kApproximations = {{"none", cv::CHAIN_APPROX_NONE},
                                                    {"simple", cv::CHAIN_APPROX_SIMPLE},
                                                    {"tc89_l1", cv::CHAIN_APPROX_TC89_L1},
                                                    {"tc89_kcos", cv::CHAIN_APPROX_TC89_KCOS}};
const std::map<std::string, int> kMatchMethods = {
    {"I1", cv::CONTOURS_MATCH_I1}, {"I2", cv::CONTOURS_MATCH_I2}, {"I3", cv::CONTOURS_MATCH_I3}};

/// To find the contour around another one OpenCV follows all borders that it may be, again for each: in noise, where
/// one border goes through the whole image, that is the square of what is there. Throws std::invalid_argument if it
/// would take many seconds.
void requireTime(const cv::Mat& mask, const ContourParams& params)
{
  if (mask.cols < 2 || params.mode == "list" || params.mode == "external") return;
  cv::Mat changes;
  cv::bitwise_xor(mask.colRange(1, mask.cols), mask.colRange(0, mask.cols - 1), changes);
  const int count = cv::countNonZero(changes);
  const double most = std::max(kMaxChanges, static_cast<double>(mask.total()) / kSparse);
  require(count <= most, "mode", params.mode,
          "list or external, or blur_size larger: the mask of " + toText(mask.size()) + " changes " +
              std::to_string(count) + " times along its rows, more than " + toText(most));
}

/// Of a mask of white things, which are 255.
struct FoundContours
{
  FoundContours(const cv::Mat& mask, const std::string& mode, const ContourParams& params)
  {
    cv::findContours(mask, outlines, hierarchy, kModes.at(mode), kApproximations.at(params.approximation));
    for (const Outline& outline : outlines)
      areas.push_back(outline.empty() ? 0.0 : cv::contourArea(outline));
    if (mode == "list") findHoles(mask);
  }

  /// Without a hierarchy: OpenCV follows the border of a hole the other way round. With few of its points a thin
  /// outline may turn round, so it is asked for all corners.
  void findHoles(const cv::Mat& mask)
  {
    std::vector<Outline> borders;  // in the order of `outlines`
    cv::findContours(mask, borders, cv::RETR_LIST, cv::CHAIN_APPROX_SIMPLE);
    for (const Outline& border : borders)
      holes.push_back(cv::contourArea(border, true) > 0.0);
  }

  /// Indices of those of at least `min_area`, the largest first, `max_count` at most.
  std::vector<int> largest(double min_area, int max_count) const
  {
    std::vector<int> indices(outlines.size());
    std::iota(indices.begin(), indices.end(), 0);
    const auto area = [this](int i) { return areas[static_cast<std::size_t>(i)]; };
    const auto is_small = [&](int i) { return area(i) < min_area || outlines[static_cast<std::size_t>(i)].empty(); };
    indices.erase(std::remove_if(indices.begin(), indices.end(), is_small), indices.end());
    std::stable_sort(indices.begin(), indices.end(), [&](int a, int b) { return area(a) > area(b); });
    indices.resize(std::min(indices.size(), static_cast<std::size_t>(max_count)));
    return indices;
  }

  int parent(int index) const { return hierarchy[static_cast<std::size_t>(index)][3]; }

  std::vector<Outline> outlines;
  std::vector<cv::Vec4i> hierarchy;  // of each its next, previous, first child and parent; -1: there is none
  std::vector<double> areas;         // px^2
  std::vector<bool> holes;           // of mode list only, where the hierarchy does not tell
};

}  // namespace

void validate(const ContourParams& params)
{
  checkFields(params);
  require(params.canny_low <= params.canny_high, "canny_high", params.canny_high,
          "at least canny_low, " + toText(params.canny_low));
}

struct ContourFinder::Impl
{
  explicit Impl(const ContourParams& p, const cv::Mat& template_bgr) : params(p), edge_detector(edgeParams(p))
  {
    if (template_bgr.empty()) return;
    const FoundContours found(maskOf(template_bgr, "bgr8"), "external", params);
    const std::vector<int> largest = found.largest(std::numeric_limits<double>::min(), 1);
    if (largest.empty())
      throw std::invalid_argument(
          "the template has no contour with an area, must show a shape that these parameters make white on black");
    pattern = found.outlines[static_cast<std::size_t>(largest[0])];
  }

  ContourResult apply(const cv::Mat& image, const std::string& encoding, const std::optional<cv::Point2d>& point)
  {
    ContourResult result;
    result.mask = maskOf(image, encoding);
    requireTime(result.mask, params);
    const FoundContours found(result.mask, params.mode, params);
    std::map<int, int> positions;  // in the result, by the index in `found`
    for (const int index : found.largest(params.min_area, params.max_contours))
    {
      positions[index] = static_cast<int>(result.contours.size());
      result.contours.push_back(measureContour(found.outlines[static_cast<std::size_t>(index)], params));
      Contour& contour = result.contours.back();
      compare(contour);
      if (point) contour.point_distance = cv::pointPolygonTest(contour.outline, cv::Point2f(*point), true);
    }
    for (const auto& [index, position] : positions)
      setPlace(index, found, positions, result.contours[static_cast<std::size_t>(position)]);
    return result;
  }

  cv::Mat maskOf(const cv::Mat& image, const std::string& encoding)
  {
    const cv::Mat gray = buffer.gray(image, encoding);
    // Not a part of a larger matrix, whose other pixels OpenCV's filters would read.
    const cv::Mat whole(gray.size(), gray.type(), gray.data, gray.step);
    if (params.blur_size > 1) cv::GaussianBlur(whole, blurred, {params.blur_size, params.blur_size}, 0.0);
    const cv::Mat& smooth = params.blur_size > 1 ? blurred : whole;
    cv::Mat mask;
    if (params.method == "canny")
      edge_detector.apply(smooth, "mono8", mask);
    else if (params.method == "fixed" || params.method == "otsu")
      cv::threshold(smooth, mask, params.threshold, 255.0,
                    cv::THRESH_BINARY | (params.method == "otsu" ? cv::THRESH_OTSU : 0));
    else
      cv::adaptiveThreshold(
          smooth, mask, 255.0,
          params.method == "adaptive_mean" ? cv::ADAPTIVE_THRESH_MEAN_C : cv::ADAPTIVE_THRESH_GAUSSIAN_C,
          cv::THRESH_BINARY, params.block_size, params.offset);
    if (params.invert) cv::bitwise_not(mask, mask);
    return mask;
  }

  void compare(Contour& contour) const
  {
    if (pattern.empty()) return;
    const double distance = cv::matchShapes(contour.outline, pattern, kMatchMethods.at(params.match_method), 0.0);
    const bool comparable = distance < std::numeric_limits<double>::max();
    contour.match = comparable ? distance : std::numeric_limits<double>::infinity();
    contour.matches = distance <= params.max_distance;
  }

  /// Fills in where a contour is in the hierarchy, and whether it is a hole.
  static void setPlace(int index, const FoundContours& found, const std::map<int, int>& positions, Contour& contour)
  {
    for (int parent = found.parent(index); parent >= 0; parent = found.parent(parent))
    {
      const auto taken = positions.find(parent);
      if (contour.parent < 0 && taken != positions.end()) contour.parent = taken->second;
      ++contour.depth;
    }
    contour.hole = found.holes.empty() ? contour.depth % 2 == 1 : found.holes[static_cast<std::size_t>(index)];
  }

  static EdgeParams edgeParams(const ContourParams& params)
  {
    EdgeParams edges;
    edges.blur_size = 1;
    edges.low_threshold = params.canny_low;
    edges.high_threshold = params.canny_high;
    return edges;
  }

  ContourParams params;
  ConversionBuffer buffer;
  EdgeDetector edge_detector;
  cv::Mat blurred;
  Outline pattern;  // of the template; empty: there is none
};

ContourFinder::ContourFinder(const ContourParams& params, const cv::Mat& template_bgr)
{
  validate(params);
  impl_ = std::make_unique<Impl>(params, template_bgr);
}

ContourFinder::ContourFinder(ContourFinder&&) = default;
ContourFinder& ContourFinder::operator=(ContourFinder&&) = default;
ContourFinder::~ContourFinder() = default;

ContourResult ContourFinder::apply(const cv::Mat& image, const std::string& encoding,
                                   const std::optional<cv::Point2d>& point)
{
  return impl_->apply(image, encoding, point);
}

}  // namespace robot_vision
