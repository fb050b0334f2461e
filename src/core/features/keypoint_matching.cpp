#include "robot_vision/features/keypoint_matching.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <utility>

#include "core/common/random_state.hpp"
#include "core/image/rects.hpp"
#include "keypoint_flow.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxReferenceSide = 1280;  // px; more details are never seen in a frame
constexpr int kSeed = 0x5EED;

// FLANN's parameters of OpenCV's tutorials.
constexpr int kLshTables = 6, kLshKeySize = 12, kLshProbes = 1;
constexpr int kTrees = 5, kChecks = 50;

int normOf(const cv::Mat& descriptors)
{
  return descriptors.depth() == CV_32F ? cv::NORM_L2 : cv::NORM_HAMMING;
}

/// The nearest two of `image` for each row of `reference`; there may be fewer.
std::vector<std::vector<cv::DMatch>> nearestTwo(const cv::Mat& reference, const cv::Mat& image, bool flann)
{
  std::vector<std::vector<cv::DMatch>> nearest;
  if (!flann)
  {
    cv::BFMatcher(normOf(reference)).knnMatch(reference, image, nearest, 2);
    return nearest;
  }
  const RandomState seeded(kSeed);
  cv::Ptr<cv::flann::IndexParams> index;
  if (reference.depth() == CV_32F)
    index = cv::makePtr<cv::flann::KDTreeIndexParams>(kTrees);
  else
    index = cv::makePtr<cv::flann::LshIndexParams>(kLshTables, kLshKeySize, kLshProbes);
  cv::FlannBasedMatcher matcher(index, cv::makePtr<cv::flann::SearchParams>(kChecks));
  matcher.knnMatch(reference, image, nearest, 2);
  return nearest;
}

bool passes(const std::vector<cv::DMatch>& nearest, double ratio)
{
  if (nearest.empty()) return false;
  if (ratio >= 1.0) return true;
  return nearest.size() > 1 && nearest[0].distance < ratio * nearest[1].distance;
}

/// Pairs of rows that cv::BFMatcher's cross check lets through.
std::set<std::pair<int, int>> crossChecked(const cv::Mat& reference, const cv::Mat& image)
{
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(normOf(reference), true).match(reference, image, matches);
  std::set<std::pair<int, int>> pairs;
  for (const cv::DMatch& match : matches)
    pairs.emplace(match.queryIdx, match.trainIdx);
  return pairs;
}

/// Positions in an image that was made smaller, as those in the image itself.
void enlarge(std::vector<cv::Point2f>& points, const cv::Point2d& factor)
{
  for (cv::Point2f& p : points)
    p = cv::Point2d((p.x + 0.5) * factor.x - 0.5, (p.y + 0.5) * factor.y - 0.5);
}

}  // namespace

void validate(const MatchParams& params)
{
  checkFields(params);
  require(params.matcher != "flow" || params.match != "reference", "matcher", params.matcher,
          "brute_force or flann if match is reference");
}

KeypointMatches matchKeypoints(const Keypoints& reference, const Keypoints& image, const MatchParams& params)
{
  validate(params);
  require(params.matcher != "flow", "matcher", params.matcher, "brute_force or flann to compare descriptors");
  KeypointMatches found;
  const cv::Mat &of_reference = reference.descriptors, &of_image = image.descriptors;
  if (of_reference.empty() || of_image.rows < 2) return found;
  require(of_reference.type() == of_image.type() && of_reference.cols == of_image.cols, "the descriptors' kind",
          describePixels(of_image.type()), "the reference's, " + describePixels(of_reference.type()));
  const bool flann = params.matcher == "flann", both = params.cross_check && !flann;
  std::set<std::pair<int, int>> mutual;
  if (both) mutual = crossChecked(of_reference, of_image);
  std::vector<cv::DMatch> matches;
  for (const std::vector<cv::DMatch>& nearest : nearestTwo(of_reference, of_image, flann))
  {
    if (!passes(nearest, params.ratio)) continue;
    if (!both || mutual.count({nearest[0].queryIdx, nearest[0].trainIdx}) > 0) matches.push_back(nearest[0]);
  }
  std::stable_sort(matches.begin(), matches.end());  // by distance: cv::RHO tries the first ones first
  for (const cv::DMatch& match : matches)
  {
    found.from.push_back(reference.described[static_cast<std::size_t>(match.queryIdx)]);
    found.to.push_back(image.described[static_cast<std::size_t>(match.trainIdx)]);
    found.distances.push_back(match.distance);
  }
  found.inliers.resize(found.from.size());
  return found;
}

KeypointMatcher::KeypointMatcher(const KeypointParams& keypoints, const MatchParams& params)
  : keypoint_params_(keypoints), params_(params)
{
  validate(keypoints);
  validate(params);
  const FlowParams flow{params.flow_window, params.flow_levels, params.flow_max_error};
  if (params.match == "last_frame" && params.matcher == "flow") flow_ = std::make_unique<KeypointFlow>(flow);
}

KeypointMatcher::~KeypointMatcher() = default;
KeypointMatcher::KeypointMatcher(KeypointMatcher&&) = default;
KeypointMatcher& KeypointMatcher::operator=(KeypointMatcher&&) = default;

void KeypointMatcher::setReference(const cv::Mat& image, const std::string& encoding)
{
  cv::Mat gray;
  toGray(image, encoding, gray);
  const cv::Size size = gray.size();
  const double scale = static_cast<double>(kMaxReferenceSide) / std::max(size.width, size.height);
  if (scale < 1.0)
  {
    cv::Mat reduced;  // not in place: `gray` may be the image itself
    cv::resize(gray, reduced, scaledSize(size, scale), 0.0, 0.0, cv::INTER_AREA);
    gray = reduced;
  }
  View view{findKeypoints(gray, "mono8", keypoint_params_, true), size};
  const int described = static_cast<int>(view.keypoints.described.size());
  require(described >= params_.min_inliers, "the reference's number of described keypoints", described,
          "at least min_inliers, " + toText(params_.min_inliers));
  const cv::Point2d factor(static_cast<double>(size.width) / gray.cols, static_cast<double>(size.height) / gray.rows);
  if (scale < 1.0) enlarge(view.keypoints.described, factor);
  reference_ = std::move(view);
}

MatchedFrame KeypointMatcher::update(const cv::Mat& image, const std::string& encoding, bool matches)
{
  const bool wanted = matches && params_.match != "none", of_last = params_.match == "last_frame";
  cv::Mat gray;
  toGray(image, encoding, gray);
  MatchedFrame frame;
  frame.keypoints = findKeypoints(gray, "mono8", keypoint_params_, wanted && !flow_);
  if (wanted && flow_) flow_->add(gray);
  const View& reference = of_last ? last_ : reference_;
  if (wanted && !reference.size.empty() && (!of_last || reference.size == gray.size()))
  {
    frame.matches =
        flow_ ? flow_->follow(reference.keypoints.all) : matchKeypoints(reference.keypoints, frame.keypoints, params_);
    findPose(reference.size, gray.size(), params_, frame.matches);
  }
  last_ = wanted && of_last ? View{frame.keypoints, gray.size()} : View{};
  return frame;
}

void KeypointMatcher::reset()
{
  last_ = {};
}

}  // namespace robot_vision
