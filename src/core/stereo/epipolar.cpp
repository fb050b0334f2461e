#include "robot_vision/stereo/epipolar.hpp"

#include <cmath>
#include <numeric>
#include <opencv2/calib3d.hpp>
#include <utility>

#include "core/common/in_this_thread.hpp"
#include "epipolar_limits.hpp"
#include "robot_vision/features/keypoint_matching.hpp"

namespace robot_vision
{
namespace
{

constexpr double kConfidence = 0.999;  // of RANSAC
constexpr int kMinInliers = 15;        // a matrix of eight numbers fits any few matches

}  // namespace

PairMatches matchPair(const cv::Mat& left, const cv::Mat& right, const std::string& encoding, int features)
{
  KeypointParams keypoints;
  keypoints.detector = "orb";
  keypoints.max_features = features;
  MatchParams params;
  params.cross_check = true;
  KeypointMatches found;
  inThisThread(
      [&]
      {
        const Keypoints of_left = findKeypoints(left, encoding, keypoints, true);
        found = matchKeypoints(of_left, findKeypoints(right, encoding, keypoints, true), params);
      });
  return {std::move(found.from), std::move(found.to)};
}

cv::Matx33d rectifiedFundamental()
{
  return {0, 0, 0, 0, 0, -1, 0, 1, 0};
}

std::optional<FundamentalMatrix> findFundamental(const PairMatches& matches)
{
  if (matches.left.size() < kMinInliers) return std::nullopt;
  FundamentalMatrix found;
  const cv::Mat F = cv::findFundamentalMat(matches.left, matches.right, cv::FM_RANSAC, kMaxEpipolarDistance,
                                           kConfidence, found.inliers);
  if (F.rows != 3 || F.cols != 3 || found.inliers.size() != matches.left.size()) return std::nullopt;
  if (std::accumulate(found.inliers.begin(), found.inliers.end(), 0) < kMinInliers) return std::nullopt;
  found.F = cv::Matx33d(F.ptr<double>());
  return found;
}

std::vector<double> epipolarDistances(const PairMatches& matches, const cv::Matx33d& F)
{
  std::vector<double> distances;
  for (std::size_t i = 0; i < matches.left.size(); ++i)
  {
    const cv::Vec3d line = F * cv::Vec3d(matches.left[i].x, matches.left[i].y, 1.0);
    const double side = line.dot(cv::Vec3d(matches.right[i].x, matches.right[i].y, 1.0));
    const double length = std::hypot(line[0], line[1]);
    // The point at the epipole has no line: everything is on it.
    distances.push_back(length == 0.0 ? 0.0 : std::abs(side) / length);
  }
  return distances;
}

}  // namespace robot_vision
