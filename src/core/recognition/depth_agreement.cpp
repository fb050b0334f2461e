#include "depth_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace robot_vision
{
namespace
{

constexpr double kGate = 3.0;            // standard deviations, by which a depth that agrees may be off
constexpr double kSteepest = 5.0;        // tangent; steeper surfaces are not compared more loosely
constexpr int kBlock = 8;                // px, side of the blocks whose normals are compared
constexpr int kMinInBlock = 24;          // px
constexpr double kMaxTilt = 0.35;        // rad, of a block against the surface drawn
constexpr double kTiltDeviations = 2.0;  // of the noise, that are granted in addition
constexpr int kReach = 6;                // px, along which a surface goes straight on or does not
constexpr double kStraight = 2.0;        // standard deviations of the noise, by which it may bend then
const double kNan = std::numeric_limits<double>::quiet_NaN();

/// The plane through differences at pixels: sums for its slopes, and what they are.
struct Slopes
{
  double n = 0, x = 0, y = 0, d = 0, xx = 0, xy = 0, yy = 0, xd = 0, yd = 0, variance = 0;

  void add(double px, double py, double difference, double deviation)
  {
    n += 1.0;
    x += px;
    y += py;
    d += difference;
    xx += px * px;
    xy += px * py;
    yy += py * py;
    xd += px * difference;
    yd += py * difference;
    variance += deviation * deviation;
  }

  /// The length of the slope, per pixel, and its standard deviation.
  cv::Vec2d solve() const
  {
    const double a = xx - x * x / n, b = xy - x * y / n, c = yy - y * y / n, det = a * c - b * b;
    if (!(det > 0.0)) return {kNan, kNan};
    const double u = xd - x * d / n, v = yd - y * d / n;
    const double along_x = (c * u - b * v) / det, along_y = (a * v - b * u) / det;
    return {std::hypot(along_x, along_y), std::sqrt(variance / n * (a + c) / det)};
  }
};

/// The depth that is measured at a pixel of a region; NaN if there is none.
double measuredAt(const RenderedRegion& region, const RecognitionFrame& frame, const cv::Point& p)
{
  const cv::Point pixel = region.inImage(p.x, p.y);
  if (!cv::Rect({}, frame.size()).contains(pixel)) return kNan;
  const auto depth = static_cast<double>(frame.depth().at<float>(pixel));
  return depth > 0.0 ? depth : kNan;
}

/// Whether the surface that is measured goes on along `way` from a pixel of a region without an edge. There may be one
/// before the pixel, too, as what touches an object has nearly its depth there.
bool goesStraightOn(const RenderedRegion& region, const RecognitionFrame& frame, const cv::Point& here,
                    const cv::Point& way, double noise)
{
  const int reach = std::max(1, kReach / region.step);
  const double limit = kStraight * std::sqrt(6.0) * noise;  // of the sum of three depths, one of them twice
  for (int back = 0; back <= reach; back += std::max(1, reach / 2))
  {
    const cv::Point middle = here - back * way;
    const double ends =
        measuredAt(region, frame, middle - reach * way) + measuredAt(region, frame, middle + reach * way);
    if (!(std::abs(ends - 2.0 * measuredAt(region, frame, middle)) < limit)) return false;
  }
  return true;
}

}  // namespace

void DepthAgreement::compare(const RenderedRegion& region, const RecognitionFrame& frame, PoseEvidence& evidence)
{
  const cv::Size size = region.view.depth.size();
  states_.create(size, CV_8UC1);
  differences_.create(size, CV_32FC1);
  deviations_.create(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y)
    compareRow(region, frame, y);
  const double noise = depthDeviation(region.center[2], errors_);
  count(noise, evidence);
  evidence.pixels *= region.step * region.step;
  evidence.normals = normalAgreement(region);
  evidence.sunken = sunkenBorder(region, frame, noise);
}

void DepthAgreement::compareRow(const RenderedRegion& region, const RecognitionFrame& frame, int y)
{
  const auto* const drawn = region.view.depth.ptr<float>(y);
  const auto* const normals = region.view.normals.ptr<cv::Vec3f>(y);
  const auto* const measured = frame.depth().ptr<float>(region.inImage(0, y).y);
  auto* const states = states_.ptr(y);
  auto* const differences = differences_.ptr<float>(y);
  auto* const deviations = deviations_.ptr<float>(y);
  const double half_pixel = 0.5 * region.camera.pixelWidth() / region.step;
  for (int x = 0; x < states_.cols; ++x)
  {
    states[x] = kEmpty;
    const auto z = static_cast<double>(drawn[x]);
    if (!(z > 0.0)) continue;
    states[x] = kUnknown;
    const auto seen = static_cast<double>(measured[region.inImage(x, y).x]);
    if (!(seen > 0.0)) continue;
    const cv::Vec3d ray = region.camera.ray(x, y);
    const double along = std::abs(cv::Vec3d(normals[x]).dot(ray)), square = ray.dot(ray);
    const double slope = std::min(std::sqrt(std::max(square - along * along, 0.0)) / std::max(along, 1e-6), kSteepest);
    const double noise = depthDeviation(z, errors_), across = slope * half_pixel * z, difference = seen - z;
    const double deviation =
        std::sqrt(noise * noise + across * across + tolerance_ * tolerance_ * (1.0 + slope * slope));
    states[x] = difference > kGate * deviation ? kPierced : difference < -kGate * deviation ? kHidden : kAgreeing;
    differences[x] = static_cast<float>(difference);
    deviations[x] = static_cast<float>(deviation);
  }
}

/// Counts the states; `noise` is the standard deviation (m) of a depth there. At the border of what is drawn, what is
/// behind it may be seen a part of a pixel early.
void DepthAgreement::count(double noise, PoseEvidence& evidence) const
{
  int counts[5] = {};
  double squares = 0.0, expected = 0.0;
  const auto isEmpty = [&](int x, int y)
  { return x < 0 || y < 0 || x >= states_.cols || y >= states_.rows || states_.at<std::uint8_t>(y, x) == kEmpty; };
  for (int y = 0; y < states_.rows; ++y)
    for (int x = 0; x < states_.cols; ++x)
    {
      int state = states_.at<std::uint8_t>(y, x);
      if (state == kPierced && (isEmpty(x - 1, y) || isEmpty(x + 1, y) || isEmpty(x, y - 1) || isEmpty(x, y + 1)))
        state = kUnknown;
      ++counts[state];
      if (state != kAgreeing) continue;
      const double normalized = static_cast<double>(differences_.at<float>(y, x) / deviations_.at<float>(y, x));
      const double noise_alone = noise / static_cast<double>(deviations_.at<float>(y, x));
      squares += normalized * normalized;
      expected += noise_alone * noise_alone;
    }
  const double all = counts[kAgreeing] + counts[kPierced] + counts[kHidden] + counts[kUnknown];
  evidence.pixels = counts[kAgreeing];
  if (all == 0.0) return;
  evidence.agreeing = counts[kAgreeing] / all;
  evidence.pierced = counts[kPierced] / all;
  evidence.hidden = counts[kHidden] / all;
  evidence.unknown = counts[kUnknown] / all;
  evidence.misfit = counts[kAgreeing] > 0 ? std::sqrt(squares / counts[kAgreeing]) : kNan;
  evidence.noise = counts[kAgreeing] > 0 ? std::sqrt(expected / counts[kAgreeing]) : kNan;
}

/// The share of the blocks in which the differences have no slope but that of the noise; NaN if that tells nothing.
double DepthAgreement::normalAgreement(const RenderedRegion& region) const
{
  int all = 0, alike = 0;
  for (int top = 0; top < states_.rows; top += kBlock)
    for (int left = 0; left < states_.cols; left += kBlock)
    {
      Slopes slopes;
      double steepness = 0.0;
      for (int y = top; y < std::min(top + kBlock, states_.rows); ++y)
        for (int x = left; x < std::min(left + kBlock, states_.cols); ++x)
        {
          if (states_.at<std::uint8_t>(y, x) != kAgreeing) continue;
          slopes.add(x - left, y - top, static_cast<double>(differences_.at<float>(y, x)),
                     static_cast<double>(deviations_.at<float>(y, x)));
          const cv::Vec3d ray = region.camera.ray(x, y);
          const double along = cv::Vec3d(region.view.normals.at<cv::Vec3f>(y, x)).dot(ray);
          steepness += along * along / ray.dot(ray);  // its square's cosine, 1 if the surface is seen from the front
        }
      if (slopes.n < kMinInBlock) continue;
      const auto z = static_cast<double>(region.center[2]);
      const cv::Vec2d tilt = slopes.solve() * (steepness / slopes.n / (z * region.camera.pixelWidth()));
      if (!(tilt[1] < kMaxTilt)) continue;
      ++all;
      alike += tilt[0] < kMaxTilt + kTiltDeviations * tilt[1] ? 1 : 0;
    }
  return all > 0 ? static_cast<double>(alike) / all : kNan;
}

/// The share of the border of what agrees, of the sides of its pixels, where the surface that is measured goes straight
/// on before the object's, as where the object is within another thing. What hides a part of the object has an edge
/// there. `noise` is the standard deviation (m) of a depth there.
double DepthAgreement::sunkenBorder(const RenderedRegion& region, const RecognitionFrame& frame, double noise) const
{
  const cv::Rect box({}, states_.size());
  int all = 0, sunken = 0;
  for (int y = 0; y < states_.rows; ++y)
    for (int x = 0; x < states_.cols; ++x)
    {
      if (states_.at<std::uint8_t>(y, x) != kAgreeing) continue;
      const cv::Point here(x, y);
      for (const cv::Point& way : {cv::Point(-1, 0), cv::Point(1, 0), cv::Point(0, -1), cv::Point(0, 1)})
      {
        const int state = box.contains(here + way) ? int{states_.at<std::uint8_t>(here + way)} : int{kEmpty};
        if (state == kAgreeing) continue;
        ++all;
        sunken += state == kHidden && goesStraightOn(region, frame, here, way, noise) ? 1 : 0;
      }
    }
  return all > 0 ? static_cast<double>(sunken) / all : kNan;
}

}  // namespace robot_vision
