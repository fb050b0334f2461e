#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "robot_vision/features/keypoint_matching.hpp"

using namespace robot_vision;

namespace
{

const cv::Size kReference(200, 100), kImage(640, 480);

/// Matches of a grid of points of the reference, which a homography puts into the image.
KeypointMatches gridMatches(const cv::Matx33d& homography, int columns = 8, int rows = 5)
{
  KeypointMatches matches;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
    {
      const cv::Vec3d from(10.0 + 180.0 * column / (columns - 1), 10.0 + 80.0 * row / (rows - 1), 1.0);
      const cv::Vec3d to = homography * from;
      matches.from.emplace_back(static_cast<float>(from[0]), static_cast<float>(from[1]));
      matches.to.emplace_back(static_cast<float>(to[0] / to[2]), static_cast<float>(to[1] / to[2]));
      matches.distances.push_back(1.0F);
    }
  return matches;
}

KeypointMatches withPose(KeypointMatches matches, const std::string& method = "ransac", int min_inliers = 10)
{
  MatchParams params;
  params.homography = method;
  params.min_inliers = min_inliers;
  findPose(kReference, kImage, params, matches);
  return matches;
}

}  // namespace

TEST(FindPose, findsTheHomographyAndTheCorners)
{
  const cv::Matx33d truth(1.2, -0.3, 200, 0.2, 1.1, 90, 2e-4, -1e-4, 1);
  for (const char* method : {"ransac", "rho", "lmeds"})
  {
    const KeypointMatches matches = withPose(gridMatches(truth), method);
    ASSERT_TRUE(matches.pose) << method;
    EXPECT_EQ(cv::countNonZero(matches.inliers), 40) << method;
    EXPECT_LT(cv::norm(matches.pose->homography - truth, cv::NORM_INF), 1e-2) << method;
    const cv::Vec3d corner = truth * cv::Vec3d(199.5, -0.5, 1);
    EXPECT_NEAR(matches.pose->outline[1].x, corner[0] / corner[2], 0.02) << method;
    EXPECT_NEAR(matches.pose->outline[1].y, corner[1] / corner[2], 0.02) << method;
    const cv::Vec3d middle = truth * cv::Vec3d(99.5, 49.5, 1);
    EXPECT_NEAR(matches.pose->center.x, middle[0] / middle[2], 0.02) << method;
  }
}

TEST(FindPose, tellsInliersFromOthers)
{
  KeypointMatches matches = gridMatches(cv::Matx33d::eye());
  for (const std::size_t wrong : {3U, 17U, 30U})
    matches.to[wrong] += cv::Point2f(150, -80);
  matches = withPose(matches);
  ASSERT_TRUE(matches.pose);
  EXPECT_EQ(cv::countNonZero(matches.inliers), 37);
  EXPECT_FALSE(matches.inliers[3] || matches.inliers[17] || matches.inliers[30]);
}

TEST(FindPose, refusesWhatNoCameraSees)
{
  const std::vector<std::pair<std::string, cv::Matx33d>> impossible = {
      {"mirrored", {-1, 0, 300, 0, 1, 0, 0, 0, 1}},   {"tiny", {0.05, 0, 200, 0, 0.05, 200, 0, 0, 1}},
      {"a line", {1, 0, 100, 0, 0.05, 200, 0, 0, 1}}, {"huge", {50, 0, -4000, 0, 50, -2000, 0, 0, 1}},
      {"grazing", {1, 0, 100, 0, 1, 100, 0.1, 0, 1}}, {"folded", {1, 0, 100, 0, 1, 100, -1.0 / 195.0, 0, 1}},
  };
  for (const auto& [name, homography] : impossible)
  {
    const KeypointMatches matches = withPose(gridMatches(homography), "ransac", 4);
    EXPECT_FALSE(matches.pose) << name;
    EXPECT_EQ(cv::countNonZero(matches.inliers), 0) << name;
  }
}

TEST(FindPose, countsPlacesInsteadOfMatches)
{
  KeypointMatches matches = gridMatches(cv::Matx33d::eye(), 3, 3);  // 9 places
  for (int copies = 0; copies < 5; ++copies)
  {
    matches.from.insert(matches.from.end(), matches.from.begin(), matches.from.begin() + 9);
    matches.to.insert(matches.to.end(), matches.to.begin(), matches.to.begin() + 9);
  }
  EXPECT_TRUE(withPose(matches, "ransac", 9).pose);
  EXPECT_FALSE(withPose(matches, "ransac", 10).pose);
}

TEST(FindPose, takesWhatHasNoHomography)
{
  for (const char* method : {"ransac", "rho", "lmeds"})
  {
    EXPECT_FALSE(withPose({}, method).pose) << method;
    KeypointMatches same = gridMatches(cv::Matx33d::eye());
    same.to.assign(same.to.size(), {50, 50});
    EXPECT_FALSE(withPose(same, method, 4).pose) << method;
    KeypointMatches line = gridMatches(cv::Matx33d::eye());
    for (cv::Point2f& point : line.from)
      point.y = point.x / 2;
    EXPECT_FALSE(withPose(line, method, 4).pose) << method;
  }
}

TEST(FindPose, forgetsTheLastPose)
{
  KeypointMatches matches = withPose(gridMatches(cv::Matx33d::eye()));
  ASSERT_TRUE(matches.pose);
  matches.to.assign(matches.to.size(), {50, 50});
  EXPECT_FALSE(withPose(matches).pose);
}
