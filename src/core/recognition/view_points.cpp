#include "view_points.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{
namespace
{

cv::Vec3d normalOf(const ViewFeature& feature)
{
  if (feature.kind == FeatureKind::kSurface)
  {
    const double x = feature.a / 127.0, y = feature.b / 127.0;
    return {x, y, -std::sqrt(std::max(0.0, 1.0 - x * x - y * y))};
  }
  const double direction = (feature.a + 0.5) * CV_PI / 128.0;
  return {std::cos(direction), std::sin(direction), 0.0};
}

}  // namespace

ViewPoints::ViewPoints(const View& view, const ViewModel& model, FeatureKind kind)
{
  std::vector<cv::Vec6f> all;
  for (const ViewFeature& feature : view.features)
  {
    if (feature.kind != kind) continue;
    const cv::Vec3d place = model.step() * cv::Vec3d(feature.x, feature.y, feature.z), normal = normalOf(feature);
    all.emplace_back(cv::Vec6d(place[0], place[1], place[2], normal[0], normal[1], normal[2]));
  }
  count_ = static_cast<int>(all.size());
  for (int k = 0; k < 6; ++k)
    for (const cv::Vec6f& one : all)
      numbers_.push_back(one[k]);
}

FitPoints ViewPoints::points() const
{
  const float* const x = numbers_.data();
  return {x, x + count_, x + 2 * count_, x + 3 * count_, x + 4 * count_, x + 5 * count_};
}

ViewFeatures::ViewFeatures(const View& view, const ViewModel& model)
  : contours(view, model, FeatureKind::kContour),
    inner(view, model, FeatureKind::kInner),
    surfaces(view, model, FeatureKind::kSurface)
{
}

}  // namespace robot_vision
