#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <set>
#include <utility>

#include "robot_vision/features/keypoint_matching.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxRefits = 5;
constexpr double kPlaceSide = 4.0;      // px; keypoints of several levels of a pyramid are often in one place
constexpr double kMinSide = 8.0;        // px, of the reference in the image
constexpr double kMaxSideRatio = 10.0;  // longest side of the reference in the image, of the image's diagonal
constexpr double kMinDepthRatio = 0.1;  // of the nearest corner of the reference, of the farthest

int methodOf(const std::string& name)
{
  if (name == "rho") return cv::RHO;
  return name == "lmeds" ? cv::LMEDS : cv::RANSAC;
}

/// Fits the homography again to all matches that agree with it, until these stay the same: those of ransac and rho
/// agree with the one of four points only.
void refit(const KeypointMatches& matches, double threshold, cv::Mat& fit, std::vector<uchar>& inliers)
{
  for (int round = 0; round < kMaxRefits; ++round)
  {
    std::vector<cv::Point2f> mapped, from, to;
    cv::perspectiveTransform(matches.from, mapped, fit);
    std::vector<uchar> agree(mapped.size());
    for (std::size_t i = 0; i < mapped.size(); ++i)
    {
      if (!(cv::norm(mapped[i] - matches.to[i]) <= threshold)) continue;
      agree[i] = 1;
      from.push_back(matches.from[i]);
      to.push_back(matches.to[i]);
    }
    if (agree == inliers || from.size() < 4) return;
    const cv::Mat better = cv::findHomography(from, to);
    if (better.empty()) return;
    fit = better;
    inliers = agree;
  }
}

/// The number of places that the points with a mask are in.
int countPlaces(const std::vector<cv::Point2f>& points, const std::vector<uchar>& mask)
{
  std::set<std::pair<int, int>> places;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (mask[i]) places.emplace(cvFloor(points[i].x / kPlaceSide), cvFloor(points[i].y / kPlaceSide));
  return static_cast<int>(places.size());
}

/// Where the outer corners of an image and its middle come to lie, and how deep the corners are: the third of their
/// homogeneous coordinates.
ReferencePose poseOf(const cv::Matx33d& homography, const cv::Size& size, std::array<double, 4>& depths)
{
  const double right = size.width - 0.5, bottom = size.height - 0.5;
  const std::array<cv::Vec3d, 4> corners = {cv::Vec3d(-0.5, -0.5, 1), cv::Vec3d(right, -0.5, 1),
                                            cv::Vec3d(right, bottom, 1), cv::Vec3d(-0.5, bottom, 1)};
  ReferencePose pose{homography, {}, {}};
  for (std::size_t i = 0; i < corners.size(); ++i)
  {
    const cv::Vec3d mapped = homography * corners[i];
    pose.outline[i] = {mapped[0] / mapped[2], mapped[1] / mapped[2]};
    depths[i] = mapped[2];
  }
  const cv::Vec3d middle = homography * cv::Vec3d((size.width - 1) / 2.0, (size.height - 1) / 2.0, 1);
  pose.center = {middle[0] / middle[2], middle[1] / middle[2]};
  return pose;
}

/// Whether corners and their depths can be those of a flat thing that is seen from its front.
bool isView(const std::array<cv::Point2d, 4>& outline, const std::array<double, 4>& depths, const cv::Size& image)
{
  const auto [nearest, farthest] = std::minmax_element(depths.begin(), depths.end());
  if (!(*nearest > 0.0 && *nearest > kMinDepthRatio * *farthest)) return false;  // nor is NaN
  const double max_side = kMaxSideRatio * std::hypot(image.width, image.height);
  for (std::size_t i = 0; i < outline.size(); ++i)
  {
    const cv::Point2d side = outline[(i + 1) % 4] - outline[i], next = outline[(i + 2) % 4] - outline[(i + 1) % 4];
    const double length = std::hypot(side.x, side.y);
    if (!(length >= kMinSide && length <= max_side && side.cross(next) > 0.0)) return false;
  }
  return true;
}

}  // namespace

void findPose(const cv::Size& reference, const cv::Size& image, const MatchParams& params, KeypointMatches& matches)
{
  matches.pose.reset();
  matches.inliers.assign(matches.from.size(), 0);
  if (static_cast<int>(matches.from.size()) < params.min_inliers) return;
  std::vector<uchar> inliers;
  cv::Mat fit =
      cv::findHomography(matches.from, matches.to, inliers, methodOf(params.homography), params.ransac_threshold);
  if (fit.empty() || inliers.size() != matches.from.size()) return;
  if (params.homography != "lmeds") refit(matches, params.ransac_threshold, fit, inliers);
  if (std::min(countPlaces(matches.from, inliers), countPlaces(matches.to, inliers)) < params.min_inliers) return;
  std::array<double, 4> depths = {};
  const ReferencePose pose = poseOf(fit, reference, depths);
  if (!isView(pose.outline, depths, image)) return;
  matches.pose = pose;
  matches.inliers = inliers;
}

}  // namespace robot_vision
