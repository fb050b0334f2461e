#include "robot_vision/scene/depth_noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

const double kFocal = 504.0;  // px
const double kKinectBaseline = 0.075, kStereoBaseline = 0.05;
const DepthSensor kNoisy[] = {DepthSensor::kKinect, DepthSensor::kStereo, DepthSensor::kTof};

CameraModel depthCamera(int width = 640, int height = 480, double focal = kFocal)
{
  CameraModel camera;
  camera.width = width;
  camera.height = height;
  camera.K = {focal, 0, (width - 1) / 2.0, 0, focal, (height - 1) / 2.0, 0, 0, 1};
  return camera;
}

/// Enough pixels for most shares and deviations.
const CameraModel kSmall = depthCamera(320, 240);

cv::Mat filled(double z, const CameraModel& camera = depthCamera())
{
  return cv::Mat(camera.height, camera.width, CV_32FC1, cv::Scalar(z));
}

/// A plane at a distance z (m), whose 1/z changes by `change` (1/m) from the left border to the right one, so that its
/// disparities are between the steps everywhere.
cv::Mat turnedPlane(const CameraModel& camera, double z, double change)
{
  cv::Mat depth(camera.height, camera.width, CV_32FC1);
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x)
      depth.at<float>(y, x) = static_cast<float>(1.0 / (1.0 / z + change * ((x + 0.5) / depth.cols - 0.5)));
  return depth;
}

cv::Mat measured(const DepthNoise& noise, const cv::Mat& exact, std::int64_t frame = 0, const cv::Mat& light = {})
{
  cv::Mat noisy;
  noise.apply(frame, exact, light, noisy);
  return noisy;
}

/// By a camera of the image's size.
cv::Mat measured(DepthSensor sensor, const cv::Mat& exact, const cv::Mat& light = {})
{
  return measured(DepthNoise(sensor, depthCamera(exact.cols, exact.rows), 1), exact, 0, light);
}

/// The errors of what is measured of a plane, each divided by the deviation that is expected there.
cv::Mat relativeErrors(const cv::Mat& noisy, const cv::Mat& exact, const std::function<double(double)>& deviation)
{
  std::vector<double> errors;
  for (int y = 0; y < exact.rows; ++y)
    for (int x = 0; x < exact.cols; ++x)
    {
      const double z = exact.at<float>(y, x), error = noisy.at<float>(y, x) - z;
      if (!std::isnan(error)) errors.push_back(error / deviation(z));
    }
  return cv::Mat(errors, true);
}

void expectUnitNormal(const cv::Mat& errors, const std::string& what)
{
  cv::Scalar mean, deviation;
  cv::meanStdDev(errors, mean, deviation);
  EXPECT_NEAR(mean[0], 0.0, 0.05) << what;
  EXPECT_NEAR(deviation[0], 1.0, 0.03) << what;
}

double kinectDeviation(double z)
{
  return 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
}

double correlation(const cv::Mat& a, const cv::Mat& b)
{
  return a.dot(b) / (cv::norm(a) * cv::norm(b));
}

/// 255 where the depth is NaN. OpenCV's == is false there; its != is true with some instruction sets only.
cv::Mat nothingIn(const cv::Mat& depth)
{
  return ~(depth == depth);
}

/// The share of NaN.
double lost(const cv::Mat& depth)
{
  return cv::countNonZero(nothingIn(depth)) / static_cast<double>(depth.total());
}

bool sameBits(const cv::Mat& a, const cv::Mat& b)
{
  return a.size() == b.size() && a.type() == b.type() && a.isContinuous() && b.isContinuous() &&
         std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

/// A wall at 2 m, and before it at 1 m a square of this many pixels.
const cv::Rect kSquare(220, 140, 200, 200);
cv::Mat squareBeforeWall()
{
  cv::Mat depth = filled(2.0);
  depth(kSquare).setTo(1.0);
  return depth;
}

}  // namespace

TEST(DepthSensor, hasAName)
{
  EXPECT_EQ(depthSensor("none"), DepthSensor::kExact);
  EXPECT_EQ(depthSensor("kinect"), DepthSensor::kKinect);
  EXPECT_EQ(depthSensor("stereo"), DepthSensor::kStereo);
  EXPECT_EQ(depthSensor("tof"), DepthSensor::kTof);
  EXPECT_EQ(refusal([] { depthSensor("sonar"); }), "sensor is 'sonar', must be none, kinect, stereo or tof");
}

TEST(DepthNoise, ofAKinectHasTheDeviationThatNguyenMeasured)
{
  for (const double z : {0.8, 1.5, 3.0, 4.4})
  {
    const cv::Mat exact = turnedPlane(kSmall, z, 0.02);
    const cv::Mat noisy = measured(DepthSensor::kKinect, exact);
    EXPECT_EQ(lost(noisy), 0.0) << z;
    expectUnitNormal(relativeErrors(noisy, exact, kinectDeviation), std::to_string(z) + " m");
  }
}

TEST(DepthNoise, ofStereoHasTheDeviationOfATenthOfAPixel)
{
  for (const double z : {0.6, 2.0, 4.0})
  {
    const cv::Mat exact = turnedPlane(depthCamera(), z, 0.02);
    const auto deviation = [](double at) { return 0.1 * at * at / (kFocal * kStereoBaseline); };
    expectUnitNormal(relativeErrors(measured(DepthSensor::kStereo, exact), exact, deviation), std::to_string(z) + " m");
  }
}

TEST(DepthNoise, ofTofIsLargerOnDarkSurfaces)
{
  for (const double z : {0.8, 2.0, 4.0})
    for (const int brightness : {0, 64, 255})  // 0: it is not told, which means 128
    {
      const cv::Mat exact = turnedPlane(kSmall, z, 0.02);
      const cv::Mat light = brightness > 0 ? cv::Mat(exact.size(), CV_8UC1, cv::Scalar(brightness)) : cv::Mat();
      const auto deviation = [=](double at) { return 0.001 + 0.064 * at * at / (brightness > 0 ? brightness : 128); };
      const cv::Mat noisy = measured(DepthSensor::kTof, exact, light);
      EXPECT_EQ(lost(noisy), 0.0) << z;
      expectUnitNormal(relativeErrors(noisy, exact, deviation), std::to_string(z) + " m");
    }
}

TEST(DepthNoise, measuresDisparitiesInSteps)
{
  const cv::Mat exact = turnedPlane(depthCamera(), 1.5, 0.4);
  const auto expectSteps = [&](DepthSensor sensor, double baseline, double step)
  {
    const cv::Mat noisy = measured(sensor, exact);
    for (int x = 0; x < noisy.cols; ++x)
    {
      const double steps = kFocal * baseline / noisy.at<float>(240, x) / step;
      EXPECT_NEAR(steps, std::round(steps), 1e-3) << x;
    }
  };
  expectSteps(DepthSensor::kKinect, kKinectBaseline, 1.0 / 8.0);
  expectSteps(DepthSensor::kStereo, kStereoBaseline, 1.0 / 32.0);
}

TEST(DepthNoise, isNeverLessThanThatOfTheSteps)
{
  // With a quarter of the focal length the steps alone deviate by 15 mm at 2 m, where Nguyen's formula has 6 mm.
  const double focal = kFocal / 4.0, step = 1.0 / 8.0;
  const CameraModel camera = depthCamera(160, 120, focal);
  const cv::Mat exact = turnedPlane(camera, 2.0, 8.0 * step / (focal * kKinectBaseline));  // eight whole steps
  const cv::Mat noisy = measured(DepthNoise(DepthSensor::kKinect, camera, 1), exact);
  const auto deviation = [=](double z) { return z * z / (focal * kKinectBaseline) * step / std::sqrt(12.0); };
  EXPECT_GT(deviation(2.0), 2.0 * kinectDeviation(2.0));
  expectUnitNormal(relativeErrors(noisy, exact, deviation), "steps");
}

TEST(DepthNoise, isIndependentFromFrameToFrame)
{
  const cv::Mat exact = turnedPlane(depthCamera(), 2.0, 0.02);
  for (const DepthSensor sensor : kNoisy)
  {
    const DepthNoise noise(sensor, depthCamera(), 1);
    const cv::Mat first = measured(noise, exact, 0) - exact, second = measured(noise, exact, 1) - exact;
    // Blocks that are alike make that an image of fewer errors: its correlations deviate by 0.011.
    EXPECT_LT(std::abs(correlation(first, second)), sensor == DepthSensor::kStereo ? 0.05 : 0.02);
  }
}

TEST(DepthNoise, isIndependentFromPixelToPixelWithoutBlocks)
{
  const cv::Mat exact = turnedPlane(depthCamera(), 2.0, 0.02);
  for (const DepthSensor sensor : {DepthSensor::kKinect, DepthSensor::kTof})
  {
    const cv::Mat errors = measured(sensor, exact) - exact;
    EXPECT_LT(std::abs(correlation(errors.colRange(0, 639), errors.colRange(1, 640))), 0.05);
    EXPECT_LT(std::abs(correlation(errors.rowRange(0, 479), errors.rowRange(1, 480))), 0.02);
  }
}

TEST(DepthNoise, ofStereoIsAlikeWithinABlock)
{
  const int block = 5;  // px
  // Steps of 1/32 px deviate by 1/32 / sqrt(12) px, and independently: a 120th of the variance of 0.1 px.
  const double matched = 1.0 - 1.0 / (32.0 * 32.0 * 12.0 * 0.1 * 0.1);
  const cv::Mat exact = turnedPlane(depthCamera(), 2.0, 0.02);
  const cv::Mat errors = measured(DepthSensor::kStereo, exact) - exact;
  for (const cv::Point& apart : {cv::Point(1, 0), cv::Point(0, 1), cv::Point(3, 0), cv::Point(0, 4), cv::Point(2, 2),
                                 cv::Point(5, 0), cv::Point(0, 5), cv::Point(9, 9)})
  {
    const cv::Size size = errors.size() - cv::Size(apart);
    const double expected = matched * std::max(1.0 - apart.x / static_cast<double>(block), 0.0) *
                            std::max(1.0 - apart.y / static_cast<double>(block), 0.0);
    EXPECT_NEAR(correlation(errors(cv::Rect({0, 0}, size)), errors(cv::Rect(apart, size))), expected, 0.03) << apart;
  }
}

TEST(DepthNoise, hasShadowsAtTheLeftOfWhatIsNearer)
{
  const auto expectShadow = [](DepthSensor sensor, double baseline)
  {
    // The disparities of the square and the wall differ by so much.
    const int width = static_cast<int>(kFocal * baseline * (1.0 / 1.0 - 1.0 / 2.0));
    cv::Mat expected(480, 640, CV_8UC1, cv::Scalar(0));
    expected(cv::Rect(kSquare.x - width, kSquare.y, width, kSquare.height)).setTo(255);
    const cv::Mat noisy = measured(sensor, squareBeforeWall());
    EXPECT_EQ(cv::norm(nothingIn(noisy), expected, cv::NORM_INF), 0.0) << width;
  };
  expectShadow(DepthSensor::kKinect, kKinectBaseline);  // 18 px
  expectShadow(DepthSensor::kStereo, kStereoBaseline);  // 12 px
  EXPECT_EQ(lost(measured(DepthSensor::kTof, squareBeforeWall())), 0.0);
}

TEST(DepthNoise, hasFlyingPixelsAtEdgesOnly)
{
  cv::Mat square(480, 640, CV_8UC1, cv::Scalar(0)), inner, outer;
  square(kSquare).setTo(255);
  const cv::Mat cross = cv::getStructuringElement(cv::MORPH_CROSS, {3, 3});
  cv::erode(square, inner, cross);
  cv::dilate(square, outer, cross);
  const cv::Mat edge = outer - inner;
  // Half of them fly. Evenly mixed z is between 1.2 and 1.8 m in 0.6 of the cases, evenly mixed 1/z in 0.556.
  for (const auto& [sensor, share] : {std::pair(DepthSensor::kKinect, 0.0), std::pair(DepthSensor::kStereo, 0.278),
                                      std::pair(DepthSensor::kTof, 0.3)})
  {
    const cv::Mat noisy = measured(sensor, squareBeforeWall());
    const cv::Mat between = (noisy > 1.2) & (noisy < 1.8);
    EXPECT_EQ(cv::countNonZero(between & ~edge), 0);
    const double flying = cv::countNonZero(between) / static_cast<double>(cv::countNonZero(edge & (noisy == noisy)));
    EXPECT_NEAR(flying, share, 0.2 * share);
  }
}

TEST(DepthNoise, losesSurfacesAtAGrazingAngle)
{
  const double height = 0.4, full = std::cos(75.0 * CV_PI / 180.0), none = std::cos(87.0 * CV_PI / 180.0);
  const CameraModel camera = depthCamera();
  cv::Mat ground(480, 640, CV_32FC1, cv::Scalar(std::numeric_limits<double>::quiet_NaN()));
  cv::Mat expected(480, 640, CV_64FC1, cv::Scalar(-1.0));  // the share that is lost, where it is to be counted
  for (int y = 0; y < ground.rows; ++y)
    for (int x = 0; x < ground.cols; ++x)
    {
      const cv::Point2d ray = camera.ray(cv::Point2d(x, y));
      if (ray.y <= 0.0) continue;
      ground.at<float>(y, x) = static_cast<float>(height / ray.y);
      const double cosine = ray.y / std::sqrt(ray.dot(ray) + 1.0);
      if (ground.at<float>(y, x) > 0.7F && ground.at<float>(y, x) < 4.2F)  // in the range, whatever the noise
        expected.at<double>(y, x) = std::min(std::max((full - cosine) / (full - none), 0.0), 1.0);
    }
  const cv::Mat noisy = measured(DepthSensor::kTof, ground);
  const int bins = 5;
  std::vector<double> count(bins + 1), sum(bins + 1), lost_count(bins + 1);
  for (int y = 0; y < ground.rows; ++y)
    for (int x = 0; x < ground.cols; ++x)
    {
      const double share = expected.at<double>(y, x);
      if (share < 0.0) continue;
      const auto bin = static_cast<std::size_t>(std::ceil(share * bins));
      count[bin] += 1.0;
      sum[bin] += share;
      lost_count[bin] += std::isnan(noisy.at<float>(y, x));
    }
  EXPECT_GT(count[0], 10000.0);
  EXPECT_EQ(lost_count[0], 0.0);
  for (std::size_t bin = 1; bin < 5; ++bin)
  {
    EXPECT_GT(count[bin], 1000.0) << bin;
    EXPECT_NEAR(lost_count[bin] / count[bin], sum[bin] / count[bin], 0.05) << bin;
  }
}

TEST(DepthNoise, losesDarkSurfaces)
{
  const cv::Mat exact = filled(1.5, kSmall);
  for (const DepthSensor sensor : kNoisy)
    for (const auto& [brightness, share] :
         {std::pair(0, 1.0), std::pair(10, 0.75), std::pair(28, 0.3), std::pair(40, 0.0), std::pair(255, 0.0)})
      EXPECT_NEAR(lost(measured(sensor, exact, cv::Mat(exact.size(), CV_8UC1, cv::Scalar(brightness)))), share, 0.01)
          << brightness;
}

TEST(DepthNoise, hasNothingOutOfTheRange)
{
  const struct
  {
    DepthSensor sensor;
    double near, first, last, far;
  } ranges[] = {{DepthSensor::kKinect, 0.45, 0.55, 4.7, 5.4},
                {DepthSensor::kStereo, 0.25, 0.35, 8.0, 14.0},
                {DepthSensor::kTof, 0.45, 0.55, 4.4, 4.6}};
  for (const auto& range : ranges)
  {
    for (const double z : {range.near, range.far})
      EXPECT_EQ(lost(measured(range.sensor, filled(z, kSmall))), 1.0) << z;
    for (const double z : {range.first, range.last})
      EXPECT_LT(lost(measured(range.sensor, filled(z, kSmall))), 0.02) << z;
  }
}

TEST(DepthNoise, takesWhatIsNoDepthForNothing)
{
  const float wrong[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity(), -1.0F, 0.0F};
  cv::Mat exact = filled(1.5), expected(480, 640, CV_8UC1, cv::Scalar(0));
  for (int i = 0; i < 5; ++i)
    for (const cv::Rect& part : {cv::Rect(20 + 100 * i, 50, 1, 1), cv::Rect(20 + 100 * i, 100, 9, 9)})
    {
      exact(part).setTo(wrong[i]);
      expected(part).setTo(255);
    }
  for (const DepthSensor sensor : {DepthSensor::kExact, DepthSensor::kKinect, DepthSensor::kStereo, DepthSensor::kTof})
  {
    cv::Mat noisy = measured(sensor, exact);
    EXPECT_EQ(cv::norm(nothingIn(noisy), expected, cv::NORM_INF), 0.0);
    cv::patchNaNs(noisy, 1.5);
    EXPECT_TRUE(cv::checkRange(noisy, true, nullptr, 1.4, 1.6));
  }
}

TEST(DepthNoise, ofNoneIsNone)
{
  const cv::Mat exact = turnedPlane(depthCamera(), 8.0, 0.02);
  EXPECT_TRUE(sameBits(measured(DepthSensor::kExact, exact, cv::Mat(480, 640, CV_8UC1, cv::Scalar(0))), exact));
}

TEST(DepthNoise, dependsOnSeedAndFrameOnly)
{
  const cv::Mat exact = squareBeforeWall(), before = exact.clone();
  for (const DepthSensor sensor : kNoisy)
  {
    const DepthNoise one(sensor, depthCamera(), 1), other(sensor, depthCamera(), 1), another(sensor, depthCamera(), 2);
    cv::Mat a, b;
    std::thread thread([&] { one.apply(7, exact, cv::Mat(), a); });
    one.apply(-250, exact, cv::Mat(), b);
    thread.join();
    EXPECT_FALSE(sameBits(a, b));
    EXPECT_TRUE(sameBits(measured(other, exact, -250), b));
    EXPECT_TRUE(sameBits(measured(other, exact, 7), a));
    EXPECT_FALSE(sameBits(measured(another, exact, 7), a));
  }
  EXPECT_TRUE(sameBits(exact, before));
}

TEST(DepthNoise, takesPaddedRowsAndWritesInPlace)
{
  for (const DepthSensor sensor : {DepthSensor::kExact, DepthSensor::kKinect})
  {
    const DepthNoise noise(sensor, depthCamera(), 1);
    const cv::Mat expected = measured(noise, squareBeforeWall());
    cv::Mat memory(480, 647, CV_32FC1, cv::Scalar(-1.0)), part = memory.colRange(0, 640);
    squareBeforeWall().copyTo(part);
    EXPECT_TRUE(sameBits(measured(noise, part), expected));
    noise.apply(0, part, cv::Mat(), part);
    EXPECT_EQ(part.data, memory.data);
    EXPECT_TRUE(sameBits(part.clone(), expected));
    EXPECT_EQ(cv::countNonZero(memory.colRange(640, 647) + 1.0), 0);
  }
  const DepthNoise tiny(DepthSensor::kKinect, depthCamera(1, 1, 1.0), 1);
  EXPECT_NEAR(measured(tiny, cv::Mat(1, 1, CV_32FC1, cv::Scalar(1.0))).at<float>(0, 0), 0.6, 1e-6);  // a step: 1/8 px
}

TEST(DepthNoise, refusesImagesThatAreNotTheCameras)
{
  const DepthNoise noise(DepthSensor::kKinect, depthCamera(), 1);
  const auto refused = [&](const cv::Mat& exact, const cv::Mat& light)
  { return refusal([&] { measured(noise, exact, 0, light); }); };
  EXPECT_EQ(refused(cv::Mat(), {}), "depth image of 0x0 is empty");
  EXPECT_EQ(refused(cv::Mat(480, 640, CV_16UC1, cv::Scalar(1500)), {}),
            "depth image of 640x480: expected pixels of 1 x 32 bits (CV_32FC1), got 1 x 16 bits (CV_16UC1)");
  EXPECT_EQ(refused(cv::Mat(240, 320, CV_32FC1, cv::Scalar(1.5)), {}),
            "the size of the depth image is 320x240, must be that of the camera, 640x480");
  EXPECT_EQ(refused(filled(1.5), cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(9))),
            "brightness image of 640x480: expected pixels of 1 x 8 bits (CV_8UC1), got 3 x 8 bits (CV_8UC3)");
  EXPECT_EQ(refused(filled(1.5), cv::Mat(480, 639, CV_8UC1, cv::Scalar(9))),
            "the size of the brightness image is 639x480, must be that of the camera, 640x480");
  EXPECT_EQ(refusal([] { DepthNoise(DepthSensor::kTof, CameraModel(), 1); }), "width is 0, must be at least 1");
}
