#include "view_features.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core/affine.hpp>
#include <opencv2/imgproc.hpp>

#include "place_search.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMargin = 4;            // px, around the object in the image
constexpr float kJump = 0.02F;        // of the depth, that a contour is nearer than what is behind it
constexpr float kSmooth = 0.94F;      // cosine of the angle between normals that are kReach px from each other
constexpr int kReach = 3;             // px
constexpr int kContrast = 25;         // gray levels, of an inner edge
constexpr int kContourMargin = 4;     // px, from a contour to the nearest inner edge
constexpr double kGrazing = 0.26;     // cosine of the largest angle between the ray and the normal of a feature
constexpr double kClearance = 12.0;   // px, from an anchor to the nearest edge that is enough
constexpr double kMaxSpacing = 32.0;  // px, between features
constexpr double kMinSpacing = 1.5;

bool isInside(const cv::Point& p, int margin)
{
  return p.x >= margin && p.y >= margin && p.x < StudioCamera::kSide - margin && p.y < StudioCamera::kSide - margin;
}

/// Calls visit(pixel) for all pixels of the mask.
template <class Visit>
void forPixels(const cv::Mat& mask, const Visit& visit)
{
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask.at<std::uint8_t>(y, x) != 0) visit(cv::Point(x, y));
}

}  // namespace

StudioCamera::StudioCamera(const ViewParams& params, double radius)
  : distance(std::max(params.distance, 2.5 * radius)),
    focal_length((0.5 * kSide - kMargin) * std::sqrt(distance * distance - radius * radius) / radius)
{
}

View ViewFeatureFinder::find(const MeshView& drawn, const cv::Matx33d& rotation)
{
  depth_ = drawn.depth;
  bgr_ = drawn.bgr;
  normals_ = drawn.normals;
  View view;
  findRegions();
  if (!findAnchor()) return view;
  view.rotation = cv::Affine3d(to_anchor_ * rotation, cv::Vec3d()).rvec();
  view.center = to_anchor_ * (cv::Vec3d(0, 0, camera_.distance) - anchor_);
  const cv::Rect box = cv::boundingRect(seen_);
  const cv::Vec3d first = camera_.ray(box.tl()), last = camera_.ray(box.br());
  const double z = anchor_[2];
  view.box = {first[0] * z - anchor_[0], first[1] * z - anchor_[1], (last[0] - first[0]) * z, (last[1] - first[1]) * z};
  findContours(edges_);
  choose(params_.contour_features, FeatureKind::kContour, view);
  findInner();
  choose(params_.inner_features, FeatureKind::kInner, view);
  findSurfaces();
  choose(params_.surface_features, FeatureKind::kSurface, view);
  return view;
}

void ViewFeatureFinder::findRegions()
{
  seen_ = depth_ == depth_;  // NaN is not equal to itself
  edges_.create(depth_.size(), CV_8UC1);
  edges_.setTo(0);
  smooth_.create(depth_.size(), CV_8UC1);
  smooth_.setTo(0);
  const cv::Point beside[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  forPixels(seen_,
            [&](const cv::Point& p)
            {
              if (!isInside(p, kReach)) return;
              const float z = depth_.at<float>(p);
              const cv::Vec3f normal = normals_.at<cv::Vec3f>(p);
              bool edge = false, smooth = true;
              for (const cv::Point& step : beside)
              {
                const float next = depth_.at<float>(p + step);
                edge = edge || !(next <= z * (1.0F + kJump));
                smooth = smooth && normal.dot(normals_.at<cv::Vec3f>(p + kReach * step)) >= kSmooth;
              }
              edges_.at<std::uint8_t>(p) = edge ? 255 : 0;
              smooth_.at<std::uint8_t>(p) = smooth && !edge ? 255 : 0;
            });
}

/// Near the middle of the view, as far as it is away from edges.
bool ViewFeatureFinder::findAnchor()
{
  if (cv::countNonZero(seen_) == 0) return false;
  const bool any_smooth = cv::countNonZero(smooth_) > 0;
  cv::distanceTransform(any_smooth ? smooth_ : seen_, clearance_, cv::DIST_L2, cv::DIST_MASK_5);
  const cv::Rect box = cv::boundingRect(seen_);
  const cv::Point2d middle(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
  double best = -1e9;
  cv::Point at;
  forPixels(any_smooth ? smooth_ : seen_,
            [&](const cv::Point& p)
            {
              const double clearance = std::min<double>(clearance_.at<float>(p), kClearance);
              const double merit = 2.0 * clearance - 0.25 * cv::norm(cv::Point2d(p) - middle);
              if (merit > best) at = p;
              best = std::max(best, merit);
            });
  const cv::Vec3d ray = camera_.ray(at);
  anchor_ = ray * static_cast<double>(depth_.at<float>(at));
  to_anchor_ = rayFrame(ray[0], ray[1]).t();
  return true;
}

/// The direction in which what is behind an edge begins, by the derivatives of depths between that of the edge and of
/// what is just behind it.
void ViewFeatureFinder::findContours(const cv::Mat& edges)
{
  candidates_.clear();
  forPixels(edges,
            [&](const cv::Point& p)
            {
              const float z = depth_.at<float>(p), far = z * (1.0F + kJump);
              double x = 0.0, y = 0.0;
              for (int v = -kReach; v <= kReach; ++v)
                for (int u = -kReach; u <= kReach; ++u)
                {
                  const float next = depth_.at<float>(p + cv::Point(u, v));
                  const float value = std::isnan(next) ? far : std::clamp(next, z, far);
                  const double weight = std::exp(-(u * u + v * v) / 6.0) * (value - z) / (far - z);
                  x += u * weight;
                  y += v * weight;
                }
              const int strength = static_cast<int>(16.0 * std::hypot(x, y));
              if (strength > 0) candidates_.push_back({p, strength, static_cast<float>(std::atan2(y, x))});
            });
}

void ViewFeatureFinder::findInner()
{
  candidates_.clear();
  cv::Mat from_edge, gray, dx, dy;
  cv::distanceTransform(edges_ == 0, from_edge, cv::DIST_L2, cv::DIST_MASK_5);
  cv::cvtColor(bgr_, gray, cv::COLOR_BGR2GRAY);
  cv::GaussianBlur(gray, gray, {3, 3}, 0.0);
  cv::Sobel(gray, dx, CV_16S, 1, 0);
  cv::Sobel(gray, dy, CV_16S, 0, 1);
  const auto strengthAt = [&](const cv::Point& p)
  { return static_cast<int>(std::hypot(dx.at<std::int16_t>(p), dy.at<std::int16_t>(p))); };
  forPixels(seen_,
            [&](const cv::Point& p)
            {
              if (!isInside(p, kReach) || from_edge.at<float>(p) < kContourMargin) return;
              const int strength = strengthAt(p);
              if (strength < 4 * kContrast) return;
              const double direction = std::atan2(dy.at<std::int16_t>(p), dx.at<std::int16_t>(p));
              const cv::Point across(cvRound(std::cos(direction)), cvRound(std::sin(direction)));
              if (strength > strengthAt(p + across) && strength >= strengthAt(p - across))
                candidates_.push_back({p, strength, static_cast<float>(direction)});
            });
}

void ViewFeatureFinder::findSurfaces()
{
  candidates_.clear();
  forPixels(smooth_,
            [&](const cv::Point& p)
            {
              const cv::Vec3d ray = camera_.ray(p);
              if (-cv::Vec3d(normals_.at<cv::Vec3f>(p)).dot(ray) < kGrazing * cv::norm(ray)) return;
              candidates_.push_back({p, cvRound(std::min<double>(clearance_.at<float>(p), kClearance)), 0.0F});
            });
}

/// The strongest ones that are far from each other, then those between them.
void ViewFeatureFinder::choose(int count, FeatureKind kind, View& view)
{
  std::stable_sort(candidates_.begin(), candidates_.end(),
                   [](const Candidate& a, const Candidate& b) { return a.strength > b.strength; });
  std::vector<Candidate> chosen;
  for (double spacing = kMaxSpacing; spacing >= kMinSpacing; spacing *= 0.75)
  {
    const int radius = cvRound(spacing);
    taken_.create(depth_.size(), CV_8UC1);
    taken_.setTo(0);
    for (const Candidate& one : chosen)
      cv::circle(taken_, one.pixel, radius, cv::Scalar(255), cv::FILLED);
    for (const Candidate& one : candidates_)
    {
      if (static_cast<int>(chosen.size()) == count) break;
      if (taken_.at<std::uint8_t>(one.pixel) != 0) continue;
      cv::circle(taken_, one.pixel, radius, cv::Scalar(255), cv::FILLED);
      chosen.push_back(one);
    }
  }
  for (const Candidate& one : chosen)
    view.features.push_back(feature(one, kind));
}

ViewFeature ViewFeatureFinder::feature(const Candidate& candidate, FeatureKind kind) const
{
  const double z = depth_.at<float>(candidate.pixel), step = radius_ / 8192.0;
  const cv::Vec3d place = to_anchor_ * (camera_.ray(candidate.pixel) * z - anchor_) / step;
  ViewFeature feature;
  feature.x = static_cast<std::int16_t>(cvRound(place[0]));
  feature.y = static_cast<std::int16_t>(cvRound(place[1]));
  feature.z = static_cast<std::int16_t>(cvRound(place[2]));
  feature.kind = kind;
  if (kind == FeatureKind::kSurface)
  {
    const cv::Vec3d normal = to_anchor_ * cv::Vec3d(normals_.at<cv::Vec3f>(candidate.pixel));
    feature.a = static_cast<std::int8_t>(normal[0] * 127.0);  // towards 0, so that the length is at most 1
    feature.b = static_cast<std::int8_t>(normal[1] * 127.0);
    return feature;
  }
  const double turns = candidate.direction / CV_PI;
  feature.a = static_cast<std::int8_t>(std::min(127, static_cast<int>((turns - std::floor(turns)) * 128.0)));
  return feature;
}

}  // namespace robot_vision
