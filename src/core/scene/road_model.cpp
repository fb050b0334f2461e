#include "road_model.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "robot_vision/scene/scene.hpp"
#include "scene_model.hpp"

namespace robot_vision::scene
{
namespace
{

const double kStraight = 1.5;                               // m, each of the two
const double kHalfCircle = CV_PI * kSceneRoadRadius;        // m
const double kRoundTrip = 2.0 * (kStraight + kHalfCircle);  // m
const double kTexel = 0.005;                                // m
const double kAround = 0.6;                                 // m, from the lane's middle to the edge of the image
const double kHalfRoad = 0.45;                              // m, from the lane's middle to the grass
const int kDashes = 78;                                     // in a round trip: 0.1 m each, and gaps as long
const double kSway = 0.05, kSwaysPerTrip = 3.0;             // m, of the robot to both sides
const double kNear = 0.25, kFar = 1.2;                      // m, of the lane in the truth
const int kLanePoints = 16;                                 // of each side of it
const double kGrain = 3.0;                                  // gray levels
const cv::Vec3f kAsphalt(108.0F, 106.0F, 104.0F), kWhite(232.0F, 234.0F, 235.0F), kYellow(40.0F, 190.0F, 225.0F);

/// A place on the floor with respect to the lane: how far to the left of its middle, and how far along it.
cv::Vec2d besideLane(double x, double y)
{
  const double half = kStraight / 2.0;
  if (std::abs(x) <= half)
    return y < 0.0 ? cv::Vec2d(y + kSceneRoadRadius, x + half)
                   : cv::Vec2d(kSceneRoadRadius - y, kStraight + kHalfCircle + half - x);
  const double side = std::copysign(1.0, x), from = x - side * half;
  const double turned = std::atan2(side * from, -side * y);
  const double begin = x > 0.0 ? kStraight : kRoundTrip - kHalfCircle;
  return {kSceneRoadRadius - std::hypot(from, y), begin + turned * kSceneRoadRadius};
}

/// The share of a texel that a line covers whose middle is so far away, m.
float covered(double away)
{
  return static_cast<float>(std::clamp(0.5 + (kSceneRoadLine / 2.0 - std::abs(away)) / kTexel, 0.0, 1.0));
}

}  // namespace

cv::Size2d roadSize()
{
  const double outer = 2.0 * (kSceneRoadRadius + kAround);
  return {outer, outer + kStraight};  // its width goes to the left
}

cv::Mat roadImage()
{
  const cv::Size2d metres = roadSize();
  const cv::Size size(cvRound(metres.width / kTexel), cvRound(metres.height / kTexel));
  cv::Mat grain(size, CV_32FC1);
  cv::RNG(1).fill(grain, cv::RNG::NORMAL, 0.0, kGrain);
  cv::Mat image(size, CV_8UC3);
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column)
    {
      const double x = metres.height / 2.0 - (row + 0.5) * kTexel, y = metres.width / 2.0 - (column + 0.5) * kTexel;
      const cv::Vec2d place = besideLane(x, y);
      cv::Vec3f color = kAsphalt;
      if (std::abs(place[0]) > kHalfRoad)
        color = cv::Vec3f(static_cast<float>(kGrass[0]), static_cast<float>(kGrass[1]), static_cast<float>(kGrass[2]));
      const bool dash = std::fmod(place[1] * kDashes / kRoundTrip, 1.0) < 0.5;
      color += (dash ? covered(place[0] - kSceneLaneWidth / 2.0) : 0.0F) * (kYellow - color);
      color += covered(place[0] + kSceneLaneWidth / 2.0) * (kWhite - color);
      image.at<cv::Vec3b>(row, column) = color + cv::Vec3f::all(grain.at<float>(row, column));
    }
  return image;
}

cv::Affine3d laneFrame(double along)
{
  along = std::fmod(along, kRoundTrip);
  const bool back = along >= kRoundTrip / 2.0;  // the second half is the first one, turned by half a turn
  if (back) along -= kRoundTrip / 2.0;
  const double angle = std::max(along - kStraight, 0.0) / kSceneRoadRadius;
  const cv::Vec3d place(std::min(along, kStraight) - kStraight / 2.0 + kSceneRoadRadius * std::sin(angle),
                        -kSceneRoadRadius * std::cos(angle), 0.0);
  return cv::Affine3d(cv::Vec3d(0.0, 0.0, back ? CV_PI : 0.0)) * cv::Affine3d(cv::Vec3d(0.0, 0.0, angle), place);
}

RoadPlace roadPlace(double seconds)
{
  const double along = kRoundTrip * seconds / kScenePeriod;
  const double per_metre = 2.0 * CV_PI * kSwaysPerTrip / kRoundTrip, phase = per_metre * along;
  const double heading = std::atan(kSway * per_metre * std::cos(phase));
  const cv::Affine3d lane = laneFrame(along);
  const cv::Affine3d in_lane(cv::Vec3d(0.0, 0.0, heading), cv::Vec3d(0.0, kSway * std::sin(phase), 0.0));
  return {lane * in_lane, lane, along};
}

cv::Affine3d mountedCamera(const cv::Affine3d& robot)
{
  const double sine = std::sin(kSceneCameraPitch), cosine = std::cos(kSceneCameraPitch);
  const cv::Matx33d axes(0.0, -sine, cosine, -1.0, 0.0, 0.0, 0.0, -cosine, -sine);  // right, down and ahead
  return robot * cv::Affine3d(axes, cv::Vec3d(0.0, 0.0, kSceneCameraHeight));
}

Polygon3 laneAhead(double along)
{
  Polygon3 outline;
  for (const double side : {-0.5, 0.5})  // out on the right, and back on the left
    for (int i = 0; i < kLanePoints; ++i)
    {
      const double part = static_cast<double>(side < 0.0 ? i : kLanePoints - 1 - i) / (kLanePoints - 1);
      outline.push_back(laneFrame(along + kNear + part * (kFar - kNear)) *
                        cv::Point3d(0.0, side * kSceneLaneWidth, 0.0));
    }
  return outline;
}

}  // namespace robot_vision::scene
