#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/features/keypoints.hpp"

namespace robot_vision
{

class KeypointFlow;

struct MatchParams
{
  std::string match = "none";
  std::string matcher = "brute_force";
  double ratio = 0.75;
  bool cross_check = false;
  int flow_window = 15;
  int flow_levels = 3;
  double flow_max_error = 1.0;
  std::string homography = "ransac";
  double ransac_threshold = 3.0;
  int min_inliers = 10;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("match", &MatchParams::match, OneOf{"none, reference or last_frame"}, "", "what keypoints are compared with");
    visit("matcher", &MatchParams::matcher, OneOf{"brute_force, flann or flow"}, "",
          "how the nearest descriptor is found, or the points of the last frame by their optical flow");
    visit("ratio", &MatchParams::ratio, Above{0, 1}, "",
          "brute_force, flann: largest distance of a match, as a share of that of the second nearest; 1: any");
    visit("cross_check", &MatchParams::cross_check, Anything{}, "",
          "brute_force: only matches that are the nearest of each other");
    visit("flow_window", &MatchParams::flow_window, OddRange{5, 51}, "px",
          "flow: side of the window around a point that is followed");
    visit("flow_levels", &MatchParams::flow_levels, Range{0, 6}, "", "flow: halvings of the image, for fast motion");
    visit("flow_max_error", &MatchParams::flow_max_error, Range{0.1, 10}, "px",
          "flow: by which a point that is followed there and back may miss itself");
    visit("homography", &MatchParams::homography, OneOf{"ransac, rho or lmeds"}, "",
          "how the homography of most matches is found");
    visit("ransac_threshold", &MatchParams::ransac_threshold, Range{0.1, 50}, "px",
          "ransac, rho: from where the homography has an inlier");
    visit("min_inliers", &MatchParams::min_inliers, Range{4, 1000}, "",
          "fewest places with an inlier, or there is no homography");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and its range, and for the matcher
/// by flow with a reference, which is no frame before.
void validate(const MatchParams& params);

/// Where a reference is in an image.
struct ReferencePose
{
  cv::Matx33d homography;              // of px of the reference to px of the image, its last element 1
  std::array<cv::Point2d, 4> outline;  // px: what is the reference's top left, top right, bottom right, bottom left
  cv::Point2d center;                  // px, of its middle
};

/// Points of a reference, each with the point of the image that looks most like it, or by flow with where it has moved
/// to. The most alike come first.
struct KeypointMatches
{
  std::vector<cv::Point2f> from;      // px, in the reference
  std::vector<cv::Point2f> to;        // px, in the image
  std::vector<float> distances;       // of the descriptors: bits that differ, of sift Euclidean; by flow: px
  std::vector<uchar> inliers;         // 1 for those that agree with the pose; all 0 if there is none
  std::optional<ReferencePose> pose;  // none if too few agree on one
};

/// Matches descriptors as cv::BFMatcher or cv::FlannBasedMatcher do (LSH for bits, KD-trees for floats), then by the
/// ratio of the distances to the nearest and the second nearest (Lowe, 2004). The same descriptors always give the same
/// matches: FLANN's random numbers have a fixed seed. Throws std::invalid_argument as validate() does, and for the
/// matcher by flow, which compares no descriptors.
KeypointMatches matchKeypoints(const Keypoints& reference, const Keypoints& image, const MatchParams& params);

/// Finds the pose of a reference of a size (px) by cv::findHomography, and the inliers; the homography of ransac and
/// rho is fitted again to all matches that agree with it. There is none if the inliers are in fewer than min_inliers
/// places of 4x4 px, in the reference or in the image, or if what the homography makes of the reference cannot be the
/// view of a flat thing from its front: if it is not convex, mirrored, seen at a grazing angle, or very much smaller or
/// larger than the image.
void findPose(const cv::Size& reference, const cv::Size& image, const MatchParams& params, KeypointMatches& matches);

/// What a KeypointMatcher finds in a frame.
struct MatchedFrame
{
  Keypoints keypoints;
  KeypointMatches matches;
};

/// Finds keypoints in frames, and matches them with those of a reference or of the frame before.
///
/// With the matcher by flow the keypoints of the frame before are followed into this one by pyramidal Lucas-Kanade
/// flow, there and back (Kalal et al.: Forward-Backward Error, 2010). Those that miss themselves by more than
/// flow_max_error px, and those that leave the image, match nothing; the distance of the others is by how much they
/// miss themselves. There are no descriptors then.
///
/// Not thread-safe.
class KeypointMatcher
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit KeypointMatcher(const KeypointParams& keypoints = KeypointParams(),
                           const MatchParams& params = MatchParams());
  ~KeypointMatcher();
  KeypointMatcher(KeypointMatcher&&);
  KeypointMatcher& operator=(KeypointMatcher&&);

  /// Sets the reference, whose keypoints are found and described here once. One with a side of more than 1280 px is
  /// made smaller for it; positions are always those of `image`. Throws std::invalid_argument if it has too few
  /// keypoints, and if `image` is not of `encoding`.
  void setReference(const cv::Mat& image, const std::string& encoding);

  /// Finds the keypoints of a frame, and their matches as `match` says, if `matches` is true. There are none without a
  /// reference, in the first frame, and in one of another size than the last. `image` is not modified. Throws
  /// std::invalid_argument if it is not of `encoding` (see encoding.hpp).
  MatchedFrame update(const cv::Mat& image, const std::string& encoding, bool matches = true);

  /// Forgets the last frame.
  void reset();

private:
  struct View
  {
    Keypoints keypoints;  // `described` in px of the full image, `all` of the one that was searched
    cv::Size size;        // px, of the full image; empty: there is none
  };

  KeypointParams keypoint_params_;
  MatchParams params_;
  View reference_;
  View last_;
  std::unique_ptr<KeypointFlow> flow_;  // null unless it matches
};

}  // namespace robot_vision
